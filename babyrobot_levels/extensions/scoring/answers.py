"""Graded answers: the values, policies and agents of students, exactly, each with a sentence.

The sentence says what is right, by how much the rest is not, and in which state first. Mistakes
are named only where the answer is exactly what the mistake gives. The solution is never told.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.evaluation import action_values, chain_values
from babyrobot_levels.analysis.solver.model import Model, attractor, closed_classes
from babyrobot_levels.analysis.solver.optimum import Optimum, optimum_of, solution_of
from babyrobot_levels.analysis.solver.policies import GRAPHS, Policy
from babyrobot_levels.analysis.solver.results import (
    EpisodeTooLongError,
    Solution,
    UndefinedReturnError,
    action_names,
)
from babyrobot_levels.extensions.learning.results import Problem, read_problem
from babyrobot_levels.extensions.scoring.score import score
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.gridworld import world_of
from babyrobot_levels.mdp.tables import Flags, Floats
from babyrobot_levels.text import budget
from babyrobot_levels.text.words import Telling

DISCOUNTS = (0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 0.98, 0.99, 0.995, 0.999, 1.0)
"""The discounts that are tried to explain an answer."""

MAX_SWEEPS = 1000
"""The most sweeps that are made to explain values."""

MAX_IN_PLACE = 50_000
"""The most updates, states times sweeps, that are made one by one to explain values."""

FROZEN_LAKE = (Action.WEST, Action.SOUTH, Action.EAST, Action.NORTH)
"""The actions in the order in which Gymnasium's FrozenLake numbers them."""


@dataclass(frozen=True, slots=True)
class GradedAnswer(Telling, public=True):
    """What an answer is worth. It is true if the answer passed, and its text is the message.

    Attributes:
        passed: whether the answer is right.
        share: how much of it is right, 0 to 1; 1 exactly if it passed.
        out_of: the points of a right answer.
        message: a sentence for the student, without the solution.
    """

    passed: bool
    share: float
    out_of: float
    message: str

    @property
    def points(self) -> float:
        """The points of the answer: its share of all."""
        return self.share * self.out_of

    def __bool__(self) -> bool:
        return self.passed

    def __str__(self) -> str:
        return self.message


def grade_values(
    level: Any,
    values: Any,
    *,
    policy: Policy | None = None,
    sweeps: int | None = None,
    discount: float | None = None,
    actions: str = "all",
    tolerance: float = 1e-3,
    points: float = 1.0,
) -> GradedAnswer:
    """Grade state values: each state counts the same, terminal ones too.

    Named as mistakes are the values of another number of sweeps, of sweeps in place, of another
    discount, of the random policy; terminal states that are valued, or next states after the end;
    discounted rewards; exchanged signs, rows and columns; what is no number, or has another shape.

    Args:
        level: a name, a path, a mapping or a `Level`.
        values: the answer, `[height, width]`, or `[states]`. A level with things has an axis of
            configurations before height, and with `actions="turns"` there is one of headings.
            What blocked cells and states that no episode reaches have does not matter.
        policy: whose values are asked for, as `brl.evaluate` takes it; by default the optimal ones.
        sweeps: the number of sweeps from values of 0 after which they are asked for, each by the
            values of the sweep before; by default those of the limit.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`.
        tolerance: by how much a value may differ: by this, and by this share of the right one.
        points: the points of a right answer.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument than `values` has an invalid value.
        UndefinedReturnError: what is asked for is undefined.
    """
    if not tolerance >= 0:
        raise ValueError(f"tolerance must be 0 or more, not {tolerance!r}")
    task = _Values(read_problem(level, discount, actions, "sweep"), policy, sweeps, tolerance)
    try:
        table = np.asarray(values, np.float64)
    except (TypeError, ValueError):
        first = next(iter(np.ravel(values)), None) if isinstance(values, np.ndarray) else None
        other = f", but such as {first!s:.40}" if first is not None else ""
        return _wrong(f"the values are not numbers in a table{other}", points)
    if (fault := task.fault_of(table)) is not None:
        return _wrong(fault, points)
    flat = table.ravel()
    right = task.right(flat)
    if right.all():
        return GradedAnswer(True, 1.0, points, f"all {right.size} values are right")
    told = _explained(task.mistakes(table)) or task.first_wrong(flat)
    count = f"{int(right.sum())} of {right.size} values are right"
    return GradedAnswer(False, float(right.mean()), points, f"{count}: {told}")


