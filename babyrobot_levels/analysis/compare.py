"""Certificates: whether a level defines the same MDP as another level or environment.

Two finite MDPs are equivalent if their start distributions agree and every action, in every state
that an episode reaches, leads to the same outcomes with the same probabilities. That is compared
here entry by entry; nothing is sampled.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS, NUM_MOVES, Action
from babyrobot_levels.mdp.reachability import transitions
from babyrobot_levels.mdp.tables import Mdp, Outcome
from babyrobot_levels.text.errors import BabyRobotError

LevelLike = str | os.PathLike[str] | Mapping[str, Any] | Level
Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]

GYMNASIUM = "gymnasium:"
"""The prefix that marks the id of an environment, where a level could be meant as well."""

REWARD_TOLERANCE = 1e-12


class ComparisonError(BabyRobotError, ValueError):
    """What was given cannot be compared with a level."""

    __module__ = "babyrobot_levels"


@dataclass(frozen=True)
class Certificate:
    """The result of comparing a level with another MDP.

    Attributes:
        equal: whether the two are equivalent: the same starts, and the same outcomes of all
            actions in all states that an episode reaches.
        actions: for each action of the other, the level's own number of it (`brl.Action`). Where
            the MDPs differ, those under which they differ least; None if no actions were compared.
        states: the number of states whose outcomes were compared: those that an episode reaches,
            without the terminal ones.
        outcomes: the number of distinct outcomes of the level that were compared.
        everywhere: whether the states that no episode reaches agree as well.
        difference: the first difference as text; None if there is none.
        digest: the level's digest.
    """

    __module__ = "babyrobot_levels"

    equal: bool
    actions: tuple[int, ...] | None
    states: int
    outcomes: int
    everywhere: bool
    difference: str | None
    digest: str


def compare(
    level: LevelLike,
    other: Any,
    *,
    actions: Sequence[int] | None = None,
    kwargs: Mapping[str, Any] | None = None,
    tolerance: float = 1e-12,
) -> Certificate:
    """Compare a level with another MDP, outcome by outcome.

    States correspond by number: the level's are `y * width + x`. The outcomes of terminal states
    are not compared, because no episode goes on there. Time limits (`max_steps`) are not part of
    the MDP.

    Args:
        level: whatever `load` takes.
        other: another level, likewise; `"gymnasium:ID"`; a Gymnasium environment that has a
            table, as those of toy_text have (`P` and `initial_state_distrib`); or such a table
            and the probability of each start: `({s: {a: [(p, s', reward, terminal)]}}, start)`.
        actions: for each action of the other, the level's own number of it. By default a mapping
            is searched for under which the MDPs agree.
        kwargs: keyword arguments for `gymnasium.make`.
        tolerance: by how much probabilities may differ. Rewards may differ by 1e-12.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
        ComparisonError: the other has no table, or none that can be read; `actions` do not name
            the four moves, or all five actions, once each; a maze has no seed yet.
    """
    mine = _with_fixed_maze(level)
    mdp = mine.compile()
    tables = _tables_of(other, kwargs)
    difference = _difference_of_shape(mdp, tables)
    if difference is not None:
        return Certificate(False, None, 0, 0, False, difference, mine.digest)
    reached = _reached(mdp)
    agreement = _agreement(mdp, tables, tolerance)
    mapping = _mapping(agreement, reached, actions)
    agree = agreement[:, range(len(mapping)), mapping]
    differing = np.argwhere(reached[:, None] & ~agree)
    difference = _difference_of_starts(mdp, tables, tolerance)
    if difference is None and differing.size:
        state, action = differing[0].tolist()
        difference = _difference_of_outcomes(mdp, tables, state, mapping[action], action)
    return Certificate(
        equal=difference is None,
        actions=mapping,
        states=int(reached.sum()),
        outcomes=int(np.count_nonzero(mdp.probability[reached][:, mapping])),
        everywhere=bool(
            (agree.all(axis=1) | mdp.is_terminal).all() and (mdp.is_terminal == tables.over).all()
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

    @property
    def over(self) -> Flags:
        """The terminal states, `[states]`: next states of outcomes with `terminal` set."""
        ends = self.next_state[self.terminal & (self.probability != 0)]
        return np.isin(np.arange(self.start.size), ends)

    def outcomes(self, state: int, action: int) -> list[Outcome]:
        """Return the outcomes of an action, as listed."""
        tables = (self.probability, self.next_state, self.reward, self.terminal)
        rows = zip(*(table[state, action].tolist() for table in tables), strict=True)
        return [row for row in rows if row[0] != 0]


def _with_fixed_maze(level: LevelLike) -> Level:
    """Return a level whose maze is always the same.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid.
        ComparisonError: it grows another maze at each reset.
    """
    loaded = load(level)
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
        env = _made(other.removeprefix(GYMNASIUM), kwargs or {})
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
    mdp = _with_fixed_maze(other).compile()
    names = tuple(action.name.lower() for action in Action)
    next_state = mdp.next_state.astype(np.float64)
    return _Tables(mdp.probability, next_state, mdp.reward, mdp.terminal, mdp.start, names)


def _made(name: str, kwargs: Mapping[str, Any]) -> Any:
    import gymnasium

    try:
        return gymnasium.make(name, **kwargs)
    except gymnasium.error.Error as error:
        raise ComparisonError(str(error)) from error
    except Exception as error:  # An environment's own code can raise anything.
        message = f"{type(error).__name__}: {error}"
        raise ComparisonError(f"Gymnasium cannot make {name!r}: {message}") from error


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
    steps = transitions(mdp).distances(np.flatnonzero(mdp.start > 0))
    reached: Flags = (steps >= 0) & ~mdp.is_terminal
    return reached


def _agreement(mdp: Mdp, other: _Tables, tolerance: float) -> Flags:
    """Return whether actions have the same outcomes, `[states, other's actions, our actions]`."""
    shape = (mdp.num_states, len(other.names), NUM_ACTIONS)
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
    count = agreement.shape[1]
    ours = range(NUM_ACTIONS - count, NUM_ACTIONS)
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


def _difference_of_shape(mdp: Mdp, other: _Tables) -> str | None:
    if other.start.size != mdp.num_states:
        return (
            f"this level has {mdp.num_states} cells ({mdp.width} by {mdp.height}), "
            f"the other has {other.start.size} states"
        )
    if len(other.names) not in (NUM_MOVES, NUM_ACTIONS):
        return (
            f"this level has {NUM_MOVES} moves and stay, the other has {len(other.names)} actions"
        )
    return None


def _difference_of_starts(mdp: Mdp, other: _Tables, tolerance: float) -> str | None:
    differing = np.flatnonzero(~(np.abs(mdp.start - other.start) <= tolerance))
    if not differing.size:
        return None
    state = int(differing[0])
    return (
        f"episodes start at {_cell(mdp, state)} with probability {mdp.start[state]:.12g} "
        f"in this level, {other.start[state]:.12g} in the other"
    )


def _difference_of_outcomes(mdp: Mdp, other: _Tables, state: int, ours: int, theirs: int) -> str:
    for digits in (6, 17):
        mine, listed = (
            _describe(mdp, outcomes, digits)
            for outcomes in (mdp.outcomes(state, ours), other.outcomes(state, theirs))
        )
        if mine != listed:
            break
    name = Action(ours).name.lower()
    return (
        f"at {_cell(mdp, state)}, {name} (in the other: {other.names[theirs]}):\n"
        f"  this level: {mine}\n"
        f"  the other:  {listed}"
    )


def _describe(mdp: Mdp, outcomes: list[Outcome], digits: int) -> str:
    merged: dict[tuple[float, float, bool], float] = {}
    for probability, state, reward, terminal in outcomes:
        key = (state, reward, terminal)
        merged[key] = merged.get(key, 0.0) + probability
    return (
        "; ".join(
            f"{_cell(mdp, state)} with probability {probability:.{digits}g}, "
            f"reward {reward:.{digits}g}" + (", terminal" if terminal else "")
            for (state, reward, terminal), probability in sorted(merged.items())
        )
        or "no outcome"
    )


def _cell(mdp: Mdp, state: float) -> str:
    if state not in range(mdp.num_states):
        return f"state {state:g}"
    y, x = divmod(int(state), mdp.width)
    return f"[{x}, {y}]"
