"""What the commands share: exit statuses, output, styles, tables, unified diffs."""

import difflib
import json
import math
import re
import struct
import sys
import textwrap
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import IO, Annotated, Any, NoReturn

import typer

from babyrobot_levels.render.terminal import moves_cursor, room_of
from babyrobot_levels.render.terminal import speaks_unicode as speaks_unicode
from babyrobot_levels.render.terminal import wants_color as wants_color
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.source import columns, printable

FINDINGS = 1
"""Exit status: the level or levels have findings."""
WRONG_CALL = 2
"""Exit status: the call is wrong."""


def value_option(metavar: str | None, help_text: str, *names: str, **more: Any) -> Any:
    """Return an option with a value, whose help itself says what holds without it."""
    return typer.Option(*names, metavar=metavar, help=help_text, show_default=False, **more)


def flag(name: str, help_text: str) -> Any:
    """Return an option without a value."""
    return typer.Option(name, help=help_text)


def not_one_of(word: str, known: Iterable[str]) -> NoReturn:
    """Refuse a value of an option, as typer refuses what is none of its choices.

    Raises:
        typer.BadParameter: always.
    """
    raise typer.BadParameter(f"{word!r} is not one of {', '.join(map(repr, known))}.")


class ReportFormat(StrEnum):
    """Output format of a command that reports."""

    TEXT = "text"
    JSON = "json"


FormatOption = Annotated[ReportFormat, typer.Option("--format", help="Output format.")]
"""The option of commands that report."""


class TableFormat(StrEnum):
    """Output format of a command that can write a table."""

    TEXT = "text"
    CSV = "csv"
    JSON = "json"


TableOption = Annotated[TableFormat, typer.Option("--format", help="Output format.")]


STANDARD_OUTPUT = Path("-")


def _file(path: Path | None) -> Path | None:
    """Return the file, None for standard output."""
    return None if path == STANDARD_OUTPUT else path


def output_option(help_text: str) -> Any:
    """Return the option -o for a file, in which `-` is standard output."""
    return value_option("FILE", help_text, "--output", "-o", callback=_file)


OutputOption = Annotated[
    Path | None, output_option("Write to this file.  [default: -, standard output]")
]
ForceOption = Annotated[bool, flag("--force", "Overwrite existing files.")]
"""The options of the commands that write a file."""


def width_of(stream: IO[str]) -> int | None:
    """Return the columns to which texts are cut; None for none, where it is no terminal."""
    return room_of(stream).columns if stream.isatty() and speaks_unicode(stream) else None


def write(text: str) -> None:
    """Write to standard output."""
    sys.stdout.write(text)


def write_json(data: Any) -> None:
    """Write data as JSON to standard output."""
    # Only ASCII, so that it is the same whatever the terminal's encoding is.
    write(json.dumps(data, indent=2) + "\n")


def note(text: str) -> None:
    """Write a line to standard error, for what is not the command's result."""
    sys.stderr.write(printable(text) + "\n")


def fail(message: str, help_text: str | None = None) -> NoReturn:
    """End the command with status 2 and an error message."""
    prefix = styled("error", sys.stderr, fg="red", bold=True)
    sys.stderr.write(f"{prefix}: {one_line(message)}\n")
    if help_text:
        note(f"  help: {one_line(help_text)}")
    raise typer.Exit(WRONG_CALL)


def put(
    made: str | bytes, output: Path | None, what: str = "PNG", *, force: bool | None = None
) -> None:
    """Write what was made to a file, or to standard output; but no picture to a terminal.

    Args:
        made: a text or a picture.
        output: the file; None for standard output.
        what: the name of its format, in messages.
        force: as that of `save`.
    """
    if output is not None:
        save(output, made, force=force)
    elif isinstance(made, str):
        write(made)
    elif sys.stdout.isatty():
        fail(f"a {what} cannot be shown in a terminal", "save it with -o FILE")
    else:
        sys.stdout.buffer.write(made)


