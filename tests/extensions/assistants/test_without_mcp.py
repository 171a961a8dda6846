"""The server for assistants where its library is missing."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from support.sessions import babyrobot

import babyrobot_levels as brl


@pytest.fixture(autouse=True)
def _missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mcp", None)


def test_the_command_says_how_to_install_it(tmp_path: Path) -> None:
    result = babyrobot("mcp", "--folder", tmp_path, status=2)
    assert result.out == ""
    first, second = result.err.splitlines()
    assert first == "error: the server needs the package `mcp`, 2.0 or later"
    assert second.startswith("  help: install the extra `mcp`: pip install ")


def test_so_does_the_function() -> None:
    with pytest.raises(ImportError, match="extra `mcp`") as caught:
        brl.mcp()
    assert caught.value.name == "mcp"
