"""What all tests share: which of them are slow, how much hypothesis tries, empty folders."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import settings

TESTS = Path(__file__).parent

SLOW = {
    "cli/test_terminals.py",
    "docs/test_notebooks.py",
    "e2e/browser",
    "e2e/test_benchmarks.py",
    "e2e/test_examples.py",
    "e2e/test_packaging.py",
    "e2e/test_pre_commit.py",
    "envs/test_notebook.py",
    "library/packs/test_built.py",
    "limits",
    "render/notebook/test_output.py",
}
"""Files and folders in which every test is slow. Elsewhere the test itself is marked."""

# `--hypothesis-profile thorough` chooses the second. A loaded machine is no reason to fail.
settings.register_profile("fast", max_examples=50, deadline=None)
settings.register_profile("thorough", max_examples=300, deadline=None)
settings.load_profile("fast")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what is slow by its place."""
    for item in items:
        place = item.path.relative_to(TESTS)
        if SLOW & {each.as_posix() for each in (place, *place.parents)}:
            item.add_marker(pytest.mark.slow)


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
