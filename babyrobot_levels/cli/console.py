"""What all commands share: output, colour, and how they end."""

from __future__ import annotations

import json
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from babyrobot_levels.render.terminal import speaks_unicode as speaks_unicode
from babyrobot_levels.render.terminal import wants_color as wants_color
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.source import printable

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
