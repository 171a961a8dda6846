"""Paths behind which there is no level file: each has a message of its own."""

from __future__ import annotations

import os
import re
import socket
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import babyrobot_levels as brl
from babyrobot_levels import lint, validate
from babyrobot_levels.language.documents import read_theme, theme_names
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.errors import LevelError, LevelNotFoundError
from babyrobot_levels.text.source import Position

needs_posix = pytest.mark.skipif(sys.platform == "win32", reason="needs what POSIX has")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def fault(path: str | Path) -> Diagnostic:
    """Return the one thing that is wrong with a path, which must be told at its beginning."""
    (found,) = validate(path)
    assert (found.file, found.line, found.column) == (str(path), 1, 1)
    assert found.end == Position(1, 1)
    return found


def not_read(path: str) -> Diagnostic:
    """Return the one thing that is wrong with a path where a single level is needed."""
    with pytest.raises(LevelError) as raised:
        brl.load(path)
    (found,) = raised.value.diagnostics
    return found


def test_a_missing_file() -> None:
    found = fault("nowhere.yaml")
    assert (found.code, found.message) == ("BR101", "no such file")


def test_a_folder(folder: Path) -> None:
    (folder / "folder.yaml").mkdir()
    assert not_read("folder.yaml").message == "this is a directory, not a file"


def test_a_file_that_may_not_be_read(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Permissions do not stop everybody who runs tests, so the refusal is played.
    def refuse(*_: object) -> int:
        raise PermissionError(13, "Permission denied")

    (folder / "mine.yaml").write_text("version: 1\n", "utf-8")
    monkeypatch.setattr(os, "open", refuse)
    assert fault("mine.yaml").message == "permission denied"


@needs_posix
@pytest.mark.parametrize("device", ["/dev/zero", "/dev/null", "/dev/tty"])
def test_devices(device: str) -> None:
    # Without a terminal, `/dev/tty` cannot even be opened.
    message = fault(device).message
    assert message.startswith(("this is not a regular file", "the file cannot be read ("))


@needs_posix
def test_a_pipe_and_a_socket(folder: Path) -> None:
    os.mkfifo("pipe.yaml")
    assert fault("pipe.yaml").message == "this is not a regular file"
    with socket.socket(socket.AF_UNIX) as server:
        server.bind("socket.yaml")
        assert fault("socket.yaml").message.startswith("the file cannot be read (")


@needs_posix
def test_links_that_lead_nowhere() -> None:
    Path("broken.yaml").symlink_to("nowhere.yaml")
    assert fault("broken.yaml").message.startswith("no such file")
    Path("circle.yaml").symlink_to("circle.yaml")
    assert fault("circle.yaml").message.startswith("the file cannot be read (")


@pytest.mark.parametrize("name", ["x" * 5000 + ".yaml", "a\0b.yaml"])
def test_names_that_cannot_be(name: str) -> None:
    assert fault(name).message.startswith("the file cannot be read (")


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be"])
def test_other_encodings_are_named(encoding: str, folder: Path) -> None:
    mark = "" if encoding == "utf-16" else "\ufeff"
    (folder / "wide.yaml").write_bytes(f"{mark}version: 1\n".encode(encoding))
    assert fault("wide.yaml").message == "the file is encoded as UTF-16"


# -- folders that may not be entered ---------------------------------------------------------


@pytest.fixture
def locked(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that may not be entered. That is played: permissions do not stop everybody."""
    home = folder / "locked"
    (home / "themes").mkdir(parents=True)
    (home / "mine.yaml").write_text("version: 1\ntheme: dusk\n", "utf-8")

    def refusing(call: Callable[..., Any]) -> Callable[..., Any]:
        def refuse(path: Any, *rest: Any, **named: Any) -> Any:
            told = "" if isinstance(path, int) else str(Path(os.fsdecode(path)).absolute())
            if told.startswith(f"{home}{os.sep}"):
                raise PermissionError(13, "Permission denied", str(path))
            return call(path, *rest, **named)

        return refuse

    for name in ("open", "stat", "lstat", "listdir", "scandir"):
        monkeypatch.setattr(os, name, refusing(getattr(os, name)))
    return home


def test_a_file_in_a_locked_folder_is_told_as_such(locked: Path) -> None:
    told = r"mine\.yaml:1:1: error BR101: permission denied"
    (found,) = lint("locked/mine.yaml")
    assert re.fullmatch(f"locked/{told}", str(found))
    with pytest.raises(LevelError, match=told):
        brl.load("locked/mine.yaml")


def test_a_locked_folder_of_themes_holds_none(locked: Path) -> None:
    assert read_theme("mine", [locked]) == (None, [])
    assert theme_names([locked / "themes"]) == []


def test_what_cannot_be_a_file_is_a_name(locked: Path) -> None:
    for name in ("locked/mine", "x" * 5000 + "/mine"):
        with pytest.raises(LevelNotFoundError, match="no level called"):
            brl.load(name)


def test_a_folder_that_windows_refuses_to_open(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> int:
        raise PermissionError(13, "Permission denied")

    (folder / "folder.yaml").mkdir()
    monkeypatch.setattr(os, "open", refuse)
    assert not_read("folder.yaml").message == "this is a directory, not a file"
