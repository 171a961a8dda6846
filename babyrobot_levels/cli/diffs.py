"""What a command would change in a file, as unified diffs."""

from __future__ import annotations

import difflib

from babyrobot_levels.source import printable

_RESET = "\x1b[0m"
_STYLES = {"---": "\x1b[1m", "+++": "\x1b[1m", "@@": "\x1b[36m", "-": "\x1b[31m", "+": "\x1b[32m"}


def unified(before: str, after: str, name: str, *, color: bool = False) -> str:
    """Return the changes from one text to another as a unified diff.

    Control characters are shown as escapes, so that no file can move the reader's cursor.
    """
    lines = difflib.unified_diff(
        before.splitlines(), after.splitlines(), printable(name), printable(name), lineterm=""
    )
    return "".join(f"{_painted(printable(line), color)}\n" for line in lines)


def _painted(line: str, color: bool) -> str:
    style = next((style for sign, style in _STYLES.items() if line.startswith(sign)), None)
    return f"{style}{line}{_RESET}" if color and style else line
