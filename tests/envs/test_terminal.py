"""`render_mode="human"` outside notebooks: in place on a terminal, in a row elsewhere."""

from __future__ import annotations

import io
import os
import re
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from support.playing import level_named
from support.sessions import environment

import babyrobot_levels as brl
from babyrobot_levels.render.terminal import Terminal
from babyrobot_levels.render.text import TextPainter

pty = pytest.importorskip("pty", reason="this system has no pseudo-terminals")
fcntl = pytest.importorskip("fcntl")
termios = pytest.importorskip("termios")

EAST = brl.Action.EAST

WALK = """
import time
import babyrobot_levels as brl
env = brl.load({level!r}).make(render_mode="human")
env.reset(seed=0)
begin = time.monotonic()
for action in {actions}:
    env.step(action)
took = time.monotonic() - begin
env.close()
env.close()
"""


def drawing(state: int) -> str:
    return "\n".join([*TextPainter(level_named("default")).lines(state, held=False), ""])


class Screen:
    """What is seen of what a terminal is sent, without colours."""

    def __init__(self, lines: int) -> None:
        self.lines, self.row, self.column = [""] * lines, 0, 0

    def send(self, text: str) -> Screen:
        for token in re.findall(r"\x1b\[[0-9;?]*[a-zA-Z]|.", text, re.DOTALL):
            if token == "\n":
                self._new_line()
            elif token == "\r":
                self.column = 0
            elif token.endswith("A") and len(token) > 1:
                self.row = max(0, self.row - int(token[2:-1]))
            elif token == "\x1b[K":
                self.lines[self.row] = self.lines[self.row][: self.column]
            elif token == "\x1b[J":
                self.lines[self.row] = self.lines[self.row][: self.column]
                for row in range(self.row + 1, len(self.lines)):
                    self.lines[row] = ""
            elif token.startswith("\x1b"):
                assert token.endswith("m"), repr(token)
            else:
                line = self.lines[self.row].ljust(self.column)
                self.lines[self.row] = line[: self.column] + token + line[self.column + 1 :]
                self.column += 1
        return self

    def _new_line(self) -> None:
        if self.row + 1 < len(self.lines):
            self.row += 1
        else:
            self.lines = [*self.lines[1:], ""]

    @property
    def text(self) -> str:
        return "\n".join(self.lines).rstrip("\n") + "\n"


def in_terminal(folder: Path, code: str, size: tuple[int, int] = (80, 24), **variables: str) -> str:
    """Run code in a terminal; return what that was sent."""
    outer, inner = pty.openpty()
    fcntl.ioctl(inner, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))
    process = subprocess.Popen(
        [sys.executable, "-W", "error", "-c", code],
        cwd=folder,
        env=environment(folder, TERM="xterm-256color", COLORTERM="truecolor") | variables,
        stdin=inner,
        stdout=inner,
        stderr=inner,
    )
    os.close(inner)
    sent = b""
    try:
        while chunk := os.read(outer, 1 << 16):
            sent += chunk
    except OSError:
        # Linux says in this way that the other end is closed.
        pass
    os.close(outer)
    assert process.wait(timeout=60) == 0, sent.decode()
    return sent.decode()


# -- in a terminal ----------------------------------------------------------------------------


def test_drawings_take_each_others_place(tmp_path: Path) -> None:
    code = "print('before')" + WALK.format(level="default", actions=[2, 2, 3]) + "print('after')"
    sent = in_terminal(tmp_path, code)
    assert "\x1b[38;2;" in sent
    assert sent.count("┌") == 4
    assert Screen(24).send(sent).text == "before\n" + drawing(5) + "after\n"


def test_a_terminal_that_scrolls(tmp_path: Path) -> None:
    code = "print('old\\n' * 30)" + WALK.format(level="default", actions=[2, 2, 3])
    sent = in_terminal(tmp_path, code)
    assert "old\n\n" + drawing(5) in Screen(24).send(sent).text


def test_of_a_large_level_the_part_around_the_robot_is_shown(tmp_path: Path) -> None:
    level = {"version": 1, "size": [60, 50], "start": [30, 20], "exit": "none"}
    code = WALK.format(level=level, actions=[2] * 5 + [3])
    sent = in_terminal(tmp_path, code, (41, 12))
    *lines, part = Screen(12).send(sent).text.splitlines()
    # Cells are whole, with the walls around them.
    assert {len(line) for line in lines} == {41}
    assert len(lines) == 9
    assert [line.index("☻") for line in lines if "☻" in line] == [22]
    assert part == "cells [30, 19] to [39, 22] of 60 x 50"


def test_drawings_stay_for_as_long_as_the_speed_says(tmp_path: Path) -> None:
    code = ""
    for speed in (1, 50):
        level = {"version": 1, "size": [3, 3], "display": {"robot": {"speed": speed}}}
        code += WALK.format(level=level, actions=[2] * 6) + "print('took', took)"
    slow, fast = map(float, re.findall(r"took (\S+)", in_terminal(tmp_path, code)))
    assert 1.45 <= slow < 10
    assert 0.03 <= fast < 1.4


