"""Certificates: whether a level defines the same MDP as another level or environment.

Two finite MDPs are equivalent if their start distributions agree and every action, in every state
that an episode reaches, leads to the same outcomes with the same probabilities. That is compared
here entry by entry; nothing is sampled.
"""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np

from babyrobot_levels.analysis.environments import (
    MINIGRID,
    Certificate,
    ComparisonError,
    certify,
    is_minigrid,
    made,
    made_minigrid,
)
from babyrobot_levels.analysis.solver.results import action_names
from babyrobot_levels.mdp.actions import Turn
from babyrobot_levels.mdp.gridworld import GridWorld, world_of
from babyrobot_levels.mdp.states import occurring, told
from babyrobot_levels.mdp.tables import Flags, Floats, Mdp, Outcome
from babyrobot_levels.text.errors import LevelNotFoundError

LevelLike = str | os.PathLike[str] | Mapping[str, Any] | GridWorld

GYMNASIUM = "gymnasium:"
"""The prefix that marks the id of an environment, where a level could be meant as well."""

VERSION = re.compile(r"-v\d+$")
"""The end of an environment's id, which no level of the gallery has."""

REWARD_TOLERANCE = 1e-12


def compare(
    level: LevelLike,
    other: Any,
    *,
    actions: Sequence[int] | None = None,
    kwargs: Mapping[str, Any] | None = None,
    seed: int = 0,
    tolerance: float = 1e-12,
) -> Certificate:
    """Compare a level with another MDP, outcome by outcome.

    States correspond by number: the level's are `y * width + x`, and with things
    `configuration * width * height + y * width + x`. If the other has three actions, they are left,
    right and forward, and the level's states are those of `Mdp.turning`. The outcomes of terminal
    states are not compared, because no episode goes on there. Time limits (`max_steps`) are not
    part of the MDP.

    An environment of MiniGrid has no table. It is put into each state of the level with turning,
    and its next state and its success are compared, but not its rewards, which shrink with each
    step. Its grid may have walls, lava and goals, and no objects.

    Args:
        level: whatever `load` takes.
        other: another level, likewise; `"gymnasium:ID"`; a Gymnasium environment that has a
            table, as those of toy_text have (`P` and `initial_state_distrib`); such a table
            and the probability of each start: `({s: {a: [(p, s', reward, terminal)]}}, start)`;
            `"minigrid:ID"`; or an environment of MiniGrid, which must have been reset.
        actions: for each action of the other, the level's own number of it. By default a mapping
            is searched for under which the MDPs agree.
        kwargs: keyword arguments for `gymnasium.make`.
        seed: the seed with which an environment of MiniGrid is reset.
        tolerance: by how much probabilities may differ. Rewards may differ by 1e-12.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
        ComparisonError: the other has no table, or none that can be read; `actions` do not name
            the four moves, or all actions, once each; a maze has no seed yet; a grid of MiniGrid
            has objects, or MiniGrid is not installed.
    """
    mine = _with_fixed_maze(level)
    if isinstance(other, str) and other.startswith(MINIGRID):
        env = made_minigrid(other.removeprefix(MINIGRID), seed, kwargs)
        try:
            return certify(mine, env)
        finally:
            env.close()
    if hasattr(other, "unwrapped") and is_minigrid(other.unwrapped):
        return certify(mine, other.unwrapped)
    mdp = mine.compile()
    tables = _tables_of(other, kwargs)
    if len(tables.names) == len(Turn):
        mdp = mdp.turning(mine.heading)
    named = _Named(mine, mdp)
    difference = _difference_of_shape(mdp, tables)
    if difference is not None:
        return Certificate(False, None, 0, 0, False, difference, mine.digest)
    reached = _reached(mdp)
    agreement = _agreement(mdp, tables, tolerance)
    if mdp.num_robots > 1:
        # Joint actions have no other numbers.
        actions = range(mdp.num_actions)
    mapping = _mapping(agreement, reached, actions)
    agree = agreement[:, range(len(mapping)), mapping]
    differing = np.argwhere(reached[:, None] & ~agree)
    difference = _difference_of_starts(named, tables, tolerance)
    if difference is None and differing.size:
        state, action = differing[0].tolist()
        difference = _difference_of_outcomes(named, tables, state, mapping[action], action)
    return Certificate(
        equal=difference is None,
        actions=mapping,
        states=int(reached.sum()),
        outcomes=int(np.count_nonzero(mdp.probability[reached][:, mapping])),
        everywhere=bool(
            (agree.all(axis=1) | mdp.is_terminal).all()
            and (_ends(mdp, mdp.num_states) == _ends(tables, mdp.num_states)).all()
        ),
        difference=difference,
        digest=mine.digest,
    )


# -- the tables of the other ---------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Tables:
    """The other's tables, as `Mdp` has them, but not sorted; and the names of its actions."""

    probability: Floats
    next_state: Floats
    reward: Floats
    terminal: Flags
    start: Floats
    names: tuple[str, ...]

    def outcomes(self, state: int, action: int) -> list[Outcome]:
        """Return the outcomes of an action, as listed."""
        tables = (self.probability, self.next_state, self.reward, self.terminal)
        rows = zip(*(table[state, action].tolist() for table in tables), strict=True)
        return [row for row in rows if row[0] != 0]


