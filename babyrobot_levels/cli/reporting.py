"""The arguments and the output of commands that check files."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, TYPE_CHECKING, Annotated, Literal

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import fail, note, wants_color, width_of, write
from babyrobot_levels.text.diagnostics import Severity, one_line

if TYPE_CHECKING:
    from babyrobot_levels.text.source import SourceFile

_RESET = "\x1b[0m"
_BOLD = "\x1b[1m"
_COLORS = {
    Severity.ERROR: "\x1b[1;31m",
    Severity.WARNING: "\x1b[1;33m",
    Severity.INFO: "\x1b[1;36m",
}
_CYAN = "\x1b[36m"

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


FindingsFormat = Literal["text", "json", "github", "sarif", "junit"]
"""The output format of findings."""


FindingsOption = Annotated[
    FindingsFormat,
    typer.Option(
        "--format",
        help="Output format: text, JSON, GitHub Actions annotations, SARIF 2.1.0, or JUnit XML.",
    ),
]


def write_report(
    kind: FindingsFormat,
    diagnostics: Sequence[brl.Diagnostic],
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
    if kind == "text":
        report = findings_text(diagnostics, sys.stdout)
        last = summary(diagnostics, len(files), clean)
        write(report + ("\n" if report else "") + last + "\n" + (ending and ending + "\n"))
        return
    from babyrobot_levels import __version__
    from babyrobot_levels.linter.reporters import render

    described: dict[str, str] = {}
    # Only these two describe codes.
    if kind in ("github", "sarif"):
        from babyrobot_levels.linter.rules import titles

        described = titles()
    write(render(kind, diagnostics, [shown_name(path) for path in files], described, __version__))


def findings_text(diagnostics: Iterable[brl.Diagnostic], stream: IO[str]) -> str:
    """Return findings as text, separated by blank lines; empty if there are none.

    On a terminal they are in colour, and source lines are cut to its width.
    """
    color, width = wants_color(stream), width_of(stream)
    shown = [_colored(each, width) if color else each.shown(width) for each in diagnostics]
    return "\n\n".join(shown) + "\n" if shown else ""


def summary(diagnostics: Sequence[brl.Diagnostic], files: int, clean: str = "valid") -> str:
    """Return the last line of a report: the number of findings and files.

    `clean` is the word for files without findings.
    """
    if not diagnostics:
        return f"{files} files checked, all {clean}" if files != 1 else f"1 file checked, {clean}"
    counts = [
        (sum(d.severity is severity for d in diagnostics), str(severity)) for severity in Severity
    ]
    listed = ", ".join(f"{n} {what}{'s' if n > 1 else ''}" for n, what in counts if n)
    affected = len({d.file for d in diagnostics})
    return f"{listed} in 1 file" if files == 1 else f"{listed} in {affected} of {files} files"


def _colored(diagnostic: brl.Diagnostic, width: int | None) -> str:
    color = _COLORS[diagnostic.severity]
    head = (
        f"{_BOLD}{one_line(diagnostic.location)}{_RESET}: "
        f"{color}{diagnostic.severity} {diagnostic.code}{_RESET}: "
        f"{_BOLD}{one_line(diagnostic.message)}{_RESET}"
    )
    _, *rest = diagnostic.shown(width).split("\n")
    lines = [head]
    for line in rest:
        word, colon, content = line.lstrip().partition(": ")
        if colon and word in ("help", "fix"):
            lines.append(f"  {_CYAN}{word}{_RESET}: {content}")
        else:
            gutter, bar, text = line.partition("|")
            is_caret = text.strip() and not text.strip("^ ")
            shown = f"{color}{text}{_RESET}" if is_caret else text
            lines.append(f"{_CYAN}{gutter}{bar}{_RESET}{shown}")
    return "\n".join(lines)


def level_paths(paths: Sequence[Path] | None) -> list[Path]:
    """Return the given files, and all level files below the given folders."""
    from babyrobot_levels.text.files import is_folder

    files: dict[Path, None] = {}
    for path in paths or [DEFAULT_FOLDER]:
        if is_folder(path):
            from babyrobot_levels.library.search_path import yaml_files

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

    with suppress(brl.LevelNotFoundError):
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

    if path != STANDARD_INPUT:
        return read_source(path)
    return source_of(path_bytes(path), shown_name(path))


def path_bytes(path: Path) -> bytes:
    """Return what is in a file, or on standard input for `-`; of more than a level may have, less.

    Raises:
        LevelError: it cannot be read.
    """
    from babyrobot_levels.text.files import read_data
    from babyrobot_levels.text.source import MAX_BYTES

    if path != STANDARD_INPUT:
        return read_data(path, str(path))
    if sys.stdin is None:
        fail("standard input is closed")
    return sys.stdin.buffer.read(MAX_BYTES + 1)
