"""What solving, evaluating and simulating return and raise, and the arguments that they share."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.mdp.actions import MOVES, Action, Turn
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import Flags, Floats, Ints, Mdp
from babyrobot_levels.registry.later import Shown, later
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.words import Telling, no_item

TURNS = "turns"
"""The set of actions of a robot that turns, which are `Turn`s and not `Action`s."""

ACTION_SETS = {"all": Action.STAY, "moves": Action.NORTH, TURNS: Turn.LEFT}
"""The sets of actions, and the action that is number 0 of each."""

OVER_STATES = ("values", "action_values", "greedy", "fastest", "policy", "margin")
"""The arrays over states of all results."""

OF_EPISODES = (
    *("expected_steps", "exit_probability", "fastest", "policy"),
    *("diverging_cells", "diverging_condition"),
)
"""What a solution tells of its episodes. Without a limit it is found when first asked for."""

MAX_LISTED = 5
"""How many cells an explanation lists."""


# -- errors --------------------------------------------------------------------------------


class UndefinedReturnError(BabyRobotError, ArithmeticError, public=True):
    """The undiscounted return of a level or of a policy is undefined.

    Raised where rewards that differ from zero cancel out in a loop without end: +1, -1, +1, …
    `cell` is a cell `(x, y)` of such a loop; `where` is that cell and what is held there, as words.
    """

    def __init__(self, cell: tuple[int, int], where: str | None = None):
        self.cell = cell
        self.where = f"[{cell[0]}, {cell[1]}]" if where is None else where
        super().__init__(cell, where)

    def __str__(self) -> str:
        return (
            f"around {self.where} an episode can go on for ever while rewards and costs cancel "
            "out, so that its return is undefined; give a discount below 1"
        )


class TooLargeError(BabyRobotError, ValueError):
    """Levels have too many states for a model of what can be known of them."""

    __module__ = "babyrobot_levels.extensions.sight"


class EpisodeTooLongError(BabyRobotError, ArithmeticError, public=True):
    """Episodes are too long to compute their expected return.

    Raised where floating point cannot tell it without a discount, where a limit of steps is so
    large that it would take too long, and where rewards are too large to add up.
    """

    def __str__(self) -> str:
        return super().__str__() or (
            "the expected episode length exceeds 10^10 steps, too many for an exact return; "
            "give a discount below 1"
        )


class NotExactError(BabyRobotError, ArithmeticError, public=True):
    """A level has no exact solution that can be computed: too many states, or too many digits.

    Raised as well where the library for it is missing.
    """


# -- results -------------------------------------------------------------------------------


class PolicyArray(np.ndarray[Any, np.dtype[np.int64]]):
    """An array of actions that carries its set of actions, which gives its numbers a meaning.

    Views and copies carry it too. The results of arithmetic and comparisons are plain arrays,
    because their numbers may mean something else.

    Args:
        table: the actions, integers of any shape.
        actions: `"all"`, `"moves"` or `"turns"`.
    """

    actions: str | None

    def __new__(cls, table: ArrayLike, actions: str | None) -> PolicyArray:
        """Return a view of a table of actions."""
        array = np.asarray(table).view(cls)
        array.actions = actions
        return array

    @property
    def first_action(self) -> int:
        """The `brl.Action` that is number 0 here: 0 with `"all"`, 1 with `"moves"`.

        With `"turns"`, it is the `brl.Turn` 0.
        """
        if self.actions is None:
            raise AttributeError("this array has no set of actions")
        return check_actions(self.actions)

    def __array_finalize__(self, obj: Any) -> None:
        self.actions = getattr(obj, "actions", None)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        if "out" in kwargs:
            kwargs["out"] = tuple(map(_plain, kwargs["out"]))
        return getattr(ufunc, method)(*map(_plain, inputs), **kwargs)

    def __reduce__(self) -> tuple[Any, ...]:
        return PolicyArray, (np.asarray(self), self.actions)

    def __repr__(self) -> str:
        return f"{np.array_repr(self)[:-1]}, actions={self.actions!r})"


def _plain(array: Any) -> Any:
    return array.view(np.ndarray) if isinstance(array, PolicyArray) else array


class Result(Telling):
    """Makes the arrays of a frozen dataclass read-only, and its `policy` a `PolicyArray`."""

    def __post_init__(self) -> None:
        values = vars(self)
        for name in ("policy", "policies"):
            if values.get(name) is not None:
                values[name] = PolicyArray(values[name], values["actions"])
        for value in values.values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    if not TYPE_CHECKING:
        __getitem__ = no_item


class StateResult(Shown, Result):
    """A result with arrays over states."""

    def at(self, configuration: int, heading: str | None = None) -> Self:
        """Return the part of one configuration, of arrays `[height, width]`, as pictures show it.

        What is not an array over states is the same as in the whole.

        Args:
            configuration: its number in the tables; 0 in a level without things.
            heading: where a robot that turns looks: N, E, S or W; by default, all 4 are kept.

        Raises:
            IndexError: there is no such configuration.
            ValueError: there is no such heading.
        """
        turns = vars(self)["actions"] == TURNS
        axes = vars(self)["values"].ndim
        index: tuple[Any, ...] = ()
        if axes == (4 if turns else 3):
            index = (operator.index(configuration),)
        elif configuration != 0:
            what = f"a level without things has no configuration {configuration}"
            raise IndexError(f"{what}; `.values[y, x]` has the value of a cell")
        if heading is not None:
            if not turns or heading not in SIDES:
                known = ", ".join(SIDES) if turns else "for actions='turns'"
                raise ValueError(f"heading must be {known}, not {heading!r}")
            index = (*index, SIDES.index(heading))
        names = {each.name for each in fields(self)} & {*OVER_STATES}  # type: ignore[arg-type]
        parts = {name: getattr(self, name)[index] for name in names}
        if vars(self).get("policies") is not None:
            parts["policies"] = vars(self)["policies"][:, *index]
        return replace(self, **parts)  # type: ignore[type-var]


@dataclass(frozen=True, eq=False)
class Evaluation(StateResult, public=True):
    """The values of a policy. All arrays are read-only.

    Actions are numbered as in an environment made with the same `actions`: 0 stay, 1 north,
    2 east, 3 south, 4 west with `"all"`, and 0 north, 1 east, 2 south, 3 west with `"moves"`.
    Adding `first_action` makes either a `brl.Action`. With `"turns"` they are `brl.Turn`s: 0 left,
    1 right, 2 forward.

    Arrays over states have the shape of the tables, which is `[height, width]` in what follows. A
    level with things has an axis of configurations before that, and `at` gives the part of one;
    with `"turns"`, an axis of the 4 headings (N, E, S, W) comes before height.

    Attributes:
        values: the expected return from each cell, float64 `[height, width]`: 0 at terminal
            cells, nan at blocked cells and, in a configuration, where no episode can come.
            Without a discount it may be inf or -inf.
        action_values: the same if an action is taken first, float64 `[height, width, actions]`.
        expected_return: the expected return from the level's starts.
        expected_steps: the expected number of steps from the starts to the end of the episode;
            inf if the episode may go on for ever, or for more than 10^10 steps. A level's
            `max_steps` is ignored.
        exit_probability: the probability of reaching an exit from the starts; nan where episodes
            are too long to compute it (more than 10^10 steps on average).
        discount: the factor by which each further reward counts less.
        actions: `"all"`, `"moves"` or `"turns"`.
        diverging_cells: where the expected return is infinite, the cells `(x, y)` of a loop in
            which an episode may go on for ever, so that the sum of its rewards diverges.
        diverging_condition: what is held and on in that loop, as words: `while key is held`;
            empty where nothing can be, or where it changes.
        within: the number of steps after which episodes are truncated; None for no limit. With a
            limit, values are those with all of these steps left, `expected_steps` counts up to
            the limit, and `exit_probability` is that of reaching an exit in time.
        level: the level; None in what earlier versions pickled.
    """

    values: Floats
    action_values: Floats
    expected_return: float
    expected_steps: float
    exit_probability: float
    discount: float
    actions: str
    diverging_cells: tuple[tuple[int, int], ...] = field(default_factory=tuple, kw_only=True)
    diverging_condition: str = field(default_factory=str, kw_only=True)
    within: int | None = field(default=None, kw_only=True)
    level: GridWorld | None = field(default=None, kw_only=True)

    @property
    def first_action(self) -> int:
        """The `brl.Action` that is number 0 here: 0 with `"all"`, 1 with `"moves"`.

        With `"turns"`, it is the `brl.Turn` 0.
        """
        return int(ACTION_SETS[self.actions])

    @property
    def unbounded(self) -> Flags:
        """Where the return is inf, bool `[height, width]`: a loop of positive reward is ahead."""
        return np.isposinf(self.values)

    @property
    def endless(self) -> Flags:
        """Where the return is -inf, bool `[height, width]`: an episode may cost for ever."""
        return np.isneginf(self.values)

    @property
    def explanation(self) -> str | None:
        """Why the expected return is infinite, as a sentence; None if it is finite."""
        if math.isfinite(self.expected_return):
            return None
        cells = [f"[{x}, {y}]" for x, y in self.diverging_cells[:MAX_LISTED]]
        cells += ["…"] if len(self.diverging_cells) > MAX_LISTED else []
        condition = self.diverging_condition and f" {self.diverging_condition}"
        sums = "costs add up without bound"
        if self.expected_return > 0:
            sums = "rewards add up without bound (rule BR504, unbounded-return)"
        return (
            f"the expected return is {self.expected_return}, because an episode may go on for ever "
            f"around {', '.join(cells)}{condition}, where {sums}; "
            "a discount below 1, such as 0.99, or a limit of steps, such as within=200, makes it "
            "finite"
        )

    _html = later("babyrobot_levels.analysis.notebooks:evaluation_html")

    def __repr__(self) -> str:
        limit = "" if self.within is None else f" within={self.within}"
        return (
            f"<{type(self).__name__} expected_return={self.expected_return:.6g} "
            f"expected_steps={self.expected_steps:.6g} "
            f"exit_probability={self.exit_probability:.6g} discount={self.discount:g}{limit}>"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Solution(Evaluation, public=True):
    """The optimal values of a level: an `Evaluation` of an optimal policy, and more.

    Attributes:
        greedy: all actions whose values are optimal but for a part in 10^9, bool
            `[height, width, actions]`; none at blocked and terminal cells.
        fastest: those of them that policies take which end the episode surely and as soon as can be
            expected, as `policy` does; where none surely does, without a discount only the action
            of `policy`. Pictures show these. Bool `[height, width, actions]`.
        policy: one optimal action for each cell, int64 `[height, width]`; -1 at blocked and
            terminal cells. The array carries its set of actions (`policy.actions`), which
            `evaluate` and everything else that takes a policy respects. Among optimal actions it
            takes those that surely end the episode, of these the fastest, and of these those most
            likely to reach an exit. Following any of the greedy actions may earn less: where there
            is no discount and a step costs nothing, they may lead round in circles.
        method: how it was found.
        iterations: how many policies were evaluated on the way, or rounds of sweeps were made.
        residual: the largest violation of Bellman's equation among finite values.
        margin: by how much values may be wrong at most, float64 `[height, width]`, all rounding
            included; 0 where they are infinite. It is inf where, without a discount, steps that
            cost nothing leave room for other values: ask for fractions there, by `exact`.
        policies: within a limit of steps, an optimal action for each step and cell, int8
            `[within, height, width]`, where number 0 is the first step; `policy` is that of the
            first step. None without a limit, where the optimum does not depend on the time.
    """

    greedy: Flags
    fastest: Flags
    policy: Ints
    method: str
    iterations: int
    residual: float
    margin: Floats
    policies: Ints | None = field(default=None, kw_only=True)

    @classmethod
    def with_episodes(cls, find: Callable[[], Mapping[str, Any]], **known: Any) -> Self:
        """Return a solution of what is known, and what is found when it is first asked for.

        Args:
            find: returns the fields `OF_EPISODES`.
            known: the other fields.
        """
        solution = object.__new__(cls)
        vars(solution).update(known, _find=find)
        solution.__post_init__()
        return solution

    def _added(self, name: str) -> Any:
        if name not in OF_EPISODES:
            return None
        self._find_episodes()
        return vars(self)[name]

    def _find_episodes(self) -> None:
        # Two threads may both do this: they find the same.
        find = vars(self).get("_find")
        if find is not None:
            vars(self).update(find())
            self.__post_init__()
            vars(self).pop("_find", None)

    def __getstate__(self) -> dict[str, Any]:
        self._find_episodes()
        return {**vars(self)}

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *OF_EPISODES]

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper bounds of the optimal values, `[height, width]` each."""
        return self.values - self.margin, self.values + self.margin