def grade_policy(
    level: Any,
    policy: Policy,
    *,
    discount: float | None = None,
    actions: str = "all",
    points: float = 1.0,
) -> GradedAnswer:
    """Grade a policy: it must be optimal from each state, by whichever of the optimal actions.

    Named as mistakes are episodes that never end, actions that do not exist, those of another
    numbering, the policy of another discount, and exchanged rows and columns.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: the answer, as `brl.evaluate` takes it.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` without stay, or `"turns"`.
        points: the points of a right answer.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument than `policy` has an invalid value.
        UndefinedReturnError: the optimal return is undefined.
    """
    task = _Policies(read_problem(level, discount, actions, "sweep"))
    task.optimum  # noqa: B018  (its errors are not the student's)
    try:
        weights = task.weights(policy)
        right, is_optimal = task.right(weights)
    except (TypeError, ValueError, UndefinedReturnError, EpisodeTooLongError) as error:
        return _wrong(task.explained(policy) or str(error), points)
    if is_optimal:
        return GradedAnswer(True, 1.0, points, f"the policy is optimal in all {right.size} states")
    told = _explained(task.mistakes(policy, weights)) or task.first_wrong(weights)
    share, count = float(right.mean()), f"{int(right.sum())} of {right.size} states"
    return GradedAnswer(False, share, points, f"the policy is right in {count}: {told}")


def grade_agent(
    level: Any, agent: Any, *, at_least: float = 0.95, points: float = 1.0, **conditions: Any
) -> GradedAnswer:
    """Grade an agent by its expected return from the starts, as `brl.score` computes it.

    Args:
        level: a name, a path, a mapping or a `Level`.
        agent: the answer: a policy, a function from observations to actions, a model, or an
            object with memory, as `brl.score` takes it.
        at_least: the share of the way from the random policy to the optimum with which it passes.
            Below, its share counts.
        points: the points of a right answer.
        conditions: the other arguments of `brl.score`, such as `within`, `observation`, `actions`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument than `agent` has an invalid value, or the optimum is infinite.
    """
    # What is wrong with the conditions is not the student's mistake.
    score(level, "random", **conditions)
    if isinstance(agent, np.ndarray):
        agent = _whole(agent, world_of(level).compile().num_states)
    try:
        (found,) = score(level, agent, **conditions)
    except (TypeError, ValueError) as error:
        return _wrong(str(error), points)
    way = 1.0 if math.isnan(found.share) and found.regret <= 1e-9 else found.share
    passed, has_exits = bool(way >= at_least), world_of(level).has_goal
    told = f"the agent covers {_percent(way)} of the way from the random policy to the optimum"
    if not passed:
        told += f", where {_percent(at_least)} are needed"
        told += f"; it reaches an exit in {_percent(found.success)} of the episodes" * has_exits
        told += "; some of its episodes never end" * math.isinf(found.steps)
        told += _impossible(agent, level, conditions.get("actions", "all"))
    return GradedAnswer(passed, 1.0 if passed else min(max(way, 0.0), 1.0), points, told)


def _impossible(policy: Any, level: Any, actions: str) -> str:
    """Return in how many states an array of actions has impossible ones, as what else is said."""
    if not isinstance(policy, np.ndarray | list) or actions not in ("all", "moves"):
        return ""
    task = _Policies(read_problem(level, None, actions, "sweep"))
    weights = task.weights(policy)
    states, count = task.problem.model.states, weights.shape[1]
    refused = (weights > 0) & (task.problem.space.mdp.action_mask[states, -count:] == 0)
    number = int((refused.any(axis=1) & task.counts).sum())
    told = f"; it takes impossible actions in {number} state{'s' * (number != 1)}"
    return f"{told}: leave them out of the maximum" if number else ""


