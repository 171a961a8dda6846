"""What cells do to the robot, as pictures tell it: how they end an episode, pay, cost and skid."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.cells import shifts
from babyrobot_levels.language.geometry import Cell

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld


STRENGTHS = 3
"""How many strengths a picture tells apart."""


class End(NamedTuple):
    """How a cell that is no exit ends the episode.

    Attributes:
        is_good: whether it pays; without exits and ends that pay, whether none costs less.
        costs: whether it costs more than a step.
        strength: 1 to 3: its reward beside the largest one of such ends.
    """

    is_good: bool
    costs: bool
    strength: int


@dataclass(frozen=True, slots=True)
class Effects:
    """What the cells that are unlike plain ones do.

    Attributes:
        ends: the cells other than exits that end the episode.
        pays: the cells that pay more than a step, and more than 0, with a strength from 1 to 3.
            These are rewards of areas, and of warps.
        costs: the cells that cost more than a step, likewise.
        skids: the cells out of which the robot may skid, puddles left out: 1 for a chance below
            1/4, 2 for one below 1/2, else 3.
        winds: how far the wind pushes, east and south, in the cells where it does.
    """

    ends: dict[Cell, End] = field(default_factory=dict)
    pays: dict[Cell, int] = field(default_factory=dict)
    costs: dict[Cell, int] = field(default_factory=dict)
    skids: dict[Cell, int] = field(default_factory=dict)
    winds: dict[Cell, tuple[int, int]] = field(default_factory=dict)

    @property
    def good_ends(self) -> frozenset[Cell]:
        """The cells other than exits in which episodes end well."""
        return frozenset(cell for cell, end in self.ends.items() if end.is_good)

    def at(self, cell: Cell) -> Effects:
        """Return what one of the cells does, as if it were the cell (0, 0)."""
        parts = {
            part.name: {(0, 0): told[cell]} if cell in (told := getattr(self, part.name)) else {}
            for part in fields(self)
        }
        return Effects(**parts)


def effects_of(level: GridWorld) -> Effects:
    """Return what the cells of a level do.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    if not (level.areas or level.warps or level.wind is not None or level.skid is not None):
        return Effects()
    # It imports NumPy, which a picture of a plain level does without.
    from babyrobot_levels.mdp.compiler.terrain import build_terrain

    terrain, blocked = build_terrain(level, level.grid()), level.grid().blocked_cells
    width, height = level.size
    free = [(x, y) for y in range(height) for x in range(width) if not blocked[y * width + x]]

    def told(values: Iterable[float]) -> dict[Cell, float]:
        numbers = list(values)
        return {(x, y): numbers[y * width + x] for x, y in free}

    is_end, reward = told(terrain.ends.tolist()), told(terrain.reward.tolist())
    # Nobody stays there.
    passed = {warp.at for warp in level.warps if warp.when == "enter"}
    exits = {*level.exits}
    ends = [cell for cell in free if is_end[cell] and cell not in exits and cell not in passed]
    left = set(free).difference(ends, exits, passed)
    puddles = {puddle.at for puddle in level.puddles}
    plain = [cell for cell in free if cell in left and cell not in puddles]
    step = _usual((reward[cell] for cell in plain), level.rewards.step)
    paid = {cell: reward[cell] for cell in plain}
    paid |= {warp.at: warp.reward for warp in level.warps if warp.reward is not None}
    pays, costs = _strengths(paid, step)
    skid = told(terrain.skid.tolist())
    south, east = shifts(level.wind, width, height)
    pushes = {(x, y): (east[y], south[x]) for x, y in free if (x, y) in left}
    return Effects(
        ends=_ends({cell: reward[cell] for cell in ends}, step, level),
        pays=pays,
        costs=costs,
        skids={cell: int(1 + 4 * min(skid[cell], 0.5)) for cell in plain if skid[cell]},
        winds={cell: push for cell, push in pushes.items() if any(push)},
    )


def _usual(rewards: Iterable[float], step: float) -> float:
    """Return the reward of a plain cell: that of a step, if there is any such cell."""
    counts = Counter(rewards)
    return step if step in counts or not counts else counts.most_common(1)[0][0]


def _ends(rewards: Mapping[Cell, float], step: float, level: GridWorld) -> dict[Cell, End]:
    best = max(rewards.values(), default=0.0)
    least = math.inf if level.exits or best > 0 else best
    most = max(map(abs, rewards.values()), default=0.0)
    return {
        cell: End(
            is_good=reward > 0 or reward >= least,
            costs=reward < min(step, 0.0),
            strength=_strength(abs(reward), most),
        )
        for cell, reward in rewards.items()
    }


def _strengths(
    rewards: Mapping[Cell, float], step: float
) -> tuple[dict[Cell, int], dict[Cell, int]]:
    """Return the cells that pay and those that cost, with their strengths."""
    most = max((abs(reward - step) for reward in rewards.values()), default=0.0)
    pays, costs = {}, {}
    for cell, reward in rewards.items():
        strength = _strength(abs(reward - step), most)
        if reward > max(step, 0.0):
            pays[cell] = strength
        elif reward < step:
            costs[cell] = strength
    return pays, costs


def _strength(amount: float, most: float) -> int:
    return min(STRENGTHS, 1 + int(STRENGTHS * amount / most)) if most else STRENGTHS
