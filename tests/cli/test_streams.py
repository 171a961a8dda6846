"""What is sent to files and pipes, and which terminals are sent escapes: the same everywhere."""

from __future__ import annotations

import contextlib
import ctypes
import importlib.util
import io
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import IO, Any, cast

import pytest
from support.sessions import environment

import babyrobot_levels as brl
from babyrobot_levels.cli import app, console, parallel
from babyrobot_levels.extensions.play import keyboard
from babyrobot_levels.parallel import processes
from babyrobot_levels.render import terminal
from babyrobot_levels.render.terminal import Terminal
from babyrobot_levels.text import budget

TITLE = "Größe − ✓ │ 迷路 🤖"
LEVEL = f"version: 1\nname: odd\ntitle: {TITLE}\nmaze: {{seed: 3}}\n"
ASCII = {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"}
"""A system whose own encoding has few characters, as those of Windows have."""


CALLS = """
import sys
from babyrobot_levels.cli.app import main

for call in ("show", "preview --format svg", "preview --format html"):
    sys.argv = ["babyrobot", *call.split(), "odd.yaml"]
    try:
        main()
    except SystemExit as end:
        assert not end.code
# Standard input may be closed.
sys.stdin, sys.argv = None, ["babyrobot", "play", "maze"]
main()
"""


@pytest.mark.slow
def test_pipes_get_utf8_whatever_the_system_speaks(tmp_path: Path) -> None:
    (tmp_path / "odd.yaml").write_text(LEVEL, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", CALLS],
        cwd=tmp_path,
        env=environment(tmp_path, **ASCII),
        capture_output=True,
        encoding="utf-8",
        timeout=60,
        check=False,
    )
    assert done.stdout.count(TITLE) >= 3
    assert done.stderr.startswith("error: `babyrobot play` needs a terminal")
    assert done.returncode == 2


@pytest.mark.parametrize(
    ("asked", "encoding"), [("", "utf-8"), (":strict", "utf-8"), ("cp437",) * 2]
)
def test_lines_end_in_a_line_feed_in_pipes_only(
    asked: str, encoding: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONIOENCODING", asked)

    class Stream(io.TextIOWrapper):
        is_terminal = False

        def isatty(self) -> bool:
            return self.is_terminal

    # What standard output is on Windows: lines end in CRLF, the encoding is an old one.
    buffers = [io.BytesIO(), io.BytesIO()]
    streams = [Stream(buffer, "cp1252", newline="\r\n") for buffer in buffers]
    streams[1].is_terminal = True
    monkeypatch.setattr(sys, "stdout", streams[0])
    monkeypatch.setattr(sys, "stderr", streams[1])
    app._prepare_streams()
    for stream in streams:
        stream.write("ö\u2603\n")
        stream.flush()
    pipe, screen = (buffer.getvalue() for buffer in buffers)
    assert pipe == "ö\u2603\n".encode(encoding, "backslashreplace")
    assert screen == "ö\\u2603\r\n".encode("cp1252")


def test_drawings_are_shown_though_the_stream_has_not_all_characters(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    buffer = io.BytesIO()
    stream = io.TextIOWrapper(buffer, "cp1252", newline="\n")
    monkeypatch.setattr(sys, "stdout", stream)
    Terminal().show(["Größe ☃ 迷路"], 0.0)
    stream.flush()
    assert buffer.getvalue() == "Größe ? ??\n\n".encode("cp1252")


# -- consoles of Windows ---------------------------------------------------------------------


class Console:
    """What Windows answers of a console; `knows` tells whether it is recent enough for escapes."""

    def __init__(self, typed: str = "", *, knows: bool = True, is_console: bool = True) -> None:
        self.mode, self.knows, self.is_console = 2, knows, is_console
        self.typed = list(typed)

    def GetConsoleMode(self, handle: int, mode: Any) -> int:  # noqa: N802  (Windows' names)
        assert handle == 1007
        mode._obj.value = self.mode
        return int(self.is_console)

    def SetConsoleMode(self, handle: int, mode: int) -> int:  # noqa: N802
        assert handle == 1007
        if self.knows:
            self.mode = mode
        return int(self.knows)

    def get_osfhandle(self, descriptor: int) -> int:
        return 1000 + descriptor

    def kbhit(self) -> bool:
        return bool(self.typed)

    def getwch(self) -> str:
        return self.typed.pop(0)


def on_windows(module: ModuleType, console: Console, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Return a module as it is where there is such a console."""
    for name in ("NO_COLOR", "FORCE_COLOR", "TERM"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setitem(sys.modules, "msvcrt", console)
    monkeypatch.setattr(ctypes, "windll", SimpleNamespace(kernel32=console), raising=False)
    spec = importlib.util.spec_from_file_location("on_windows", module.__file__)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


SCREEN = cast(IO[str], SimpleNamespace(isatty=lambda: True, fileno=lambda: 7))


def test_a_console_is_made_to_understand_escapes(monkeypatch: pytest.MonkeyPatch) -> None:
    console = Console()
    module = on_windows(terminal, console, monkeypatch)
    assert module.wants_color(SCREEN)
    assert module.moves_cursor(SCREEN)
    assert console.mode == 2 | 1 | 4
    monkeypatch.setenv("TERM", "dumb")
    assert not module.moves_cursor(SCREEN)


@pytest.mark.parametrize(
    "console", [Console(knows=False), Console(is_console=False)], ids=["old", "NUL"]
)
def test_what_does_not_understand_escapes_gets_none(
    console: Console, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = on_windows(terminal, console, monkeypatch)
    assert not module.wants_color(SCREEN)
    assert not module.moves_cursor(SCREEN)
    assert console.mode == 2


def test_a_terminal_without_a_descriptor_gets_no_escapes(monkeypatch: pytest.MonkeyPatch) -> None:
    def fileno() -> int:
        raise io.UnsupportedOperation("fileno")

    module = on_windows(terminal, Console(), monkeypatch)
    assert not module.wants_color(SimpleNamespace(isatty=lambda: True, fileno=fileno))


def test_keys_have_the_same_names_as_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    console = Console("w\xe0H\x00P\xe0M\xe0K\x00;ä")
    with on_windows(keyboard, console, monkeypatch).keyboard() as next_key:
        found = [next_key(0.0) for _ in range(7)]
        assert found == ["w", "up", "down", "right", "left", "\x00;", "ä"]
        assert next_key(0.02) is None


def test_an_interrupt_is_one_there_too(monkeypatch: pytest.MonkeyPatch) -> None:
    module = on_windows(keyboard, Console("\x03"), monkeypatch)
    with module.keyboard() as next_key, pytest.raises(KeyboardInterrupt):
        next_key(0.0)


# -- terminals of other systems --------------------------------------------------------------


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has one kind of terminal")
@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"TERM": "linux", "COLORTERM": ""}, terminal.SIXTEEN),
        ({"TERM": "xterm-256color"}, terminal.PALETTE),
        ({"TERM": "xterm", "COLORTERM": "truecolor"}, terminal.ALL_COLORS),
        ({"TERM": "xterm-direct"}, terminal.ALL_COLORS),
        ({"TERM": "xterm-kitty"}, terminal.ALL_COLORS),
        ({"TERM": "xterm-256color", "TERM_PROGRAM": "iTerm.app"}, terminal.ALL_COLORS),
        ({"TERM": "xterm-256color", "WT_SESSION": "1"}, terminal.ALL_COLORS),
    ],
)
def test_colors_are_those_that_the_terminal_knows(
    variables: dict[str, str], expected: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("NO_COLOR", "FORCE_COLOR", "TERM", "COLORTERM", "TERM_PROGRAM", "WT_SESSION"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert terminal.colors_of(SCREEN) == expected


# -- processes -------------------------------------------------------------------------------


def test_an_interrupt_that_a_library_drops_ends_the_work_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    handlers: dict[int, Any] = {}
    monkeypatch.setattr(signal, "signal", handlers.__setitem__)
    monkeypatch.setattr(app, "_arrived", [])
    app._handle_interrupts()
    assert [*parallel.track("ab", 2, "counting")] == ["a", "b"]
    with contextlib.suppress(KeyboardInterrupt):
        handlers[signal.SIGINT](signal.SIGINT, None)
    with pytest.raises(KeyboardInterrupt):
        [*parallel.track("ab", 2, "counting")]
    monkeypatch.setattr(budget, "_before_work", app.end_if_interrupted)
    with pytest.raises(KeyboardInterrupt):
        brl.solve("frozen-lake")


def test_no_more_processes_than_windows_can_wait_for(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def pool(jobs: int, **options: Any) -> ThreadPoolExecutor:
        asked.append(jobs)
        return ThreadPoolExecutor(1, **options)

    monkeypatch.setattr(processes, "ProcessPoolExecutor", pool)
    monkeypatch.setattr(signal, "signal", lambda number, handler: None)
    assert parallel.map_all(str, range(300), parallel.Workers(128), "counting") == [
        *map(str, range(300))
    ]
    assert asked == [61]


# -- what is said of a file ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("size", "told"),
    [
        (1, "1 byte"),
        (999, "999 bytes"),
        (1_000, "1.0 KB"),
        (9_949, "9.9 KB"),
        (9_950, "10 KB"),
        (999_499, "999 KB"),
        (999_500, "1.0 MB"),
    ],
)
def test_a_size_is_told_in_units(
    size: int, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    console.save(tmp_path / "x.bin", b"x" * size)
    assert capsys.readouterr().err.endswith(f"({told})\n")
