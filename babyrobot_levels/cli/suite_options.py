"""The options of `babyrobot generate` that state conditions, as the fields of a suite."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from babyrobot_levels.cli.console import fail

if TYPE_CHECKING:
    from babyrobot_levels.language.suite import SuiteFields

_NUMBER = r"[0-9]{1,9}(?:\.[0-9]{1,9})?"
_SIZE = re.compile(r"([0-9]{1,5})[xX×,]([0-9]{1,5})")
_RANGE = re.compile(rf"({_NUMBER})?\.\.({_NUMBER})?")

_RANGES = (
    "puddles",
    "wind",
    "keys",
    "doors",
    "coins",
    "guards",
    "detour",
    "path_length",
    "dead_ends",
    "difficulty",
)
"""The options that take a number or a range."""


@dataclass(frozen=True, slots=True)
class Options:
    """The options that state conditions, as they were typed; None for those not given."""

    count: int | None = None
    size: str | None = None
    algorithm: tuple[str, ...] = ()
    loops: str | None = None
    puddles: str | None = None
    wind: str | None = None
    keys: str | None = None
    doors: str | None = None
    coins: str | None = None
    guards: str | None = None
    detour: str | None = None
    path_length: str | None = None
    dead_ends: str | None = None
    difficulty: str | None = None
    start: str | None = None
    exit: str | None = None
    theme: str | None = None
    seed: int | None = None
    split: str | None = None

    def given(self) -> dict[str, Any]:
        """Return the values that were given, by option."""
        pairs = ((name, getattr(self, name)) for name in self.__slots__)
        return {option(name): value for name, value in pairs if value not in (None, ())}

    def command_line(self) -> str:
        """Return the call that generates the same levels, as a line for a shell."""
        given = {"--size": "8x5", **self.given(), "--seed": self.seed or 0}
        del given["--count"]
        if "--split" in given:
            # The splits depend on the number of levels.
            given = {"--count": self.count, **given}
        words = []
        for name, value in given.items():
            for each in value if isinstance(value, tuple) else (value,):
                words += [name, shlex.quote(str(each))]
        return " ".join(["babyrobot", "generate", *words])


def option(field: str) -> str:
    """Return the option for a field of a suite."""
    return "--" + {"splits": "split", "maze": "loops"}.get(field, field).replace("_", "-")


def suite_of(options: Options) -> SuiteFields:
    """Return the suite that options describe; end the command if they are wrong."""
    from babyrobot_levels.language.suite import SuiteFields
    from babyrobot_levels.language.validation import route_of, validate

    data: dict[str, Any] = {"version": 1, "kind": "suite", "count": options.count}
    maze: dict[str, Any] = {}
    if options.algorithm:
        maze["algorithm"] = list(options.algorithm)
    if options.loops is not None:
        maze["loops"] = _range("loops", options.loops)
    if maze:
        data["maze"] = maze
    if options.size is not None:
        data["size"] = _sizes(options.size)
    if options.split is not None:
        data["splits"] = _splits(options.split)
    for name in _RANGES:
        text = getattr(options, name)
        if text is not None:
            data[name] = _range(name, text)
    for name in ("start", "exit", "theme", "seed"):
        if getattr(options, name) is not None:
            data[name] = getattr(options, name)
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
        fail(f"--size: invalid size {text!r}", "expected 8x5, or a range such as 6x6..12x12")
    return [int(match[1]), int(match[2])]


def _range(name: str, text: str) -> Any:
    """Return a number, or a mapping with `min` and `max`."""
    match = _RANGE.fullmatch(text)
    if match and (match[1] or match[2]):
        ends = {"min": match[1], "max": match[2]}
        return {end: _plain(value) for end, value in ends.items() if value}
    if not re.fullmatch(_NUMBER, text):
        fail(f"{option(name)}: invalid range {text!r}", "expected 20..30, 20, 20.. or ..30")
    return _plain(text)


def _plain(text: str) -> int | float:
    return float(text) if "." in text else int(text)


def _splits(text: str) -> dict[str, float]:
    shares: dict[str, float] = {}
    for part in text.split(","):
        name, _, share = part.strip().partition("=")
        if not re.fullmatch(_NUMBER, share) or not name or name in shares:
            fail(
                f"--split: invalid shares {text!r}",
                "expected NAME=SHARE,..., for example train=0.8,test=0.2",
            )
        shares[name] = float(share)
    return shares
