"""A game in a terminal of its own: pressed keys, and what is on the screen then."""

from __future__ import annotations

import codecs
import os
import re
import select
import struct
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType

import pytest

from support.sessions import environment

pty = pytest.importorskip("pty", reason="this system has no pseudo-terminals")
fcntl = pytest.importorskip("fcntl")
termios = pytest.importorskip("termios")

COMMAND = [sys.executable, "-m", "babyrobot_levels", "play"]
UP, DOWN, RIGHT, LEFT = (b"\x1b[A", b"\x1b[B", b"\x1b[C", b"\x1b[D")
ENTER, LEAVE = "\x1b[?1049h", "\x1b[?1049l"
HIDE, SHOW = "\x1b[?25l", "\x1b[?25h"


class Game:
    """The command in a terminal of its own, and what it has sent there.

    What is `given` comes through standard input, which is the terminal otherwise.
    """

    def __init__(
        self,
        folder: Path,
        *arguments: str,
        size: tuple[int, int] = (80, 24),
        given: bytes | None = None,
        **variables: str,
    ) -> None:
        self.outer, self.inner = pty.openpty()
        self.resize(*size)
        self.before = termios.tcgetattr(self.inner)
        self.sent = ""
        self.decode = codecs.getincrementaldecoder("utf-8")().decode
        self.process = subprocess.Popen(
            [*COMMAND, *arguments],
            cwd=folder,
            env=environment(folder, TERM="xterm-256color") | variables,
            stdin=self.inner if given is None else subprocess.PIPE,
            stdout=self.inner,
            stderr=self.inner,
            start_new_session=given is not None,
            preexec_fn=self.hold if given is not None else None,
        )
        if self.process.stdin is not None:
            with self.process.stdin as stream:
                stream.write(given or b"")

    @staticmethod
    def hold() -> None:
        """Make the terminal the one by which the process can be reached."""
        fcntl.ioctl(1, termios.TIOCSCTTY, 0)

    def __enter__(self) -> Game:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        self.process.kill()
        self.process.wait()
        for descriptor in (self.outer, self.inner):
            if descriptor >= 0:
                os.close(descriptor)

    def resize(self, columns: int, lines: int) -> None:
        fcntl.ioctl(self.inner, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))

    def press(self, keys: bytes) -> None:
        os.write(self.outer, keys)

    def listen(self, seconds: float = 0.1) -> None:
        while select.select([self.outer], [], [], seconds)[0]:
            # What is there may end in the middle of a character.
            self.sent += self.decode(os.read(self.outer, 1 << 16))

    def until(self, text: str) -> str:
        """Wait until a text is on the screen, and return the screen without its colours."""
        end = time.monotonic() + 30
        while text not in self.screen:
            assert time.monotonic() < end, f"no {text!r} on the screen:\n{self.screen}"
            self.listen()
        return self.screen

    @property
    def screen(self) -> str:
        """The screen as it was drawn last."""
        last = self.sent.rpartition("\x1b[H")[2].replace("\r\n", "\n")
        return re.sub(r"\x1b\[[0-9;]*[a-zA-Z]", "", last)

    def ended(self) -> tuple[int, str]:
        """Wait for the end; return the exit status and what was written after the screen.

        It goes on reading: a terminal that nobody reads is full at some time, and then the
        game waits for it.
        """
        end = time.monotonic() + 30
        while (status := self.process.poll()) is None:
            assert time.monotonic() < end, f"the game goes on:\n{self.screen}"
            self.listen()
        self.listen()
        return status, self.sent.rpartition(LEAVE)[2].replace("\r\n", "\n")

    @property
    def is_restored(self) -> bool:
        """Whether the terminal is as it was: its modes, its screen, its cursor."""
        modes: bool = termios.tcgetattr(self.inner) == self.before
        screens = self.sent.count(ENTER) == self.sent.count(LEAVE) == 1
        return modes and screens and self.sent.rfind(SHOW) > self.sent.rfind(HIDE)
