"""`babyrobot replay` on a terminal: the episode is shown step by step."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.sessions import FILES, environment

pty = pytest.importorskip("pty", reason="this system has no pseudo-terminals")

PLAY = FILES / "plays" / "ben.brlplay"
COMMAND = [sys.executable, "-m", "babyrobot_levels", "replay", str(PLAY)]


def shown(
    folder: Path, *arguments: str, interrupt: bool = False, term: str = "xterm-256color"
) -> str:
    """Return what the command writes to a terminal."""
    outer, inner = pty.openpty()
    process = subprocess.Popen(
        [*COMMAND, *arguments],
        env=environment(folder, TERM=term),
        stdin=subprocess.DEVNULL,
        stdout=inner,
        stderr=subprocess.DEVNULL,
    )
    os.close(inner)
    told, is_pressed = b"", False
    end = time.monotonic() + 30
    while time.monotonic() < end:
        try:
            part = os.read(outer, 1 << 16)
        except OSError:
            # On Linux, what nobody has open any more.
            break
        if not part:
            break
        told += part
        if interrupt and not is_pressed and b"step 1 " in told:
            process.send_signal(signal.SIGINT)
            is_pressed = True
    os.close(outer)
    assert process.wait(timeout=30) == 0
    return told.decode().replace("\r\n", "\n")


def steps(told: str) -> list[int]:
    return [int(number) for number in re.findall(r"step (\d+) ", told)]


def test_a_single_episode_is_shown_step_by_step(tmp_path: Path) -> None:
    told = shown(tmp_path, "--episode", "2")
    assert steps(told) == [0, 1, 2, 3, 4]
    assert "☻" in told
    assert told.rstrip().endswith("yes")


def test_an_interrupt_ends_the_show_and_not_the_command(tmp_path: Path) -> None:
    told = shown(tmp_path, "--episode", "2", interrupt=True)
    assert steps(told)[-1] < 4
    assert told.rstrip().endswith("yes")


@pytest.mark.parametrize(
    ("arguments", "term"),
    [
        (("--episode", "2"), "dumb"),
        (("--episode", "2", "--format", "json"), "xterm"),
        ((), "xterm"),
    ],
)
def test_nothing_is_shown_elsewhere(tmp_path: Path, arguments: tuple[str, ...], term: str) -> None:
    assert steps(shown(tmp_path, *arguments, term=term)) == []
