"""The optimal policy of a level: whether it terminates, in time, and what makes no difference."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.hardness import optimal_ends
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import (
    EpisodeTooLongError,
    Solution,
    UndefinedReturnError,
)
from babyrobot_levels.language.metric_names import MAX_SOLVED
from babyrobot_levels.language.things import Door
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.gridworld import changed
from babyrobot_levels.mdp.states import Reach, ends_by_hit, exit_states, occurring
from babyrobot_levels.mdp.tables import Flags, Mdp
from babyrobot_levels.text.errors import LevelError

MAX_WORK = 200_000_000
"""States times steps: the limit up to which the exit probability is computed step by step."""

_STEP = 2_000
"""As how many states a step counts, however few there are."""


def solution_of(level: Level) -> Solution | None:
    """Solve a level; return None if it has no optimal value or takes too long to solve."""
    if level.compile().num_states > MAX_SOLVED:
        return None
    try:
        return solve(level)
    except (UndefinedReturnError, EpisodeTooLongError):
        return None


def surely_terminates(mdp: Mdp, discount: float) -> bool:
    """Return whether rewards alone show that never terminating is never better than terminating.

    This holds if every step costs something and there is no discount, or if all steps cost the
    same and the last step costs no more than the others. False means unknown.
    """
    happens = (mdp.probability > 0) & ~mdp.is_terminal[:, None, None]
    ends = mdp.terminal & happens
    going_on = happens & ~ends
    if not going_on.any():
        return True
    lowest = mdp.reward.min(where=going_on, initial=np.inf)
    highest = mdp.reward.max(where=going_on, initial=-np.inf)
    if highest < 0 and discount == 1:
        return True
    return bool(lowest == highest <= 0 and mdp.reward.min(where=ends, initial=0.0) >= highest)


def endless_loop(mdp: Mdp, reach: Reach, solution: Solution) -> list[int]:
    """Return states in which the optimal policy loops forever although the episode could end.

    If there are several such loops, only one of them is returned.
    """
    policy = solution.policy.ravel()
    states = np.flatnonzero(policy >= 0)
    happens = mdp.probability[states, policy[states]] > 0
    hits = ends_by_hit(mdp)[states, policy[states]]
    goes_on = happens & ~hits
    origins = np.repeat(states, goes_on.sum(axis=1))
    ways = Graph(mdp.num_states, origins, mdp.next_state[states, policy[states]][goes_on])
    back = ways.reversed()
    visited = ways.distances(mdp.start.nonzero()[0].tolist()).tolist()
    is_last = mdp.is_terminal.copy()
    is_last[states[hits.any(axis=1)]] = True
    ending = back.distances(is_last.nonzero()[0].tolist()).tolist()
    stuck = [
        state
        for state in range(mdp.num_states)
        if visited[state] >= 0 > ending[state] and reach.to_end[state] >= 0
    ]
    # If the policy can leave a loop for another one, continue there.
    while stuck:
        loop = [s for s, steps in enumerate(ways.distances(stuck[:1]).tolist()) if steps >= 0]
        returns = back.distances(stuck[:1]).tolist()
        stuck = [state for state in loop if returns[state] < 0]
        if not stuck:
            return loop
    return []


def surely_within_limit(level: Level, to_exit: Sequence[int]) -> bool:
    """Return whether costs alone show that the optimal policy succeeds in half of the episodes.

    If every step has a cost, the optimal policy takes no more steps than a deterministic path
    costs, divided by the lowest cost of a step. By Markov's inequality, at most half of the
    episodes take twice the expected number of steps. False means unknown.

    Args:
        level: the level, which has `max_steps`.
        to_exit: the minimum number of steps from each state to an exit.
    """
    mdp, limit = level.compile(), level.max_steps or 0
    happens = (mdp.probability > 0) & ~mdp.is_terminal[:, None, None]
    ends = mdp.terminal & happens
    lowest_cost = -mdp.reward.max(where=happens & ~ends, initial=-np.inf)
    if level.has_things:
        return False
    if level.discount < 1 or lowest_cost <= 0 or mdp.is_terminal.sum() > len(level.exits):
        return False
    highest = float(mdp.reward.max(where=ends, initial=-np.inf))
    sure = happens.sum(axis=2) == 1
    # Cells that some action leaves deterministically, and terminal cells.
    firm = (sure[:, 1:].any(axis=1) | mdp.is_terminal).tolist()
    for state in mdp.start.nonzero()[0].tolist():
        value = 0.0
        while to_exit[state] > 0:
            is_sure, following = sure[state].tolist(), mdp.next_state[state, :, 0].tolist()
            nearer = (
                action
                for action, other in enumerate(following)
                if is_sure[action] and firm[other] and 0 <= to_exit[other] < to_exit[state]
            )
            action = next(nearer, None)
            if action is None:
                return False
            value += float(mdp.reward[state, action, 0])
            state = following[action]
        if 2 * (1 + (highest - value) / lowest_cost) > limit + 1:
            return False
    return True


def is_within_limit(level: Level, solution: Solution, share: float) -> bool | None:
    """Return whether the optimal policy reaches an exit in `max_steps` with a probability.

    Args:
        level: the level, which has `max_steps`.
        solution: its solution.
        share: the probability.

    Returns:
        None if there are too many steps to compute.
    """
    mdp, limit = level.compile(), level.max_steps or 0
    probability = solution.exit_probability
    # Markov's inequality bounds the share of episodes that take longer than the limit.
    if probability - solution.expected_steps / (limit + 1) >= share:
        return True
    policy = solution.policy.ravel()
    states = np.flatnonzero(policy >= 0)
    chances = mdp.probability[states, policy[states]]
    targets = mdp.next_state[states, policy[states]]
    chances = np.where(ends_by_hit(mdp)[states, policy[states]], 0.0, chances)
    arrived = exit_states(level, mdp).astype(np.float64)
    most = MAX_WORK // (chances.size + _STEP)
    for _ in range(min(limit, most)):
        ahead = (chances * arrived[targets]).sum(axis=1)
        if (ahead == arrived[states]).all():
            return False
        arrived[states] = ahead
        if mdp.start @ arrived >= share:
            return True
    return None if limit > most else False


Entry = TypeVar("Entry")

MAX_STATES = 20_000
"""After variants with so many states together, no further one is looked at."""

Facts = list[NDArray[Any]]
"""All that can happen under some policies: the same if and only if the same can happen."""


def episodes(level: Level) -> Facts:
    """Return all that can happen in a level, whatever the robot does.

    Raises:
        LevelError: its tables are too large.
    """
    mdp = level.compile()
    return _facts(mdp, occurring(mdp).ravel(), np.ones(mdp.reward.shape[:2], bool))


def best_episodes(level: Level) -> Facts:
    """Return all that can happen in a level under optimal policies.

    Raises:
        ArithmeticError: it has no optimum, none that is finite, or takes too long to solve.
        LevelError: its tables are too large.
    """
    solution, mdp = solution_of(level), level.compile()
    if solution is None or not np.isfinite(solution.expected_return):
        raise ArithmeticError
    return _facts(mdp, optimal_ends(solution)[0], solution.greedy.reshape(mdp.num_states, -1))


def _facts(mdp: Mdp, here: Flags, taken: Flags) -> Facts:
    """Return what happens in some states, `[states]`, with some actions, `[states, actions]`."""
    rows = (mdp.probability > 0) & (taken & (here & ~mdp.is_terminal)[:, None])[..., None]
    facts: Facts = []
    # Numbers of configurations may differ, so states are told by the values of things.
    for numbers in (np.flatnonzero(here), mdp.next_state[rows]):
        facts += [mdp.configurations[numbers // mdp.cells], numbers % mdp.cells]
    facts += [taken[here], rows.sum(axis=2)[here]]
    return [*facts, mdp.probability[rows], mdp.reward[rows], mdp.terminal[rows]]


@dataclass(frozen=True, slots=True)
class Need:
    """A name in `needs` or `unless` of a door, or in `exit_needs`.

    Attributes:
        name: the name.
        door: the index of the door, None for `exit_needs`.
        field: `needs` or `unless`; of the exits, `exit_needs`.
        index: its place among the names.
    """

    name: str
    door: int | None
    field: str
    index: int

    def removed(self, doors: tuple[Door, ...], exit_needs: tuple[str, ...]) -> dict[str, Any]:
        """Return the fields of a level with such doors and needs that change without the name."""
        if self.door is None:
            return {"exit_needs": without(exit_needs, self.index)}
        door = doors[self.door]
        names = door.keys if self.field == "needs" else door.locks
        other = door.model_copy(update={self.field: without(names, self.index)})
        return {"doors": (*doors[: self.door], other, *doors[self.door + 1 :])}


class Necessity:
    """The needs and doors of a level that make no difference.

    A need makes none if all episodes stay the same without it, whatever the robot does. Of a door
    it is enough that the best policies stay the same both without it and with a wall in its place.

    They are checked from last to first, needs before doors, and one without effect counts as
    removed from then on: all of them can be removed together.

    Attributes:
        idle_needs: the needs without effect.
        idle_doors: the doors without effect, by index, and whether they are not passed: others
            are open whenever the robot comes to them.
    """

    def __init__(self, level: Level, doors: Sequence[int], *, check_needs: bool) -> None:
        """Look at variants of a level, as long as there is time.

        Args:
            level: the level.
            doors: the doors to check, by index, with what they need.
            check_needs: whether needs are checked, too.
        """
        self.idle_needs: list[Need] = []
        self.idle_doors: dict[int, bool] = {}
        self._level, self._left = level, MAX_STATES
        self._wanted: dict[Callable[[Level], Facts], Facts | None] = {}
        self._now: dict[str, Any] = {"doors": level.doors, "exit_needs": level.exit_keys}
        for need in self._needs(doors) if check_needs else ():
            fields = need.removed(**self._now)
            if self._same(episodes, self._variant(fields)):
                self.idle_needs.append(need)
                self._now |= fields
        for number in sorted(doors, reverse=True):
            names = (*level.doors[number].keys, *level.doors[number].locks)
            gone = self._with_door(number, ())
            without_lock = self._variant(gone)
            is_open = self._same(episodes, without_lock)
            if is_open or self._same(
                best_episodes, without_lock, self._variant(self._with_door(number, names))
            ):
                self.idle_doors[number] = not is_open
                self._now |= gone

    def _with_door(self, number: int, names: tuple[str, ...]) -> dict[str, Any]:
        """Return the fields in which a door needs to have some things and not to have them."""
        # The others keep their numbers: a door that needs nothing is none.
        doors = self._now["doors"]
        door = doors[number].model_copy(update={"needs": names, "unless": names})
        return {"doors": (*doors[:number], door, *doors[number + 1 :])}

    def _needs(self, doors: Sequence[int]) -> Iterator[Need]:
        """Yield the needs to check; the last one of a door is none of them."""
        for index in reversed(range(len(self._level.exit_keys))):
            yield Need(self._level.exit_keys[index], None, "exit_needs", index)
        for number in sorted(doors, reverse=True):
            door = self._level.doors[number]
            for field, names in (("unless", door.locks), ("needs", door.keys)):
                for index in reversed(range(len(names))):
                    now = self._now["doors"][number]
                    if len(now.keys) + len(now.locks) > 1:
                        yield Need(names[index], number, field, index)

    def _same(self, facts: Callable[[Level], Facts], *variants: Level | None) -> bool:
        """Return whether facts are the same in some variants; False where this is not proved."""
        if facts not in self._wanted:
            self._wanted[facts] = _known(facts, self._level)
        wanted = self._wanted[facts]
        for variant in variants:
            found = None if variant is None or wanted is None else _known(facts, variant)
            if wanted is None or found is None or not all(map(np.array_equal, wanted, found)):
                return False
        return True

    def _variant(self, fields: dict[str, Any]) -> Level | None:
        """Return the level with other values for some fields; None if that takes too long."""
        variant = changed(self._level, **{**self._now, **fields})
        with suppress(LevelError):
            if self._left >= 0:
                self._left -= variant.compile().num_states
                return variant
        return None


def _known(facts: Callable[[Level], Facts], level: Level) -> Facts | None:
    with suppress(ArithmeticError):
        return facts(level)
    return None


def without(entries: tuple[Entry, ...], number: int) -> tuple[Entry, ...]:
    """Return entries without one of them, by its index."""
    return (*entries[:number], *entries[number + 1 :])
