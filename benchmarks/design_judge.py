"""The design briefs, and how the linter judges the answers to them; `design.py` asks authors.

The process of `Judge` is this module: it reads briefs and answers, and writes what was found.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from threading import Timer
from typing import IO, Any

import yaml

import babyrobot_levels as brl
from babyrobot_levels.analysis.expectations import is_met
from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.expectations import Expect
from babyrobot_levels.language.metric_names import NEEDS, THINGS

FOLDER = Path(__file__).with_name("design")
SECONDS = 120.0
"""How long an answer may take, and how long to judge it."""
MAX_CHARACTERS = 1 << 20
MAX_FINDINGS = 50

Finding = dict[str, Any]

KINDS: Mapping[str, Callable[[brl.Level], Collection[Any]]] = {
    "starts": lambda level: level.starts,
    "exits": lambda level: level.exits,
    "puddles": lambda level: level.puddles,
    "large_puddles": lambda level: [each for each in level.puddles if each.size == "large"],
    "holes": lambda level: [area for area in level.areas if area.ends],
    "areas": lambda level: [area for area in level.areas if not area.ends],
    "blocked": lambda level: level.blocked,
    "glass": lambda level: [wall for wall in level.walls if wall.pass_],
    "warps": lambda level: level.warps,
    "wind": lambda level: [
        strength
        for side in SIDE_NAMES
        for strength in getattr(level.wind, side, None) or ()
        if strength
    ],
    "items": lambda level: level.items,
    "coins": lambda level: [item for item in level.items if item.reward is not None],
    "doors": lambda level: level.doors,
    "switches": lambda level: level.switches,
    "guards": lambda level: [mover for mover in level.movers if mover.path],
    "wanderers": lambda level: [mover for mover in level.movers if mover.within],
    "drawn": lambda level: [item for item in level.items if item.one_of] + [
        cells for cells in (level.exit_one_of,) if cells
    ],
    "exit_needs": lambda level: level.exit_keys,
}  # fmt: skip
"""What is counted of a level beside its metrics; see the README of the briefs."""

USUAL = {"starts": 1, "exits": 1}
"""How many there are where a brief counts none; of all others, none."""

PLAIN = {
    "holes": {"reward": None},
    "areas": {"reward": None, "skid": None},
    "warps": {"reward": None},
}
"""What each of a kind has where a brief does not speak of it."""

FIXED = ("rewards", "hit", "puddle_types", "skid", "discount")
"""Fields that have their defaults where a brief does not speak of them."""


@dataclass(frozen=True)
class Brief:
    """A brief, and the facts by which answers are judged.

    Attributes:
        name: the folder, which is its family, and the file.
        text: what is wanted, in plain English.
        fields: fields of the level file with the values that they must have, or `any`.
        counts: how many there must be of what `KINDS` names.
        each: fields that each of a kind must have.
        expect: metrics, as `expect` of a level file states them.
    """

    name: str
    text: str
    fields: Mapping[str, Any] = field(default_factory=dict)
    counts: Mapping[str, Any] = field(default_factory=dict)
    each: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    expect: Mapping[str, Any] = field(default_factory=dict)

    @property
    def family(self) -> str:
        """The kind of brief."""
        return self.name.split("/")[0]

    @cached_property
    def wanted(self) -> brl.Level:
        """A level with the values of the fields."""
        fields = {name: value for name, value in self.fields.items() if value != "any"}
        return brl.Level(version=1, **fields)

    def judge(self, text: str) -> list[Finding]:
        """Return what is wrong with an answer: nothing if it meets the brief.

        Facts, comments and settings that the answer states itself have no effect.
        """
        try:
            answer = brl.loads(level_text(text), name="answer")
            # A level that is from no text has no comments that suppress findings.
            level = brl.Level(**{**answer.to_dict(), "expect": None})
            found, others = [*self.unmet(level)], brl.lint(level)
        except brl.LevelError as error:
            told = [each.to_dict() for each in error.diagnostics[:MAX_FINDINGS]]
            return told or [{"message": str(error)}]
        except (MemoryError, RecursionError, ArithmeticError) as error:
            return [{"message": f"the level cannot be judged: {error or type(error).__name__}"}]
        kept = ("code", "severity", "message", "help")
        serious = (each.to_dict() for each in others if each.severity is not brl.Severity.INFO)
        found += [{name: each[name] for name in kept} for each in serious]
        return found[:MAX_FINDINGS]

    def unmet(self, level: brl.Level) -> Iterator[Finding]:
        """Yield the facts that are not true of a level, those first that are quickly found.

        Raises:
            LevelError: its tables cannot be made.
        """
        yield from self._unlike(level)
        stated = dict(self.expect)
        names = [item.name for item in level.items] + [each.name for each in level.switches]
        if not {*stated.get("needs", ())} <= {*names}:
            told = f"`needs` is to be {stated['needs']}, but items and switches are {names}"
            yield _fact("needs", stated.pop("needs"), None, told)
        for name in stated.keys() & {*(() if level.has_things else (*THINGS, *NEEDS))}:
            yield _fact(name, stated.pop(name), None)
        for each in brl.broken_expectations(level.replace(expect=stated or None)):
            yield _fact(each.name, each.expected, each.value, each.message)

    def _unlike(self, level: brl.Level) -> Iterator[Finding]:
        """Yield the fields and counts that are not as they must be."""
        for name in {**self.fields, **dict.fromkeys(FIXED)}:
            expected, value = (_plain(_field(each, name)) for each in (self.wanted, level))
            if self.fields.get(name) != "any" and value != expected:
                yield _fact(name, expected, value)
        for kind, entries in KINDS.items():
            found = entries(level)
            expected, number = self.counts.get(kind, USUAL.get(kind, 0)), _number(kind, found)
            # A count is stated as a metric is.
            stated = Expect.model_validate({"states": expected}).stated["states"]
            if not (is_met(kind, stated, number) or (kind == "wind" and kind in self.fields)):
                yield _fact(kind, expected, number)
            for name, wanted in {**PLAIN.get(kind, {}), **self.each.get(kind, {})}.items():
                for value in {json.dumps(_plain(getattr(entry, name))) for entry in found}:
                    if json.loads(value) != wanted:
                        yield _fact(f"{kind}.{name}", wanted, json.loads(value))


def _field(level: brl.Level, name: str) -> Any:
    """Return the value of a field; the cells of starts and exits in order."""
    cells = {"start": level.starts, "exit": level.exits}
    return sorted(cells[name]) if name in cells else getattr(level, name)


def _fact(name: str, expected: Any, value: Any, message: str = "") -> Finding:
    expected, value = _plain(expected), _plain(value)
    message = message or f"`{name}` is {json.dumps(value)}, not {json.dumps(expected)}"
    return {"fact": name, "expected": expected, "value": value, "message": message}


def _plain(value: Any) -> Any:
    """Return a value as JSON has it, in one form."""
    if hasattr(value, "model_dump"):
        value = value.model_dump(mode="json")
    if isinstance(value, Mapping):
        # The default rule of skids need not be written.
        is_skid = value.get("to") == "open"
        return value["probability"] if is_skid else {k: _plain(v) for k, v in value.items()}
    return [*map(_plain, value)] if isinstance(value, tuple | list) else value


def _number(kind: str, entries: Collection[Any]) -> int:
    """Return how many there are: of cells and of walls, each for itself."""
    if kind in ("holes", "areas", "blocked"):
        return len(_cells(entries))
    return sum(wall.length for wall in entries) if kind == "glass" else len(entries)


def _cells(rectangles: Iterable[Any]) -> set[tuple[int, int]]:
    return {
        (each.at[0] + column, each.at[1] + row)
        for each in rectangles
        for column in range(each.size[0])
        for row in range(each.size[1])
    }


def level_text(answer: str) -> str:
    """Return the level in an answer: the last block in a fence of Markdown, or all of it."""
    fenced: list[str] = re.findall(r"^```\w*\n(.*?)^```", answer, re.DOTALL | re.MULTILINE)
    return fenced[-1] if fenced else answer


def load(words: Sequence[str] = (), folder: Path = FOLDER) -> list[Brief]:
    """Return the briefs, or those whose names begin with one of some words."""
    briefs = []
    for path in sorted(folder.glob("*/*.yaml")):
        data = yaml.safe_load(path.read_text("utf-8"))
        name = f"{path.parent.name}/{path.stem}"
        if not words or name.startswith(tuple(words)):
            briefs.append(Brief(name, data.pop("brief").strip(), **data))
    return briefs


# -- judging and asking, within limits -------------------------------------------------------


class Judge:
    """Judges answers in a process of its own, which is ended if it takes too long."""

    def __init__(self, seconds: float = SECONDS) -> None:
        self.seconds = seconds
        self._process: subprocess.Popen[str] | None = None

    def __enter__(self) -> Judge:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def __call__(self, brief: Brief, answer: str) -> list[Finding]:
        """Return what is wrong with an answer."""
        if len(answer) > MAX_CHARACTERS:
            return [{"message": f"the answer has more than {MAX_CHARACTERS:,} characters"}]
        try:
            process = self._process = self._process or self._start()
            assert process.stdin is not None
            assert process.stdout is not None
            process.stdin.write(json.dumps([asdict(brief), answer]) + "\n")
            process.stdin.flush()
            with Limit(process, self.seconds):
                line = process.stdout.readline()
        except OSError:
            line = ""
        except BaseException:
            self._end()
            raise
        if not line:
            self._end()
            return [{"message": f"the level could not be judged in {self.seconds:g} seconds"}]
        found: list[Finding] = json.loads(line)
        return found

    def _start(self) -> subprocess.Popen[str]:
        command = [sys.executable, str(Path(__file__).resolve())]
        process = start(command)
        assert process.stdout is not None
        process.stdout.readline()
        return process

    def _end(self) -> None:
        if self._process is not None:
            close(self._process)
            self._process = None


def serve(asked: IO[str], answered: IO[str]) -> None:
    """Judge what comes in lines, one after the other: the process of `Judge`."""
    # Libraries are loaded when they are first needed, which takes seconds.
    Brief("", "", expect={"success": 1}).judge("version: 1")
    print("ready", file=answered, flush=True)
    for line in asked:
        data, answer = json.loads(line)
        print(json.dumps(Brief(**data).judge(answer)), file=answered, flush=True)


def start(command: Sequence[str]) -> subprocess.Popen[str]:
    """Start a process that is written to and read from."""
    # In a session of its own it can be ended with all that it starts, and Ctrl-C ends only this.
    pipe = subprocess.PIPE
    return subprocess.Popen(
        command, stdin=pipe, stdout=pipe, encoding="utf-8", errors="replace", start_new_session=True
    )


def kill(process: subprocess.Popen[str]) -> None:
    """End a process with all that it has started."""
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL) if hasattr(os, "killpg") else process.kill()
    process.wait()


def close(process: subprocess.Popen[str]) -> None:
    """End a process, and close what it was written to and read from."""
    kill(process)
    for stream in (process.stdin, process.stdout):
        with suppress(OSError, AttributeError):
            stream.close()  # type: ignore[union-attr]


class Limit:
    """Ends a process that is not done in time."""

    def __init__(self, process: subprocess.Popen[str], seconds: float) -> None:
        self._timer = Timer(seconds, kill, [process])
        self._timer.daemon = True

    def __enter__(self) -> None:
        self._timer.start()

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()


if __name__ == "__main__":
    serve(sys.stdin, sys.stdout)