@dataclass(frozen=True, eq=False, repr=False)
class ExactSolution(StateResult, public=True):
    """The optimal values of a level as fractions, proven: no action of any state is better.

    The numbers of the level are the decimals that its file says. Arrays are shaped as those of a
    `Solution`, hold `fractions.Fraction`s, and are read-only.

    Attributes:
        values: the expected return from each cell: 0 at terminal cells. Floats stand for what is
            no fraction: nan as in a `Solution`, inf and -inf.
        action_values: the same if an action is taken first, `[height, width, actions]`.
        expected_return: the expected return from the level's starts; inf or -inf as there.
        expected_steps: the expected steps of `policy` until the end; inf if there may be none.
        exit_probability: how likely `policy` reaches an exit.
        discount: the discount.
        actions: `"all"`, `"moves"` or `"turns"`.
        greedy: all optimal actions, bool `[height, width, actions]`.
        policy: one optimal action for each cell, int64 `[height, width]`: that of the solution in
            floating point, unless another one is better.
        error: by how much the values in floating point differ, at most.
        iterations: how many policies were evaluated over the rationals.
        level: the level.
    """

    values: NDArray[np.object_]
    action_values: NDArray[np.object_]
    expected_return: Fraction | float
    expected_steps: Fraction | float
    exit_probability: Fraction | float
    discount: Fraction
    actions: str
    greedy: Flags
    policy: Ints
    error: float
    iterations: int
    level: GridWorld | None

    _html = later("babyrobot_levels.analysis.notebooks:exact_html")

    def __repr__(self) -> str:
        return (
            f"<ExactSolution expected_return={self.expected_return} "
            f"expected_steps={self.expected_steps} exit_probability={self.exit_probability} "
            f"discount={self.discount}>"
        )


