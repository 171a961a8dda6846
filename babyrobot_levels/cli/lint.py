"""`babyrobot lint`: errors, and faults of play and of style, and their fixes."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import FINDINGS, fail, wants_color, write
from babyrobot_levels.cli.parallel import JobsOption, map_all
from babyrobot_levels.cli.reporting import (
    STANDARD_INPUT,
    FindingsFormat,
    FindingsOption,
    PathsArgument,
    level_paths,
    read_path,
    shown_name,
    write_report,
)
from babyrobot_levels.text.errors import LevelError

if TYPE_CHECKING:
    from babyrobot_levels.lint.rule import Rule
    from babyrobot_levels.text.diagnostics import Diagnostic, Fix


@dataclass(frozen=True, slots=True)
class Order:
    """What is to be done with each file."""

    select: tuple[str, ...] | None
    ignore: tuple[str, ...]
    fix: bool
    unsafe: bool

    def rules_for(self, path: Path) -> tuple[Rule, ...]:
        """Return the rules for a file: those of the call, else those of the project."""
        from babyrobot_levels.lint.settings import Settings, settings_for

        if self.select is not None:
            return Settings(self.select, self.ignore).rules_for(path)
        return settings_for(path).ignoring(self.ignore).rules_for(path)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a file. It travels between processes, and carries no level.

    Attributes:
        diagnostics: what is found in it now.
        before: the text as it was, None where it could not be read.
        text: the text that fixes made of it, None where they changed nothing.
        count: how many fixes were applied.
        likeness: by which equal games are found, where somebody compares games.
    """

    diagnostics: list[Diagnostic]
    before: str | None = None
    text: str | None = None
    count: int = 0
    likeness: int | None = None


def lint(
    paths: PathsArgument = None,
    fix: Annotated[bool, typer.Option("--fix", help="Apply the safe fixes.")] = False,
    unsafe_fixes: Annotated[
        bool,
        typer.Option(
            "--unsafe-fixes", help="With --fix or --diff: also fixes that may change the game."
        ),
    ] = False,
    diff: Annotated[
        bool, typer.Option("--diff", help="Show what --fix would change, and change nothing.")
    ] = False,
    select: Annotated[
        list[str] | None,
        typer.Option(
            metavar="RULE",
            help="Only these rules: codes, beginnings of codes (`BR5`), names, or `ALL`. "
            "Takes the place of the project's settings; may be given several times.",
            show_default=False,
        ),
    ] = None,
    ignore: Annotated[
        list[str] | None,
        typer.Option(metavar="RULE", help="Not these rules.", show_default=False),
    ] = None,
    report_format: FindingsOption = FindingsFormat.TEXT,
    watch: Annotated[
        bool, typer.Option("--watch", help="Report again whenever a file is saved.")
    ] = False,
    jobs: JobsOption = None,
) -> None:
    """Check level files, and find faults of play and of style in those that are valid.

    The rules of play are proved from the level's exact tables: an exit that cannot be reached, a
    trap, a puddle that nobody notices. `babyrobot rule` lists all rules. A comment
    `# babyrobot: ignore[BR503] why` silences one where it is meant to be so.

    Ends with status 0 if nothing was found, and with 1 if something was.

    Examples:

      babyrobot lint levels/first.yaml

      babyrobot lint --fix

      babyrobot lint --select BR5 --format json levels/
    """
    from babyrobot_levels.lint.registry import UnknownRuleError

    order = Order(
        _words(select) if select else None, _words(ignore or []), fix or diff, unsafe_fixes
    )
    if unsafe_fixes and not (fix or diff):
        fail("--unsafe-fixes needs --fix or --diff")
    if watch and (diff or STANDARD_INPUT in (paths or [])):
        fail("--watch reports on files, and goes with neither --diff nor standard input")
    try:
        if watch:
            from babyrobot_levels.cli.watching import each_change

            for files in each_change(lambda: level_paths(paths)):
                _run(files, order, report_format, diff=False, jobs=jobs)
        elif _run(level_paths(paths), order, report_format, diff=diff, jobs=jobs):
            raise typer.Exit(FINDINGS)
    except UnknownRuleError as error:
        fail(str(error), "`babyrobot rule` lists all rules")


