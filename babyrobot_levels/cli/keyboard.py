"""Keys, one at a time as they are pressed: the only module that knows the systems' keyboards."""

from __future__ import annotations

import codecs
import re
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

UP, DOWN, RIGHT, LEFT = "up", "down", "right", "left"

NextKey = Callable[[float], str | None]
"""Waits for a key, at most so many seconds. Returns an arrow's name, a character, an escape
sequence that means neither, or None if no key was pressed."""

_INTERRUPT = "\x03"


if sys.platform == "win32":
    import msvcrt

    _ARROWS = {"H": UP, "P": DOWN, "M": RIGHT, "K": LEFT}

    @contextmanager
    def keyboard() -> Iterator[NextKey]:
        """Give what waits for keys. The function raises KeyboardInterrupt for Ctrl-C."""
        yield _next_key

    def _next_key(seconds: float) -> str | None:
        end = time.monotonic() + seconds
        while not msvcrt.kbhit():
            if time.monotonic() >= end:
                return None
            time.sleep(0.01)
        key = msvcrt.getwch()
        if key == _INTERRUPT:
            raise KeyboardInterrupt
        if key in ("\x00", "\xe0"):
            key = msvcrt.getwch()
            return _ARROWS.get(key, f"\x00{key}")
        return key

else:
    import os
    import select
    import termios

    _ARROWS = {"A": UP, "B": DOWN, "C": RIGHT, "D": LEFT}
    _KEY = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]|\x1bO[@-~]|.", re.DOTALL)
    _UNFINISHED = re.compile(r"\x1b(?:\[[0-?]*[ -/]*|O)?")
    _REST_OF_A_SEQUENCE = 0.05

    @contextmanager
    def keyboard() -> Iterator[NextKey]:
        """Give what waits for keys, while the terminal sends each at once and shows none.

        The function raises KeyboardInterrupt for Ctrl-C and EOFError when the terminal is gone.
        """
        descriptor = sys.stdin.fileno()
        before = termios.tcgetattr(descriptor)
        mode = termios.tcgetattr(descriptor)
        # Ctrl-Z, too, is a key: it would leave the screen as the game has it.
        mode[3] &= ~(termios.ICANON | termios.ECHO | termios.ISIG)
        mode[6][termios.VMIN], mode[6][termios.VTIME] = 1, 0
        try:
            termios.tcsetattr(descriptor, termios.TCSADRAIN, mode)
            yield _Keys(descriptor)
        finally:
            # A terminal that is gone needs no more. On one that is not, what was pressed too
            # late for the game shall not be typed into the shell.
            with suppress(termios.error):
                termios.tcsetattr(descriptor, termios.TCSAFLUSH, before)

    class _Keys:
        """Reads keys from a terminal."""

        def __init__(self, descriptor: int) -> None:
            self._descriptor = descriptor
            self._decode = codecs.getincrementaldecoder("utf-8")("replace").decode
            self._text = ""

        def __call__(self, seconds: float) -> str | None:
            end = time.monotonic() + seconds
            while not self._text:
                # Not even a whole character may have come.
                if not self._read(max(0.0, end - time.monotonic())):
                    return None
            while _UNFINISHED.fullmatch(self._text) and self._read(_REST_OF_A_SEQUENCE):
                pass
            found = _KEY.match(self._text)
            key = found[0] if found else self._text
            self._text = self._text[len(key) :]
            if key == _INTERRUPT:
                raise KeyboardInterrupt
            return _ARROWS.get(key[-1], key) if len(key) > 2 else key

        def _read(self, seconds: float) -> bool:
            """Take what is there, or what comes in time. Return whether anything was."""
            if not select.select([self._descriptor], [], [], seconds)[0]:
                return False
            data = b""
            # A terminal that is gone either gives nothing or cannot be read.
            with suppress(OSError):
                data = os.read(self._descriptor, 1024)
            if not data:
                raise EOFError("the terminal is gone")
            self._text += self._decode(data)
            return True