@dataclass(frozen=True, eq=False)
class Simulation(Result, public=True):
    """Simulated episodes of a policy. All arrays are read-only.

    Attributes:
        returns: the (discounted) sum of the rewards of each episode, float64 `[episodes]`.
        steps: the number of steps of each episode, int64 `[episodes]`.
        at_exit: which episodes ended on an exit, bool `[episodes]`.
        cut: which episodes were truncated by the limit, bool `[episodes]`.
        max_steps: the limit.
        discount: the factor by which each further reward counted less.
    """

    returns: Floats
    steps: Ints
    at_exit: Flags
    cut: Flags
    max_steps: int
    discount: float

    @property
    def mean(self) -> float:
        """The mean of the returns."""
        return float(self.returns.mean())

    @property
    def standard_error(self) -> float:
        """The standard error of `mean`; nan for a single episode."""
        if self.returns.size < 2:
            return float("nan")
        return float(self.returns.std(ddof=1) / np.sqrt(self.returns.size))

    @property
    def exit_rate(self) -> float:
        """The share of the episodes that ended on an exit."""
        return float(self.at_exit.mean())

    @property
    def truncated(self) -> int:
        """The number of episodes that were truncated by the limit."""
        return int(self.cut.sum())

    def __repr__(self) -> str:
        return (
            f"<Simulation of {self.returns.size} episodes: mean={self.mean:.6g} "
            f"standard_error={self.standard_error:.3g} exit_rate={self.exit_rate:.6g} "
            f"truncated={self.truncated}>"
        )


