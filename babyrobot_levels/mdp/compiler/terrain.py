"""What each cell does to a robot: arrays over the cells, painted from the level's fields."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.cells import SkidLike, SkidRule, as_skid
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.grid import Grid

RULES = tuple(SkidRule)
OPEN_RULE, SIDES_RULE, OTHERS_RULE = range(3)


@dataclass(frozen=True, eq=False)
class Terrain:
    """Arrays `[states]`; a state is a cell, numbered row by row.

    Attributes:
        skid: the probability that a move out of the cell goes astray.
        rule: where it goes then, an index into `RULES`.
        reward: the reward of standing on the cell after a step.
        exit: whether the cell is an exit.
        ends: whether the episode is over there, exits left out: a cell that ends it, or blocked.
        over: whether the episode is over there: an exit, a cell that ends it, a blocked cell.
        distance: the squared straight-line distance to the nearest exit; None where there is no
            exit, or no reward asks for it.
    """

    skid: NDArray[np.float64]
    rule: NDArray[np.int8]
    reward: NDArray[np.float64]
    exit: NDArray[np.bool_]
    ends: NDArray[np.bool_]
    over: NDArray[np.bool_]
    distance: NDArray[np.int64] | None


def build_terrain(
    level: LevelFields, grid: Grid, exits: tuple[tuple[int, int], ...] | None = None
) -> Terrain:
    """Paint the level's properties: those of the whole level, then areas in order, then puddles.

    Args:
        level: the level.
        grid: its grid.
        exits: the exits, if they are not those of the level.
    """
    shape = (grid.height, grid.width)
    skid, rule = np.zeros(shape), np.zeros(shape, np.int8)
    reward = np.full(shape, level.rewards.step)
    ends = np.zeros(shape, bool)
    if level.skid is not None:
        skid[:], rule[:] = _skid(level.skid)
    for area in level.areas:
        (x, y), (columns, rows) = area.at, area.size
        where = (slice(y, y + rows), slice(x, x + columns))
        if area.reward is not None:
            reward[where] = area.reward
        if area.skid is not None:
            skid[where], rule[where] = _skid(area.skid)
        if area.ends is not None:
            ends[where] = area.ends
    for size in ("small", "large"):
        kind = getattr(level.puddle_types, size)
        rows_, columns_ = _index(puddle.at for puddle in level.puddles if puddle.size == size)
        reward[rows_, columns_] = kind.reward
        skid[rows_, columns_], rule[rows_, columns_] = _skid(kind.skid)
    shaped = level.rewards.closer is not None or level.rewards.farther is not None
    exit_cells = level.exits if exits is None else exits
    is_exit = np.zeros(shape, bool)
    is_exit[_index(exit_cells)] = True
    return Terrain(
        skid.ravel(),
        rule.ravel(),
        reward.ravel(),
        is_exit.ravel(),
        (ends | grid.blocked).ravel(),
        (ends | is_exit | grid.blocked).ravel(),
        _squared_distance(is_exit).ravel() if exit_cells and shaped else None,
    )


def _skid(value: SkidLike) -> tuple[float, int]:
    skid = as_skid(value)
    return skid.probability, RULES.index(SkidRule(skid.to))


def _index(cells: Iterable[tuple[int, int]]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return cells `(x, y)` as an index into arrays `[height, width]`."""
    pairs = np.array(list(cells), np.intp).reshape(-1, 2)
    return pairs[:, 1], pairs[:, 0]


def _squared_distance(exits: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return each cell's squared distance to the nearest exit, whole numbers and so exact.

    First along the columns, then along the rows: as fast for many exits as for one.
    """
    height, width = exits.shape
    far = 4 * (height + width)
    vertical = np.where(exits, 0, far).astype(np.int64)
    for y in range(1, height):
        vertical[y] = np.minimum(vertical[y], vertical[y - 1] + 1)
    for y in range(height - 2, -1, -1):
        vertical[y] = np.minimum(vertical[y], vertical[y + 1] + 1)
    return _least_with_distance(vertical**2)


def _least_with_distance(values: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return, for each x of each row, the least of all `values[row, q] + (x - q)²`.

    The first best q never falls from one x to a greater one, so it is looked for only between
    those of two neighbours that are known: far apart at first, then halfway between them.
    """
    rows, width = values.shape
    best, nearest = np.zeros_like(values), np.empty_like(values)
    first = np.arange(rows)[:, None] * width
    step = 1 << (width.bit_length() - 1)
    while step:
        x = np.arange(step - 1, width, 2 * step)
        low, high = np.zeros((rows, x.size), np.int64), np.full((rows, x.size), width - 1)
        low[:, 1:] = best[:, x[1:] - step]
        is_known = x + step < width
        high[:, is_known] = best[:, (x + step)[is_known]]
        # All that is looked at, one after another, by its place in the flat array.
        length = (high - low + 1).ravel()
        begin = np.cumsum(length) - length
        place = np.arange(length.sum()) + np.repeat((first + low).ravel() - begin, length)
        distance = place - np.repeat((first + x).ravel(), length)
        told = (values.ravel()[place] + distance**2) * width + place % width
        least = np.minimum.reduceat(told, begin).reshape(rows, x.size)
        nearest[:, x], best[:, x] = np.divmod(least, width)
        step //= 2
    return nearest