def save(path: Path, data: str | bytes, *, force: bool | None = None) -> None:
    """Write a file atomically, and a line about it.

    Args:
        path: the file.
        data: its contents.
        force: whether to overwrite a file; None for a picture or page, which overwrites what has
            the suffix of one.
    """
    from babyrobot_levels.analysis.picture_formats import SUFFIXES
    from babyrobot_levels.text.files import write_bytes

    if path == STANDARD_OUTPUT:
        fail("this output cannot be written to standard output", "give the path of a file")
    content = data.encode("utf-8") if isinstance(data, str) else data
    try:
        if path.is_dir():
            fail(f"{path} is a folder", "give the path of a file")
        if path.exists() and not path.is_file():
            fail(f"{path} exists and is not a regular file")
        if path.exists() and force is None and path.suffix.lower() not in SUFFIXES:
            fail(f"{path} already exists, and is not a picture", "give the path of another file")
        if path.exists() and force is False:
            fail(f"{path} already exists", "use --force to overwrite it")
        write_bytes(path, content)
    except typer.Exit:
        raise
    except (OSError, RuntimeError) as error:
        fail(f"{path} cannot be written ({getattr(error, 'strerror', None) or error})")
    facts = _facts_of(content)
    if not speaks_unicode(sys.stderr):
        facts = facts.replace("×", "x")
    note(f"wrote {one_line(str(path))} ({facts})")


_PNG, _GIF = b"\x89PNG\r\n\x1a\n", b"GIF89a"
_SVG_SIZE = rb'<svg [^>]*?width="([\d.]+)" height="([\d.]+)"'


def _facts_of(data: bytes) -> str:
    """Return the size of a file: the pixels of a picture, and the bytes."""
    size = _pixels(data)
    shown = _in_bytes(len(data))
    return f"{size[0]:g} × {size[1]:g}, {shown}" if size else shown


def _pixels(data: bytes) -> tuple[float, float] | None:
    """Return width and height of a picture; None for other files."""
    if data.startswith(_PNG):
        width, height = struct.unpack(">II", data[16:24])
        return width, height
    if data.startswith(_GIF):
        width, height = struct.unpack("<HH", data[6:10])
        return width, height
    found = re.match(_SVG_SIZE, data)
    return (round(float(found[1])), round(float(found[2]))) if found else None


def _in_bytes(count: int) -> str:
    if count < 1000:
        return "1 byte" if count == 1 else f"{count} bytes"
    kilobytes = count / 1000
    if kilobytes < 999.5:
        return f"{kilobytes:.1f} KB" if kilobytes < 9.95 else f"{kilobytes:.0f} KB"
    return f"{kilobytes / 1000:.1f} MB"


def quoted(word: Path | str) -> str:
    """Return a word of a command to type, quoted for the system's shell."""
    if sys.platform == "win32":
        from subprocess import list2cmdline

        return one_line(list2cmdline([str(word)]))
    from shlex import quote

    return one_line(quote(str(word)))


def styled(text: str, stream: IO[str] | None = None, **style: Any) -> str:
    """Return a text in a style such as `bold=True` if a stream takes colour, else as it is."""
    return typer.style(text, **style) if wants_color(stream or sys.stdout) else text


def bold(text: str) -> str:
    """Return a text in bold if standard output takes colour."""
    return styled(text, bold=True)


def short(value: float | None) -> str:
    """Return a number for a table; `-` where there is none."""
    return "-" if value is None or math.isnan(value) else f"{value:.4g}"


def percent(value: float | None) -> str:
    """Return a share for a table, in percent; `-` where there is none."""
    return "-" if value is None or math.isnan(value) else f"{100 * value:.3g} %"


def fact_lines(facts: Mapping[str, str]) -> str:
    """Return names and values, one below the other, with the values aligned."""
    indent = max(map(len, facts)) + 2
    return "".join(
        bold(f"{name}:".ljust(indent - 1)) + hanging(value, indent) + "\n"
        for name, value in facts.items()
        if value
    )


def hanging(text: str, indent: int) -> str:
    """Return a text behind the name that it belongs to, with the blanks before its lines.

    On a terminal, lines break between words, and a word without room has a line of its own.

    Args:
        text: the text.
        indent: the column in which its lines begin.
    """
    width = width_of(sys.stdout)
    before = f"\n{' ' * indent}"
    if width is not None:
        room = max(width - indent, _LEAST)
        if any(columns(word) > room for word in text.split()):
            before, room = "\n  ", max(width - 2, _LEAST)
            text = "\n" + text
        text = "\n\n".join(_broken(part, room) for part in text.split("\n\n"))
    return " " * (not text.startswith("\n")) + text.replace("\n", before)


def _broken(paragraph: str, room: int) -> str:
    """Return a paragraph whose lines are broken anew if one of them has no room."""
    if all(columns(line) <= room for line in paragraph.split("\n")):
        return paragraph
    indent = "\n" * paragraph.startswith("\n")
    return indent + textwrap.fill(paragraph, room, break_long_words=False, break_on_hyphens=False)


