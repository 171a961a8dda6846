"""The half of the keyboard that is for Windows, with a console that only seems to be there."""

from __future__ import annotations

import importlib.util
import sys
from types import ModuleType

import pytest

import babyrobot_levels.cli.play


class Console:
    """What Windows would answer."""

    def __init__(self, typed: str) -> None:
        self.typed = list(typed)

    def kbhit(self) -> bool:
        return bool(self.typed)

    def getwch(self) -> str:
        return self.typed.pop(0)


def keyboard_of(console: Console, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Return the module as it is where there is such a console."""
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setitem(sys.modules, "msvcrt", console)
    path = babyrobot_levels.cli.play.__file__
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


def test_an_interrupt_is_one_there_too(monkeypatch: pytest.MonkeyPatch) -> None:
    module = keyboard_of(Console("\x03"), monkeypatch)
    with module.keyboard() as next_key, pytest.raises(KeyboardInterrupt):
        next_key(0.0)
