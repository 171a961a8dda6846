"""What cells are to formats that know walls, starts, exits and perhaps cells that end all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.convert.blocks import Rows, as_blocks, has_walls
from babyrobot_levels.convert.conversion import Lost, fields_lost
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.checks import painted
from babyrobot_levels.language.fields import Role, fields_with

if TYPE_CHECKING:
    from babyrobot_levels.language.moves import Rewards
    from babyrobot_levels.library.level import Level

ENDS = "x"
"""The mark of a cell whose area ends the episode."""

HOLE_COLOR, LAVA_COLOR = "#1b3a5c", "orangered"
"""The colours of such cells where the other format shows them in one of its own."""

SPATIAL = frozenset(fields_with(Role.GEOMETRY)) - {"map", "legend"}
"""The fields that a map of blocks is made of."""

UNLIKE = frozenset({"areas", "rewards"})
"""Fields of which a part may be carried, and which are looked at one by one."""


def marked(level: Level) -> Rows:
    """Return the cells row by row: plain, blocked, a start, an exit, or one that ends all."""
    width, height = level.size
    blocked = level.grid().blocked_cells
    ends = painted(level, ((area, area.ends) for area in level.areas if area.ends is not None))
    rows = [[d.PLAIN] * width for _ in range(height)]
    for y, row in enumerate(rows):
        for x in range(width):
            if blocked[y * width + x]:
                row[x] = d.BLOCKED
            elif ends((x, y)):
                row[x] = ENDS
    for character, cells in ((d.START, level.starts), (d.EXIT, level.exits)):
        for x, y in cells:
            rows[y][x] = character
    return tuple("".join(row) for row in rows)


def block_map(
    level: Level, place: str, rewards: Rewards, *, ends: str | None, many: str
) -> tuple[Rows, list[Lost]]:
    """Return a level in blocks with a ring around it, and what these cannot say.

    Args:
        level: the level.
        place: what has no place for the rest: "a Sokoban map".
        rewards: the rewards that reading such a map gives.
        ends: why cells that end the episode are not what they were; None where they are.
        many: of which marks there may be more than one: `S`, `E`, both or none.
    """
    lost = list(fields_lost(level, SPATIAL | UNLIKE, place))
    lost += lost_areas(level, ends)
    if level.rewards != rewards:
        lost.append(Lost("rewards", f"{place} has no place for them"))
    grid, cells = level.grid(), list(marked(level))
    for character, name, found in ((d.START, "start", level.starts), (d.EXIT, "exit", level.exits)):
        if len(found) > 1 and character not in many:
            lost.append(
                Lost(name, f"{place} has one, so only [{found[0][0]}, {found[0][1]}] is kept")
            )
            for x, y in found[1:]:
                cells[y] = cells[y][:x] + d.PLAIN + cells[y][x + 1 :]
    lattice = has_walls(grid)
    if lattice:
        message = "walls between cells become blocks, and each step becomes two"
        lost.append(Lost("walls", message))
    if ends is not None:
        cells = [row.replace(ENDS, d.PLAIN) for row in cells]
    return as_blocks(grid, cells, lattice=lattice), lost


def lost_areas(level: Level, ends: str | None, *, hole: float | None = None) -> Iterator[Lost]:
    """Yield what areas say beside that the episode ends there.

    Args:
        level: the level.
        ends: why not even that is kept; None if it is.
        hole: the reward that is kept where it ends; None for that of a step.
    """
    step = level.rewards.step
    hole = step if hole is None else hole
    kept: dict[str, set[object]] = {
        "color": {None, HOLE_COLOR, LAVA_COLOR},
        "skid": {None},
        "ends": {None, False, True} if ends is None else {None, False},
        "label": {None},
    }
    for name, values in kept.items():
        if any(getattr(area, name) not in values for area in level.areas):
            yield Lost(f"areas.{name}", ends if name == "ends" and ends else "areas are not shown")
    rewards = ((area, step if area.reward is None else area.reward) for area in level.areas)
    if any(reward != (hole if area.ends else step) for area, reward in rewards):
        yield Lost("areas.reward", "areas are not shown")
