"""The arguments and the output of commands that check files."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import suppress
from enum import StrEnum
from pathlib import Path
from typing import IO, TYPE_CHECKING, Annotated, cast

import typer

from babyrobot_levels.cli.console import fail, note, wants_color, width_of, write

if TYPE_CHECKING:
    from babyrobot_levels.linter.reporters import MachineFormat
    from babyrobot_levels.text.diagnostics import Diagnostic
    from babyrobot_levels.text.source import SourceFile

DEFAULT_FOLDER = Path("levels")
STANDARD_INPUT = Path("-")

PathsArgument = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="PATHS",
        help="Level files and folders of level files; `-` for standard input.  [default: levels/]",
        show_default=False,
    ),
]


class FindingsFormat(StrEnum):
    """The output format of findings."""

    TEXT = "text"
    JSON = "json"
    GITHUB = "github"
    SARIF = "sarif"
    JUNIT = "junit"


FindingsOption = Annotated[
    FindingsFormat,
    typer.Option(
        "--format",
        help="Output format: text, JSON, GitHub Actions annotations, SARIF 2.1.0, or JUnit XML.",
    ),
]


def write_report(
    kind: FindingsFormat,
    diagnostics: Sequence[Diagnostic],
    files: Sequence[Path],
    *,
    clean: str = "valid",
    ending: str = "",
) -> None:
    """Write findings to standard output.

    Args:
        kind: the format.
        diagnostics: the findings.
        files: all files that were checked.
        clean: the word for files without findings.
        ending: the last line of the text format.
    """
    if kind is FindingsFormat.TEXT:
        from babyrobot_levels.linter.reporters import text

        report = findings_text(diagnostics, sys.stdout)
        summary = text.summary(diagnostics, len(files), clean)
        write(report + ("\n" if report else "") + summary + "\n" + (ending and ending + "\n"))
        return
    from babyrobot_levels import __version__
    from babyrobot_levels.linter.reporters import render

    # Only these two describe codes.
    named = kind in (FindingsFormat.GITHUB, FindingsFormat.SARIF)
    names = [shown_name(path) for path in files]
    titles = _titles() if named else {}
    write(render(cast("MachineFormat", kind.value), diagnostics, names, titles, __version__))


def findings_text(diagnostics: Sequence[Diagnostic], stream: IO[str]) -> str:
    """Return findings as text for a stream: in colour and cut to the width on a terminal."""
    from babyrobot_levels.linter.reporters import text

    return text.render(diagnostics, color=wants_color(stream), width=width_of(stream))


def _titles() -> dict[str, str]:
    from babyrobot_levels.linter.registry import titles

    return titles()


def level_paths(paths: Sequence[Path] | None) -> list[Path]:
    """Return the given files, and all level files below the given folders."""
    from babyrobot_levels.library.search_path import yaml_files
    from babyrobot_levels.text.files import is_folder

    files: dict[Path, None] = {}
    for path in paths or [DEFAULT_FOLDER]:
        if is_folder(path):
            found = list(yaml_files(path, all_of_them=True))
            if not found:
                note(f"no level files (.yaml) in {path}")
            files.update(dict.fromkeys(found))
        elif path == DEFAULT_FOLDER and not path.exists():
            fail("no folder levels/ here", "name the files or folders to check")
        else:
            _note_file_of(path)
            files[path] = None
    if not files:
        fail("no files to check")
    return list(files)


def _note_file_of(path: Path) -> None:
    """If an argument is the name of a level instead of a file, write a note with its file."""
    from babyrobot_levels.text.files import is_file

    if path == STANDARD_INPUT or path.suffix or is_file(path):
        return
    from babyrobot_levels.library.catalogue import find
    from babyrobot_levels.text.errors import LevelNotFoundError

    with suppress(LevelNotFoundError):
        file = find(path.as_posix())
        note(f"{path} is the name of a level, but this command takes files: {file}")


def shown_name(path: Path | str) -> str:
    """Return the name of a file, or of a level given as an argument, in messages."""
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
