"""The results that the algorithms yield, and the problem that they all learn."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from babyrobot_levels.analysis.shown import image, state_picture
from babyrobot_levels.analysis.solver.evaluation import MAX_STEPS
from babyrobot_levels.analysis.solver.model import Model
from babyrobot_levels.analysis.solver.optimum import TOLERANCE, solve
from babyrobot_levels.analysis.solver.policies import Policy, StateSpace, read_policy, space_of
from babyrobot_levels.analysis.solver.results import (
    EpisodeTooLongError,
    StateResult,
    UndefinedReturnError,
    check_actions,
    check_count,
    check_discount,
)
from babyrobot_levels.language.metric_names import MAX_SOLVED
from babyrobot_levels.mdp.gridworld import GridWorld, check_one_robot, world_of
from babyrobot_levels.mdp.tables import Floats, Ints
from babyrobot_levels.render.words.phrases import number
from babyrobot_levels.text.words import no_attribute


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What all results of one run of an algorithm share.

    Attributes:
        level: the level.
        discount: the discount.
        unit: what the results are numbered by: `"sweep"`, `"round"` or `"episode"`.
        estimates: the number of each result so far, and its estimate of the return from the starts.
    """

    level: GridWorld
    discount: float
    unit: str
    estimates: list[tuple[int, float]] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Sweep(StateResult, public=True):
    """The estimates after a sweep, a round or some episodes. All arrays are read-only copies.

    In a level with things, arrays have an axis of configurations before height, and `at` gives the
    part of one; with `actions="turns"`, an axis of the 4 headings comes before height.

    Attributes:
        number: the number of sweeps, rounds or episodes so far.
        values: the estimated return from each cell, float64 `[height, width]`: 0 at terminal
            cells, nan at blocked cells.
        policy: the greedy action for each cell, int64 `[height, width]`, the first one of ties;
            -1 at blocked and terminal cells. Actions are numbered as in an environment made with
            the same `actions`; the array carries this set, which `evaluate` and everything
            else that takes a policy respects.
        delta: the largest change of an estimate since the sweep before; inf for number 0.
        actions: `"all"`, `"moves"` or `"turns"`.
        run: what it shares with the other results of the same run; None in what earlier versions
            pickled.
    """

    number: int
    values: Floats
    policy: Ints
    delta: float
    actions: str
    run: Run | None = field(default=None, kw_only=True)

    @property
    def level(self) -> GridWorld | None:
        """The level; None without a run."""
        return None if self.run is None else self.run.level

    @property
    def first_action(self) -> int:
        """The `brl.Action` that is number 0 here: 0 with `"all"`, 1 with `"moves"`.

        With `"turns"`, it is the `brl.Turn` 0.
        """
        return check_actions(self.actions)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} number={self.number} delta={self.delta:.6g}>"

    def _html(self) -> str:
        from babyrobot_levels.render.notebook.html import Picture, beside, facts

        run = self.run
        rows = [("Number", f"{self.number:,}"), ("Largest change", f"{self.delta:.2g}")]
        if run is not None:
            rows[0] = (run.unit.title(), rows[0][1])
            rows += [
                ("Return from the start", number(value))
                for at, value in run.estimates
                if at == self.number
            ]
            rows.append(("Discount", number(run.discount)))
        rows.append(("Actions", self.actions))
        title, svg = self._curve(self._goal())
        curve = Picture(svg.encode(), "image/svg+xml", 460, 260, title) if svg else None
        return beside(image(state_picture(self)), image(curve) + facts(rows))

    def _curve(self, goal: tuple[str, float] | None) -> tuple[str, str]:
        """Return how the run has gone so far, a title and an SVG, which is empty without a run."""
        from babyrobot_levels.extensions.learning.charts import Curve, curves_svg

        title, run = "Return from the start", self.run
        if run is None:
            return title, ""
        points = [(at, value) for at, value in run.estimates if at <= self.number]
        return title, curves_svg(
            [Curve("estimate", points)], goal=goal, x_title=run.unit, y_title=title.lower()
        )

    def _goal(self) -> tuple[str, float] | None:
        """Return the optimum that learning is compared with; None where it takes long."""
        if self.run is None or self.values.size > MAX_SOLVED:
            return None
        try:
            best = solve(self.run.level, self.run.discount, actions=self.actions)
        except (UndefinedReturnError, EpisodeTooLongError):
            return None
        return "optimum", best.expected_return


