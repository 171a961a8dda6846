"""`babyrobot replay` on a terminal: the episode is shown step by step."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.sessions import FILES, babyrobot, environment

from babyrobot_levels.render.terminal import Terminal

PLAY = FILES / "plays" / "ben.brlplay"


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The last lines of what is shown on a terminal."""
    lines: list[str] = []

    def show(self: Terminal, picture: list[str], seconds: float) -> None:
        assert seconds == 0.25
        assert any("@" in line or "\N{BLACK SMILING FACE}" in line for line in picture)
        lines.append(picture[-1])

    monkeypatch.setattr(Terminal, "room", os.terminal_size((80, 24)))
    monkeypatch.setattr(Terminal, "show", show)
    return lines


def test_a_single_episode_is_shown_step_by_step(shown: list[str]) -> None:
    told = babyrobot("replay", PLAY, "--episode", "2")
    assert [line.split("  ")[0] for line in shown] == [f"step {number}" for number in range(5)]
    assert told.out.endswith("yes\n")
    shown.clear()
    babyrobot("replay", PLAY, "--episode", "2", "--format", "json")
    babyrobot("replay", PLAY)
    assert shown == []


@pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo-terminals")
def test_an_interrupt_ends_the_show_and_not_the_command(tmp_path: Path) -> None:
    outer, inner = os.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "babyrobot_levels", "replay", str(PLAY), "--episode", "2"],
        env=environment(tmp_path, TERM="xterm-256color"),
        stdin=subprocess.DEVNULL,
        stdout=inner,
        stderr=subprocess.DEVNULL,
    )
    os.close(inner)
    told, is_pressed, end = b"", False, time.monotonic() + 30
    while time.monotonic() < end:
        try:
            part = os.read(outer, 1 << 16)
        except OSError:
            # On Linux, what nobody has open any more.
            break
        if not part:
            break
        told += part
        if not is_pressed and b"step 1 " in told:
            process.send_signal(signal.SIGINT)
            is_pressed = True
    os.close(outer)
    assert process.wait(timeout=30) == 0
    assert is_pressed
    assert b"step 4 " not in told
    assert "\N{BLACK SMILING FACE}".encode() in told
    assert told.rstrip().endswith(b"yes")