def _whole(policy: NDArray[Any], states: int) -> NDArray[Any]:
    """Return actions as integers that are whole numbers, as `np.zeros` holds them."""
    if policy.dtype.kind != "f" or policy.size != states:
        return policy
    is_whole = (np.nan_to_num(policy, nan=0.5) % 1 == 0).all()
    return policy.astype(np.int64) if is_whole else policy


def _explained(mistakes: Iterator[str]) -> str | None:
    """Return the first mistake that explains an answer, if an eighth of the work finds it."""
    limits = replace(budget.UNLIMITED, steps=budget.left() / 8)
    with suppress(budget.OverBudgetError), budget.within(limits):
        return next(mistakes, None)
    return None


def _wrong(message: str, points: float) -> GradedAnswer:
    return GradedAnswer(False, 0.0, points, message)


def _percent(share: float) -> str:
    # Rounded down: what falls short of a bound must not look like it.
    return f"{math.floor(share * 100 + 1e-9)} %" if math.isfinite(share) else "nothing"


def _magnitude(difference: float) -> str:
    """Return how large a difference is, by powers of ten: the exact one would tell the solution."""
    if not math.isfinite(difference):
        return "infinitely much"
    power = math.floor(math.log10(difference))
    low, high = (f"{10.0**each:,.10g}" for each in (power, power + 1))
    return f"between {low} and {high}"


@dataclass(frozen=True)
class _Task:
    """What is asked for: states are those of the problem's model, `[n]`."""

    problem: Problem

    @cached_property
    def counts(self) -> Flags:
        """Which states of the model are graded, `[n]`: not those that no episode reaches."""
        return ~self.problem.space.without_value[self.problem.model.states]

    def optimum_at(self, discount: float) -> Optimum:
        """Return the optimum for a discount, which counts as much work as with another model."""
        model = self.problem.model
        budget.spend(GRAPHS * model.probability.size)
        return optimum_of(model, self.problem.space, discount)

    def other_discounts(self) -> list[float]:
        """Return the discounts that a student may have used."""
        return [each for each in DISCOUNTS if each != self.problem.discount]

    def place(self, wrong: Flags) -> str:
        """Return the first of some states of the model, `[n]`, as words."""
        return self.problem.space.text(int(self.problem.model.states[wrong.argmax()]))

    def transposed(self, table: Any) -> Any:
        """Return a table with rows and columns exchanged; None where it would not fit."""
        array = np.asarray(table)
        if array.ndim < 2 or array.shape != self.problem.space.mdp.shape[: array.ndim]:
            return None
        turned = np.swapaxes(array, -1, -2)
        return turned if turned.shape == array.shape else None