def _with_fixed_maze(level: LevelLike) -> GridWorld:
    """Return a level whose maze is always the same.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid.
        ComparisonError: it grows another maze at each reset.
    """
    loaded = world_of(level)
    if loaded.has_random_maze:
        raise ComparisonError(
            "each reset grows another maze of this level; compare one with a fixed seed"
        )
    return loaded


def _tables_of(other: Any, kwargs: Mapping[str, Any] | None = None) -> _Tables:
    """Return the tables of a level, an environment, its id, or a pair of table and starts.

    Raises:
        ComparisonError: there is no table, or none that can be read.
    """
    if isinstance(other, str) and other.startswith(GYMNASIUM):
        env = made(other.removeprefix(GYMNASIUM), kwargs)
        try:
            return _tables_of_environment(env)
        finally:
            env.close()
    if kwargs is not None:
        raise ComparisonError(f"keyword arguments are for environments, `{GYMNASIUM}ID`")
    if hasattr(other, "unwrapped"):
        return _tables_of_environment(other)
    if isinstance(other, tuple) and len(other) == 2:
        return _tables_of_pair(*other)
    if isinstance(other, Mapping) and other and not any(isinstance(key, str) for key in other):
        raise _invalid_table("the starts are missing; give a pair of both")
    try:
        mdp = _with_fixed_maze(other).compile()
    except LevelNotFoundError as error:
        if not VERSION.search(error.name):
            raise
        raise LevelNotFoundError(
            error.name, [GYMNASIUM + error.name.removeprefix("gym:")]
        ) from None
    names = tuple(action_names("all", mdp))
    next_state = mdp.next_state.astype(np.float64)
    return _Tables(mdp.probability, next_state, mdp.reward, mdp.terminal, mdp.start, names)


def _tables_of_environment(env: Any) -> _Tables:
    inner = env.unwrapped
    table, start = (getattr(inner, name, None) for name in ("P", "initial_state_distrib"))
    if table is None or start is None:
        name = env.spec.id if getattr(env, "spec", None) else type(inner).__name__
        raise ComparisonError(
            f"{name} has no table of its outcomes (`P` and `initial_state_distrib`)"
        )
    return _tables_of_pair(table, start)


def _tables_of_pair(table: Any, start: Any) -> _Tables:
    try:
        counts = {len(table[state]) for state in range(len(table))}
        (count,) = counts if len(counts) == 1 else (0,)
        rows = [[list(table[s][a]) for a in range(count)] for s in range(len(table))]
        longest = max((len(row) for actions in rows for row in actions), default=0)
        # Padding has probability 0, and so cannot happen.
        full = [
            [[*row, *[(0, 0, 0, 0)] * (longest - len(row))] for row in actions] for actions in rows
        ]
        numbers = np.array(full, np.float64).reshape(len(rows), count, longest, 4)
        starts = np.array(start, np.float64)
    except (LookupError, TypeError, ValueError) as error:
        raise _invalid_table(f"{type(error).__name__}: {error}") from error
    if not numbers.size:
        raise _invalid_table("each state needs the same actions, and these need outcomes")
    if not (np.isfinite(numbers).all() and np.isfinite(starts).all()):
        raise _invalid_table("not all of its numbers are finite")
    if starts.shape != (len(rows),):
        raise _invalid_table(f"{len(rows)} states need as many probabilities of starts")
    probability, next_state, reward, terminal = np.moveaxis(numbers, -1, 0)
    names = tuple(f"action {number}" for number in range(count))
    return _Tables(probability, next_state, reward, terminal != 0, starts, names)


def _invalid_table(why: str) -> ComparisonError:
    return ComparisonError(
        "this is no table {state: {action: [(probability, next state, reward, terminal)]}} "
        f"with the probability of each start: {why}"
    )


# -- where they agree ----------------------------------------------------------------------


def _reached(mdp: Mdp) -> Flags:
    """Return the states that an episode reaches, without the terminal ones, `[states]`."""
    return occurring(mdp).ravel() & ~mdp.is_terminal


def _ends(tables: Mdp | _Tables, count: int) -> Flags:
    """Return the states to which outcomes with `terminal` set lead, `[states]`."""
    ends = tables.next_state[tables.terminal & (tables.probability != 0)]
    return np.isin(np.arange(count), ends)


def _agreement(mdp: Mdp, other: _Tables, tolerance: float) -> Flags:
    """Return whether actions have the same outcomes, `[states, other's actions, our actions]`."""
    shape = (mdp.num_states, len(other.names), mdp.num_actions)
    agreement = np.zeros(shape, np.bool_)
    for theirs, ours in np.ndindex(*shape[1:]):
        probability, next_state, terminal, reward = (
            np.concatenate(
                [getattr(mdp, name)[:, ours], getattr(other, name)[:, theirs]], axis=1, dtype=float
            )
            for name in ("probability", "next_state", "terminal", "reward")
        )
        # The other's count as negative: outcomes that are equally probable add up to nothing.
        probability[:, mdp.probability.shape[2] :] *= -1
        agrees = _sums(probability, next_state, terminal, reward) <= tolerance
        agreement[:, theirs, ours] = agrees.all(axis=1)
    return agreement


