"""Folders in which nothing is found but what a test puts there."""

from __future__ import annotations

from pathlib import Path

import pytest

from babyrobot_levels.folders import user_folder


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make the current folder and the user's ones empty, and return the current one."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("BABYROBOT_LEVELS", raising=False)
    return folder


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder from which packages are imported."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    return folder


@pytest.fixture
def users_pack(here: Path) -> Path:
    """The folder of a pack `zoo` that the user has put among the installed ones."""
    folder = user_folder() / "packs" / "zoo"
    folder.mkdir(parents=True)
    return folder