@dataclass(frozen=True)
class _Values(_Task):
    """Values of all states: the optimal ones, or those of a policy; of the limit, or of a sweep."""

    policy: Policy | None
    sweeps: int | None
    tolerance: float

    @cached_property
    def model(self) -> Model:
        """The model, with the actions of the policy if there is one."""
        model = self.problem.model
        return model if self.policy is None else model.mixed(self.problem.weights(self.policy))

    @cached_property
    def expected(self) -> Floats:
        """The right values, `[n]`."""
        if self.sweeps is not None:
            *_, (_, last) = self.swept(self.sweeps)
            return last
        return self.at(self.problem.discount)

    def at(self, discount: float) -> Floats:
        """Return the values for a discount, `[n]`."""
        if self.policy is None:
            return self.optimum_at(discount).found.values
        return chain_values(self.model, discount, self.problem.space)

    def swept(self, most: int) -> Iterator[tuple[int, Floats]]:
        """Yield the values after each sweep from 0 on, until nothing changes any more."""
        before, values = np.full(self.model.size, np.nan), np.zeros(self.model.size)
        for number in range(most + 1):
            yield number, values
            if np.array_equal(before, values):
                return
            before, values = values, self.ahead(values)

    def ahead(self, values: Floats) -> Floats:
        """Return what the next sweep makes of values, `[n]`."""
        found: Floats = action_values(self.model, values, self.problem.discount).max(axis=1)
        return found

    @cached_property
    def ends(self) -> Flags:
        """The terminal states that have a value, `[states]`."""
        space = self.problem.space
        return np.asarray(space.mdp.is_terminal & ~space.without_value)

    def fault_of(self, table: Floats) -> str | None:
        """Return why a table has no values of this level; None if it has."""
        space = self.problem.space
        shape = space.mdp.shape
        if table.shape not in (shape, (space.mdp.num_states,)):
            given = f"one of shape {[*table.shape]}" if table.ndim else "a single number"
            message = f"the values must be an array {[*shape]}, not {given}"
            if table.shape[:-1] in (shape, (space.mdp.num_states,)) and table.shape[-1] in (4, 5):
                message += ": of action values, a state takes the largest"
            elif table.shape == (*shape[:-2], shape[-1], shape[-2]):
                message += "; rows come first: values[y, x]"
            elif table.size == space.mdp.num_states:
                message += f": reshape it to {shape}"
            elif table.shape[1:] == shape:
                message += f": these are {len(table)} arrays, return the values alone"
            return message
        counts = self.ends.copy()
        counts[self.model.states] = self.counts
        if (missing := np.isnan(table.ravel()) & counts).any():
            return f"the value of {space.text(int(missing.argmax()))} is not a number (nan)"
        return None

    def close(self, given: Floats, expected: Floats) -> Flags:
        """Return where values of the model's states agree, `[n]`."""
        return np.isclose(given, expected, rtol=self.tolerance, atol=self.tolerance)

    def agree(self, given: Floats, expected: Floats) -> bool:
        """Return whether all values agree that count."""
        return bool(self.close(given, expected)[self.counts].all())

    def right(self, flat: Floats) -> Flags:
        """Return which values are right, first of the states that go on, then of the ends."""
        close = self.close(flat[self.model.states], self.expected)[self.counts]
        return np.append(close, ~self.valued(flat)[self.ends])

    def valued(self, flat: Floats) -> Flags:
        """Return which terminal states have another value than 0, `[states]`."""
        return np.asarray(self.ends & (np.abs(flat) > self.tolerance))

    def mistakes(self, table: Floats) -> Iterator[str]:
        """Yield what the student did, if the values are exactly what it gives."""
        flat = table.ravel()
        given, valued = flat[self.model.states], self.valued(flat)
        discount, turned = self.problem.discount, self.transposed(table)
        end = f"first {self._state(valued)}: no step follows there, so their value is 0"
        if valued.any() and self.agree(given, self.expected):
            yield f"only terminal states have wrong ones, {end}"
        if turned is not None and self.right(turned.ravel()).all():
            yield "rows and columns are exchanged; rows come first: values[y, x]"
        for number, values in self.swept(MAX_SWEEPS):
            if number != self.sweeps and self.agree(given, values):
                more = "; go on until the largest change of a sweep is tiny"
                more = more if self.sweeps is None else f", not {self.sweeps}"
                told = f"these are the values after {number} sweep{'s' * (number != 1)}{more}"
                yield told if number else "all of them are 0"
                break
        beyond = "the value of the next state is added even where a step ends the episode"
        candidates: dict[str, Callable[[], Floats]] = {
            "their signs are exchanged: costs are negative rewards": lambda: -self.expected,
            "the reward of a step is discounted, too; only what follows it is": (
                lambda: discount * self.expected
            ),
        }
        if self.policy is None:
            candidates[
                "these are the values of the random policy: a state takes the largest of its "
                "action values, not their mean"
            ] = lambda: replace(self, policy="random").expected
        else:
            told = "these are the optimal values, not those of the policy"
            candidates[told] = lambda: replace(self, policy=None).expected
        if self.sweeps is None:
            for each in self.other_discounts():
                told = f"these are the values for the discount {each:g}, not {discount:g}"
                candidates[told] = partial(self.at, each)
            told = f"terminal states are valued, {end}" if valued.any() else beyond
            candidates[told] = lambda: self._beyond_the_end(flat)
        elif self.sweeps * self.model.size <= MAX_IN_PLACE:
            candidates[
                "these are the values of sweeps in place: take all values of next states from the "
                "sweep before"
            ] = partial(self._in_place, self.sweeps)
        for told, made in candidates.items():
            with suppress(UndefinedReturnError, EpisodeTooLongError):
                if self.agree(given, made()):
                    yield told

    def _state(self, states: Flags) -> str:
        return self.problem.space.text(int(states.argmax()))

    def _in_place(self, sweeps: int) -> Floats:
        model, values = self.model, np.zeros(self.model.size + 1)
        for _ in range(sweeps):
            for state in range(model.size):
                following = (model.probability[state] * values[model.next_state[state]]).sum(axis=1)
                values[state] = (model.reward[state] + self.problem.discount * following).max()
        return values[:-1]

    def _beyond_the_end(self, flat: Floats) -> Floats:
        """Return a sweep of the given values that goes on after the end, `[n]`."""
        space, states = self.problem.space, self.problem.model.states
        mdp, first = space.mdp, space.first_action
        known = np.nan_to_num(flat)[mdp.next_state[states, first:]]
        outcomes = mdp.reward[states, first:] + self.problem.discount * known
        ahead = (mdp.probability[states, first:] * outcomes).sum(axis=2)
        if self.policy is None:
            return np.asarray(ahead.max(axis=1))
        return np.asarray((self.problem.weights(self.policy) * ahead).sum(axis=1))

    def first_wrong(self, flat: Floats) -> str:
        """Return where the first wrong value is, how large the difference is, and of what kind."""
        given = flat[self.model.states]
        wrong = ~self.close(given, self.expected) & self.counts
        if not wrong.any():
            return f"the terminal state {self._state(self.valued(flat))}"
        # A value that does not follow from its neighbours is nearer to the cause.
        causes = wrong & ~self.close(given, self.ahead(np.where(self.counts, given, 0.0)))
        chosen = causes if causes.any() and self.sweeps is None else wrong
        at = int(chosen.argmax())
        difference = float(given[at] - self.expected[at])
        told = (
            f"at {self.place(chosen)} it is too {'high' if difference > 0 else 'low'}, by "
            f"{_magnitude(abs(difference))}"
        )
        if chosen is causes:
            by = "its best action gives" if self.policy is None else "the policy gives"
            told += f", and not what {by} with your values of the next states"
        return told


