"""Folders in which packs are found, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from babyrobot_levels.text.files import user_folder


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
