"""Whether what a level states of itself in `expect` is true."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from babyrobot_levels.analysis.metrics import Metrics
from babyrobot_levels.language.metric_names import SHARES
from babyrobot_levels.language.ranges import bounds
from babyrobot_levels.mdp.gridworld import world_of
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.emitter import flow, scalar

TOLERANCE = 1e-9
"""What differs by no more than this share is the same."""


@dataclass(frozen=True, slots=True)
class BrokenExpectation:
    """A fact in `expect` that is not true.

    Attributes:
        name: the metric.
        expected: what it must be: a number, a text such as `18..22`, a mapping, or a list of names.
        value: what it is; None if the level has no such value.
        message: both in words.
    """

    __module__ = "babyrobot_levels"

    name: str
    expected: Any
    value: Any
    message: str

    def __str__(self) -> str:
        return self.message


def broken_expectations(level: Any) -> list[BrokenExpectation]:
    """Return the facts in a level's `expect` that are not true, in the order of the metrics.

    `lint: clean` is not among them: `brl.lint` tells.

    Args:
        level: a name, a path, a mapping or a `Level`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid.
    """
    return [*broken_in(Metrics(world_of(level)))]


def broken_in(measured: Metrics, document: Document | None = None) -> Iterator[BrokenExpectation]:
    """Yield the facts that the metrics of a level break.

    Args:
        measured: the metrics. Those that are not stated are not computed.
        document: the text of the level, if it was read already.
    """
    level = measured.level
    decimals = level.stated_decimals(document)
    for name, stated in () if level.expect is None else level.expect.stated.items():
        if name == "lint":
            continue
        value = getattr(measured, name)
        if not is_met(name, stated, value, decimals.get(name, 0)):
            message = _told(measured, name, stated, decimals.get(name, 0))
            yield BrokenExpectation(name, stated, value, message)


def is_met(name: str, stated: Any, value: Any, decimals: int = 0) -> bool:
    """Return whether a metric is what is stated of it.

    Args:
        name: the metric.
        stated: what is stated, as `Facts.stated` has it.
        value: the metric of the level.
        decimals: with how many decimals a single figure is stated.
    """
    if value is None or not isinstance(value, int | float):
        return value is not None and {*value} == {*stated}
    if not math.isfinite(value):
        return False
    if isinstance(stated, float):
        if abs(value - stated) <= _slack(stated):
            return True
        is_exact = name in SHARES and stated in (0, 1)
        return not is_exact and _rounds_to(value, stated, 0.5 * 10**-decimals)
    least, most = bounds(stated)
    return (least is None or value >= least - _slack(least)) and (
        most is None or value <= most + _slack(most)
    )


def _rounds_to(value: float, stated: float, half: float) -> bool:
    """Return whether a number is rounded to a figure; halves are rounded away from 0."""
    outward = (value - stated) * math.copysign(1.0, stated or value)
    # What is a half but for rounding errors is one.
    return -half <= outward + _slack(stated) and outward + _slack(stated) < half


def _slack(number: float) -> float:
    return TOLERANCE * max(1.0, abs(number))


def shown(stated: Any, decimals: int = 0) -> str:
    """Return what is stated of a metric, as it may stand in a file."""
    if isinstance(stated, float):
        return f"{stated:.{decimals}f}"
    if isinstance(stated, str):
        return stated
    if isinstance(stated, tuple):
        return flow([*stated])
    return "..".join("" if end is None else scalar(end) for end in bounds(stated))


def _told(measured: Metrics, name: str, stated: Any, decimals: int) -> str:
    """Return what a metric is, and what it is not, in words."""
    value, expected = getattr(measured, name), shown(stated, decimals)
    if value is None:
        return f"`{name}` has no value, not {expected}: {measured.why_none(name)}"
    if not isinstance(value, int | float):
        return f"`{name}` is {flow([*value])}, not {expected}"
    # With more digits where fewer would tell no difference.
    texts = (f"{value:.{digits}g}" for digits in (6, 10, 17))
    told = next(text for text in texts if not is_met(name, stated, float(text), decimals))
    words = {"inf": "infinite", "-inf": "minus infinity", "nan": "undefined"}
    return f"`{name}` is {words.get(told, told)}, not {expected}"
