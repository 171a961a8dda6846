"""Design briefs: who turns plain English into a level of which all facts are true?

    python benchmarks/design.py --author "llm -m MODEL"   # a command: text in, text out
    python benchmarks/design.py --baseline search         # or `random`, `repair`: no language
    python benchmarks/design.py --list keys               # the briefs of a family

Each file in `benchmarks/design/` is a brief with its facts (see the README there). An author reads
the brief and answers with a level; the linter judges it, and what it finds goes back to the author,
up to `--rounds` times. From Python, with a chat model: `design.main(model)`.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shlex
import shutil
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from threading import Thread, Timer
from typing import IO, Any

import yaml

import babyrobot_levels as brl
from babyrobot_levels.analysis.expectations import is_met
from babyrobot_levels.language.expectations import Expect
from babyrobot_levels.language.metric_names import NEEDS, THINGS

FOLDER = Path(__file__).with_suffix("")
ROUNDS = 4
SECONDS = 120.0
"""How long an answer may take, and how long to judge it."""
MAX_CHARACTERS = 1 << 20
MAX_FINDINGS = 50

Finding = dict[str, Any]
Message = dict[str, str]
Author = Callable[[list[Message]], str]
"""What answers with a level: a function of all messages so far, as chat models are."""

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
        strength for _, line in level.wind or () for strength in line or () if strength
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

REQUEST = """\
Write a level file for babyrobot-levels that meets this brief:

{brief}

