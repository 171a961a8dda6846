"""`babyrobot validate`: errors, each where it stands."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import (
    FINDINGS,
    FormatOption,
    ReportFormat,
    fail,
    note,
    wants_color,
    write,
)

if TYPE_CHECKING:
    from babyrobot_levels.diagnostics import Diagnostic

DEFAULT_FOLDER = Path("levels")


def validate(
    paths: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="PATHS",
            help="Level files, and folders of them; `-` is standard input.  [default: levels/]",
            show_default=False,
        ),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Check level files: every error, where it stands, and what to do.

    Ends with status 0 if all files are valid, and with 1 if there are errors.

    Examples:

      babyrobot validate levels/first.yaml

      babyrobot validate --format json levels/
    """
    from babyrobot_levels.reading import read_file

    files = level_paths(paths or [DEFAULT_FOLDER])
    diagnostics: list[Diagnostic] = []
    for path in files:
        diagnostics += read_standard_input() if str(path) == "-" else read_file(path)[1]
    if report_format is ReportFormat.JSON:
        from babyrobot_levels.report import json

        write(json.render(diagnostics))
    else:
        from babyrobot_levels.report import text

        report = text.render(diagnostics, color=wants_color(sys.stdout))
        write(report + ("\n" if report else "") + text.summary(diagnostics, len(files)) + "\n")
    if diagnostics:
        raise typer.Exit(FINDINGS)


def level_paths(paths: list[Path]) -> list[Path]:
    """Return the files that are meant: those named, and all below the folders named."""
    from babyrobot_levels.catalogue import yaml_files

    files: dict[Path, None] = {}
    for path in paths:
        if is_folder(path):
            found = list(yaml_files(path))
            if not found:
                note(f"there are no level files (.yaml) in {path}")
            files.update(dict.fromkeys(found))
        elif path == DEFAULT_FOLDER and not path.exists():
            fail("there is no folder levels/ here", "name the files or folders to check")
        else:
            files[path] = None
    if not files:
        fail("there is nothing to check")
    return list(files)


def is_folder(path: Path) -> bool:
    """Tell whether a path is a folder; one that cannot be asked is none."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def read_standard_input() -> list[Diagnostic]:
    """Return what is wrong with the level on standard input."""
    from babyrobot_levels.files import ReadFault, decode
    from babyrobot_levels.reading import read_level
    from babyrobot_levels.syntax.reader import MAX_BYTES

    if sys.stdin is None:
        fail("standard input is closed")
    try:
        source = decode(sys.stdin.buffer.read(MAX_BYTES + 1), "<stdin>")
    except ReadFault as fault:
        return [fault.diagnostic]
    return read_level(source)[1]
