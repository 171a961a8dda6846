"""Warps as look-up tables: where they send whom, and what that is worth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.moves import Warp
from babyrobot_levels.mdp.grid import Grid


@dataclass(frozen=True, eq=False)
class Warps:
    """Arrays `[states]`. The state number `states` itself stands for "one of the starts".

    Attributes:
        arrive: where a robot stands that would come to stand on the state.
        arrive_reward: the reward of that step, nan where the warps give none.
        leaves: whether every move out of the state is a warp.
        leave_to: where those moves lead, `arrive` included.
        leave_reward: the reward of those moves, nan where the warps give none.
    """

    arrive: NDArray[np.int64]
    arrive_reward: NDArray[np.float64]
    leaves: NDArray[np.bool_]
    leave_to: NDArray[np.int64]
    leave_reward: NDArray[np.float64]


def build_warps(level: LevelFields, grid: Grid) -> Warps:
    """Follow every warp to its end: one that leads onto another goes on from there."""
    count = grid.width * grid.height
    enter = {_state(warp.at, grid): warp for warp in level.warps if warp.when == "enter"}
    arrive = np.arange(count + 1)
    arrive_reward = np.full(count + 1, np.nan)
    for state in enter:
        arrive[state], arrive_reward[state] = _follow(state, enter, level, grid)
    leaves = np.zeros(count, bool)
    leave_to = np.arange(count)
    leave_reward = np.full(count, np.nan)
    for warp in level.warps:
        if warp.when == "leave":
            state, to = _state(warp.at, grid), _target(warp, level, grid)
            leaves[state] = True
            leave_to[state] = arrive[to]
            leave_reward[state] = arrive_reward[to] if warp.reward is None else warp.reward
    return Warps(arrive, arrive_reward, leaves, leave_to, leave_reward)


def _follow(
    state: int, enter: dict[int, Warp], level: LevelFields, grid: Grid
) -> tuple[int, float]:
    """Return where the chain of warps ends, and the first reward that it gives."""
    reward = None
    # The fields were checked: no chain is a circle.
    while state in enter:
        warp = enter[state]
        reward = warp.reward if reward is None else reward
        state = _target(warp, level, grid)
    return state, np.nan if reward is None else reward


def _target(warp: Warp, level: LevelFields, grid: Grid) -> int:
    if isinstance(warp.to, str):
        starts = level.starts
        return _state(starts[0], grid) if len(starts) == 1 else grid.width * grid.height
    return _state(warp.to, grid)


def _state(cell: tuple[int, int], grid: Grid) -> int:
    return cell[1] * grid.width + cell[0]
