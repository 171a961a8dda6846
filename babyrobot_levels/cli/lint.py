"""Commands of the linter: `babyrobot lint` and `rule`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.check import show_changes
from babyrobot_levels.cli.console import (
    FINDINGS,
    FormatOption,
    ReportFormat,
    bold,
    each_change,
    fail,
    flag,
    hanging,
    note,
    value_option,
    write,
    write_json,
)
from babyrobot_levels.cli.parallel import JobsOption, RayAddressOption, RayOption, Workers, map_all
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
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.files import write_text

if TYPE_CHECKING:
    from babyrobot_levels.linter.linting import Options
    from babyrobot_levels.linter.linting import Outcome as Linted
    from babyrobot_levels.text.diagnostics import Fix


def lint(
    paths: PathsArgument = None,
    fix: Annotated[bool, flag("--fix", "Apply the safe fixes.")] = False,
    unsafe_fixes: Annotated[
        bool,
        flag("--unsafe-fixes", "Include fixes that may change the MDP (with --fix or --diff)."),
    ] = False,
    diff: Annotated[
        bool, flag("--diff", "Show what --fix would change, without changing files.")
    ] = False,
    select: Annotated[
        list[str] | None,
        value_option(
            "RULE",
            "Rules to apply: codes, prefixes of codes (`BR5`), names, or `ALL`. "
            "Replaces the project's settings; can be repeated.",
        ),
    ] = None,
    ignore: Annotated[list[str] | None, value_option("RULE", "Rules to leave out.")] = None,
    report_format: FindingsOption = "text",
    watch: Annotated[bool, flag("--watch", "Repeat whenever a file is saved.")] = False,
    jobs: JobsOption = None,
    ray: RayOption = False,
    ray_address: RayAddressOption = None,
) -> None:
    """Check level files for errors, and valid ones for problems of play and style.

    The rules of play use the level's exact transition tables: an exit that cannot be reached, a
    state that cannot be left, a puddle without effect. `babyrobot rule` lists all rules. A comment
    `# babyrobot: ignore[BR503] reason` suppresses a finding that is intended.

    Exit status: 0 if there are no findings except notes, 1 otherwise.

    Examples:

      babyrobot lint levels/first.yaml

      babyrobot lint --fix

      babyrobot lint --select BR5 --format json levels/
    """
    from babyrobot_levels.linter.linting import Options

    options = Options(
        _words(select) if select else None, _words(ignore or []), fix or diff, unsafe_fixes
    )
    if unsafe_fixes and not (fix or diff):
        fail("--unsafe-fixes needs --fix or --diff")
    if watch and (diff or STANDARD_INPUT in (paths or [])):
        fail("--watch cannot be combined with --diff or standard input")
    workers = Workers(jobs, ray, ray_address)
    try:
        if watch:
            for files in each_change(lambda: level_paths(paths)):
                _lint(files, options, report_format, diff=False, workers=workers)
        elif _lint(level_paths(paths), options, report_format, diff=diff, workers=workers):
            raise typer.Exit(FINDINGS)
    except brl.UnknownRuleError as error:
        fail(str(error), "`babyrobot rule` lists all rules")


def _words(given: Sequence[str]) -> tuple[str, ...]:
    """Return the values of an option that is repeated or has several values, with commas."""
    return tuple(word for text in given for word in text.replace(",", " ").split())


def _lint(
    files: list[Path],
    options: Options,
    report_format: FindingsFormat,
    *,
    diff: bool,
    workers: Workers,
) -> bool:
    """Lint files once. Return whether there are findings, or with `diff` whether files change."""
    from babyrobot_levels.linter.linting import findings_of
    from babyrobot_levels.linter.runner import is_note

    outcomes = dict(
        zip(files, map_all(partial(lint_path, options), files, workers, "linting"), strict=True)
    )
    for path, each in outcomes.items():
        if each.is_cut:
            note(each.told_cut(one_line(shown_name(path))))
    if diff:
        changed = {path: each for path, each in outcomes.items() if each.text is not None}
        show_changes((path, each.before or "", each.text or "") for path, each in changed.items())
        return bool(changed)
    for path, outcome in outcomes.items():
        if options.fix:
            _write_fixed(path, outcome)
    found = findings_of(outcomes, options, shown_name)
    if not (options.fix and STANDARD_INPUT in outcomes):
        count = sum(outcome.count for outcome in outcomes.values())
        ending = _ending(count, [each.fix for each in found], unsafe=options.unsafe)
        write_report(report_format, found, files, clean="clean", ending=ending)
    return not all(map(is_note, found))


def lint_path(options: Options, path: Path) -> Linted:
    """Lint a file, or standard input for `-`, and fix its text if that is asked for."""
    from babyrobot_levels.linter import linting

    if path != STANDARD_INPUT:
        return linting.lint_path(options, path)
    return linting.outcome_of(options, read_path(path), options.rules_for(path))


def _write_fixed(path: Path, outcome: Linted) -> None:
    """Write a file that fixes changed. The text of standard input goes to standard output."""
    if path == STANDARD_INPUT:
        write(outcome.mark + (outcome.text or outcome.before or ""))
    elif outcome.text is not None:
        try:
            write_text(path, outcome.mark + outcome.text)
        except OSError as error:
            fail(f"cannot write {path}: {error.strerror or error}")


def _ending(count: int, left: Sequence[Fix | None], *, unsafe: bool) -> str:
    """Return the last line of a report: the number of fixes applied and available."""
    parts = [f"{count} fixed"] if count else []
    safe = sum(each is not None and each.safe for each in left)
    others = sum(each is not None and not each.safe for each in left)
    if safe:
        parts.append(f"{safe} fixable with --fix")
    if others and not unsafe:
        parts.append(f"{others} fixable with --fix --unsafe-fixes")
    return "; ".join(parts)


def rule(
    code: Annotated[
        str | None,
        typer.Argument(
            metavar="[CODE]",
            help="A code or a name. Without it, all are listed.",
            show_default=False,
        ),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """List all rules and error codes, or explain one: what it checks, why, and an example.

    Examples:

      babyrobot rule

      babyrobot rule BR503

      babyrobot rule inescapable-state
    """
    try:
        rules = brl.rule() if code is None else (brl.rule(code),)
    except brl.UnknownRuleError as error:
        fail(str(error), "`babyrobot rule` lists all rules")
    if report_format is ReportFormat.JSON:
        write_json(
            [
                {
                    "code": each.code,
                    "name": each.name,
                    "severity": str(each.severity),
                    "summary": each.summary,
                    "page": each.page,
                }
                for each in rules
            ]
        )
    elif code is None:
        width = max(len(each.name) for each in rules)
        for each in rules:
            told = hanging(each.summary, len(each.code) + width + 4)
            write(f"{bold(each.code)}  {each.name.ljust(width)} {told}\n")
    else:
        (only,) = rules
        write(f"{bold(f'{only.code} {only.name}')}\n\n{_shown(only.page)}\n")


def _shown(page: str) -> str:
    """Return a page for the terminal, with bold headings, indented examples and no links."""
    lines, inside = [], False
    for line in page.rstrip().split("\n"):
        if line.startswith("```"):
            inside = not inside
        elif inside:
            lines.append(f"    {line}".rstrip())
        else:
            text = re.sub(r"\[([^\]]*)\]\([^)]*\.md\)", r"\1", line)
            lines.append(bold(text.removeprefix("## ")) if line.startswith("## ") else text)
    return "\n".join(lines)