def _words(given: Sequence[str]) -> tuple[str, ...]:
    """Return the words of an option that takes several, apart or with commas between them."""
    return tuple(word for text in given for word in text.replace(",", " ").split())


def _run(
    files: list[Path], order: Order, report_format: FindingsFormat, *, diff: bool, jobs: int | None
) -> bool:
    """Lint files once. Return whether something was found, or with `diff` would change."""
    from babyrobot_levels.lint.across import same_games
    from babyrobot_levels.text.source import SourceFile

    outcomes = dict(
        zip(files, map_all(partial(work_on, order), files, jobs, "linting"), strict=True)
    )
    if diff:
        return _show_changes(outcomes)
    for path, outcome in outcomes.items():
        if order.fix:
            _write_fixed(path, outcome)
    texts = {
        path: (SourceFile(shown_name(path), outcome.text or outcome.before), outcome.likeness)
        for path, outcome in outcomes.items()
        if outcome.before is not None and outcome.likeness is not None
    }
    same = same_games(texts, order.rules_for)
    found = [
        each
        for path, outcome in outcomes.items()
        for each in [*([same[path]] if path in same else []), *outcome.diagnostics]
    ]
    if not (order.fix and STANDARD_INPUT in outcomes):
        count = sum(outcome.count for outcome in outcomes.values())
        ending = _ending(count, [each.fix for each in found], unsafe=order.unsafe)
        write_report(report_format, found, files, praise="clean", ending=ending)
    return bool(found)


def work_on(order: Order, path: Path) -> Outcome:
    """Lint a file, and fix its text if that is wanted. Nothing is written."""
    from babyrobot_levels.lint.across import likeness
    from babyrobot_levels.lint.fixer import fix
    from babyrobot_levels.lint.rules.same_game import CODE
    from babyrobot_levels.lint.runner import lint_source

    rules = order.rules_for(path)
    try:
        source = read_path(path)
    except LevelError as fault:
        return Outcome([*fault.diagnostics])
    origin = None if path == STANDARD_INPUT else path
    text, count = None, 0
    if order.fix:
        fixed = fix(source, rules, origin, unsafe=order.unsafe)
        report, count = fixed.report, fixed.count
        text = fixed.text if count else None
    else:
        report = lint_source(source, rules, origin)
    level, number = report.level, None
    if level is not None and not level.has_random_maze and any(rule.code == CODE for rule in rules):
        number = likeness(level)
    return Outcome(report.diagnostics, source.text, text, count, number)


def _write_fixed(path: Path, outcome: Outcome) -> None:
    """Write what fixes made of a file; of standard input, to standard output in any case."""
    from babyrobot_levels.text.files import write_text

    if path == STANDARD_INPUT:
        write(outcome.text or outcome.before or "")
    elif outcome.text is not None:
        try:
            write_text(path, outcome.text)
        except OSError as error:
            fail(f"{path} cannot be written ({error.strerror or error})")


def _show_changes(outcomes: dict[Path, Outcome]) -> bool:
    """Write what fixes would change, as unified diffs. Return whether they would."""
    from babyrobot_levels.cli.console import unified

    changed = False
    for path, outcome in outcomes.items():
        if outcome.text is not None:
            before, color = outcome.before or "", wants_color(sys.stdout)
            write(unified(before, outcome.text, shown_name(path), color=color))
            changed = True
    return changed


def _ending(count: int, left: Sequence[Fix | None], *, unsafe: bool) -> str:
    """Return the last line of a report: what was mended, and what could be."""
    parts = [f"{count} mended"] if count else []
    safe = sum(each is not None and each.safe for each in left)
    others = sum(each is not None and not each.safe for each in left)
    if safe:
        parts.append(f"{safe} can be mended with --fix")
    if others and not unsafe:
        parts.append(f"{others} with --fix --unsafe-fixes")
    return "; ".join(parts)
