"""The example of a notebook for otter-grader, under otter's own commands."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from support.places import EXAMPLES, ROOT

BIN = Path(sys.executable).parent
SWEEPS = """\
    for _ in range(1000):
        following = np.where(mdp.terminal, 0, values[mdp.next_state])
        ahead = (mdp.probability * (mdp.reward + {discount} * following)).sum(axis=-1)
        values = np.where(mdp.is_terminal, 0, ahead.max(axis=1))
"""


def otter(folder: Path, *arguments: object) -> None:
    path = os.pathsep.join([str(BIN), os.environ.get("PATH", "")])
    environment = {**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [BIN / "otter", *map(str, arguments)],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def assigned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder in which otter has made the notebook of students and the autograder.

    It runs its tests on the solution, and fails if one of them does.
    """
    folder = tmp_path_factory.mktemp("otter")
    otter(folder, "assign", EXAMPLES / "homework.ipynb", "dist")
    return folder


def graded(folder: Path, sweeps: str) -> dict[str, Any]:
    """Return the tests of a notebook in which a student has written the sweeps, by their names."""
    notebook = json.loads((folder / "dist" / "student" / "homework.ipynb").read_text("utf-8"))
    (cell,) = (each for each in notebook["cells"] if "def value_iteration" in str(each["source"]))
    written = "".join(cell["source"])
    assert "following" not in written
    cell["source"] = written.replace("    ...\n", sweeps)
    (folder / "student.ipynb").write_text(json.dumps(notebook), "utf-8")
    (autograder,) = (folder / "dist" / "autograder").glob("*.zip")
    (folder / "results").mkdir(exist_ok=True)
    otter(folder, "run", folder / "student.ipynb", "-a", autograder, "-o", folder / "results")
    results = json.loads((folder / "results" / "results.json").read_text("utf-8"))
    return {each["name"]: each for each in results["tests"]}


def test_a_right_answer_has_its_points(assigned: Path) -> None:
    tests = graded(assigned, SWEEPS.format(discount="level.discount"))
    assert (tests["values"]["score"], tests["values"]["max_score"]) == (3, 3)


def test_a_mistake_is_told_to_the_student(assigned: Path) -> None:
    tests = graded(assigned, SWEEPS.format(discount=0.9))
    assert (tests["values"]["score"], tests["policy"]["score"]) == (0, 0)
    told = tests["Public Tests"]["output"]
    assert (
        "AssertionError: 5 of 16 values are right: these are the values for the discount 0.9, not 1"
        in told
    )
    assert "from [0, 0] its episodes never end, but go on around [0, 0]" in told