Use nothing that the brief does not speak of: walls may stand anywhere, but there are no other
things, cells with effects, wind or skids, and rewards, hits, puddles and the discount keep their
defaults. There is one start and one exit, if not said otherwise. `babyrobot lint` must find
nothing but notes. Answer with the YAML of the file, and nothing else."""

REPAIR = "That is not yet right. What was found, as JSON:\n\n{found}\n\nAnswer with the whole file."


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
            found, others = self.unmet(level), brl.lint(level)
        except brl.LevelError as error:
            told = [each.to_dict() for each in error.diagnostics[:MAX_FINDINGS]]
            return told or [{"message": str(error)}]
        except (MemoryError, RecursionError, ArithmeticError) as error:
            return [{"message": f"the level cannot be judged: {error or type(error).__name__}"}]
        kept = ("code", "severity", "message", "help")
        serious = (each.to_dict() for each in others if each.severity is not brl.Severity.INFO)
        found += [{name: each[name] for name in kept} for each in serious]
        return found[:MAX_FINDINGS]

    def unmet(self, level: brl.Level) -> list[Finding]:
        """Return the facts that are not true of a level.

        Raises:
            LevelError: its tables cannot be made.
        """
        without = () if level.has_things else (*THINGS, *NEEDS)
        stated = {name: each for name, each in self.expect.items() if name not in without}
        broken = brl.broken_expectations(level.replace(expect=stated or None))
        return [
            *self._unlike(level),
            *(_fact(name, self.expect[name], None) for name in self.expect if name in without),
            *(_fact(each.name, each.expected, each.value, each.message) for each in broken),
        ]

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
            with _Limit(process, self.seconds):
                line = process.stdout.readline()
        except BaseException:
            self._end()
            raise
        if not line:
            self._end()
            return [{"message": f"the level could not be judged in {self.seconds:g} seconds"}]
        found: list[Finding] = json.loads(line)
        return found

    def _start(self) -> subprocess.Popen[str]:
        command = [sys.executable, str(Path(__file__).resolve()), "--serve"]
        process = _open(command)
        assert process.stdout is not None
        process.stdout.readline()
        return process

    def _end(self) -> None:
        if self._process is not None:
            _close(self._process)
            self._process = None


def serve(asked: IO[str], answered: IO[str]) -> None:
    """Judge what comes in lines, one after the other: the process of `Judge`."""
    # Libraries are loaded when they are first needed, which takes seconds.
    Brief("", "", expect={"success": 1}).judge("version: 1")
    print("ready", file=answered, flush=True)
    for line in asked:
        data, answer = json.loads(line)
        print(json.dumps(Brief(**data).judge(answer)), file=answered, flush=True)


def _open(command: Sequence[str]) -> subprocess.Popen[str]:
    # In a session of its own it can be ended with all that it starts, and Ctrl-C ends only this.
    pipe = subprocess.PIPE
    return subprocess.Popen(
        command, stdin=pipe, stdout=pipe, encoding="utf-8", errors="replace", start_new_session=True
    )


def _kill(process: subprocess.Popen[str]) -> None:
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL) if hasattr(os, "killpg") else process.kill()
    process.wait()


def _close(process: subprocess.Popen[str]) -> None:
    _kill(process)
    for stream in (process.stdin, process.stdout):
        with suppress(OSError, AttributeError):
            stream.close()  # type: ignore[union-attr]


class _Limit:
    """Ends a process that is not done in time."""

    def __init__(self, process: subprocess.Popen[str], seconds: float) -> None:
        self._timer = Timer(seconds, _kill, [process])
        self._timer.daemon = True

    def __enter__(self) -> None:
        self._timer.start()

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()


class AuthorError(Exception):
    """An author did not answer."""


def command_author(command: str, seconds: float = SECONDS) -> Author:
    """Return the author that a command is: it reads all messages as a text, and writes the level.

    A command that takes longer is ended, and more than `MAX_CHARACTERS` are not read.
    """

    def author(messages: list[Message]) -> str:
        process = _open(shlex.split(command))
        assert process.stdin is not None
        assert process.stdout is not None
        text = "\n\n".join(message["content"] for message in messages)
        begin = time.monotonic()
        sender = Thread(target=_send, args=(process.stdin, text), daemon=True)
        sender.start()
        try:
            with _Limit(process, seconds):
                answer = process.stdout.read(MAX_CHARACTERS + 1)
        finally:
            _kill(process)
            sender.join()
            _close(process)
        if time.monotonic() - begin >= seconds:
            raise AuthorError(f"no answer within {seconds:g} seconds")
        return answer

    return author


def _send(stream: IO[str], text: str) -> None:
    with suppress(OSError, ValueError), stream:
        stream.write(text)


def ask(author: Author, messages: list[Message], seconds: float = SECONDS) -> str:
    """Return the answer of an author; a function that takes too long is left behind.

    Raises:
        AuthorError: there is no answer.
    """
    answers: list[Any] = []

    def call() -> None:
        try:
            answers.append(author(messages))
        except Exception as error:
            answers.append(error)

    thread = Thread(target=call, daemon=True)
    thread.start()
    thread.join(seconds)
    answer = answers[0] if answers else AuthorError(f"no answer within {seconds:g} seconds")
    if isinstance(answer, str):
        return answer
    raise AuthorError(str(answer) or type(answer).__name__)


# -- the benchmark ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Attempt:
    """What became of a brief.

    Attributes:
        name: the brief.
        solved: in which answer it was met, from 1; None if in none.
        seconds: how long the author took, altogether.
        answers: its answers, in turn.
        found: what was found in each.
    """

    name: str
    solved: int | None
    seconds: float
    answers: tuple[str, ...]
    found: tuple[list[Finding], ...]


def attempt(
    brief: Brief,
    author: Author,
    judge: Callable[[Brief, str], list[Finding]],
    rounds: int = ROUNDS,
    seconds: float = SECONDS,
    system: str = "",
) -> Attempt:
    """Let an author answer a brief, and mend the answer until it is right, or rounds are over.

    Args:
        brief: the brief.
        author: the author.
        judge: returns what is wrong with an answer.
        rounds: how often it may mend.
        seconds: how long an answer may take.
        system: what is said before the brief: the language, for those who do not know it.
    """
    messages = [{"role": "system", "content": system}] if system else []
    messages.append({"role": "user", "content": REQUEST.format(brief=brief.text)})
    answers, found, taken = list[str](), list[list[Finding]](), 0.0
    for number in range(1, rounds + 2):
        begin = time.monotonic()
        try:
            answer = ask(author, [*messages], seconds)
            findings: list[Finding] | None = None
        except AuthorError as error:
            answer, findings = "", [{"message": str(error)}]
        taken += time.monotonic() - begin
        findings = judge(brief, answer) if findings is None else findings
        answers.append(answer[:MAX_CHARACTERS])
        found.append(findings)
        if not findings:
            return Attempt(brief.name, number, taken, tuple(answers), tuple(found))
        told = REPAIR.format(found=json.dumps(findings, indent=1))
        messages.append({"role": "assistant", "content": answer})
        messages.append({"role": "user", "content": told})
    return Attempt(brief.name, None, taken, tuple(answers), tuple(found))


def table(attempts: Sequence[Attempt]) -> str:
    """Return a table in Markdown: a row for each family, and one for all."""
    families: dict[str, list[Attempt]] = {}
    for each in attempts:
        families.setdefault(each.name.split("/")[0], []).append(each)
    lines = ["| family | briefs | at once | after repairs | answers | seconds |", "|---" * 6 + "|"]
    for name, some in {**families, "all": [*attempts]}.items():
        if not some:
            continue
        once = sum(each.solved == 1 for each in some) / len(some)
        solved = sum(each.solved is not None for each in some) / len(some)
        answers = statistics.mean(len(each.answers) for each in some)
        seconds = statistics.mean(each.seconds for each in some)
        row = f"{len(some)} | {once:.2f} | {solved:.2f} | {answers:.1f} | {seconds:.1f}"
        lines.append(f"| {name} | {row} |")
    return "\n".join(lines)


def main(author: Author | None = None, words: Sequence[str] | None = None) -> None:
    """Print the table of an author: a function, or what the command line names."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("briefs", nargs="*", help="families or briefs, by how their names begin")
    parser.add_argument("--author", help="a command that reads text and writes a level")
    parser.add_argument("--baseline", choices=("random", "search", "repair"))
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="how often it may mend")
    parser.add_argument(
        "--seconds", type=float, default=SECONDS, help="how long an answer may take"
    )
    parser.add_argument("--no-language", action="store_true", help="do not send the language")
    parser.add_argument("-o", "--output", type=Path, help="a file for all answers, as JSON lines")
    parser.add_argument("--list", action="store_true", help="print the briefs")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(words)
    if options.serve:
        serve(sys.stdin, sys.stdout)
        return
    briefs = load(options.briefs)
    if options.list:
        print("\n\n".join(f"{brief.name}\n{brief.text}" for brief in briefs))
        return
    if not briefs or (author is None and not (options.author or options.baseline)):
        parser.error("no such briefs" if not briefs else "give an --author or a --baseline")
    if options.author:
        if not shutil.which(shlex.split(options.author)[0]):
            parser.error(f"there is no command {options.author}")
        author = command_author(options.author, options.seconds)
    attempts: list[Attempt] = []
    with Judge() as judge, suppress(KeyboardInterrupt):
        for brief in briefs:
            if options.baseline:
                import design_baselines

                author = design_baselines.BASELINES[options.baseline](brief)
            assert author is not None
            system = "" if options.no_language or options.baseline else brl.skill()
            done = attempt(brief, author, judge, options.rounds, options.seconds, system)
            attempts.append(done)
            if options.output:
                with options.output.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(asdict(done)) + "\n")
            print(f"{done.name}: {done.solved or 'not met'}", file=sys.stderr, flush=True)
    # Ctrl-C ends the run: what is done is told.
    print(table(attempts))


if __name__ == "__main__":
    main()