class _Policies(_Task):
    """A policy that is optimal from all states."""

    def weights(self, policy: Any) -> Floats:
        """Return a policy as probabilities, `[n, actions]`.

        Raises:
            ValueError: it is none of this level.
        """
        if not isinstance(policy, str) and not callable(policy) and not hasattr(policy, "actions"):
            try:
                policy = np.asarray(policy)
            except ValueError:
                raise ValueError("the policy is not a table: its rows differ in length") from None
            policy = _whole(policy, self.problem.space.mdp.num_states)
        return self.problem.weights(policy)

    @cached_property
    def optimum(self) -> Optimum:
        """The optimum."""
        return self.optimum_at(self.problem.discount)

    @property
    def solution(self) -> Solution:
        """The optimum with all that is known of it: its tables are too large to be kept."""
        problem = self.problem
        return solution_of(problem.model, problem.space, self.optimum, problem.discount)

    @cached_property
    def greedy(self) -> Flags:
        """The optimal actions, `[n, actions]`."""
        table = self.solution.greedy
        return table.reshape(-1, table.shape[-1])[self.problem.model.states]

    def is_optimal(self, weights: Floats, discount: float) -> Flags:
        """Return from which states a policy earns the optimum, `[n]`."""
        values = chain_values(self.problem.model.mixed(weights), discount, self.problem.space)
        is_own = discount == self.problem.discount
        optimum = self.optimum if is_own else self.optimum_at(discount)
        close = np.isclose(values, optimum.found.values, rtol=1e-7, atol=1e-9)
        return np.asarray(close | ~self.counts)

    def right(self, weights: Floats) -> tuple[Flags, bool]:
        """Return in which of the states that count a policy is right, and whether it is optimal."""
        optimal = self.is_optimal(weights, self.problem.discount)
        right = ~self.wrong_actions(weights).any(axis=1) & (optimal | ~self.endless(weights))
        return (optimal if right.all() else right)[self.counts], bool(optimal.all())

    def wrong_actions(self, weights: Floats) -> Flags:
        """Return which actions a policy takes that are not optimal, `[n, actions]`."""
        return (weights > 0) & ~self.greedy & self.counts[:, None]

    def endless(self, weights: Floats) -> Flags:
        """Return from which states a policy surely never ends, `[n]`."""
        chain = self.problem.model.mixed(weights)
        return np.asarray(~attractor(chain, chain.end, chain.allowed)[0] & self.counts)

    def mistakes(self, policy: Any, weights: Floats) -> Iterator[str]:
        """Yield what the student did, if it explains all that is wrong."""
        if (explained := self.explained(policy)) is not None:
            yield explained
        discount = self.problem.discount
        for other in self.other_discounts():
            with suppress(UndefinedReturnError, EpisodeTooLongError):
                if self.is_optimal(weights, other).all():
                    yield f"it is optimal for the discount {other:g}, not for {discount:g}"
        # Where the optimum goes on for ever, that is no mistake.
        bad = ~self.is_optimal(weights, discount) & ~self.endless(self.weights(self.solution))
        endless: Flags = self.endless(weights) & bad
        label = closed_classes(self.problem.model.mixed(weights))
        if (stuck := endless & (label >= 0)).any():
            cells = self.problem.space.cells(
                self.problem.model.states[(label == label[stuck][0]) & self.counts]
            )
            around = ", ".join(f"[{x}, {y}]" for x, y in cells[:5]) + ", …" * (len(cells) > 5)
            yield f"from {self.place(endless)} its episodes never end, but go on around {around}"

    def explained(self, policy: Any) -> str | None:
        """Return how a plain array of actions would have to be read to be optimal, if at all."""
        if isinstance(policy, str) or callable(policy) or hasattr(policy, "actions"):
            return None
        space = self.problem.space
        try:
            table = np.asarray(policy)
            table = table.reshape(space.mdp.shape) if table.ndim == 1 else table
        except ValueError:
            return None
        if table.dtype.kind in "iu" and space.actions != "turns" and table.shape == space.mdp.shape:
            first, going_on = space.first_action, table.ravel()[self.problem.model.states]
            readings = {
                "0 is north there, as with actions='moves'": np.arange(4) + 1 - first,
                "0 is stay there, as with actions='all'": np.arange(5) - first,
                "they are numbered as in Gymnasium's FrozenLake": np.array(FROZEN_LAKE) - first,
            }
            for told, reading in readings.items():
                read = reading[table.clip(0, reading.size - 1)]
                if ((going_on >= 0) & (going_on < reading.size)).all() and self._passes(read):
                    known = enumerate(action_names("all", space.mdp)[first:])
                    here = ", ".join(f"{number} {name}" for number, name in known)
                    return f"its actions would be right if {told}; here they are {here}"
        turned = self.transposed(table)
        if turned is not None and self._passes(turned):
            return "rows and columns are exchanged; rows come first: policy[y, x]"
        return None

    def _passes(self, policy: Any) -> bool:
        try:
            return self.right(self.weights(policy))[1]
        except (ValueError, UndefinedReturnError, EpisodeTooLongError):
            return False

    def first_wrong(self, weights: Floats) -> str:
        """Return the first action that is not optimal, and how large its loss is."""
        wrong = self.wrong_actions(weights)
        states: Flags = np.any(wrong, axis=1)
        if not states.any():
            return "it risks episodes that go on for ever"
        at = int(states.argmax())
        action = int(wrong[at].argmax())
        problem, space = self.problem, self.problem.space
        ahead = action_values(problem.model, self.optimum.found.values, problem.discount)[at]
        name = action_names(space.actions, space.mdp)[action + space.first_action]
        loss = _magnitude(float(ahead.max() - ahead[action]))
        return f"at {self.place(states)}, {name} is not optimal; it loses {loss}"
