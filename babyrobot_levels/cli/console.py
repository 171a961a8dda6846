"""What all commands share: output, styles, tables, differences of texts, and exit statuses."""

from __future__ import annotations

import difflib
import json
import sys
from collections.abc import Iterator, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from babyrobot_levels.render.terminal import speaks_unicode as speaks_unicode
from babyrobot_levels.render.terminal import wants_color as wants_color
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.source import columns, printable

FINDINGS = 1
"""Exit status: the level or levels have findings."""
WRONG_CALL = 2
"""Exit status: the call is wrong."""


class ReportFormat(StrEnum):
    """How a command reports."""

    TEXT = "text"
    JSON = "json"


FormatOption = Annotated[ReportFormat, typer.Option("--format", help="How to report.")]
"""The option that every command has that reports."""


STANDARD_OUTPUT = Path("-")


def _file(path: Path | None) -> Path | None:
    """Return the file that is meant, None for standard output."""
    return None if path == STANDARD_OUTPUT else path


OutputOption = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="FILE",
        callback=_file,
        help="Write to a file.  [default: -, standard output]",
        show_default=False,
    ),
]
ForceOption = Annotated[bool, typer.Option("--force", help="Overwrite the file.")]
"""The options of the commands that write a file."""


def write(text: str) -> None:
    """Write to standard output, as it is."""
    sys.stdout.write(text)


def write_json(data: Any) -> None:
    """Write data as JSON to standard output."""
    # Only ASCII, so that it is the same whatever the terminal's encoding is.
    write(json.dumps(data, indent=2) + "\n")


def note(text: str) -> None:
    """Write a line to standard error: for what is not the command's result."""
    sys.stderr.write(printable(text) + "\n")


def fail(message: str, help_text: str | None = None) -> NoReturn:
    """End the command because the call is wrong, and say why."""
    prefix = "\x1b[1;31merror\x1b[0m" if wants_color(sys.stderr) else "error"
    sys.stderr.write(f"{prefix}: {one_line(message)}\n")
    if help_text:
        note(f"  help: {one_line(help_text)}")
    raise typer.Exit(WRONG_CALL)


def save(path: Path, data: str | bytes, *, force: bool) -> None:
    """Write a file whole, but never over one that is there without `--force`."""
    from babyrobot_levels.text.files import write_bytes

    if path == STANDARD_OUTPUT:
        fail("this is not written to standard output", "name a file")
    try:
        if path.is_dir():
            fail(f"{path} is a folder", "name a file in it")
        if path.exists() and not path.is_file():
            fail(f"{path} is not a regular file, and is left alone")
        if path.exists() and not force:
            fail(f"{path} is there already", "write it anew with --force")
        write_bytes(path, data.encode("utf-8") if isinstance(data, str) else data)
    except typer.Exit:
        raise
    except (OSError, RuntimeError) as error:
        fail(f"{path} cannot be written ({getattr(error, 'strerror', None) or error})")


def table(rows: Sequence[Sequence[str]]) -> str:
    """Return rows of cells as a text with aligned columns; the first row is the heading."""
    widths = [max(columns(row[number]) for row in rows) for number in range(len(rows[0]))]
    lines = [
        "  ".join(
            text + " " * (width - columns(text)) for text, width in zip(row, widths, strict=True)
        ).rstrip()
        for row in rows
    ]
    if wants_color(sys.stdout):
        lines[0] = f"\x1b[1m{lines[0]}\x1b[0m"
    return "\n".join(lines) + "\n"


_RESET = "\x1b[0m"
_STYLES = {"---": "\x1b[1m", "+++": "\x1b[1m", "@@": "\x1b[36m", "-": "\x1b[31m", "+": "\x1b[32m"}


def unified(before: str, after: str, name: str, *, color: bool = False) -> str:
    """Return the changes from one text to another as a unified diff.

    Control characters are shown as escapes, so that no file can move the reader's cursor.
    """
    shown = one_line(name)
    lines = difflib.unified_diff(_lines(before), _lines(after), shown, shown)
    return "".join(f"{_painted(text, color)}\n" for line in lines for text in _texts(line))


def _lines(text: str) -> list[str]:
    """Return the lines of a text with their ends, which can be all that changes."""
    lines = [f"{line}\n" for line in text.split("\n")]
    last = lines.pop().removesuffix("\n")
    return [*lines, last] if last else lines


def _texts(line: str) -> Iterator[str]:
    yield printable(line.removesuffix("\n"))
    if not line.endswith("\n"):
        yield "\\ No newline at end of file"


def _painted(line: str, color: bool) -> str:
    style = next((style for sign, style in _STYLES.items() if line.startswith(sign)), None)
    return f"{style}{line}{_RESET}" if color and style else line
