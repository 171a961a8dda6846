"""`babyrobot replay` on a terminal: the episode is shown step by step."""

from __future__ import annotations

import os

import pytest
from support.sessions import FILES, babyrobot

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
