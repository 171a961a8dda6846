"""What is sent to files and pipes, and which terminals are sent escapes: the same everywhere."""

from __future__ import annotations

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

import babyrobot_levels.render.terminal
from babyrobot_levels.cli import app, parallel
from babyrobot_levels.parallel import processes
from babyrobot_levels.render.terminal import Terminal

TITLE = "Größe − ✓ │ 迷路 🤖"
LEVEL = f"version: 1\nname: odd\ntitle: {TITLE}\nmaze: {{seed: 3}}\n"
ASCII = {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"}
"""A system whose own encoding has few characters, as those of Windows have."""


def sent(folder: Path, *arguments: str, **variables: str) -> bytes:
    """Return what a command sends to a pipe, which must go well."""
    (folder / "odd.yaml").write_text(LEVEL, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "babyrobot_levels", *arguments],
        cwd=folder,
        env=environment(folder, **ASCII, **variables),
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, b"")
    return done.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ["show", "odd.yaml"],
        ["resolve", "odd.yaml"],
        ["preview", "odd.yaml", "--format", "svg"],
        ["preview", "odd.yaml", "--format", "html"],
    ],
    ids=" ".join,
)
def test_pipes_get_utf8_whatever_the_system_speaks(tmp_path: Path, arguments: list[str]) -> None:
    assert TITLE in sent(tmp_path, *arguments).decode("utf-8")


def test_who_asks_for_an_encoding_gets_it(tmp_path: Path) -> None:
    out = sent(tmp_path, "show", "odd.yaml", PYTHONIOENCODING="cp1252")
    assert r"Größe \u2212 \u2713" in out.decode("cp1252")
    out = sent(tmp_path, "show", "odd.yaml", PYTHONIOENCODING=":strict")
    assert TITLE in out.decode("utf-8")


def test_lines_end_in_a_line_feed_in_pipes_only(monkeypatch: pytest.MonkeyPatch) -> None:
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
        stream.write("ö\n")
        stream.flush()
    pipe, terminal = (buffer.getvalue() for buffer in buffers)
    assert (pipe, terminal) == ("ö\n".encode(), "ö\r\n".encode("cp1252"))


def test_drawings_are_shown_though_the_stream_has_not_all_characters(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    buffer = io.BytesIO()
    stream = io.TextIOWrapper(buffer, "cp1252", newline="\n")
    monkeypatch.setattr(sys, "stdout", stream)
    Terminal().show(["Größe ☃ 迷路"], 0.0)
    stream.flush()
    assert buffer.getvalue() == "Größe ? ??\n\n".encode("cp1252")


def test_closed_input_is_no_terminal_to_play_on(tmp_path: Path) -> None:
    code = "import sys; sys.stdin = None; from babyrobot_levels.cli.app import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, "play", "maze"],
        env=environment(tmp_path),
        capture_output=True,
        encoding="utf-8",
        timeout=60,
        check=False,
    )
    assert done.returncode == 2
    assert "`babyrobot play` needs a terminal" in done.stderr


# -- consoles of Windows ---------------------------------------------------------------------


class Console:
    """What Windows answers of a console; `knows` tells whether it is recent enough for escapes."""

    def __init__(self, *, knows: bool = True, is_console: bool = True) -> None:
        self.mode, self.knows, self.is_console = 2, knows, is_console

    def GetConsoleMode(self, handle: int, mode: Any) -> int:  # noqa: N802  (Windows' names)
        assert handle == 1007
        mode._obj.value = self.mode
        return int(self.is_console)

    def SetConsoleMode(self, handle: int, mode: int) -> int:  # noqa: N802
        assert handle == 1007
        if self.knows:
            self.mode = mode
        return int(self.knows)


def terminal_of(console: Console, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Return the module as it is where there is such a console."""
    for name in ("NO_COLOR", "FORCE_COLOR", "TERM"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "win32")
    msvcrt = SimpleNamespace(get_osfhandle=lambda descriptor: 1000 + descriptor)
    monkeypatch.setitem(sys.modules, "msvcrt", msvcrt)
    monkeypatch.setattr(ctypes, "windll", SimpleNamespace(kernel32=console), raising=False)
    path = babyrobot_levels.render.terminal.__file__
    spec = importlib.util.spec_from_file_location("terminal_on_windows", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


SCREEN = cast(IO[str], SimpleNamespace(isatty=lambda: True, fileno=lambda: 7))


def test_a_console_is_made_to_understand_escapes(monkeypatch: pytest.MonkeyPatch) -> None:
    console = Console()
    module = terminal_of(console, monkeypatch)
    assert module.wants_color(SCREEN)
    assert module.moves_cursor(SCREEN)
    assert console.mode == 2 | 1 | 4


@pytest.mark.parametrize(
    "console", [Console(knows=False), Console(is_console=False)], ids=["old", "NUL"]
)
def test_what_does_not_understand_escapes_gets_none(
    console: Console, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = terminal_of(console, monkeypatch)
    assert not module.wants_color(SCREEN)
    assert not module.moves_cursor(SCREEN)
    assert console.mode == 2


def test_a_terminal_without_a_descriptor_gets_no_escapes(monkeypatch: pytest.MonkeyPatch) -> None:
    def fileno() -> int:
        raise io.UnsupportedOperation("fileno")

    module = terminal_of(Console(), monkeypatch)
    assert not module.wants_color(SimpleNamespace(isatty=lambda: True, fileno=fileno))


# -- processes -------------------------------------------------------------------------------


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
