"""What can happen in a step, as branches: the chances of skidding, of glass, and none at all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.actions import NUM_ACTIONS, NUM_MOVES, Action
from babyrobot_levels.compiler.moves import Moves
from babyrobot_levels.compiler.terrain import OPEN_RULE, OTHERS_RULE, SIDES_RULE, Terrain
from babyrobot_levels.compiler.warps import Warps

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(slots=True)
class Branches:
    """Possible ends of steps, before any warp. All arrays have one length.

    Attributes:
        row: state and action, `state * actions + action`.
        probability: how likely the branch is.
        landing: the state on which the robot comes to stand.
        bumped: whether a wall refused the move.
        bounced: whether it bounced off a wall of glass.
    """

    row: Ints
    probability: Floats
    landing: Ints
    bumped: Flags
    bounced: Flags

    def select(self, which: Flags | Ints) -> Self:
        """Return some of the branches, by flags or by numbers."""
        return type(self)(*(values[which] for values in self._arrays()))

    def joined(self, *others: Branches) -> Self:
        """Return these branches and others."""
        columns = zip(self._arrays(), *(other._arrays() for other in others), strict=True)
        return type(self)(*(np.concatenate(column) for column in columns))

    def _arrays(self) -> tuple[NDArray, ...]:  # type: ignore[type-arg]
        return self.row, self.probability, self.landing, self.bumped, self.bounced


def plain_branches(moves: Moves, terrain: Terrain, warps: Warps) -> Branches:
    """Return one branch for every state and action, in order: what happens without chance."""
    count = terrain.over.size
    states = np.arange(count)
    landing = np.empty((count, NUM_ACTIONS), np.int64)
    landing[:, Action.STAY] = states
    landing[:, 1:] = moves.landing.T
    landing[terrain.over] = states[terrain.over, None]
    bumped = np.zeros((count, NUM_ACTIONS), bool)
    bumped[:, 1:] = moves.refused.T & ~warps.leaves[:, None]
    rows = np.arange(count * NUM_ACTIONS)
    return Branches(
        rows, np.ones(rows.size), landing.ravel(), bumped.ravel(), np.zeros(rows.size, bool)
    )


def chancy_rows(moves: Moves, terrain: Terrain, warps: Warps) -> Flags:
    """Return, `[states, actions]`, the rows in which chance decides where the robot goes."""
    can_move = ~terrain.over & ~warps.leaves
    slips = (terrain.skid > 0) & can_move
    chancy = np.zeros((terrain.over.size, NUM_ACTIONS), bool)
    for way in range(NUM_MOVES):
        sheltered = moves.refused[way] & (moves.glass[way] == 0) & (terrain.rule == OPEN_RULE)
        chancy[:, way + 1] = (slips & ~sheltered) | (can_move & (moves.glass[way] > 0))
    return chancy


def chancy_branches(moves: Moves, terrain: Terrain, chancy: Flags) -> Branches:
    """Return all branches of the chancy rows."""
    number_open = moves.open.sum(axis=0)
    parts: list[Branches] = []
    for way in range(NUM_MOVES):
        states = np.flatnonzero(chancy[:, way + 1])
        behind_glass = moves.glass[way, states] > 0
        parts += _glass_branches(moves, terrain, way, states[behind_glass])
        parts += _skid_branches(moves, terrain, way, states[~behind_glass], number_open)
    branches = parts[0].joined(*parts[1:])
    return branches.select(branches.probability > 0)


def _branches(
    states: Ints, way: int, chance: Floats, landing: Ints, bumped: Flags | None, bounced: bool
) -> Branches:
    quiet = np.zeros(states.size, bool)
    row = states * NUM_ACTIONS + way + 1
    return Branches(row, chance, landing, quiet if bumped is None else bumped, quiet | bounced)


def _glass_branches(moves: Moves, terrain: Terrain, way: int, states: Ints) -> list[Branches]:
    """Return the branches of moves against glass: through it, or bounced off."""
    chance = moves.glass[way, states] * (1.0 - terrain.skid[states])
    return [
        _branches(states, way, chance, moves.through[way, states], None, False),
        _branches(states, way, 1.0 - chance, moves.bounce[way, states], None, True),
    ]


def _skid_branches(
    moves: Moves, terrain: Terrain, way: int, states: Ints, number_open: Ints
) -> list[Branches]:
    """Return the branches of moves that may go astray: where they go, and every other way."""
    skid, rule = terrain.skid[states], terrain.rule[states]
    landing, refused = moves.landing[:, states], moves.refused[:, states]
    others = number_open[states] - moves.open[way, states]
    stuck = (rule == OPEN_RULE) & (others == 0)
    parts = [
        _branches(states, way, 1.0 - skid, landing[way], refused[way], False),
        _branches(states[stuck], way, skid[stuck], states[stuck], None, False),
    ]
    for turn in (1, 2, 3):
        other = (way + turn) % NUM_MOVES
        share = np.zeros(states.size)
        is_open = (rule == OPEN_RULE) & moves.open[other, states]
        share[is_open] = skid[is_open] / others[is_open]
        if turn != 2:
            share[rule == SIDES_RULE] = skid[rule == SIDES_RULE] / 2
        share[rule == OTHERS_RULE] = skid[rule == OTHERS_RULE] / 3
        parts.append(_branches(states, way, share, landing[other], refused[other], False))
    return parts
