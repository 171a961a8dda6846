"""Commands that read level files: `babyrobot validate` and `format`."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from babyrobot_levels.cli.console import (
    FINDINGS,
    WRONG_CALL,
    fail,
    flag,
    note,
    unified,
    wants_color,
    write,
)
from babyrobot_levels.cli.parallel import JobsOption, RayAddressOption, RayOption, Workers, map_all
from babyrobot_levels.cli.reporting import (
    STANDARD_INPUT,
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
    from babyrobot_levels.text.diagnostics import Diagnostic


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
    notes = [*_notes(outcomes, name_changes=check and not diff)]
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


def _notes(outcomes: dict[Path, Outcome], *, name_changes: bool) -> Iterator[str]:
    """Yield the lines about single files that have no errors."""
    for path, outcome in outcomes.items():
        name = one_line(shown_name(path))
        if outcome.kept:
            yield f"left unchanged: {name}: {outcome.kept}"
        if outcome.differs and name_changes:
            yield f"would reformat: {name}"


def _summary(changed: int, unchanged: int, faulty: int, *, would: bool) -> str:
    parts = [
        (changed, "would be reformatted" if would else "reformatted"),
        (unchanged, "already formatted" if would else "left unchanged"),
        (faulty, "with errors"),
    ]
    return ", ".join(f"{n} file{'s' * (n != 1)} {what}" for n, what in parts if n)
