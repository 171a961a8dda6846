"""Commands that check: `babyrobot validate`, `format` and `rule`."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from babyrobot_levels.cli.console import (
    FINDINGS,
    WRONG_CALL,
    FormatOption,
    ReportFormat,
    fail,
    note,
    wants_color,
    write,
    write_json,
)
from babyrobot_levels.cli.parallel import JobsOption, RayAddressOption, RayOption, Workers, map_all
from babyrobot_levels.cli.reporting import (
    STANDARD_INPUT,
    FindingsFormat,
    FindingsOption,
    PathsArgument,
    findings_text,
    level_paths,
    read_path,
    shown_name,
    write_report,
)
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError

if TYPE_CHECKING:
    from babyrobot_levels.text.diagnostics import Diagnostic


def validate(
    paths: PathsArgument = None,
    report_format: FindingsOption = FindingsFormat.TEXT,
    jobs: JobsOption = None,
    ray: RayOption = False,
    ray_address: RayAddressOption = None,
) -> None:
    """Check level files and report every error with its position and a suggestion.

    Exit status: 0 if all files are valid, 1 if there are errors.

    Examples:

      babyrobot validate levels/first.yaml

      babyrobot validate --format json levels/
    """
    files, workers = level_paths(paths), Workers(jobs, ray, ray_address)
    found = [each for errors in map_all(errors_of, files, workers, "checking") for each in errors]
    write_report(report_format, found, files)
    if found:
        raise typer.Exit(FINDINGS)


def errors_of(path: Path) -> list[Diagnostic]:
    """Return the errors of a file, or of standard input for `-`."""
    from babyrobot_levels.suites import checking

    try:
        source = read_path(path)
    except LevelError as error:
        return [*error.diagnostics]
    return checking.errors_of(source, None if path == STANDARD_INPUT else path)


class Outcome(NamedTuple):
    """The result for one file.

    Attributes:
        before: its text, without a byte order mark.
        text: its canonical form; unchanged if the file has errors.
        differs: whether the file has to be rewritten.
        errors: the errors for which it is not formatted.
        kept: why it is left unchanged although it has no errors.
    """

    before: str = ""
    text: str = ""
    differs: bool = False
    errors: tuple[Diagnostic, ...] = ()
    kept: str | None = None


def format_levels(
    paths: PathsArgument = None,
    check: Annotated[
        bool, typer.Option("--check", help="Only list the files that would change.")
    ] = False,
    diff: Annotated[bool, typer.Option("--diff", help="Only show what would change.")] = False,
    jobs: JobsOption = None,
    ray: RayOption = False,
    ray_address: RayAddressOption = None,
) -> None:
    """Format level files: one canonical form, with all comments.

    The level itself does not change, and formatting twice has no further effect. Standard input
    (`-`) is written to standard output. Files with errors are reported and left unchanged.

    Exits with status 1 if a file has errors or, with --check or --diff, would change.

    Examples:

      babyrobot format

      babyrobot format --check levels/first.yaml
    """
    files, workers = level_paths(paths), Workers(jobs, ray, ray_address)
    if STANDARD_INPUT in files and len(files) > 1:
        fail("standard input (`-`) cannot be formatted together with files", "use two calls")
    outcomes = dict(zip(files, map_all(work_on, files, workers, "formatting"), strict=True))
    changed = [path for path, outcome in outcomes.items() if outcome.differs]
    unwritten = 0
    if diff:
        _show_changes(outcomes)
    elif not check:
        unwritten = sum(not _write(path, outcomes[path]) for path in outcomes)
    # Standard output may hold formatted texts or diffs, and then nothing else.
    stream = sys.stderr if diff or STANDARD_INPUT in files else sys.stdout
    errors = [error for outcome in outcomes.values() for error in outcome.errors]
    notes = _notes(outcomes, name_changes=check and not diff)
    if STANDARD_INPUT not in files:
        faulty = sum(bool(outcome.errors) for outcome in outcomes.values())
        counts = len(changed) - unwritten, len(files) - len(changed) - faulty, faulty
        notes.append(_summary(*counts, would=check or diff))
    report = findings_text(errors, stream)
    stream.write(report + ("\n" if report and notes else ""))
    stream.writelines(f"{line}\n" for line in notes)
    if unwritten:
        raise typer.Exit(WRONG_CALL)
    if errors or (changed and (check or diff)):
        raise typer.Exit(FINDINGS)


def work_on(path: Path) -> Outcome:
    """Format a file, or standard input for `-`. Nothing is written."""
    from babyrobot_levels.language.formatting import format_source
    from babyrobot_levels.text.errors import LevelError

    try:
        source = read_path(path)
        result = format_source(source, None if path == STANDARD_INPUT else path)
    except LevelError as error:
        return Outcome(errors=error.diagnostics)
    differs = result.text != source.text or (result.kept is None and bool(source.mark))
    return Outcome(source.text, result.text, differs, kept=result.kept)


def _write(path: Path, outcome: Outcome) -> bool:
    """Write a file's canonical form if it differs. Return False if that failed."""
    from babyrobot_levels.text.files import write_text

    if path == STANDARD_INPUT:
        # Level files are UTF-8, whatever the encoding of the terminal is.
        sys.stdout.buffer.write(outcome.text.encode("utf-8"))
        sys.stdout.buffer.flush()
    elif outcome.differs:
        try:
            write_text(path, outcome.text)
        except OSError as error:
            note(f"error: {path} cannot be written ({error.strerror or error})")
            return False
    return True


def _show_changes(outcomes: dict[Path, Outcome]) -> None:
    from babyrobot_levels.cli.console import unified

    for path, outcome in outcomes.items():
        color = wants_color(sys.stdout)
        name = one_line(shown_name(path))
        write(unified(outcome.before, outcome.text, name, color=color))


def _notes(outcomes: dict[Path, Outcome], *, name_changes: bool) -> list[str]:
    """Return the lines about single files that have no errors."""
    notes = []
    for path, outcome in outcomes.items():
        name = one_line(shown_name(path))
        if outcome.kept:
            notes.append(f"left unchanged: {name}: {outcome.kept}")
        if outcome.differs and name_changes:
            notes.append(f"would reformat: {name}")
    return notes


def _summary(changed: int, unchanged: int, faulty: int, *, would: bool) -> str:
    parts = [
        (changed, "would be reformatted" if would else "reformatted"),
        (unchanged, "already formatted" if would else "left unchanged"),
        (faulty, "with errors"),
    ]
    return ", ".join(f"{n} file{'s' * (n != 1)} {what}" for n, what in parts if n)


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
    from babyrobot_levels.linter.rules import UnknownRuleError
    from babyrobot_levels.linter.rules import rule as rule_of

    try:
        rules = rule_of() if code is None else (rule_of(code),)
    except UnknownRuleError as error:
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
            write(f"{_bold(each.code)}  {each.name.ljust(width)}  {each.summary}\n")
    else:
        (only,) = rules
        write(f"{_bold(f'{only.code} {only.name}')}\n\n{_shown(only.page)}\n")


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
            lines.append(_bold(text.removeprefix("## ")) if line.startswith("## ") else text)
    return "\n".join(lines)


def _bold(text: str) -> str:
    return f"\x1b[1m{text}\x1b[0m" if wants_color(sys.stdout) else text
