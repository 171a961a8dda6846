"""Level and grid to the exact tables.

Every chance becomes a branch: a row (state and action), a probability, and where it comes to
stand. Rows without chance have one branch and are filled in as whole columns; only the others are
expanded, merged and sorted. All arithmetic is in the same order on every platform.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.actions import NUM_ACTIONS, NUM_MOVES, Action
from babyrobot_levels.grid import Grid, build_grid
from babyrobot_levels.mdp import FREE, GLASS, REFUSED, Mdp
from babyrobot_levels.moves import Moves, build_moves
from babyrobot_levels.spec.level import LevelFields
from babyrobot_levels.terrain import OPEN_RULE, OTHERS_RULE, SIDES_RULE, Terrain, build_terrain
from babyrobot_levels.warps import Warps, build_warps

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(slots=True)
class _Branches:
    """Possible ends of steps, one an entry; all arrays have one length."""

    row: Ints
    probability: Floats
    landing: Ints
    bumped: Flags
    bounced: Flags


def compile_mdp(level: LevelFields, grid: Grid | None = None) -> Mdp:
    """Compile a level into its exact tables.

    Raises:
        LevelError: the level's maze has no seed yet (`seed: random`).
    """
    grid = grid or build_grid(level)
    terrain, moves, warps = (
        build_terrain(level, grid),
        build_moves(level, grid),
        build_warps(level, grid),
    )
    count = grid.width * grid.height
    plain = _plain_branches(moves, terrain, warps)
    chancy = _chancy_rows(moves, terrain, warps)
    branches = _chancy_branches(moves, terrain, chancy)
    tables = _Tables(level, terrain, warps, count)
    tables.fill_plain(plain, chancy)
    if branches.row.size or tables.has_many_starts:
        tables.merge(branches)
    hindered, target = _hindrances(moves, terrain, warps, count)
    possible = (hindered != REFUSED).astype(np.int8)
    possible[terrain.over, 1:] = 0
    start = np.zeros(count)
    for x, y in level.starts:
        start[y * grid.width + x] = 1.0 / len(level.starts)
    return Mdp(
        grid.width,
        grid.height,
        tables.probability,
        tables.next_state,
        tables.reward,
        tables.terminal,
        start,
        terrain.over,
        possible,
        target,
        hindered,
    ).freeze()


def _plain_branches(moves: Moves, terrain: Terrain, warps: Warps) -> _Branches:
    """Return one branch for every state and action: what happens without chance."""
    count = terrain.over.size
    states = np.arange(count)
    landing = np.empty((count, NUM_ACTIONS), np.int64)
    landing[:, Action.STAY] = states
    landing[:, 1:] = moves.landing.T
    bumped = np.zeros((count, NUM_ACTIONS), bool)
    bumped[:, 1:] = moves.refused.T & ~warps.leaves[:, None]
    landing[terrain.over] = states[terrain.over, None]
    rows = np.arange(count * NUM_ACTIONS)
    return _Branches(
        rows,
        np.ones(rows.size),
        landing.ravel(),
        bumped.ravel(),
        np.zeros(rows.size, bool),
    )


def _chancy_rows(moves: Moves, terrain: Terrain, warps: Warps) -> Flags:
    """Return, `[states, actions]`, which rows chance has a part in."""
    can_move = ~terrain.over & ~warps.leaves
    slips = (terrain.skid > 0) & can_move
    chancy = np.zeros((terrain.over.size, NUM_ACTIONS), bool)
    for way in range(NUM_MOVES):
        closed = ~moves.open[way] & (moves.glass[way] == 0)
        sheltered = closed & (terrain.rule == OPEN_RULE)
        chancy[:, way + 1] = (slips & ~sheltered) | (can_move & (moves.glass[way] > 0))
    return chancy


def _chancy_branches(moves: Moves, terrain: Terrain, chancy: Flags) -> _Branches:
    """Return all branches of the rows that chance has a part in, those of a row in one order."""
    parts: list[_Branches] = []

    def add(
        states: Ints, way: int, probability: Floats, landing: Ints, bumped: Flags, bounced: bool
    ) -> None:
        parts.append(
            _Branches(
                states * NUM_ACTIONS + way + 1,
                probability,
                landing,
                bumped,
                np.full(states.size, bounced),
            )
        )

    number_open = moves.open.sum(axis=0)
    for way in range(NUM_MOVES):
        states = np.flatnonzero(chancy[:, way + 1])
        behind_glass = moves.glass[way, states] > 0
        tries = states[behind_glass]
        through = moves.glass[way, tries] * (1.0 - terrain.skid[tries])
        quiet = np.zeros(tries.size, bool)
        add(tries, way, through, moves.through[way, tries], quiet, False)
        add(tries, way, 1.0 - through, moves.bounce[way, tries], quiet, True)

        states = states[~behind_glass]
        skid, rule = terrain.skid[states], terrain.rule[states]
        add(states, way, 1.0 - skid, moves.landing[way, states], moves.refused[way, states], False)
        others = number_open[states] - moves.open[way, states]
        stuck = states[(rule == OPEN_RULE) & (others == 0)]
        add(stuck, way, terrain.skid[stuck], stuck, np.zeros(stuck.size, bool), False)
        for turn in (1, 2, 3):
            other = (way + turn) % NUM_MOVES
            share = np.zeros(states.size)
            is_open = (rule == OPEN_RULE) & moves.open[other, states]
            share[is_open] = skid[is_open] / others[is_open]
            if turn != 2:
                share[rule == SIDES_RULE] = skid[rule == SIDES_RULE] / 2
            share[rule == OTHERS_RULE] = skid[rule == OTHERS_RULE] / 3
            add(
                states,
                way,
                share,
                moves.landing[other, states],
                moves.refused[other, states],
                False,
            )
    joined = _Branches(
        np.concatenate([part.row for part in parts]),
        np.concatenate([part.probability for part in parts]),
        np.concatenate([part.landing for part in parts]),
        np.concatenate([part.bumped for part in parts]),
        np.concatenate([part.bounced for part in parts]),
    )
    return _select(joined, joined.probability > 0)


def _select(branches: _Branches, which: Flags | Ints) -> _Branches:
    return _Branches(
        branches.row[which],
        branches.probability[which],
        branches.landing[which],
        branches.bumped[which],
        branches.bounced[which],
    )


def _hindrances(
    moves: Moves, terrain: Terrain, warps: Warps, count: int
) -> tuple[NDArray[np.int8], NDArray[np.int32]]:
    """Return what hinders each action, and where it leads without chance."""
    hindered = np.full((count, NUM_ACTIONS), FREE, np.int8)
    target = np.empty((count, NUM_ACTIONS), np.int64)
    target[:, Action.STAY] = np.arange(count)
    free = ~warps.leaves
    for way in range(NUM_MOVES):
        glass = moves.glass[way] > 0
        hindered[:, way + 1][free & moves.refused[way]] = REFUSED
        hindered[:, way + 1][free & glass] = GLASS
        goal = warps.arrive[np.where(glass, moves.through[way], moves.landing[way])]
        target[:, way + 1] = np.where(warps.leaves, warps.leave_to, goal)
    target[terrain.over] = np.flatnonzero(terrain.over)[:, None]
    hindered[terrain.over] = FREE
    return hindered, target.astype(np.int32)


class _Tables:
    """The four tables while they are filled."""

    def __init__(self, level: LevelFields, terrain: Terrain, warps: Warps, count: int):
        self.level, self.terrain, self.warps, self.count = level, terrain, warps, count
        self.starts = np.array([y * level.size[0] + x for x, y in level.starts])
        self.deferred: _Branches | None = None

    @property
    def has_many_starts(self) -> bool:
        """Whether some plain row leads to one of several starts, which is a chance too."""
        return self.deferred is not None

    def fill_plain(self, plain: _Branches, chancy: Flags) -> None:
        """Fill in the first outcome of every row as if there were no chance."""
        next_state, reward = self._arrive(plain)
        many = (next_state == self.count) & ~chancy.ravel()
        if many.any():
            self.deferred = _select(plain, many)
            next_state = np.where(many, 0, next_state)
        over = np.repeat(self.terrain.over, NUM_ACTIONS)
        reward[over] = 0.0
        shape = (self.count, NUM_ACTIONS, 1)
        self.probability = np.ones(shape)
        self.next_state = np.where(next_state == self.count, 0, next_state).astype(np.int32)
        self.next_state = self.next_state.reshape(shape)
        self.reward = reward.reshape(shape)
        self.terminal = self.terrain.over[self.next_state]

    def merge(self, branches: _Branches) -> None:
        """Replace the rows that chance has a part in by their distinct outcomes, sorted."""
        if self.deferred is not None:
            extra = self.deferred
            branches = _Branches(
                np.concatenate([branches.row, extra.row]),
                np.concatenate([branches.probability, extra.probability]),
                np.concatenate([branches.landing, extra.landing]),
                np.concatenate([branches.bumped, extra.bumped]),
                np.concatenate([branches.bounced, extra.bounced]),
            )
        next_state, reward = self._arrive(branches)
        row, probability = branches.row, branches.probability
        lost = next_state == self.count
        if lost.any():
            row, probability, next_state, reward = self._spread(
                lost, branches, row, probability, next_state, reward
            )
        order = np.lexsort((reward, next_state, row))
        row, probability = row[order], probability[order]
        next_state, reward = next_state[order], reward[order]
        fresh = np.ones(row.size, bool)
        fresh[1:] = (
            (row[1:] != row[:-1])
            | (next_state[1:] != next_state[:-1])
            | (reward[1:] != reward[:-1])
        )
        firsts = np.flatnonzero(fresh)
        probability = np.add.reduceat(probability, firsts)
        row, next_state, reward = row[firsts], next_state[firsts], reward[firsts]
        self._scatter(row, probability, next_state, reward)

    def _spread(
        self,
        lost: Flags,
        branches: _Branches,
        row: Ints,
        probability: Floats,
        next_state: Ints,
        reward: Floats,
    ) -> tuple[Ints, Floats, Ints, Floats]:
        """Spread the branches that lead to "one of the starts" evenly over the starts."""
        number = self.starts.size
        sent = _select(branches, lost)
        goals = np.tile(self.starts, sent.row.size)
        each = _Branches(*(np.repeat(values, number) for values in _fields(sent)))
        _, gain = self._arrive(each, goals)
        return (
            np.concatenate([row[~lost], each.row]),
            np.concatenate([probability[~lost], each.probability / number]),
            np.concatenate([next_state[~lost], goals]),
            np.concatenate([reward[~lost], gain]),
        )

    def _scatter(self, row: Ints, probability: Floats, next_state: Ints, reward: Floats) -> None:
        starts_row = np.ones(row.size, bool)
        starts_row[1:] = row[1:] != row[:-1]
        first = np.flatnonzero(starts_row)
        length = np.diff(np.append(first, row.size))
        slot = np.arange(row.size) - np.repeat(first, length)
        width = int(length.max(initial=1))
        shape = (self.count, NUM_ACTIONS, width)
        for name, fill, values in (
            ("probability", 0.0, probability),
            ("next_state", 0, next_state),
            ("reward", 0.0, reward),
            ("terminal", False, self.terrain.over[next_state]),
        ):
            plain = getattr(self, name)
            table = np.full(shape, fill, plain.dtype)
            table[:, :, :1] = plain
            flat = table.reshape(-1, width)
            flat[row, slot] = values
            setattr(self, name, table)

    def _arrive(self, branches: _Branches, goals: Ints | None = None) -> tuple[Ints, Floats]:
        """Return the next state and the reward of each branch, warps and all."""
        level, terrain, warps = self.level, self.terrain, self.warps
        state, action = branches.row // NUM_ACTIONS, branches.row % NUM_ACTIONS
        leaves = warps.leaves[state] & (action != Action.STAY)
        stays = action == Action.STAY
        arrived = np.where(stays, branches.landing, warps.arrive[branches.landing])
        sent = np.where(leaves, warps.leave_to[state], arrived)
        next_state = sent if goals is None else goals
        end = np.minimum(next_state, self.count - 1)
        reward = terrain.reward[end]
        rewards = level.rewards
        if terrain.distance is not None and (rewards.closer, rewards.farther) != (None, None):
            before, after = terrain.distance[state], terrain.distance[end]
            if rewards.closer is not None:
                reward = np.where(after < before, rewards.closer, reward)
            if rewards.farther is not None:
                reward = np.where(after > before, rewards.farther, reward)
        if rewards.bump is not None:
            reward = np.where(branches.bumped, rewards.bump, reward)
        if rewards.stay is not None:
            reward = np.where(stays, rewards.stay, reward)
        reward = np.where(terrain.exit[end], rewards.exit, reward)
        warped = np.where(stays, np.nan, warps.arrive_reward[branches.landing])
        warped = np.where(leaves, warps.leave_reward[state], warped)
        reward = np.where(np.isnan(warped), reward, warped)
        return next_state, reward + np.where(branches.bounced, rewards.bounce, 0.0)


def _fields(branches: _Branches) -> tuple[NDArray, ...]:  # type: ignore[type-arg]
    return (
        branches.row,
        branches.probability,
        branches.landing,
        branches.bumped,
        branches.bounced,
    )
