"""How commands that check files name them, and report what they found."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import suppress
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from babyrobot_levels.cli.console import fail, note, wants_color, write

if TYPE_CHECKING:
    from babyrobot_levels.lint.reporters import MachineFormat
    from babyrobot_levels.text.diagnostics import Diagnostic
    from babyrobot_levels.text.source import SourceFile

DEFAULT_FOLDER = Path("levels")
STANDARD_INPUT = Path("-")

PathsArgument = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="PATHS",
        help="Level files, and folders of them; `-` is standard input.  [default: levels/]",
        show_default=False,
    ),
]


class FindingsFormat(StrEnum):
    """How findings are reported."""

    TEXT = "text"
    JSON = "json"
    GITHUB = "github"
    SARIF = "sarif"
    JUNIT = "junit"


FindingsOption = Annotated[
    FindingsFormat,
    typer.Option(
        "--format",
        help="How to report: for people, for programs, as annotations of GitHub Actions, "
        "as SARIF 2.1.0, or as JUnit's XML.",
    ),
]


def write_report(
    kind: FindingsFormat,
    diagnostics: Sequence[Diagnostic],
    files: Sequence[Path],
    *,
    praise: str = "valid",
    ending: str = "",
) -> None:
    """Write what was found to standard output.

    Args:
        kind: the format.
        diagnostics: the findings.
        files: all files that were looked at.
        praise: what is said of files in which nothing was found.
        ending: a last line of the text format.
    """
    if kind is FindingsFormat.TEXT:
        from babyrobot_levels.lint.reporters import text

        report = text.render(diagnostics, color=wants_color(sys.stdout))
        summary = text.summary(diagnostics, len(files), praise)
        write(report + ("\n" if report else "") + summary + "\n" + (ending and ending + "\n"))
        return
    from babyrobot_levels.lint.reporters import render

    # Only these two say what codes mean.
    named = kind in (FindingsFormat.GITHUB, FindingsFormat.SARIF)
    names = [shown_name(path) for path in files]
    write(render(cast("MachineFormat", kind.value), diagnostics, names, _titles() if named else {}))


def _titles() -> dict[str, str]:
    from babyrobot_levels.lint.pages import titles

    return titles()


def level_paths(paths: Sequence[Path] | None) -> list[Path]:
    """Return the files that are meant: those named, and all below the folders named."""
    from babyrobot_levels.library.search_path import yaml_files
    from babyrobot_levels.text.files import is_folder

    files: dict[Path, None] = {}
    for path in paths or [DEFAULT_FOLDER]:
        if is_folder(path):
            found = list(yaml_files(path, all_of_them=True))
            if not found:
                note(f"there are no level files (.yaml) in {path}")
            files.update(dict.fromkeys(found))
        elif path == DEFAULT_FOLDER and not path.exists():
            fail("there is no folder levels/ here", "name the files or folders to check")
        else:
            _tell_file_of(path)
            files[path] = None
    if not files:
        fail("there is nothing to check")
    return list(files)


def _tell_file_of(path: Path) -> None:
    """Where other commands know a level by what is no file, say which file that is."""
    from babyrobot_levels.library.catalogue import find
    from babyrobot_levels.text.errors import LevelNotFoundError
    from babyrobot_levels.text.files import is_file

    if path == STANDARD_INPUT or path.suffix or is_file(path):
        return
    with suppress(LevelNotFoundError):
        file = find(path.as_posix())
        note(f"{path} is the name of a level; what is checked here are files: {file}")


def shown_name(path: Path | str) -> str:
    """Return what messages call a file, or another level that an argument names."""
    return "<stdin>" if str(path) == str(STANDARD_INPUT) else str(path)


def read_path(path: Path) -> SourceFile:
    """Return the text of a file, or of standard input for `-`.

    Raises:
        LevelError: it cannot be read.
    """
    from babyrobot_levels.text.files import read_source, source_of
    from babyrobot_levels.text.source import MAX_BYTES

    if path != STANDARD_INPUT:
        return read_source(path)
    if sys.stdin is None:
        fail("standard input is closed")
    return source_of(sys.stdin.buffer.read(MAX_BYTES + 1), shown_name(path))