def probability(value: float) -> float:
    """Return a probability without the rounding errors that put it beyond 0 or 1; nan for nan."""
    return min(max(value, 0.0), 1.0)


# -- arguments -----------------------------------------------------------------------------


def check_actions(actions: str) -> int:
    """Return the action that is number 0 of a set of actions.

    Raises:
        ValueError: there is no such set.
    """
    if actions not in ACTION_SETS:
        raise ValueError(f"actions must be 'all', 'moves' or 'turns', not {actions!r}")
    return int(ACTION_SETS[actions])


def action_names(actions: str, mdp: Mdp) -> list[str]:
    """Return the names of the actions of the tables, of which a set leaves out the first ones.

    Those of several robots are joint actions: `north_stay` is north of the first, stay of the
    second.
    """
    if actions == TURNS:
        return [str(turn) for turn in Turn]
    if mdp.num_robots == 1:
        return [str(action) for action in list(Action)[: mdp.num_actions]]
    names = map(str, (Action.STAY, *MOVES))
    return ["_".join(each) for each in product(names, repeat=mdp.num_robots)]


def check_discount(discount: float | None, default: float) -> float:
    """Return the discount that counts.

    Raises:
        ValueError: it is not above 0 and at most 1.
    """
    if discount is None:
        return float(default)
    return check_share("discount", discount, is_above_0=True)


