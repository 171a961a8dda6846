"""Commands that check: `babyrobot validate`, `format`, `lint` and `rule`."""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import (
    FINDINGS,
    WRONG_CALL,
    FormatOption,
    ReportFormat,
    bold,
    each_change,
    fail,
    flag,
    hanging,
    note,
    unified,
    value_option,
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
from babyrobot_levels.registry.own import own
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import SUFFIXES, unreadable, write_text

if TYPE_CHECKING:
    from babyrobot_levels.linter.linting import Options
    from babyrobot_levels.linter.linting import Outcome as Linted
    from babyrobot_levels.text.diagnostics import Diagnostic, Fix


def validate(
    paths: PathsArgument = None,
    report_format: FindingsOption = "text",
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
        if error.diagnostics[0].code == "BR102" and path != STANDARD_INPUT:
            return _errors_of_foreign(path, [*error.diagnostics])
        return [*error.diagnostics]
    errors = checking.errors_of(source, None if path == STANDARD_INPUT else path)
    if not errors or path == STANDARD_INPUT or path.suffix in SUFFIXES:
        return errors
    return _errors_of_foreign(path, errors)


def _errors_of_foreign(path: Path, errors: list[Diagnostic]) -> list[Diagnostic]:
    """Return the errors of a file of another program, of which these are those as a level file."""
    try:
        with warnings.catch_warnings():
            # What a level cannot express is no error.
            warnings.simplefilter("ignore")
            return errors if own("foreign_level")(path) is None else []
    except LevelError as error:
        if error.diagnostics:
            return [*error.diagnostics]
        message = str(error).partition("\n")[0].rpartition(": error: ")[2]
        return [unreadable("BR110", str(path), message, None).diagnostics[0]]


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
    check: Annotated[bool, flag("--check", "Only list the files that would change.")] = False,
    diff: Annotated[bool, flag("--diff", "Only show what would change.")] = False,
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
        show_changes((path, each.before, each.text) for path, each in outcomes.items())
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
    from babyrobot_levels.suites.checking import formatted

    try:
        source = read_path(path)
        result = formatted(source, None if path == STANDARD_INPUT else path)
    except LevelError as error:
        return Outcome(errors=error.diagnostics)
    differs = result.text != source.text or (result.kept is None and bool(source.mark))
    return Outcome(source.text, result.text, differs, kept=result.kept)


def _write(path: Path, outcome: Outcome) -> bool:
    """Write a file's canonical form if it differs. Return False if that failed."""
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


def show_changes(changes: Iterable[tuple[Path, str, str]]) -> None:
    """Write what changes in files, their texts before and after it, as unified diffs."""
    color = wants_color(sys.stdout)
    for path, before, after in changes:
        write(unified(before, after, shown_name(path), color=color))


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
    from babyrobot_levels.linter.linting import equivalent_levels
    from babyrobot_levels.linter.runner import is_note
    from babyrobot_levels.text.source import SourceFile

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
    texts = {
        path: (SourceFile(shown_name(path), outcome.text or outcome.before), outcome.fingerprint)
        for path, outcome in outcomes.items()
        if outcome.before is not None and outcome.fingerprint is not None
    }
    same = equivalent_levels(texts, options.rules_for)
    found = [
        each
        for path, outcome in outcomes.items()
        for each in [*([same[path]] if path in same else []), *outcome.diagnostics]
    ]
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
