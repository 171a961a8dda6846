"""The kinds of ground of a level: cells that areas and warps make alike."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from babyrobot_levels.language.cells import Skid, as_skid
from babyrobot_levels.language.moves import Warp
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
        color: its colour; None for that of all other cells.
        label: the label of its area; empty without one, or if it has no letters.
        reward: the reward for entering it.
        skid: its own skid; None for that of the level.
        ends: whether it ends the episode.
        warp: the warp in it.
    """

    cells: tuple[int, ...]
    color: str | None
    label: str
    reward: float
    skid: Skid | None
    ends: bool
    warp: Warp | None


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
    wet = {y * width + x for x, y in (puddle.at for puddle in level.puddles)}
    for index in sorted(range(kinds.shape[1]), key=lambda index: cells[index][0]):
        *areas, warp = kinds[:, index].tolist()
        ground = _ground(level, cells[index], areas, warp)
        if ground.ends or ground.cells[0] not in wet:
            yield ground


def _ground(level: GridWorld, cells: tuple[int, ...], areas: list[int], warp: int) -> Ground:
    def given(name: str) -> Area | None:
        number = areas[_PROPERTIES.index(name)]
        return level.areas[number] if number >= 0 else None

    color, label, reward, skid, ends = (given(name) for name in _PROPERTIES)
    return Ground(
        cells=cells,
        color=color.color if color else None,
        label=phrases.worded(phrases.name_of(label.label)) if label else "",
        reward=reward.reward if reward and reward.reward is not None else level.rewards.step,
        skid=as_skid(skid.skid) if skid and skid.skid is not None else None,
        ends=bool(ends and ends.ends),
        warp=level.warps[warp] if warp >= 0 else None,
    )
