"""The keys of a terminal, one at a time."""

import codecs
import re
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

UP, DOWN, RIGHT, LEFT = "up", "down", "right", "left"

NextKey = Callable[[float], str | None]
"""Waits at most so many seconds for a key. Returns the name of an arrow key, a character, another
escape sequence, or None if no key was pressed."""

_INTERRUPT = "\x03"


if sys.platform == "win32":
    import msvcrt

    _ARROWS = {"H": UP, "P": DOWN, "M": RIGHT, "K": LEFT}

    @contextmanager
    def keyboard() -> Iterator[NextKey]:
        """Yield a function that waits for keys. It raises KeyboardInterrupt for Ctrl-C."""
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
        """Yield a function that waits for keys, which the terminal does not echo meanwhile.

        It raises KeyboardInterrupt for Ctrl-C, and EOFError if the terminal is closed.
        """
        descriptor = sys.stdin.fileno()
        before = termios.tcgetattr(descriptor)
        mode = termios.tcgetattr(descriptor)
        # Ctrl-Z, too, is a key: suspended, the game would not restore the screen.
        mode[3] &= ~(termios.ICANON | termios.ECHO | termios.ISIG)
        mode[6][termios.VMIN], mode[6][termios.VTIME] = 1, 0
        try:
            termios.tcsetattr(descriptor, termios.TCSADRAIN, mode)
            yield _Keys(descriptor)
        finally:
            # Fails if the terminal is closed. Keys that were pressed too late for the game are
            # discarded, so that they are not typed into the shell.
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
                # There may be less than a whole character.
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
            """Read what is there or comes in time. Return False if nothing was."""
            if not select.select([self._descriptor], [], [], seconds)[0]:
                return False
            data = b""
            # A closed terminal either gives nothing or cannot be read.
            with suppress(OSError):
                data = os.read(self._descriptor, 1024)
            if not data:
                raise EOFError("the terminal is closed")
            self._text += self._decode(data)
            return True
