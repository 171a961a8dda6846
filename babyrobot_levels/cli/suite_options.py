"""The options of `babyrobot generate` that state conditions, as the fields of a suite."""

from __future__ import annotations

import inspect
import re
import shlex
from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, get_args

from babyrobot_levels.cli.console import fail, value_option
from babyrobot_levels.language.cells import Algorithm
from babyrobot_levels.language.suite import Place

if TYPE_CHECKING:
    from babyrobot_levels.language.suite import SuiteFields

_NUMBER = r"[0-9]{1,9}(?:\.[0-9]{1,9})?"
_SIZE = re.compile(r"([0-9]{1,5})[xX×,]([0-9]{1,5})")
_RANGE = re.compile(rf"({_NUMBER})?\.\.({_NUMBER})?")

RANGE = "A..B"
"""How help shows a number or a range."""

# An enum, because typer takes no lists of literals.
AlgorithmName = StrEnum(  # type: ignore[misc]
    "AlgorithmName", {name.upper().replace("-", "_"): name for name in get_args(Algorithm)}
)

_CONDITIONS: dict[str, tuple[Any, str | None, str]] = {
    "count": (int, "N", "Number of levels."),
    "size": (str, "SIZE", "Width and height, or a range of them: 8x5, 6x6..12x12.  [default: 8x5]"),
    "algorithm": (
        list[AlgorithmName],
        "A",
        "Maze algorithm; if repeated, one of them is drawn for each level.  [default: depth-first]",
    ),
    "loops": (str, "R", "Share of dead ends to open: 0.5, 0..1."),
    "puddles": (str, RANGE, "Number of puddles: 3, 0..4."),
    "wind": (str, RANGE, "Number of rows and columns with wind: 2, 0..3."),
    "keys": (str, RANGE, "Number of keys, all needed: 1, 1..3."),
    "doors": (str, RANGE, "Number of locked doors.  [default: one for each key]"),
    "coins": (str, RANGE, "Number of coins: 3, 0..4."),
    "guards": (str, RANGE, "Number of guards on patrol: 1, 0..2."),
    "detour": (
        str,
        RANGE,
        "Steps that doors, guards and wind add to the shortest path: 10.., 6..12.",
    ),
    "path_length": (
        str,
        RANGE,
        "Length of the shortest path to the exit, with open doors: 20..30, 20.., 18.",
    ),
    "dead_ends": (str, RANGE, "Number of cells with exactly one open side: 5..8."),
    "difficulty": (str, RANGE, "Difficulty, as in `babyrobot show`: 4..6."),
    "start": (Place, None, "Position of the start.  [default: corner]"),
    "exit": (Place, None, "Position of the exit.  [default: corner]"),
    "theme": (
        str,
        "THEME",
        "Theme: default, black_orange, blue_green, green, high_contrast or print.",
    ),
    "seed": (int, "S", "Random seed: the same seed generates the same files.  [default: 0]"),
    "split": (
        str,
        "NAME=SHARE,…",
        "Split the levels into folders that share no maze: train=0.8,test=0.2.",
    ),
}
"""The options that state conditions: their types, how help shows values, and their texts."""


def with_conditions(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command that takes any keywords the options that state conditions, as its second."""
    signature = inspect.signature(command, eval_str=True)
    first, *others = (
        each for each in signature.parameters.values() if each.kind != each.VAR_KEYWORD
    )
    options = [
        first.replace(
            name=name,
            annotation=Annotated[kind | None, value_option(metavar, text)],
        )
        for name, (kind, metavar, text) in _CONDITIONS.items()
    ]
    parameters = [first, *options, *others]
    command.__annotations__ = {each.name: each.annotation for each in parameters}
    command.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    return command


def given_options(typed: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that were given, by option."""
    return {option(name): value for name, value in typed.items() if value not in (None, [])}


def command_line(typed: Mapping[str, Any]) -> str:
    """Return the call that generates the same levels, as a line for a shell."""
    given = {"--size": "8x5", **given_options(typed), "--seed": typed["seed"] or 0}
    del given["--count"]
    if "--split" in given:
        # The splits depend on the number of levels.
        given = {"--count": typed["count"], **given}
    words = []
    for name, value in given.items():
        for each in value if isinstance(value, list) else (value,):
            words += [name, shlex.quote(str(each))]
    return " ".join(["babyrobot", "generate", *words])


def option(field: str) -> str:
    """Return the option for a field of a suite."""
    return "--" + {"splits": "split", "maze": "loops"}.get(field, field).replace("_", "-")


def suite_of(typed: Mapping[str, Any]) -> SuiteFields:
    """Return the suite that options describe; end the command if they are wrong."""
    from babyrobot_levels.language.suite import SuiteFields
    from babyrobot_levels.language.validation import route_of, validate

    data: dict[str, Any] = {"version": 1, "kind": "suite"}
    for name, value in typed.items():
        if value in (None, []):
            continue
        if name in ("algorithm", "loops"):
            maze = data.setdefault("maze", {})
            maze[name] = [*map(str, value)] if name == "algorithm" else _range(name, value)
        elif name == "size":
            data[name] = _sizes(value)
        elif name == "split":
            data["splits"] = _splits(value)
        else:
            is_range = _CONDITIONS[name][1] == RANGE
            data[name] = _range(name, value) if is_range else value
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
