"""The hooks that other projects get: run by pre-commit itself, with our own environment as theirs.

Only what would ask the network is left out: pre-commit making an environment of its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml
from support.combinations import swept
from support.places import ROOT

MANIFEST = ROOT / ".pre-commit-hooks.yaml"
HOOKS: list[dict[str, Any]] = yaml.safe_load(MANIFEST.read_text("utf-8"))
IDS = [hook["id"] for hook in HOOKS]

each_hook = pytest.mark.parametrize("hook", swept(["babyrobot-lint"], IDS))


@dataclass(frozen=True)
class Project:
    """A repository of somebody who uses the hooks."""

    folder: Path

    def write(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8", newline="\n")
        return path

    def call(self, *command: str) -> subprocess.CompletedProcess[str]:
        # Git must not read the settings of whoever runs the tests.
        scripts = str(Path(sys.executable).parent)
        variables = {
            **os.environ,
            "PATH": os.pathsep.join([scripts, os.environ["PATH"]]),
            "PRE_COMMIT_HOME": str(self.folder / ".cache"),
            "GIT_CONFIG_GLOBAL": os.devnull,
            "GIT_CONFIG_NOSYSTEM": "1",
        }
        for name in ("GIT_DIR", "GIT_INDEX_FILE", "GIT_WORK_TREE"):
            variables.pop(name, None)
        return subprocess.run(
            command,
            cwd=self.folder,
            env=variables,
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
        )

    def run(self, hook: str) -> tuple[int, str]:
        """Run one hook on all files; return the status and what it printed."""
        assert self.call("git", "add", "-A", ":!.cache").returncode == 0
        pre_commit = (sys.executable, "-m", "pre_commit")
        done = self.call(*pre_commit, "run", hook, "--all-files", "--color", "never")
        return done.returncode, done.stdout + done.stderr


@pytest.fixture
def project(tmp_path: Path) -> Project:
    project = Project(tmp_path)
    assert project.call("git", "init", "-q").returncode == 0
    hooks = [{**hook, "language": "system"} for hook in HOOKS]
    config = {"repos": [{"repo": "local", "hooks": hooks}]}
    project.write(".pre-commit-config.yaml", yaml.safe_dump(config))
    project.write("levels/good.yaml", "version: 1\ndescription: A small world.\n")
    return project


def test_the_manifest_is_valid_and_makes_environments_of_its_own() -> None:
    command = [sys.executable, "-m", "pre_commit", "validate-manifest", str(MANIFEST)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")
    assert IDS == ["babyrobot-validate", "babyrobot-lint", "babyrobot-format"]
    assert {hook["language"] for hook in HOOKS} == {"python"}


@each_hook
def test_good_levels_pass_and_what_is_no_level_is_left_alone(hook: str, project: Project) -> None:
    for name in (
        *("levels/themes/mine.yaml", "levels/pack.yaml", "levels/.hidden.yaml"),
        *("levels/notes.txt", "docs/other.yaml", "mylevels/other.yaml", "other.yaml"),
    ):
        project.write(name, "no: level\n")
    status, output = project.run(hook)
    assert (status, "Passed" in output) == (0, True), output


@each_hook
def test_bad_levels_fail(hook: str, project: Project) -> None:
    name = "levels/bad.yaml" if hook == IDS[0] else "deep/levels/pack/bad.yml"
    project.write(name, "version: 1\nsize: [3, x]\n")
    status, output = project.run(hook)
    assert status == 1, output
    assert f"{name}:2:11: error BR203" in output
    assert "good.yaml" not in output


def test_formatting_rewrites_the_file_and_is_content_then(project: Project) -> None:
    path = project.write("levels/wide.yaml", "version:   1 # one\nsize: [4,4]\n")
    status, output = project.run("babyrobot-format")
    assert (status, "files were modified by this hook" in output) == (1, True)
    assert path.read_text("utf-8") == "version: 1  # one\nsize: [4, 4]\n"
    assert project.run("babyrobot-format")[0] == 0


def test_linting_finds_what_validating_does_not(project: Project) -> None:
    project.write(
        "levels/shut.yaml",
        "version: 1\ndescription: Shut in.\nwalls:\n"
        "  - {at: [0, 0], side: E}\n  - {at: [0, 0], side: S}\n",
    )
    assert project.run("babyrobot-validate")[0] == 0
    status, output = project.run("babyrobot-lint")
    assert (status, "levels/shut.yaml:" in output) == (1, True)


def test_linting_holds_a_level_to_what_it_states(project: Project) -> None:
    path = project.write(
        "levels/meant.yaml",
        "version: 1\ndescription: Wide.\nsize: [4, 3]\nexpect:\n  path_length: 5\n",
    )
    assert project.run("babyrobot-lint")[0] == 0
    path.write_text(path.read_text("utf-8").replace("expect", "exit: [1, 1]\nexpect"), "utf-8")
    status, output = project.run("babyrobot-lint")
    assert (status, "meant.yaml:6:16: error BR540: `path_length` is 2, not 5" in output) == (
        1,
        True,
    )