def _sums(probability: Floats, next_state: Floats, terminal: Floats, reward: Floats) -> Floats:
    """Return the absolute sum of the probabilities of each distinct outcome, row by row.

    All tables are `[rows, outcomes]`; where an outcome is listed again, the sum is 0.
    """
    order = np.lexsort((reward, terminal, next_state), axis=-1)

    def steps(table: Floats) -> Floats:
        return np.diff(np.take_along_axis(table, order, axis=1), axis=1)

    is_first = np.ones(order.shape, np.bool_)
    is_first[:, 1:] = (
        (steps(next_state) != 0) | (steps(terminal) != 0) | (steps(reward) > REWARD_TOLERANCE)
    )
    firsts = np.flatnonzero(is_first)
    ordered = np.take_along_axis(probability, order, axis=1)
    sums = np.zeros(order.shape)
    sums.flat[firsts] = np.abs(np.add.reduceat(ordered.ravel(), firsts))
    return sums


def _mapping(agreement: Flags, reached: Flags, given: Sequence[int] | None) -> tuple[int, ...]:
    """Return, for each action of the other, that of ours: as given, or with most agreement."""
    _, count, all_ours = agreement.shape
    # Stay comes first, and the other may lack it.
    ours = range(all_ours - count, all_ours)
    if given is not None:
        if sorted(given) != list(ours):
            raise ComparisonError(
                f"for the other's {count} actions, `actions` must name each of "
                f"{', '.join(map(str, ours))} once, not {', '.join(map(str, given))}"
            )
        return tuple(given)
    here, anywhere = agreement[reached].sum(axis=0), agreement.sum(axis=0)

    def score(mapping: tuple[int, ...]) -> tuple[int, int]:
        return int(here[range(count), mapping].sum()), int(anywhere[range(count), mapping].sum())

    return max(permutations(ours), key=score)


# -- where they differ ---------------------------------------------------------------------


@dataclass(frozen=True)
class _Named:
    """Names for the states and actions of a level's tables."""

    level: GridWorld
    mdp: Mdp

    def state(self, state: float) -> str:
        """Return a state in words, or its number if the level has no such state."""
        if state not in range(self.mdp.num_states):
            return f"state {state:g}"
        return told(self.level, self.mdp, int(state))

    def action(self, action: int) -> str:
        """Return the name of an action."""
        return action_names("turns" if self.mdp.headings > 1 else "all", self.mdp)[action]


def _difference_of_shape(mdp: Mdp, other: _Tables) -> str | None:
    if other.start.size != mdp.num_states:
        cells = f"{mdp.cells} cells ({mdp.width} by {mdp.height})"
        if mdp.num_configurations > 1:
            cells = f"{mdp.num_configurations} configurations of {cells}"
        if mdp.headings > 1:
            cells = f"{mdp.headings} headings in {cells}"
        return f"this level has {cells}, the other has {other.start.size} states"
    if mdp.num_robots > 1 and len(other.names) != mdp.num_actions:
        return (
            f"this level has {mdp.num_actions} actions of {mdp.num_robots} robots together, the "
            f"other has {len(other.names)} actions"
        )
    moves = mdp.num_actions - 1
    if mdp.num_robots == 1 and len(other.names) not in (len(Turn), moves, mdp.num_actions):
        return f"this level has {moves} moves and stay, the other has {len(other.names)} actions"
    return None


def _difference_of_starts(named: _Named, other: _Tables, tolerance: float) -> str | None:
    start = named.mdp.start
    differing = np.flatnonzero(~(np.abs(start - other.start) <= tolerance))
    if not differing.size:
        return None
    state = int(differing[0])
    return (
        f"episodes start at {named.state(state)} with probability {start[state]:.12g} "
        f"in this level, {other.start[state]:.12g} in the other"
    )


def _difference_of_outcomes(
    named: _Named, other: _Tables, state: int, ours: int, theirs: int
) -> str:
    for digits in (6, 17):
        mine, listed = (
            _describe(named, outcomes, digits)
            for outcomes in (named.mdp.outcomes(state, ours), other.outcomes(state, theirs))
        )
        if mine != listed:
            break
    return (
        f"at {named.state(state)}, {named.action(ours)} (in the other: {other.names[theirs]}):\n"
        f"  this level: {mine}\n"
        f"  the other:  {listed}"
    )


def _describe(named: _Named, outcomes: list[Outcome], digits: int) -> str:
    merged: dict[tuple[float, float, bool], float] = {}
    for probability, state, reward, terminal in outcomes:
        key = (state, reward, terminal)
        merged[key] = merged.get(key, 0.0) + probability
    return (
        "; ".join(
            f"{named.state(state)} with probability {probability:.{digits}g}, "
            f"reward {reward:.{digits}g}" + (", terminal" if terminal else "")
            for (state, reward, terminal), probability in sorted(merged.items())
        )
        or "no outcome"
    )
