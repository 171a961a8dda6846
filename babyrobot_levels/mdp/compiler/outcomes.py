"""The outcomes of a step: chances, next states after warps, rewards, and room for them all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.cells import PRECEDENCE, Rewards
from babyrobot_levels.mdp.actions import NUM_MOVES, Action
from babyrobot_levels.mdp.compiler.terrain import Air, Moves, Terrain, Warps
from babyrobot_levels.mdp.graph import differs, expanded
from babyrobot_levels.mdp.ground import OPEN_RULE, OTHERS_RULE, SIDES_RULE
from babyrobot_levels.mdp.tables import Flags, Floats, Ints

RANKS = {name: np.int8(rank) for rank, name in enumerate(PRECEDENCE)}
"""The rewards by their precedence: of those that apply, the one with the least rank is paid."""

NOTHING, BUMPED, BOUNCED, PUSHED = np.int8(0), np.int8(1), np.int8(2), np.int8(4)
"""What may happen to the robot in a branch: a wall refuses the move, glass bounces it back, or it
pushes a box: then `WAY` times the direction is added."""

WAY = np.int8(8)


@dataclass(frozen=True, slots=True)
class Pay:
    """What each of some steps pays, and the rank of the reward that it is.

    What is added is no part of it.
    """

    reward: Floats
    rank: NDArray[np.int8]

    def of(self, which: Ints) -> Pay:
        """Return what some of the steps pay, which then may be changed."""
        return Pay(self.reward[which], self.rank[which])

    def add(self, applies: Mapping[str, tuple[Flags, Floats | float]]) -> None:
        """Consider further rewards: where each of them applies, and what it is."""
        for name in reversed(PRECEDENCE):
            if name in applies:
                where, reward = applies[name]
                where = where & (self.rank > RANKS[name])
                np.copyto(self.reward, reward, where=where)
                np.copyto(self.rank, RANKS[name], where=where)


def exit_reward(rewards: Rewards, terrain: Terrain, cell: Ints) -> Floats | float:
    """Return what it pays to leave by an exit in cells: what these pay, or the same anywhere."""
    return terrain.reward[cell] if isinstance(rewards.exit, str) else rewards.exit


def draw(
    pay: Pay, rewards: Rewards, terrain: Terrain, cell: Ints
) -> tuple[Ints | slice, Floats | float, Floats]:
    """Draw the rewards that ends of steps pay for their cells.

    Args:
        pay: what each of the ends pays.
        rewards: the rewards of the level.
        terrain: its terrain.
        cell: the cell of each end.

    Returns:
        which of the ends, how likely it is there, and the reward, of each draw.
    """
    draws = terrain.draws
    if draws is None:
        return slice(None), 1.0, pay.reward
    by_cell = pay.rank == RANKS["step"]
    if isinstance(rewards.exit, str):
        by_cell |= pay.rank == RANKS["exit"]
    number = np.where(by_cell, draws.number[cell], 0)
    end, draw = expanded(draws.begin[number], draws.begin[number + 1])
    reward = np.where(number[end] > 0, draws.value[draw], pay.reward[end])
    return end, draws.chance[draw], reward


@dataclass(frozen=True, eq=False)
class Arrivals:
    """Computes where branches end, and their rewards."""

    rewards: Rewards
    terrain: Terrain
    warps: Warps
    here: Ints
    actions: int

    def next_states(self, branches: Branches) -> Ints:
        """Return the next cells; below 0, a lot decides."""
        state, action = np.divmod(branches.row, self.actions)
        stays = (action == Action.STAY) | self.terrain.over[state]
        return np.where(stays, branches.landing, self.warps.arrive[branches.landing])

    def rewards_of(
        self, branches: Branches, next_state: Ints
    ) -> tuple[Ints | slice, Floats | float, Floats]:
        """Draw the rewards of branches that end on `next_state`: see `draw`."""
        pay = self.pay(branches, next_state)
        which, chance, reward = draw(pay, self.rewards, self.terrain, next_state)
        bounced = (branches.happened[which] & BOUNCED) != 0
        return which, chance, reward + np.where(bounced, self.rewards.bounce, 0.0)

    def is_drawn(self, next_state: Ints) -> Flags:
        """Return whether a lot decides on next cells, or on the rewards of these."""
        is_drawn, draws = next_state < 0, self.terrain.draws
        return is_drawn if draws is None else is_drawn | (draws.number[next_state] > 0)

    def pay(self, branches: Branches, next_state: Ints) -> Pay:
        """Return what branches pay that end on `next_state`, whatever things there are.

        Where the episode is over, that is nothing.
        """
        state, action = np.divmod(branches.row, self.actions)
        rank = np.full(state.size, RANKS["step"])
        pay = Pay(self.terrain.reward[next_state], rank)
        conditions: dict[str, Callable[[], Flags]] = {
            "stay": lambda: action == Action.STAY,
            "bump": lambda: (branches.happened & BUMPED) != 0,
            "closer": lambda: self._is_nearer(next_state, self.here[state]),
            "farther": lambda: self._is_nearer(self.here[state], next_state),
        }
        applies: dict[str, tuple[Flags, Floats | float]] = {
            name: (condition(), getattr(self.rewards, name))
            for name, condition in conditions.items()
            if getattr(self.rewards, name) is not None
        }
        applies["exit"] = (
            self.terrain.exit[next_state],
            exit_reward(self.rewards, self.terrain, next_state),
        )
        if self.warps.pay:
            warped = np.where(action == Action.STAY, np.nan, self.warps.reward[branches.landing])
            applies["warp"] = ~np.isnan(warped), warped
        pay.add(applies)
        over = self.terrain.over[state]
        np.copyto(pay.reward, 0.0, where=over)
        # That is no reward of a cell.
        np.copyto(pay.rank, np.int8(0), where=over)
        return pay

    def _is_nearer(self, one: Ints, other: Ints) -> Flags:
        """Return where cells are nearer to an exit than others."""
        distance = self.terrain.distance
        if distance is None:
            return np.zeros(one.size, bool)
        nearer: Flags = distance[one] < distance[other]
        return nearer

    def is_sent(self, branches: Branches) -> Flags:
        """Return whether a warp sends the robot."""
        moves = branches.row % self.actions != Action.STAY
        sent: Flags = self.warps.sends[branches.landing] & moves
        return sent


@dataclass(slots=True)
class Branches:
    """Possible ends of steps, before any warp. All arrays have one length.

    Attributes:
        row: state and action, `state * actions + action`.
        probability: how likely the branch is.
        landing: the cell on which the robot comes to stand, or the landing of a warp.
        happened: what happens to the robot, as a bit set: `BUMPED`, `BOUNCED`, `PUSHED`.
    """

    row: Ints
    probability: Floats
    landing: Ints
    happened: NDArray[np.int8]

    def select(self, which: Flags | Ints | slice) -> Self:
        """Return some of the branches, by flags, by numbers or in a row."""
        return type(self)(*(values[which] for values in self._arrays()))

    def joined(self, *others: Branches) -> Self:
        """Return these branches and others."""
        columns = zip(self._arrays(), *(other._arrays() for other in others), strict=True)
        return type(self)(*(np.concatenate(column) for column in columns))

    def _arrays(self) -> tuple[NDArray, ...]:  # type: ignore[type-arg]
        return self.row, self.probability, self.landing, self.happened


def plain_branches(moves: Moves, terrain: Terrain, warps: Warps, part: slice) -> Branches:
    """Return one branch for each state of a part and each action, in order: without chance."""
    here, over, actions = moves.here[part], terrain.over[part], moves.num_actions
    landing = np.empty((here.size, actions), np.int64)
    landing[:, Action.STAY] = here
    landing[:, 1:] = np.where(warps.leaves[part], warps.leave[part], moves.landing[:, part]).T
    landing[over] = here[over, None]
    happened = np.zeros(landing.shape, np.int8)
    happens = BUMPED * moves.refused[:, part].T | moves.pushed[:, part].T
    happened[:, 1:] = happens * ~warps.leaves[part, None]
    rows = np.arange(part.start * actions, part.stop * actions)
    return Branches(rows, np.ones(rows.size), landing.ravel(), happened.ravel())


def stochastic_rows(moves: Moves, terrain: Terrain, warps: Warps, part: slice) -> Flags:
    """Return, `[states, actions]`, the rows of a part in which chance decides where it goes."""
    can_move = ~terrain.over[part] & ~warps.leaves[part]
    slips = (terrain.skid[part] > 0) & can_move
    glass = moves.glass[:, part] > 0
    sheltered = moves.refused[:, part] & ~glass & (terrain.rule[part] == OPEN_RULE)
    stochastic = np.zeros((can_move.size, moves.num_actions), bool)
    stochastic[:, 1:] = ((slips & ~sheltered) | (can_move & (glass | (warps.chance[part] > 0)))).T
    return stochastic


def chance_branches(
    air: Air, terrain: Terrain, warps: Warps, part: slice
) -> tuple[Flags, Branches]:
    """Return the rows of a part that chance decides, `[states, actions]`, and their branches."""
    actions = air.given.num_actions
    varies = np.zeros((part.stop - part.start, actions), bool)
    if len(air.moves) > 1:
        goes = ~terrain.over[part] & ~warps.leaves[part] & air.windy[part]
        varies[:, Action.NORTH :] = goes[:, None]
    rows, found = varies.copy(), [_no_branches()]
    for number, (chance, moves) in enumerate(zip(air.chances, air.moves, strict=True)):
        stochastic = stochastic_rows(moves, terrain, warps, part)
        # Where there is no wind, one of them is enough.
        stochastic &= varies | (number == 0)
        parts = stochastic_branches(moves, terrain, warps, stochastic, part)
        if varies.any():
            plain = plain_branches(moves, terrain, warps, part)
            parts.append(plain.select((varies & ~stochastic).ravel()))
            for each in parts:
                share = np.where(varies.ravel()[each.row - part.start * actions], chance, 1.0)
                each.probability = each.probability * share
        rows |= stochastic
        found += parts
    branches = found[0].joined(*found[1:])
    return rows, branches.select(branches.probability > 0)


def _no_branches() -> Branches:
    return Branches(np.zeros(0, np.int64), np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.int8))


def stochastic_branches(
    moves: Moves, terrain: Terrain, warps: Warps, stochastic: Flags, part: slice
) -> list[Branches]:
    """Return all branches of the stochastic rows of a part, also those with probability 0."""
    states, ways = np.nonzero(stochastic[:, 1:])
    states += part.start
    behind_glass = moves.glass[ways, states] > 0
    parts: list[Branches] = []
    if behind_glass.any():
        parts += _glass_branches(moves, terrain, states[behind_glass], ways[behind_glass])
    skids = ~behind_glass
    if skids.any():
        parts += _skid_branches(moves, terrain, states[skids], ways[skids])
    if warps.chance[states].any():
        for each in parts:
            each.probability = each.probability * (
                1.0 - warps.chance[each.row // moves.num_actions]
            )
        row = rows_of(moves, states, ways)
        parts.append(_branches(row, warps.chance[states], warps.leave[states], NOTHING))
    return parts


def rows_of(moves: Moves, states: Ints, ways: Ints) -> Ints:
    """Return the numbers of the rows of moves from states."""
    return states * moves.num_actions + ways + 1


def _branches(
    row: Ints, chance: Floats, landing: Ints, happened: NDArray[np.int8] | np.int8
) -> Branches:
    return Branches(row, chance, landing, np.zeros(row.size, np.int8) | happened)


def _glass_branches(moves: Moves, terrain: Terrain, states: Ints, ways: Ints) -> list[Branches]:
    """Return the branches of moves against glass: through it, or bounced off."""
    row, chance = (
        rows_of(moves, states, ways),
        moves.glass[ways, states] * (1.0 - terrain.skid[states]),
    )
    return [
        _branches(row, chance, moves.through[ways, states], moves.through_pushed[ways, states]),
        _branches(
            row,
            1.0 - chance,
            moves.bounce[ways, states],
            BOUNCED | moves.bounce_pushed[ways, states],
        ),
    ]


def _skid_branches(moves: Moves, terrain: Terrain, states: Ints, ways: Ints) -> list[Branches]:
    """Return the branches of moves that may go astray: where they go, and every other way."""
    rule, row, count = terrain.rule[states], rows_of(moves, states, ways), len(moves.open)
    sheltered = moves.refused[ways, states] & (rule == OPEN_RULE)
    skid = np.where(sheltered, 0.0, terrain.skid[states])
    others = moves.open[:, states].sum(axis=0) - moves.open[ways, states]

    def branches(ways_taken: Ints, chance: Floats) -> Branches:
        which = ways_taken, states
        happened = BUMPED * moves.refused[which] | moves.pushed[which]
        return _branches(row, chance, moves.landing[which], happened)

    stuck = (rule == OPEN_RULE) & (others == 0)
    parts = [
        branches(ways, 1.0 - skid),
        _branches(row[stuck], skid[stuck], moves.here[states[stuck]], NOTHING),
    ]
    for turn in range(1, count):
        other = (ways + turn) % count
        share = np.zeros(states.size)
        is_open = (rule == OPEN_RULE) & moves.open[other, states]
        share[is_open] = skid[is_open] / others[is_open]
        if turn % 2:
            # Directions at right angles are both diagonal, or both not.
            aside = (rule == SIDES_RULE) & (ways // NUM_MOVES == other // NUM_MOVES)
            share[aside] = skid[aside] / 2
        share[rule == OTHERS_RULE] = skid[rule == OTHERS_RULE] / (count - 1)
        parts.append(branches(other, share))
    return parts


def ended(branches: Branches, arrivals: Arrivals) -> tuple[Branches, Ints]:
    """Return branches and their next states, with those that a lot decides led to each end."""
    next_state = arrivals.next_states(branches)
    drawn = next_state < 0
    if drawn.any():
        lots = arrivals.warps.lots
        begin = np.cumsum([0, *(lot.landings.size for lot in lots)])
        landings, weights = (np.concatenate(column) for column in zip(*lots, strict=True))
        total = np.array([lot.weights.sum() for lot in lots])
        number = -1 - next_state[drawn]
        which, end = expanded(begin[number], begin[number + 1])
        spread = branches.select(np.flatnonzero(drawn)[which])
        spread.probability = spread.probability * weights[end] / total[number[which]]
        spread.landing = landings[end]
        branches = branches.select(~drawn).joined(spread)
        goals = arrivals.warps.arrive[spread.landing]
        next_state = np.concatenate([next_state[~drawn], goals])
    return branches, next_state


@dataclass(frozen=True, slots=True)
class Outcomes:
    """Distinct outcomes, sorted by row, next state, reward and whether they end the episode.

    `slot` is the number of each among those of its row.
    """

    row: Ints
    slot: Ints
    probability: Floats
    next_state: Ints
    reward: Floats
    terminal: Flags

    @property
    def width(self) -> int:
        """How many outcomes the longest row has."""
        return int(self.slot.max(initial=0)) + 1


class Room:
    """The tables of some states, with room for a number of outcomes in each row."""

    def __init__(self, states: int, actions: int, width: int):
        self._shape = states, actions, width
        rows = states * actions, width
        self._used = 1
        self._tables: dict[str, NDArray[Any]] = {
            "probability": np.zeros(rows),
            "next_state": np.zeros(rows, np.int32),
            "reward": np.zeros(rows),
            "terminal": np.zeros(rows, bool),
        }

    def put(self, outcomes: Outcomes) -> None:
        """Put outcomes in their rows."""
        self._used = max(self._used, outcomes.width)
        place = outcomes.row * self._shape[2] + outcomes.slot
        for name, table in self._tables.items():
            table.reshape(-1)[place] = getattr(outcomes, name)

    def tables(self) -> dict[str, Any]:
        """Return the tables `[states, actions, outcomes]`, as wide as the longest row needs."""
        for name, table in self._tables.items():
            # One after the other: two copies of all of them would need much.
            narrow = np.ascontiguousarray(table[:, : self._used])
            self._tables[name] = narrow.reshape(*self._shape[:2], self._used)
        return self._tables


def merged(
    row: Ints, probability: Floats, next_state: Ints, reward: Floats, terminal: Flags
) -> Outcomes:
    """Return the outcomes sorted, those that are alike as one."""
    # Branches come in runs of rising rows: to sort one key is fast. The others are needed only
    # where rewards or ends tell apart what leads to one state.
    target = row * (int(next_state.max(initial=0)) + 1) + next_state
    order = np.argsort(target, kind="stable")
    is_new = differs(target[order])
    by_more = differs(reward[order]) | differs(terminal[order])
    if (by_more & ~is_new).any():
        order = np.lexsort((terminal, reward, target))
        is_new = differs(target[order]) | differs(reward[order]) | differs(terminal[order])
    row, next_state, reward, terminal = (
        row[order],
        next_state[order],
        reward[order],
        terminal[order],
    )
    first = is_new.nonzero()[0]
    total = np.add.reduceat(probability[order], first)
    row = row[first]
    begin = differs(row).nonzero()[0]
    slot = np.arange(row.size) - np.repeat(begin, np.diff(np.append(begin, row.size)))
    return Outcomes(row, slot, total, next_state[first], reward[first], terminal[first])
