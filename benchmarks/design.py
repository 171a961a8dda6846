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
import shlex
import shutil
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from threading import Thread
from typing import IO, Any

from design_judge import MAX_CHARACTERS, SECONDS, Brief, Finding, Judge, Limit, close, load, start

import babyrobot_levels as brl

ROUNDS = 4

Message = dict[str, str]
Author = Callable[[list[Message]], str]
"""What answers with a level: a function of all messages so far, as chat models are."""

REQUEST = """\
Write a level file for babyrobot-levels that meets this brief:

{brief}

Use nothing that the brief does not speak of: walls may stand anywhere, but there are no other
things, cells with effects, wind or skids, and rewards, hits, puddles and the discount keep their
defaults. There is one start and one exit, if not said otherwise. `babyrobot lint` must find
nothing but notes. Answer with the YAML of the file, and nothing else."""

REPAIR = "That is not yet right. What was found, as JSON:\n\n{found}\n\nAnswer with the whole file."


class AuthorError(Exception):
    """An author did not answer."""


@dataclass(frozen=True)
class Command:
    """The author that a command is: it reads all messages as a text, and writes the level.

    It is ended if it takes too long, and more than `MAX_CHARACTERS` are not read.
    """

    words: Sequence[str]
    seconds: float = SECONDS

    def __call__(self, messages: list[Message]) -> str:
        text = "\n\n".join(message["content"] for message in messages)
        begin = time.monotonic()
        process = start(self.words)
        try:
            assert process.stdin is not None
            assert process.stdout is not None
            Thread(target=_send, args=(process.stdin, text), daemon=True).start()
            with Limit(process, self.seconds):
                answer = process.stdout.read(MAX_CHARACTERS + 1)
        finally:
            close(process)
        if time.monotonic() - begin >= self.seconds:
            raise AuthorError(f"no answer within {self.seconds:g} seconds")
        return answer


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

    if isinstance(author, Command):
        call()  # It ends its process itself, also at Ctrl-C.
    else:
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
    options = parser.parse_args(words)
    briefs = load(options.briefs)
    if options.list:
        print("\n\n".join(f"{brief.name}\n{brief.text}" for brief in briefs))
        return
    if not briefs or (author is None and not (options.author or options.baseline)):
        parser.error("no such briefs" if not briefs else "give an --author or a --baseline")
    try:
        if options.author:
            author = Command(shlex.split(options.author), options.seconds)
            if not shutil.which(author.words[0]):
                parser.error(f"there is no command {author.words[0]}")
        if options.output:
            options.output.touch()
    except (OSError, ValueError) as error:
        parser.error(str(error))
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
