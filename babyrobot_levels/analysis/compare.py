"""Certificates: whether a level plays the same game as another level or environment.

Two finite games are the same if their episodes begin alike and every action, in every state that
an episode comes to, leads to the same outcomes with the same probabilities. That is compared here
entry by entry; nothing is sampled.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np

from babyrobot_levels.analysis.transition_tables import (
    ComparisonError,
    Flags,
    Floats,
    Game,
    LevelLike,
    fixed_level,
    game_of,
)
from babyrobot_levels.mdp.actions import NUM_ACTIONS, NUM_MOVES, Action
from babyrobot_levels.mdp.reachability import transitions
from babyrobot_levels.mdp.tables import Mdp, Outcome

REWARD_TOLERANCE = 1e-12


@dataclass(frozen=True)
class Certificate:
    """What comparing a level with another game has shown.

    Attributes:
        equal: whether the two are the same game: the same starts, and the same outcomes of all
            actions in all states that an episode comes to.
        actions: for each action of the other, the level's own number of it (`brl.Action`). Where
            the games differ, those under which they differ least; None if no actions were compared.
        states: the number of states whose outcomes were compared: those that an episode comes
            to, but for those where it is over.
        outcomes: the number of distinct outcomes of the level that were compared.
        everywhere: whether the states that no episode comes to agree as well.
        difference: the first difference, for people to read; None if there is none.
        digest: the level's digest.
    """

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
    """Compare a level with another game, outcome by outcome.

    States correspond by number: the level's are `y * width + x`. What a game says of states
    where the episode is over is not compared, because it is not played. Limits of steps are not
    part of the game.

    Args:
        level: whatever `load` takes.
        other: another level, likewise; `"gymnasium:ID"`; a Gymnasium environment that has a
            table, as those of toy_text have (`P` and `initial_state_distrib`); or such a table
            and the probability of each start: `({s: {a: [(p, s', reward, terminal)]}}, start)`.
        actions: for each action of the other, the level's own number of it. By default a way is
            found in which the games agree, if there is one.
        kwargs: what `gymnasium.make` is given beside the id.
        tolerance: by how much probabilities may differ. Rewards may differ by 1e-12.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
        ComparisonError: the other has no table, or none that can be read; `actions` do not name
            the four moves, or all five actions, once each; a maze has no seed yet.
    """
    mine = fixed_level(level)
    mdp = mine.compile()
    game = game_of(other, kwargs)
    difference = _difference_of_shape(mdp, game)
    if difference is not None:
        return Certificate(False, None, 0, 0, False, difference, mine.digest)
    reached = _reached(mdp)
    agreement = _agreement(mdp, game, tolerance)
    mapping = _best_mapping(agreement, reached, actions)
    agree = agreement[:, range(len(mapping)), mapping]
    faults = np.argwhere(reached[:, None] & ~agree)
    difference = _difference_of_starts(mdp, game, tolerance)
    if difference is None and faults.size:
        state, action = faults[0].tolist()
        difference = _difference_of_outcomes(mdp, game, state, mapping[action], action)
    return Certificate(
        equal=difference is None,
        actions=mapping,
        states=int(reached.sum()),
        outcomes=int(np.count_nonzero(mdp.probability[reached][:, mapping])),
        everywhere=bool((agree.all(axis=1) | mdp.over).all() and (mdp.over == game.over).all()),
        difference=difference,
        digest=mine.digest,
    )


# -- what agrees ---------------------------------------------------------------------------


def _reached(mdp: Mdp) -> Flags:
    """Return which states an episode reaches and goes on from, `[states]`."""
    steps = transitions(mdp).distances(np.flatnonzero(mdp.start > 0).tolist())
    reached: Flags = (steps >= 0) & ~mdp.over
    return reached


def _agreement(mdp: Mdp, game: Game, tolerance: float) -> Flags:
    """Return whether actions have the same outcomes, `[states, other's actions, our actions]`."""
    shape = (mdp.num_states, len(game.names), NUM_ACTIONS)
    agreement = np.zeros(shape, np.bool_)
    for theirs, ours in np.ndindex(*shape[1:]):
        probability, next_state, terminal, reward = (
            np.concatenate(
                [getattr(mdp, name)[:, ours], getattr(game, name)[:, theirs]], axis=1, dtype=float
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


def _best_mapping(agreement: Flags, reached: Flags, given: Sequence[int] | None) -> tuple[int, ...]:
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


# -- what differs --------------------------------------------------------------------------


def _difference_of_shape(mdp: Mdp, game: Game) -> str | None:
    if game.start.size != mdp.num_states:
        return (
            f"this level has {mdp.num_states} cells ({mdp.width} by {mdp.height}), "
            f"the other has {game.start.size} states"
        )
    if len(game.names) not in (NUM_MOVES, NUM_ACTIONS):
        return f"this level has four moves, and can stay; the other has {len(game.names)} actions"
    return None


def _difference_of_starts(mdp: Mdp, game: Game, tolerance: float) -> str | None:
    differing = np.flatnonzero(~(np.abs(mdp.start - game.start) <= tolerance))
    if not differing.size:
        return None
    state = int(differing[0])
    return (
        f"episodes begin at {_cell(mdp, state)} with probability {mdp.start[state]:.12g} "
        f"in this level, {game.start[state]:.12g} in the other"
    )


def _difference_of_outcomes(mdp: Mdp, game: Game, state: int, ours: int, theirs: int) -> str:
    for digits in (6, 17):
        told = [
            _told(mdp, outcomes, digits)
            for outcomes in (mdp.outcomes(state, ours), game.outcomes(state, theirs))
        ]
        if told[0] != told[1]:
            break
    name = Action(ours).name.lower()
    return (
        f"at {_cell(mdp, state)}, {name} (in the other: {game.names[theirs]}):\n"
        f"  this level: {told[0]}\n"
        f"  the other:  {told[1]}"
    )


def _told(mdp: Mdp, outcomes: list[Outcome], digits: int) -> str:
    merged: dict[tuple[float, float, bool], float] = {}
    for probability, state, reward, terminal in outcomes:
        key = (state, reward, terminal)
        merged[key] = merged.get(key, 0.0) + probability
    return (
        "; ".join(
            f"{_cell(mdp, state)} with probability {probability:.{digits}g}, "
            f"reward {reward:.{digits}g}" + (", the end" if terminal else "")
            for (state, reward, terminal), probability in sorted(merged.items())
        )
        or "nothing"
    )


def _cell(mdp: Mdp, state: float) -> str:
    if state not in range(mdp.num_states):
        return f"state {state:g}"
    y, x = divmod(int(state), mdp.width)
    return f"[{x}, {y}]"
