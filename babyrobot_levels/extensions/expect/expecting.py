"""The facts in `expect`, written into the texts of levels as they are today."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal, localcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from babyrobot_levels.analysis.expectations import is_met, shown
from babyrobot_levels.analysis.metrics import Metrics
from babyrobot_levels.language.checks import RANDOM_MAZE
from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.language.metric_names import NEEDS, SHARES, THINGS
from babyrobot_levels.language.ranges import bounds, ends
from babyrobot_levels.language.validation import validate
from babyrobot_levels.mdp.gridworld import GridWorld, check_world
from babyrobot_levels.suites.checking import texts_of
from babyrobot_levels.text.diagnostics import Issue
from babyrobot_levels.text.emitter import Figure, flow, scalar
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source, write_text
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.splice import splice

if TYPE_CHECKING:
    from babyrobot_levels.suites.suite import Levels

USUAL = ("success", "best_return", "best_steps", "path_length", "difficulty", "needs")
"""What is stated of a level that states nothing yet."""

_MOST_DECIMALS = 17


@dataclass(frozen=True, slots=True)
class Stated:
    """What became of the facts in a text.

    Attributes:
        source: the text as it was.
        text: the text with the facts of today.
        changes: what is other than it was, in words.
    """

    source: SourceFile
    text: str
    changes: tuple[str, ...] = ()


def expect(level: Levels, *, add: Sequence[str] = (), write: bool = False) -> str:
    """Return the text of a level with what is true of it today in `expect`, as the command does.

    Facts that are true stay as they are written. A figure that is not gets as many decimals as it
    had, and a range is widened; what has no value goes. A level that states nothing gets
    `success`, `best_return`, `best_steps`, `path_length`, `difficulty` and, with things, `needs`.

    Args:
        level: a name, a path, a text, a share code, a mapping, or a `Level`.
        add: names of further metrics, or `"lint"`.
        write: whether to write the text to the file that it is from.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the text is no valid level, or its maze has no seed yet.
        ValueError: it is not one level, there is no such metric, or no file to write to.
    """
    add = [add] if isinstance(add, str) else add
    found = [*texts_of(level)]
    if len(found) > 1:
        raise ValueError(f"expect takes one level, not {len(found):,}")
    if isinstance(found[0], SourceFile):
        if write:
            raise ValueError("the text is from no file that could be written")
        return stated(found[0], None, add).text
    done = stated(read_source(found[0]), found[0], add)
    if write and done.text != done.source.text:
        write_text(found[0], done.source.mark + done.text)
    return done.text


def check_names(names: Sequence[str]) -> None:
    """Check that facts can have some names.

    Raises:
        ValueError: one of them cannot.
    """
    for issue in validate({"version": 1, "expect": dict.fromkeys(names, "0..")}, LevelSpec)[1]:
        if issue.code == "BR201":
            raise ValueError(issue.message.replace("field", "metric"))


def stated(source: SourceFile, path: Path | None, add: Sequence[str] = ()) -> Stated:
    """Return a level's text with the facts of today. A suite stays as it is; see `expect`."""
    check_names(add)
    document = read(source)
    level = check_world(document, GridWorld, path).valid()
    if not isinstance(level, GridWorld):
        return Stated(source, source.text)
    if level.has_random_maze:
        issue = Issue("BR326", ("maze", "seed"), RANDOM_MAZE, "give the maze a seed")
        raise LevelError([document.diagnostic(issue)])
    measured = Metrics(level)
    before = {} if level.expect is None else level.expect.stated
    decimals = level.stated_decimals(document)
    facts, changes = dict[str, Any](document.data.get("expect") or {}), list[str]()
    for name in before:
        value = None if name == "lint" else getattr(measured, name)
        if name == "lint" or is_met(name, before[name], value, decimals.get(name, 0)):
            continue
        told = shown(before[name], decimals.get(name, 0))
        after = _mended(name, before[name], value, decimals.get(name, 0))
        if after is None:
            del facts[name]
            why = "it is infinite" if value is not None else measured.why_none(name)
            changes.append(f"`{name}` was {told} and is gone: {why}")
        else:
            facts[name] = after
            changes.append(f"`{name}` was {told} and is {flow(after)}")
    for name in (*(() if before else USUAL), *add):
        has_it = level.has_things or name not in (*THINGS, *NEEDS)
        value = "clean" if name == "lint" else getattr(measured, name) if has_it else None
        new = value if name == "lint" else _new(name, value)
        if name not in facts and new is not None:
            facts[name] = new
            changes.append(f"`{name}` is {flow(new)}")
    if not changes:
        return Stated(source, source.text)
    text = splice(source.text, {**document.data, "expect": facts}, [*GridWorld.model_fields])
    if text is None:
        message = "the file is written in an unusual way, in which no facts can be put into it"
        raise LevelError([document.diagnostic(Issue("BR326", (), message))])
    check_world(read(replace(source, text=text)), GridWorld, path).valid()
    return Stated(source, text, tuple(changes))


def _new(name: str, value: Any) -> Any:
    """Return how a metric is stated for the first time; None if it has no finite value."""
    if value is None or isinstance(value, int | tuple):
        return [*value] if isinstance(value, tuple) else value
    if not math.isfinite(value):
        return None
    if name in SHARES and is_met(name, float(round(value)), value):
        return round(value)
    # Three digits that say something, and two decimals at least.
    digits = 2 - math.floor(math.log10(abs(value))) if value else 0
    return _figure(name, value, min(max(2, digits), _MOST_DECIMALS))


def _mended(name: str, stated: Any, value: Any, decimals: int) -> Any:
    """Return what is true in the form of what is not; None if there is no finite value."""
    if value is None or isinstance(value, tuple):
        return None if value is None else [*value]
    if not math.isfinite(value):
        return None
    if isinstance(stated, float):
        return _figure(name, value, decimals)
    least, most = bounds(stated)
    if isinstance(stated, str):
        low, _, high = stated.partition("..")
    else:
        low, high = ("" if end is None else scalar(end) for end in (least, most))
    if least is not None and value < least:
        low = _outward(value, low, ROUND_FLOOR)
    elif most is not None:
        high = _outward(value, high, ROUND_CEILING)
    text = f"{low}..{high}"
    named = {name: Figure(end) for name, end in (("min", low), ("max", high)) if end}
    return text if isinstance(stated, str) and ends(text) else named


def _figure(name: str, value: float, decimals: int) -> Figure:
    """Return a figure that is true, with so many decimals, or more where these are too few."""
    for number in range(decimals, _MOST_DECIMALS):
        text = f"{value:.{number}f}"
        if is_met(name, float(text), value, number):
            return Figure(text)
    return Figure(repr(float(value)))


def _outward(value: float, end: str, rounding: str) -> str:
    """Return the end of a range that holds a value, with as many decimals as the end has."""
    with localcontext(prec=400):
        return f"{Decimal(repr(float(value))).quantize(Decimal(end), rounding):f}"
