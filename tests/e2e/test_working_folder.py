"""Processes that are started import nothing from the working folder, however they are started."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from support.combinations import swept
from support.strangers import run_among, strangers

from babyrobot_levels.extensions.editor import runtime

PROGRAM = """\
import multiprocessing
import os
import sys

import babyrobot_levels as brl
from babyrobot_levels.extensions.assistants.worker import Worker

if __name__ == "__main__":
    multiprocessing.set_start_method(sys.argv[1])
    values = brl.solve_many(["first-key", "frozen-lake"], jobs=2)
    print([each.states for each in values])
    print(Worker(None, 60).call("format", {"level": "version: 1"}).told.strip())
    print(os.environ.get("PYTHONSAFEPATH"))
"""

AGENT = """\
import json
from beside import ACTION

def east(observation):
    return ACTION
"""


@pytest.mark.slow
@pytest.mark.parametrize("method", swept(["spawn"], ["fork", "spawn", "forkserver"]))
def test_workers_and_tools(method: str, tmp_path: Path) -> None:
    if sys.platform == "win32" and method != "spawn":
        pytest.skip("Windows starts processes in one way")
    program = tmp_path / "program.py"
    program.write_text(PROGRAM, "utf-8")
    told = run_among(strangers(tmp_path / "working"), sys.executable, program, method)
    assert told.splitlines() == ["[23, 16]", "version: 1", "None"]


@pytest.mark.slow
def test_commands_with_workers_and_with_an_agent_of_the_folder(tmp_path: Path) -> None:
    command = Path(sys.executable).with_name("babyrobot")
    levels = [tmp_path / f"{number}.yaml" for number in range(4)]
    for level in levels:
        level.write_text("version: 1\n", "utf-8")
    folder = strangers(tmp_path / "working")
    assert run_among(folder, command, "show", *levels, "--jobs", "2")
    (folder / "agent.py").write_text(AGENT, "utf-8")
    (folder / "beside.py").write_text("ACTION = 2\n", "utf-8")
    assert "frozen-lake" in run_among(folder, command, "score", "agent.py:east", "frozen-lake")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs a script for npm")
def test_what_fetches_the_runtime_of_the_editor(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "npm").write_text("#!/bin/sh\nexec cp ../pip.py .\n", "utf-8")
    (tmp_path / "npm").chmod(0o755)
    (tmp_path / "pip.py").write_text(f"open({str(tmp_path / 'mark')!r}, 'w')\n", "utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    monkeypatch.setattr(runtime, "_PIP", (*runtime.DOWNLOAD, "none.whl"))
    failure = pytest.raises(runtime.RuntimeFileError, match=r"none.whl cannot be fetched")
    with failure, runtime.runtime_folder(None):
        pass
    assert not (tmp_path / "mark").exists()