def write_table(
    heading: Sequence[str],
    rows: Sequence[Sequence[str]],
    less: Sequence[str] = (),
    groups: Sequence[str] = (),
) -> None:
    """Write a table to standard output, one line for each row.

    On a terminal it is as wide as there is room: texts of the columns `less` are cut between
    words, those of the first one first, and a column without room is left out. `groups` has the
    group of each row: it stands above its rows.
    """
    cells = [list(heading), *(list(row) for row in rows)]
    width = width_of(sys.stdout)
    for name in less:
        if width is not None:
            _narrow(cells, cells[0].index(name), width)
    first, *lines = _table(cells).splitlines()
    for number, group in reversed([*enumerate(groups)]):
        if number == 0 or groups[number - 1] != group:
            lines[number:number] = [*([""] if number else []), bold(f"{group}:")]
    write("\n".join([first, *lines]) + "\n")


_LEAST = 16
"""The least columns in which a cut text says something."""


def _narrow(cells: list[list[str]], column: int, width: int) -> None:
    """Cut the texts of a column, or remove it, if a table is too wide."""
    widths = [max(map(columns, texts)) for texts in zip(*cells, strict=True)]
    room = width - (sum(widths) - widths[column] + 2 * (len(widths) - 1))
    if room >= widths[column]:
        return
    for row in cells:
        if room < _LEAST:
            del row[column]
        else:
            row[column] = cut_to(row[column], room)


def cut_to(text: str, room: int) -> str:
    """Return a text that takes at most so many columns, cut after a word."""
    if columns(text) <= room:
        return text
    while columns(text) > room - 1:
        before, _, _ = text.rpartition(" ")
        text = before or text[:-1]
    return text.rstrip(" ,") + "…"


def _table(rows: Sequence[Sequence[str]]) -> str:
    """Return rows of cells as a text with aligned columns; the first row is the heading."""
    widths = [max(columns(row[number]) for row in rows) for number in range(len(rows[0]))]
    lines = [
        "  ".join(
            text + " " * (width - columns(text)) for text, width in zip(row, widths, strict=True)
        ).rstrip()
        for row in rows
    ]
    lines[0] = bold(lines[0])
    return "\n".join(lines) + "\n"


_STYLES: dict[str, dict[str, Any]] = {
    "---": {"bold": True},
    "+++": {"bold": True},
    "@@": {"fg": "cyan"},
    "-": {"fg": "red"},
    "+": {"fg": "green"},
}


def unified(before: str, after: str, name: str, *, color: bool = False) -> str:
    """Return the changes from one text to another as a unified diff.

    Control characters are shown as escapes, so that no file can move the reader's cursor.
    """
    shown = one_line(name)
    lines = difflib.unified_diff(_lines(before), _lines(after), shown, shown)
    return "".join(f"{_painted(text, color)}\n" for line in lines for text in _texts(line))


def _lines(text: str) -> list[str]:
    """Return the lines of a text with their line ends, which may be all that changes."""
    lines = [f"{line}\n" for line in text.split("\n")]
    last = lines.pop().removesuffix("\n")
    return [*lines, last] if last else lines


def _texts(line: str) -> Iterator[str]:
    yield printable(line.removesuffix("\n"))
    if not line.endswith("\n"):
        yield "\\ No newline at end of file"


def _painted(line: str, color: bool) -> str:
    style = next((style for sign, style in _STYLES.items() if line.startswith(sign)), None)
    return typer.style(line, **style) if color and style else line


PAUSE = 0.2
"""Seconds between two checks of the files."""


def each_change(files: Callable[[], list[Path]]) -> Iterator[list[Path]]:
    """Yield the files immediately, and again whenever one is saved, added or removed.

    On a terminal, the screen is cleared before each round except the first. Stop with Ctrl-C.

    Args:
        files: returns the files to watch.
    """
    shown = files()
    seen = _state(shown)
    while True:
        yield shown
        sys.stdout.flush()
        while True:
            time.sleep(PAUSE)
            shown = files()
            state = _state(shown)
            if state != seen:
                break
        seen = state
        if moves_cursor(sys.stdout):
            sys.stdout.write("\x1b[2J\x1b[H")


def _state(files: list[Path]) -> dict[Path, tuple[int, int] | None]:
    """Return the modification time and the size of each file, None if there is no such file."""
    state: dict[Path, tuple[int, int] | None] = {}
    for path in files:
        try:
            status = path.stat()
            state[path] = (status.st_mtime_ns, status.st_size)
        except OSError:
            state[path] = None
    return state
