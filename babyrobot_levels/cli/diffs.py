"""What a command would change in a file, as unified diffs."""

from __future__ import annotations

import difflib
from collections.abc import Iterator

from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.source import printable

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
