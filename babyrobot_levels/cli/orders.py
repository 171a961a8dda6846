"""The words of `babyrobot generate`, as an order: sizes, ranges, shares."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from babyrobot_levels.cli.console import fail

if TYPE_CHECKING:
    from babyrobot_levels.language.suite import SuiteFields

_NUMBER = r"[0-9]{1,9}(?:\.[0-9]{1,9})?"
_SIZE = re.compile(r"([0-9]{1,5})[x,]([0-9]{1,5})")
_RANGE = re.compile(rf"({_NUMBER})?\.\.({_NUMBER})?")


@dataclass(frozen=True, slots=True)
class Words:
    """What a call asks for, as it was typed; None for what it does not say."""

    count: int | None = None
    size: str | None = None
    algorithm: tuple[str, ...] = ()
    loops: str | None = None
    puddles: str | None = None
    path_length: str | None = None
    dead_ends: str | None = None
    difficulty: str | None = None
    start: str | None = None
    exit: str | None = None
    theme: str | None = None
    seed: int | None = None
    split: str | None = None

    def given(self) -> dict[str, Any]:
        """Return what is said, by the names of the options."""
        pairs = ((name, getattr(self, name)) for name in self.__slots__)
        return {option(name): value for name, value in pairs if value not in (None, ())}

    def told(self) -> str:
        """Return the call that asks for the same levels, as a line of a shell."""
        said = {"--size": "8x5", **self.given(), "--seed": self.seed or 0}
        del said["--count"]
        if "--split" in said:
            # Of how many levels there are the splits are shares.
            said = {"--count": self.count, **said}
        words = []
        for name, value in said.items():
            for each in value if isinstance(value, tuple) else (value,):
                words += [name, shlex.quote(str(each))]
        return " ".join(["babyrobot", "generate", *words])


def option(field: str) -> str:
    """Return the option that stands for a field of a suite."""
    return "--" + {"splits": "split", "maze": "loops"}.get(field, field).replace("_", "-")


def suite_of(words: Words) -> SuiteFields:
    """Return the suite that a call asks for; if it asks for what cannot be, say so and end."""
    from babyrobot_levels.language.suite import SuiteFields
    from babyrobot_levels.language.validation import route_of, validate

    data: dict[str, Any] = {"version": 1, "kind": "suite", "count": words.count}
    maze: dict[str, Any] = {}
    if words.algorithm:
        maze["algorithm"] = list(words.algorithm)
    if words.loops is not None:
        maze["loops"] = _range("loops", words.loops)
    if maze:
        data["maze"] = maze
    if words.size is not None:
        data["size"] = _sizes(words.size)
    if words.split is not None:
        data["splits"] = _splits(words.split)
    for name in ("puddles", "path_length", "dead_ends", "difficulty"):
        text = getattr(words, name)
        if text is not None:
            data[name] = _range(name, text)
    for name in ("start", "exit", "theme", "seed"):
        if getattr(words, name) is not None:
            data[name] = getattr(words, name)
    suite, problems = validate(data, SuiteFields)
    if suite is None:
        field, message = str(route_of(problems[0])[0]), problems[0].message
        message = re.sub(r"^`[^`]*` (?=must )", "", message)
        fail(f"{option(field)}: {message}", problems[0].help)
    return suite


def _sizes(text: str) -> Any:
    least, dots, most = text.partition("..")
    if not dots:
        return _size(text, text)
    return {"min": _size(least, text), "max": _size(most, text)}


def _size(part: str, text: str) -> list[int]:
    match = _SIZE.fullmatch(part)
    if not match:
        fail(f"--size: {text!r} is no size", "8x5 is one, and 6x6..12x12 a range of them")
    return [int(match[1]), int(match[2])]


def _range(name: str, text: str) -> Any:
    """Return a number, or a mapping with `min` and `max`."""
    match = _RANGE.fullmatch(text)
    if match and (match[1] or match[2]):
        ends = {"min": match[1], "max": match[2]}
        return {end: _plain(value) for end, value in ends.items() if value}
    if not re.fullmatch(_NUMBER, text):
        fail(f"{option(name)}: {text!r} is no range", "20..30 is one; 20, 20.. and ..30 are, too")
    return _plain(text)


def _plain(text: str) -> int | float:
    return float(text) if "." in text else int(text)


def _splits(text: str) -> dict[str, float]:
    shares: dict[str, float] = {}
    for part in text.split(","):
        name, _, share = part.strip().partition("=")
        if not re.fullmatch(_NUMBER, share) or not name or name in shares:
            fail(f"--split: {text!r} names no shares", "train=0.8,test=0.2 does")
        shares[name] = float(share)
    return shares
