"""The ground of a level: what its areas and puddles paint on its cells.

Plain Python, no NumPy needed.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field

from babyrobot_levels.language.cells import RandomReward, SkidLike, SkidRule, as_skid, mean_of
from babyrobot_levels.language.fields import LevelFields

RULES = tuple(SkidRule)
OPEN_RULE, SIDES_RULE, OTHERS_RULE = range(3)


@dataclass(frozen=True, eq=False)
class Ground:
    """Sequences `[cells]`; cells are numbered row by row.

    Attributes:
        skid: the probability that a move out of the cell goes astray.
        rule: where it goes then, an index into `RULES`.
        reward: the reward of standing on the cell after a step; of one that is drawn, the mean.
        ends: 1 for a cell that ends the episode, exits left out.
        random: the rewards that are drawn, by cell.
    """

    skid: array[float]
    rule: bytearray
    reward: array[float]
    ends: bytearray
    random: dict[int, RandomReward] = field(default_factory=dict)

    def paint_skid(self, cells: slice, value: SkidLike) -> None:
        """Give cells another skid."""
        skid, count = as_skid(value), cells.stop - cells.start
        self.skid[cells] = array("d", [skid.probability]) * count
        self.rule[cells] = bytes([RULES.index(SkidRule(skid.to))]) * count

    def paint_reward(self, cells: slice, reward: float | RandomReward) -> None:
        """Give cells another reward."""
        self.reward[cells] = array("d", [mean_of(reward)]) * (cells.stop - cells.start)
        numbers = range(cells.start, cells.stop)
        if isinstance(reward, RandomReward):
            self.random.update(dict.fromkeys(numbers, reward))
        elif self.random:
            for cell in numbers:
                self.random.pop(cell, None)


def build_ground(level: LevelFields) -> Ground:
    """Paint the level's properties: those of the whole level, then areas in order, then puddles."""
    width, height = level.size
    count = width * height
    reward = array("d", [level.rewards.step]) * count
    ground = Ground(array("d", bytes(8 * count)), bytearray(count), reward, bytearray(count))
    if level.skid is not None:
        ground.paint_skid(slice(0, count), level.skid)
    for area in level.areas:
        for cells in rows_of(area.at, area.size, width):
            if area.reward is not None:
                ground.paint_reward(cells, area.reward)
            if area.skid is not None:
                ground.paint_skid(cells, area.skid)
            if area.ends is not None:
                ground.ends[cells] = bytes([area.ends]) * (cells.stop - cells.start)
    for size in ("small", "large"):
        kind = getattr(level.puddle_types, size)
        for puddle in level.puddles:
            if puddle.size == size:
                (cells,) = rows_of(puddle.at, (1, 1), width)
                ground.paint_reward(cells, kind.reward)
                ground.paint_skid(cells, kind.skid)
    return ground


def exit_rewards(
    level: LevelFields, exits: Sequence[tuple[int, int]]
) -> list[float | RandomReward]:
    """Return what some exits pay: each what its cell does (`exit: cell`), or all the same."""
    if not isinstance(level.rewards.exit, str):
        return [level.rewards.exit] * len(exits)
    ground = build_ground(level)
    cells = [y * level.size[0] + x for x, y in exits]
    return [ground.random.get(cell, ground.reward[cell]) for cell in cells]


def rows_of(at: tuple[int, int], size: tuple[int, int], width: int) -> Sequence[slice]:
    """Return the cells of each row of a rectangle, in a level so many columns wide."""
    (x, y), (columns, rows) = at, size
    return [slice(row * width + x, row * width + x + columns) for row in range(y, y + rows)]
