"""The half of the keyboard that is for Windows, with a console that only seems to be there."""

from __future__ import annotations

import ctypes
import importlib.util
import sys
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import babyrobot_levels.cli.keyboard


class Console:
    """What Windows would answer."""

    def __init__(self, typed: str) -> None:
        self.typed, self.mode = list(typed), 3

    def kbhit(self) -> bool:
        return bool(self.typed)

    def getwch(self) -> str:
        return self.typed.pop(0)

    def GetStdHandle(self, which: int) -> int:  # noqa: N802  (Windows' names)
        assert which == -11
        return 7

    def GetConsoleMode(self, handle: int, mode: Any) -> None:  # noqa: N802
        assert handle == 7
        mode._obj.value = self.mode

    def SetConsoleMode(self, handle: int, mode: int) -> None:  # noqa: N802
        assert handle == 7
        self.mode = mode


def keyboard_of(console: Console, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Return the module as it is where there is such a console."""
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setitem(sys.modules, "msvcrt", console)
    windll = SimpleNamespace(kernel32=console)
    monkeypatch.setattr(ctypes, "windll", windll, raising=False)
    path = babyrobot_levels.cli.keyboard.__file__
    spec = importlib.util.spec_from_file_location("keyboard_on_windows", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_keys_have_the_same_names_as_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    console = Console("w\xe0H\x00P\xe0M\xe0K\x00;ä")
    with keyboard_of(console, monkeypatch).keyboard() as next_key:
        found = [next_key(0.0) for _ in range(7)]
        assert found == ["w", "up", "down", "right", "left", "\x00;", "ä"]
        assert next_key(0.02) is None


def test_the_console_understands_escape_sequences_meanwhile(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    console = Console("\x03")
    module = keyboard_of(console, monkeypatch)

    def interrupted() -> None:
        with module.keyboard() as next_key:
            assert console.mode == 3 | 4 | 1
            next_key(0.0)

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert console.mode == 3