def check_share(name: str, value: Any, *, is_above_0: bool = False) -> float:
    """Return an argument that is a share.

    Raises:
        ValueError: it is not from 0 to 1, or not above 0 where it has to be.
    """
    # Numbers of all kinds can be compared, other values raise TypeError.
    with suppress(TypeError):
        if 0 <= value <= 1 and not (is_above_0 and value == 0):
            return float(value)
    allowed = "above 0 and at most 1" if is_above_0 else "from 0 to 1"
    raise ValueError(f"{name} must be {allowed}, not {value!r}")


def check_within(within: int | str | None, max_steps: int | None) -> int | None:
    """Return the number of steps after which episodes are truncated, None for no limit.

    Args:
        within: the number, or `"max_steps"` for that of the level; None for no limit.
        max_steps: that of the level.

    Raises:
        ValueError: it is none of these, or the level has no `max_steps`.
    """
    if within is None:
        return None
    if within == "max_steps":
        if max_steps is None:
            raise ValueError("the level has no max_steps; give a number of steps, such as 200")
        return max_steps
    with suppress(TypeError):
        if not isinstance(within, bool | str) and operator.index(within) >= 1:
            return operator.index(within)
    raise ValueError(f"within must be a number of steps from 1 on, or 'max_steps', not {within!r}")


def check_count(name: str, value: Any, least: int = 1, most: int | None = None) -> int:
    """Return an argument that is a number of things.

    Raises:
        ValueError: it is not a whole number, below the least or above the most.
    """
    with suppress(TypeError):
        number = operator.index(value)
        if not isinstance(value, bool) and least <= number <= (number if most is None else most):
            return number
    allowed = f", at least {least}" if most is None else f" from {least} to {most:,}"
    raise ValueError(f"{name} must be a whole number{allowed}, not {value!r}")


def check_seed(seed: int | None) -> int | None:
    """Return a seed as an int, None for None.

    Raises:
        ValueError: it is no whole number from 0 on.
    """
    return None if seed is None else check_count("seed", seed, 0)
