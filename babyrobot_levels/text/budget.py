"""How much may be done for a level: counted in steps of work, and so the same on every machine.

Whatever may take long notes its steps before it takes them. Without a budget, as in Python, there
may be any number of them; a command, a tool and the editor have one for each level that is read.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NoReturn

from babyrobot_levels.text.errors import HelpfulError


@dataclass(frozen=True, slots=True)
class Limits:
    """What may be done for a level.

    Attributes:
        steps: the most steps of work: a usual machine takes 200,000,000 of them in a second.
        entries: the most states times outcomes of an action of its tables, which need the memory.
        seconds: how long a usual machine takes for that at most, start included.
        megabytes: how much memory it takes at most, libraries included.
        help: what to do about it.
    """

    steps: float
    entries: float
    seconds: float = math.inf
    megabytes: float = math.inf
    help: str = "use a smaller level"


CHECKED = Limits(300_000_000, 5_000_000, 2, 300)
"""To find out whether a level is valid, where its fields leave open whether it can be compiled."""

READ = Limits(300_000_000, 1 << 20, 5, 600)
"""For `lint` and `show`, and to take a change in the editor."""

COMMAND = Limits(2_000_000_000, 1_500_000, 30, 1_500)
"""For whatever else a command, a tool or the editor does with a level."""

UNLIMITED = Limits(math.inf, math.inf)
"""Where more is asked for."""


class OverBudgetError(HelpfulError):
    """More work than may be done for a level. `help` says what to do."""


_ACTIONS = 5
"""How many actions one robot has."""


class Meter:
    """How many steps of work have been taken, within whatever limits."""

    def __init__(self) -> None:
        self.steps = 0.0


_meter: ContextVar[Meter | None] = ContextVar("meter", default=None)


class _Budget:
    """What is left for the level at hand, and its largest tables."""

    def __init__(self, limits: Limits, *, is_one: bool = False) -> None:
        self.limits, self.meter, self.is_one = limits, _meter.get(), is_one
        self.begin()

    def begin(self) -> None:
        self.left = self.limits.steps
        self.states, self.outcomes, self.actions = 0, 0, _ACTIONS

    @property
    def entries(self) -> int:
        """How many states times outcomes the tables have, as if an action were one of five."""
        return self.states * self.actions // _ACTIONS * self.outcomes

    @property
    def size(self) -> str:
        joint = f", {self.actions} joint actions" if self.actions > _ACTIONS else ""
        return f"{self.states:,} states{joint}, and {self.outcomes} or more outcomes of an action"


_before_work: Callable[[], object] = int
"""What is called before work is done; it does nothing unless `call_before_work` says otherwise."""


def call_before_work(function: Callable[[], object]) -> None:
    """Have a function called before work is done; it may raise what ends it."""
    global _before_work
    _before_work = function


_budget: ContextVar[_Budget | None] = ContextVar("budget", default=None)


@contextmanager
def within(limits: Limits) -> Iterator[None]:
    """Work within limits, which count anew from each level on that is read.

    Limits within `UNLIMITED` do not count.
    """
    if (outer := _budget.get()) is not None and outer.limits == UNLIMITED:
        limits = UNLIMITED
    token = _budget.set(_Budget(limits))
    try:
        yield
    finally:
        _budget.reset(token)


@contextmanager
def metered() -> Iterator[Meter]:
    """Count the steps of many parts of work, each of which has limits of its own."""
    token = _meter.set(meter := Meter())
    try:
        yield meter
    finally:
        _meter.reset(token)


@contextmanager
def together() -> Iterator[None]:
    """Count anew, and then all levels that are read as one."""
    if (outer := _budget.get()) is None:
        yield
        return
    token = _budget.set(_Budget(outer.limits, is_one=True))
    try:
        yield
    finally:
        _budget.reset(token)


def limited(function: Callable[..., Any], *, entries: float = math.inf) -> Callable[..., Any]:
    """Return a function that works within the limits at hand, also in another process.

    Args:
        function: what it calls.
        entries: how large tables may be at most, where there are limits.
    """
    if (budget := _budget.get()) is None:
        return function
    limits = budget.limits
    if limits != UNLIMITED:
        limits = replace(limits, entries=min(entries, limits.entries))
    return partial(_called_within, limits, function)


def _called_within(limits: Limits, function: Callable[..., Any], *arguments: Any) -> Any:
    with within(limits):
        return function(*arguments)


def fits(limits: Limits, work: Callable[[], object]) -> bool:
    """Do some work within limits of its own, whose steps those at hand count as well.

    Unlike with `within`, its limits count also where there are none around.

    Returns:
        Whether it could be done within its own limits.

    Raises:
        OverBudgetError: those at hand are used up.
    """
    inner = _Budget(replace(limits, steps=min(limits.steps, left())))
    token = _budget.set(inner)
    try:
        work()
        is_done = True
    except OverBudgetError:
        is_done = False
    finally:
        _budget.reset(token)
    if (budget := _budget.get()) is not None:
        budget.left -= int(inner.limits.steps - inner.left)
        spend(0)
    return is_done


def begin() -> None:
    """Count anew, for another level."""
    if (budget := _budget.get()) is not None and not budget.is_one:
        budget.begin()


def spend(steps: float) -> None:
    """Note steps of work that are about to be taken.

    Raises:
        OverBudgetError: they are more than are left.
    """
    _before_work()
    if (budget := _budget.get()) is not None:
        budget.left -= int(steps)
        if budget.meter is not None:
            budget.meter.steps += steps
        if budget.left < 0:
            size = budget.states and f": it has {budget.size}"
            refuse(f"takes more than {budget.limits.steps:,} steps of work{size or ''}")


def left() -> float:
    """Return how many steps of work are left."""
    budget = _budget.get()
    return math.inf if budget is None else budget.left


def entries() -> float:
    """Return how many states times outcomes tables may have."""
    budget = _budget.get()
    return math.inf if budget is None else budget.limits.entries


def check_tables(states: int, outcomes: int, actions: int = _ACTIONS) -> None:
    """Note how large tables are.

    Raises:
        OverBudgetError: they are larger than the limits allow.
    """
    if (budget := _budget.get()) is not None:
        entries = states * actions // _ACTIONS * outcomes
        if entries > budget.entries:
            budget.states, budget.outcomes, budget.actions = states, outcomes, actions
        if entries > (most := budget.limits.entries):
            refuse(f"has {budget.size}; together at most {most:,} are allowed here")


def refuse(why: str) -> NoReturn:
    """Refuse to do more for the level at hand.

    Raises:
        OverBudgetError: always.
    """
    budget = _budget.get()
    assert budget is not None
    raise OverBudgetError(f"the level {why}", budget.limits.help)
