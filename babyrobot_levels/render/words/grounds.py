"""The kinds of ground of a level: cells that areas and warps make alike."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from babyrobot_levels.language.cells import Skid, Warp, as_skid
from babyrobot_levels.render.effects import End, effects_of
from babyrobot_levels.render.words import phrases

if TYPE_CHECKING:
    from babyrobot_levels.language.cells import Area
    from babyrobot_levels.mdp.gridworld import GridWorld

_PROPERTIES = ("color", "label", "reward", "skid", "ends")


@dataclass(frozen=True, slots=True)
class Ground:
    """A kind of ground.

    Attributes:
        cells: the numbers of its cells, row by row.
        name: what it is called: by its label, by its mark in pictures, or by its colour.
        reward: the reward for entering it.
        skid: its own skid; None for that of the level.
        end: how it ends the episode; None if it does not.
        warp: the warp in it.
    """

    cells: tuple[int, ...]
    name: str
    reward: float
    skid: Skid | None
    end: End | None
    warp: Warp | None

    def places(self, level: GridWorld) -> list[tuple[int, int]]:
        """Return its cells as `(x, y)`."""
        width = level.size[0]
        return [(cell % width, cell // width) for cell in self.cells]


def grounds_of(level: GridWorld) -> Iterator[Ground]:
    """Yield the kinds of ground that areas and warps make, in the order of their first cells.

    Exits, blocked cells and puddles are left out, except for puddles in which episodes end.
    """
    if not (level.areas or level.warps):
        return
    # Levels without areas need no NumPy for their words.
    import numpy as np

    width, height = level.size
    table = np.full((len(_PROPERTIES) + 1, height, width), -1)
    for number, area in enumerate(level.areas):
        (x, y), (columns, rows) = area.at, area.size
        given = [getattr(area, name) is not None for name in _PROPERTIES]
        table[:-1, y : y + rows, x : x + columns][given] = number
    for number, warp in enumerate(level.warps):
        table[-1, warp.at[1], warp.at[0]] = number
    flat = table.reshape(len(table), -1)
    left_out = np.frombuffer(level.grid().blocked_cells, np.uint8).astype(bool)
    left_out[[y * width + x for x, y in level.exits]] = True
    places = np.flatnonzero((flat >= 0).any(axis=0) & ~left_out)
    kinds, kind = np.unique(flat[:, places], axis=1, return_inverse=True)
    by_kind = np.argsort(kind.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(kind.ravel()))[:-1]
    cells = [tuple(places[part].tolist()) for part in np.split(by_kind, ends)]
    told = effects_of(level).ends
    wet = {y * width + x for x, y in (puddle.at for puddle in level.puddles)}
    for index in sorted(range(kinds.shape[1]), key=lambda index: cells[index][0]):
        *areas, warp = kinds[:, index].tolist()
        ground = _ground(level, cells[index], areas, warp, told)
        if ground.end or ground.cells[0] not in wet:
            yield ground


def _ground(
    level: GridWorld,
    cells: tuple[int, ...],
    areas: list[int],
    warp: int,
    told: Mapping[tuple[int, int], End],
) -> Ground:
    def given(name: str) -> Area | None:
        number = areas[_PROPERTIES.index(name)]
        return level.areas[number] if number >= 0 else None

    color, label, reward, skid, ends = (given(name) for name in _PROPERTIES)
    y, x = divmod(cells[0], level.size[0])
    end = told.get((x, y)) if ends and ends.ends else None
    name = phrases.worded(phrases.name_of(label.label)) if label else ""
    if not name and end is not None:
        name = "chest" if end.is_good else "trap" if end.costs else "hole"
    elif not name and warp >= 0:
        name = "warp"
    elif not name:
        shown = color.color if color else None
        theme = level.resolved_theme.colors
        name = "some cells" if shown is None else f"{phrases.color_name(shown, theme)} cell"
    return Ground(
        cells=cells,
        name=name,
        reward=reward.reward if reward and reward.reward is not None else level.rewards.step,
        skid=as_skid(skid.skid) if skid and skid.skid is not None else None,
        end=end,
        warp=level.warps[warp] if warp >= 0 else None,
    )