@pytest.mark.parametrize(
    "variables", [{"NO_COLOR": "1"}, pytest.param({"TERM": "dumb"}, marks=pytest.mark.sweep)]
)
def test_terminals_without_colour(tmp_path: Path, variables: dict[str, str]) -> None:
    code = WALK.format(level="default", actions=[2])
    sent = in_terminal(tmp_path, code, (80, 24), **variables)
    assert not re.search(r"\x1b\[[0-9;]*m", sent)
    if "TERM" in variables:
        assert sent.replace("\r\n", "\n") == drawing(0) + "\n" + drawing(1) + "\n"
    else:
        assert Screen(24).send(sent).text == drawing(1)


def test_a_terminal_that_knows_no_box_characters(tmp_path: Path) -> None:
    code = WALK.format(level="default", actions=[2])
    sent = in_terminal(tmp_path, code, PYTHONUTF8="0", PYTHONIOENCODING="ascii")
    shown = Screen(24).send(sent).text
    assert shown.splitlines()[1] == "| S   @     |"
    assert shown.isascii()


def test_infos_are_seen_at_once(tmp_path: Path) -> None:
    walk = WALK.format(level="default", actions=[2])
    info = "env.unwrapped.show_info({'side_panel': ['reward: -1'], 'values': [[1] * 3] * 3})\n"
    shown = walk.replace("env.close()\n", info, 1)
    seen = Screen(24).send(in_terminal(tmp_path, shown)).text
    assert [line.split() for line in seen.splitlines()[1:7:2]] == [
        ["│S1", "☻1", "1", "│"],
        ["│", "1", "1", "1", "│"],
        ["│", "1", "1", "E1", "│"],
    ]
    assert seen.splitlines()[-3:] == ["   1", "", "reward: -1"]
    table = Screen(24).send(in_terminal(tmp_path, shown, NO_COLOR="1")).text
    assert table == drawing(1) + "\n" + "1.00  1.00  1.00\n" * 3 + "\nreward: -1\n"
    cleared = walk.replace("env.close()\n", info + "env.unwrapped.clear_info()\n", 1)
    assert Screen(24).send(in_terminal(tmp_path, cleared)).text == drawing(1)


# -- elsewhere --------------------------------------------------------------------------------


def test_in_a_pipe_there_is_a_drawing_for_each_step(tmp_path: Path) -> None:
    code = WALK.format(level="default", actions=[2, 2, 3] * 20)
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code + "assert took < 5"],
        env=environment(tmp_path, TERM="xterm", FORCE_COLOR="1"),
        capture_output=True,
        timeout=60,
        check=True,
    )
    text = done.stdout.decode()
    assert text.startswith("".join(f"{drawing(state)}\n" for state in (0, 1, 2, 5)))
    assert text.count("┌") == 61
    assert "\x1b" not in text
    assert done.stderr == b""


@pytest.mark.parametrize("stream", [None, io.StringIO()], ids=["none", "text"])
def test_without_a_screen_nothing_fails(stream: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdout", stream)
    env = level_named("default").make(render_mode="human")
    env.reset()
    env.step(EAST)
    env.render()
    env.close()
    if stream is not None:
        # Its encoding is not known, so that it is given ASCII.
        assert stream.getvalue().splitlines()[1] == "| @         |"
        assert stream.getvalue().count("@") == 2


def test_reset_and_step_render_by_themselves(capsys: pytest.CaptureFixture[str]) -> None:
    env = level_named("default").make(render_mode="human")
    assert capsys.readouterr().out == ""
    env.reset()
    assert capsys.readouterr().out == drawing(0) + "\n"
    # What is on the screen already needs no second drawing.
    assert env.render() is None
    assert capsys.readouterr().out == ""
    env.step(EAST)
    assert capsys.readouterr().out == drawing(1) + "\n"
    env.step(brl.Action.STAY)
    assert capsys.readouterr().out == drawing(1) + "\n"


def test_a_first_render_needs_no_reset(capsys: pytest.CaptureFixture[str]) -> None:
    env: Any = level_named("default").make(render_mode="human").unwrapped
    env.show_info({"bottom_panel": "ready"})
    assert capsys.readouterr().out == ""
    assert env.render() is None
    assert capsys.readouterr().out == drawing(0) + "\nready\n\n"
    env.show_info({"bottom_panel": "steady"})
    assert capsys.readouterr().out == drawing(0) + "\nsteady\n\n"
    env.close()
    env.render()
    assert capsys.readouterr().out == drawing(0) + "\nsteady\n\n"


@pytest.mark.parametrize("mode", [None, "rgb_array", "ansi", "svg", "canvas"])
def test_other_modes_write_nothing(mode: str | None, capsys: pytest.CaptureFixture[str]) -> None:
    env = level_named("default").make(render_mode=mode)
    env.reset()
    env.step(EAST)
    env.unwrapped.show_info({"bottom_panel": "x"})  # type: ignore[attr-defined]
    if mode is not None:
        env.render()
    env.close()
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("", "")


def test_a_terminal_has_room_for_so_much(monkeypatch: pytest.MonkeyPatch) -> None:
    outer, inner = pty.openpty()
    monkeypatch.setenv("TERM", "xterm")
    with os.fdopen(inner, "w", encoding="utf-8") as stream:
        monkeypatch.setattr("sys.stdout", stream)
        # Nobody has said how large it is.
        assert Terminal().room == (80, 23)
        fcntl.ioctl(stream, termios.TIOCSWINSZ, struct.pack("HHHH", 10, 30, 0, 0))
        assert Terminal().room == (30, 9)
    os.close(outer)