@dataclass(frozen=True, eq=False, repr=False)
class Trials(Sweep, public=True):
    """The estimates after some episodes in an environment: a `Sweep`, and more.

    Attributes:
        action_values: the estimated return if an action is taken first, float64
            `[height, width, actions]`; `values` are their maxima.
        returns: the (discounted) sum of the rewards of each episode so far, float64 `[number]`.
    """

    action_values: Floats
    returns: Floats

    def _curve(self, goal: tuple[str, float] | None) -> tuple[str, str]:
        from babyrobot_levels.extensions.learning.charts import FAINT, Curve, curves_svg

        returns = self.returns
        window = max(1, returns.size // 20)
        means = np.convolve(returns, np.full(window, 1 / window), "valid")
        raw = Curve("each episode", [*enumerate(returns.tolist(), 1)], FAINT, 1.0)
        mean = Curve(f"mean of {window}", [*enumerate(means.tolist(), window)])
        curves = [raw, mean] if window > 1 else [Curve("each episode", raw.points)]
        svg = curves_svg(curves, goal=goal, x_title="episode", y_title="return")
        return "Return of each episode", svg


Step = TypeVar("Step", bound=Sweep)


class Learning(Iterator[Step]):
    """The results of an algorithm, one after the other: it goes on as they are asked for.

    It also has the attributes of the latest result, such as `policy` and `values`. Before the
    first is asked for, reading one of these lets the algorithm go on to its end.
    """

    __module__ = "babyrobot_levels"

    def __init__(self, kind: type[Step], results: Iterator[Step]):
        self._kind, self._results = kind, results
        self._latest: Step | None = None

    def __next__(self) -> Step:
        self._latest = next(self._results)
        return self._latest

    def __dir__(self) -> list[str]:
        return [*self._kind.__match_args__, *dir(self._kind)]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in dir(self):
            raise no_attribute(self, name)
        for _ in self if self._latest is None else ():
            pass
        return getattr(self._latest, name)

    def __repr__(self) -> str:
        return f"<Learning: each {self._kind.__name__}, and the policy, values, … of the latest>"


@dataclass(frozen=True, eq=False)
class Problem:
    """A level to learn: its states for a set of actions, their model, and the discount."""

    space: StateSpace
    model: Model
    run: Run

    @property
    def discount(self) -> float:
        """The discount."""
        return self.run.discount

    @property
    def max_steps(self) -> int:
        """The number of steps after which an episode is truncated."""
        return self.space.level.max_steps or MAX_STEPS

    def weights(self, policy: Policy) -> Floats:
        """Return a policy as probabilities, `[n, actions]`.

        Raises:
            ValueError: it is no policy, or does not fit the level.
        """
        return read_policy(policy, self.space)[self.model.states]

    def greedy(self, ahead: Floats) -> Ints:
        """Return the greedy actions, `[n]`: the first of those that differ by rounding only."""
        best = ahead.max(axis=1, keepdims=True)
        size = np.where(np.isfinite(best), np.abs(best), 0.0)
        first: Ints = (ahead >= best - TOLERANCE * np.maximum(1.0, size)).argmax(axis=1)
        return first

    def sweep(self, number: int, values: Floats, delta: float, policy: Ints | None = None) -> Sweep:
        """Return the `Sweep` of some state values, `[n]`.

        Args:
            number: the sweep's number.
            values: the finite values; infinite ones only with a policy.
            delta: the largest change.
            policy: an action for each state, `[n]`; by default, the greedy ones.
        """
        if policy is None:
            policy = self.greedy(self.model.action_values(values, self.discount))
        self.run.estimates.append((number, self.space.at_start(self.model, values)))
        states = self.space.spread(self.model, values)
        return Sweep(number, states, self._policy(policy), delta, self.space.actions, run=self.run)

    def trials(self, number: int, ahead: Floats, delta: float, returns: list[float]) -> Trials:
        """Return the `Trials` of some action values, `[n, actions]`."""
        states = self.space.spread(self.model, ahead.max(axis=1))
        rows = self.space.spread(self.model, ahead)
        policy, actions = self._policy(self.greedy(ahead)), self.space.actions
        return Trials(number, states, policy, delta, actions, rows, np.array(returns), run=self.run)

    def _policy(self, policy: Ints) -> Ints:
        mdp = self.space.mdp
        states = np.full(mdp.num_states, -1)
        states[self.model.states] = policy
        return states.reshape(mdp.shape)


def read_problem(level: Any, discount: float | None, actions: str, unit: str) -> Problem:
    """Return the problem of learning a level.

    Args:
        level: a name, a path, a mapping or a `Level`.
        discount: above 0 and at most 1; by default, the level's.
        actions: `"all"`, `"moves"` or `"turns"`.
        unit: what results are numbered by: `"sweep"`, `"round"` or `"episode"`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, its maze has no seed yet, or episodes have several
            robots.
        ValueError: another argument has an invalid value.
    """
    level = world_of(level)
    if unit == "episode":
        check_one_robot(level, "algorithms that learn from episodes")
    run = Run(level, check_discount(discount, level.discount), unit)
    space = space_of(level, actions, run.discount)
    return Problem(space, space.model(), run)


def check_counts(**counts: int) -> None:
    """Check numbers of sweeps or episodes.

    Raises:
        ValueError: one is not at least 1.
    """
    for name, count in counts.items():
        check_count(name, count)


def largest_change(after: Floats, before: Floats) -> float:
    """Return the largest change of an estimate; values that stay infinite do not change."""
    changed = after != before
    return float(np.abs(after[changed] - before[changed]).max(initial=0.0))
