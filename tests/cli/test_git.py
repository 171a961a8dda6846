"""Levels in `git diff`, in a repository of their own."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from support.sessions import babyrobot, environment

LEVEL = "version: 1\nsize: [2, 2]\ntheme: mine\n"


class Repository:
    """A folder under git, in which levels are compared by us."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.env = environment(
            folder,
            GIT_CONFIG_GLOBAL=os.devnull,
            GIT_CONFIG_SYSTEM=os.devnull,
            **{
                f"GIT_{who}_{what}": "x"
                for who in ("AUTHOR", "COMMITTER")
                for what in ("NAME", "EMAIL")
            },
        )
        self.git("init", "--quiet")
        driver = f"{shlex.quote(sys.executable)} -m babyrobot_levels diff"
        self.git("config", "diff.babyrobot.command", driver)
        self.write(".gitattributes", "levels/*.yaml diff=babyrobot\n")
        self.write("levels/themes/mine.yaml", "colors: {base: red}\n")
        self.write("levels/maze.yaml", LEVEL)
        self.commit()

    def git(self, *arguments: str) -> str:
        call = ["git", *arguments]
        done = subprocess.run(
            call, cwd=self.folder, env=self.env, capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stderr) == (0, ""), done
        return done.stdout

    def write(self, path: str, text: str) -> None:
        place = self.folder / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, "utf-8")

    def commit(self) -> None:
        self.git("add", "--all")
        self.git("commit", "--quiet", "--message", "Levels")


@pytest.fixture
def repository(tmp_path: Path) -> Repository:
    return Repository(tmp_path)


@pytest.mark.slow
def test_a_changed_game(repository: Repository) -> None:
    repository.write("levels/maze.yaml", LEVEL + "rewards: {exit: 5}\n")
    # From a folder of the repository, too.
    assert repository.git("-C", "levels", "diff", "maze.yaml") == (
        "levels/maze.yaml: another MDP\n"
        "\n"
        "rewards.exit: 0 -> 5\n"
        "transitions: 2 of 20 changed (--limit 0 shows all)\n"
        "\n"
        "optimal return: -1 -> 4\n"
        "random return: -5 -> 0\n"
        "\n"
    )


@pytest.mark.slow
def test_files_that_come_and_go(repository: Repository) -> None:
    (repository.folder / "levels/maze.yaml").unlink()
    repository.write("levels/new.yaml", "version: 1\nsize: [2, 1]\n")
    repository.git("add", "--all")
    assert repository.git("diff", "--cached", "--no-renames") == (
        "levels/maze.yaml: deleted level\n\n"
        "levels/new.yaml: new level\n\n+---+---+\n| S   E |\n+---+---+\n\n"
    )


@pytest.mark.slow
def test_a_file_that_was_renamed(repository: Repository) -> None:
    repository.git("mv", "levels/maze.yaml", "levels/other.yaml")
    repository.write("levels/other.yaml", LEVEL + "start: [1, 0]\n")
    repository.git("add", "--all")
    told = repository.git("diff", "--cached", "--find-renames=10%")
    assert told.startswith(
        "levels/maze.yaml -> levels/other.yaml: another MDP\n\nstart: [0, 0] -> [1, 0]\n"
    )
    assert told.endswith("not part of the MDP:\n  name: maze -> other\n\n")


def compared(before: bytes | None, after: bytes | None) -> str:
    """Return what git would show of two versions of a file, none where it is not there."""
    words = ["levels/maze.yaml"]
    for name, data in (("before", before), ("after", after)):
        if data is not None:
            Path(name).write_bytes(data)
        words += [os.devnull, ".", "."] if data is None else [name, 40 * "a", "100644"]
    result = babyrobot("diff", *words)
    assert (result.status, result.err) == (0, "")
    return result.out


@pytest.mark.usefixtures("here")
def test_a_level_that_is_not_valid_is_compared_as_text() -> None:
    level = LEVEL.encode().replace(b"mine", b"green")
    assert compared(level, level.replace(b"2, 2", b"0, 2")) == (
        "levels/maze.yaml: not a valid level after the change\n"
        "  after, line 2: `size[0]` must be at least 1, not `0`\n"
        "\n"
        "--- levels/maze.yaml\n"
        "+++ levels/maze.yaml\n"
        "@@ -1,3 +1,3 @@\n"
        " version: 1\n"
        "-size: [2, 2]\n"
        "+size: [0, 2]\n"
        " theme: green\n"
        "\n"
    )
    told = compared(level, b"\xff\xfe")
    assert told == "levels/maze.yaml: the file is encoded as UTF-16\n\n"


@pytest.mark.usefixtures("here")
def test_a_file_that_comes_without_being_a_level_is_shown_as_text() -> None:
    told = compared(None, b"sice: 3\n")
    assert told.startswith("levels/maze.yaml: new file, not a valid level\n  after, line 1: ")
    assert told.endswith("@@ -0,0 +1 @@\n+sice: 3\n\n")
    told = compared(b"sice: 3\n", None)
    assert told.startswith("levels/maze.yaml: deleted file, not a valid level\n  before, line 1: ")
    assert told.endswith("@@ -1 +0,0 @@\n-sice: 3\n\n")


@pytest.mark.slow
def test_a_conflict(repository: Repository) -> None:
    repository.git("checkout", "--quiet", "-b", "other")
    repository.write("levels/maze.yaml", LEVEL + "start: [1, 0]\n")
    repository.commit()
    repository.git("checkout", "--quiet", "-")
    repository.write("levels/maze.yaml", LEVEL + "start: [0, 1]\n")
    repository.commit()
    call = ["git", "merge", "--quiet", "other"]
    subprocess.run(
        call, cwd=repository.folder, env=repository.env, capture_output=True, check=False
    )
    assert "levels/maze.yaml: unmerged\n\n" in repository.git("diff", "--base")
