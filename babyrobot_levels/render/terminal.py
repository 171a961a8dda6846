"""Drawings on a terminal, each replacing the previous one; in files and pipes, one after another.

This is the only module of the library that writes to standard output: `"human"` rendering does.
"""

import os
import re
import sys
import time
from collections.abc import Sequence
from typing import IO

RESET = "\x1b[0m"
_TOKEN = r"\x1b\[[0-9;]*m|."
_ROOM = os.terminal_size((80, 24))
_PROCESSED_AND_VIRTUAL = 0x1 | 0x4
"""The modes in which a Windows console processes control characters and escape sequences."""


if sys.platform == "win32":

    def _knows_escapes(stream: IO[str]) -> bool:
        """Enable escape sequences on the console of a stream; return whether that worked."""
        import ctypes
        import msvcrt

        kernel, mode = ctypes.windll.kernel32, ctypes.c_ulong()
        try:
            console = msvcrt.get_osfhandle(stream.fileno())
        except (OSError, ValueError):
            return False
        # Not every terminal is a console: NUL counts as a terminal, too.
        if not kernel.GetConsoleMode(console, ctypes.byref(mode)):
            return False
        return bool(kernel.SetConsoleMode(console, mode.value | _PROCESSED_AND_VIRTUAL))

else:

    def _knows_escapes(stream: IO[str]) -> bool:
        return True


SIXTEEN, PALETTE, ALL_COLORS = 16, 256, 1 << 24
"""How many colours a terminal may show."""

_FULL_TERMS = ("alacritty", "foot", "ghostty", "iterm", "kitty", "wezterm", "contour", "rio")
_FULL_PROGRAMS = ("ghostty", "iTerm.app", "rio", "vscode", "WezTerm")
"""Terminals that show all colours, as they call themselves in TERM and in TERM_PROGRAM."""


def colors_of(stream: IO[str]) -> int:
    """Return how many colours to use: none if `NO_COLOR` is set, or the stream is no terminal.

    With `FORCE_COLOR`, other streams get all colours.
    """
    if os.environ.get("NO_COLOR"):
        return 0
    if moves_cursor(stream):
        return _colors_of_terminal()
    return ALL_COLORS if os.environ.get("FORCE_COLOR", "0") not in ("", "0") else 0


def wants_color(stream: IO[str]) -> bool:
    """Return whether to use colours."""
    return colors_of(stream) > 0


def _colors_of_terminal() -> int:
    environment, term = os.environ, os.environ.get("TERM", "").lower()
    if (
        environment.get("COLORTERM", "").lower() in ("truecolor", "24bit")
        or term.endswith("-direct")
        or any(name in term for name in _FULL_TERMS)
        or environment.get("TERM_PROGRAM") in _FULL_PROGRAMS
        or "WT_SESSION" in environment
        or sys.platform == "win32"
    ):
        return ALL_COLORS
    return PALETTE if "256" in term else SIXTEEN


def speaks_unicode(stream: IO[str]) -> bool:
    """Return whether the stream can encode box-drawing characters."""
    encoding = (getattr(stream, "encoding", None) or "ascii").lower().replace("-", "")
    return encoding.startswith("utf")


def moves_cursor(stream: IO[str]) -> bool:
    """Return whether the stream is a terminal on which a drawing can replace the previous one."""
    return stream.isatty() and os.environ.get("TERM") != "dumb" and _knows_escapes(stream)


def room_of(stream: IO[str]) -> os.terminal_size:
    """Return the columns and lines of a terminal; 80 and 24 if they are unknown."""
    try:
        size = os.get_terminal_size(stream.fileno())
    except (OSError, ValueError):
        return _ROOM
    return size if all(size) else _ROOM


def cut_out(lines: Sequence[str], left: int, top: int, width: int, height: int) -> list[str]:
    """Return a part of a picture, with its colours; `left` is a column, `top` a line."""
    return [_cut(line, left, width) for line in lines[top : top + height]]


def _cut(line: str, left: int, width: int) -> str:
    """Return `width` columns of a line from `left`; every character takes one."""
    style, column = "", 0
    kept: list[str] = []
    for token in re.findall(_TOKEN, line):
        if token.startswith("\x1b"):
            style = token
            if kept:
                kept.append(token)
            continue
        if left <= column < left + width:
            kept += [token] if kept else [style, token]
        column += 1
    return "".join(kept) + (RESET if style else "")


def _encodable(text: str, stream: IO[str]) -> str:
    """Return a text with `?` for each character that the stream cannot encode."""
    encoding = getattr(stream, "encoding", None)
    return text.encode(encoding, "replace").decode(encoding) if encoding else text


class Terminal:
    """Shows drawings on the standard output of the time it is created.

    On a terminal each drawing replaces the previous one, which stays for the requested time. In
    files and pipes, drawings are written one after another, immediately and without control
    characters. Without a standard output nothing happens.
    """

    def __init__(self) -> None:
        self._stream: IO[str] | None = sys.stdout
        self._moves_cursor = self._stream is not None and moves_cursor(self._stream)
        self._height = 0
        self._due = 0.0

    @property
    def room(self) -> os.terminal_size | None:
        """The columns and lines available for a drawing; None for no limit."""
        if self._stream is None or not self._moves_cursor:
            return None
        columns, lines = room_of(self._stream)
        # The cursor is on the line below.
        return os.terminal_size((columns, max(1, lines - 1)))

    @property
    def colors(self) -> int:
        """How many colours drawings may have."""
        return colors_of(self._stream) if self._stream is not None and self._moves_cursor else 0

    @property
    def takes_unicode(self) -> bool:
        """Whether drawings may have non-ASCII characters."""
        return self._stream is not None and speaks_unicode(self._stream)

    def show(self, lines: Sequence[str], seconds: float) -> None:
        """Show a drawing.

        Args:
            lines: its lines; on a terminal at most as many as `room` allows.
            seconds: how long it stays on a terminal before the next one may replace it.
        """
        if self._stream is None:
            return
        lines = [_encodable(line, self._stream) for line in lines]
        if not self._moves_cursor:
            self._stream.write("".join(f"{line}\n" for line in lines) + "\n")
            return
        time.sleep(max(0.0, self._due - time.monotonic()))
        self._due = time.monotonic() + seconds
        up = f"\x1b[{self._height}A" if self._height else ""
        self._stream.write(up + "\r" + "".join(f"{line}\x1b[K\n" for line in lines) + "\x1b[J")
        self._stream.flush()
        self._height = len(lines)
