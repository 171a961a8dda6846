"""Submissions: the code of students is run in each level of the course, and graded."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from support.classrooms import RESULT, TOLD
from support.places import ROOT

import babyrobot_levels as brl
from babyrobot_levels.extensions.packs.archive import PackError
from babyrobot_levels.text.budget import Limits, OverBudgetError, within

SOLUTIONS = Path(__file__).parent / "solutions"

PACK = """\
name: small
version: 1.0.0
description: Two levels.
functions: {value_iteration: values, policy_iteration: policy}
levels:
  - {level: row, points: 4}
  - {level: lake, points: 6, functions: [value_iteration], hidden: true}
"""

MISSING = (
    "there is no policy_iteration.py, but value_iteration.py, and none of the files has a function "
    "policy_iteration"
)


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """Return the folder of a small course."""
    folder = tmp_path / "small"
    folder.mkdir()
    (folder / "pack.yaml").write_text(PACK, "utf-8")
    (folder / "row.yaml").write_text("version: 1\nsize: [4, 1]\n", "utf-8")
    lake = brl.load("frozen-lake").replace(name="lake")
    lake.save(folder / "lake.yaml")
    return folder


def code(folder: Path, **texts: str) -> Path:
    """Write the files of a student."""
    folder.mkdir(exist_ok=True)
    for name, text in texts.items():
        (folder / f"{name}.py").write_text(text, "utf-8")
    return folder


@pytest.mark.sweep
def test_solutions_have_all_points_in_the_example() -> None:
    found = brl.grade_functions(ROOT / "course", SOLUTIONS)
    assert [each.message for each in found if not each.passed] == []
    assert (round(found.points, 9), found.out_of) == (100, 100)


def test_the_skeleton_has_none_and_says_why(small: Path) -> None:
    shutil.copy(ROOT / "course" / "value_iteration.py", small)
    found = brl.grade_functions(small)
    assert found.points == 0
    assert found.out_of == 10
    assert [each.out_of for each in found] == [2, 6, 2]
    assert [each.hidden for each in found] == [False, True, False]
    report = str(found).splitlines()
    assert report[0] == "value_iteration"
    assert report[1].split(None, 4) == ["wrong", "2", "levels", "0/8", "it is not written yet"]
    assert report[3].endswith(MISSING)
    assert report[-1] == "0 of 10 points"


@pytest.mark.beside("publish")
def test_a_virtual_environment_in_the_folder_is_none_of_the_course(small: Path) -> None:
    code(small, value_iteration="x = 1")
    (small / "venv" / "lib").mkdir(parents=True)
    (small / "venv" / "pyvenv.cfg").write_text("", "utf-8")
    (small / "venv" / "lib" / "port.yaml").write_text("a: 1\n", "utf-8")
    assert brl.grade_functions(small, functions=["value_iteration"]).out_of == 8
    assert not brl.lint(small)
    left_out = brl.pack(small, small.parent / "small.brlpack").left_out
    assert [*left_out] == ["value_iteration.py", "venv/"]


@pytest.mark.slow
def test_each_fault_of_code_is_told_in_a_line(small: Path, tmp_path: Path) -> None:
    wrong = """\
def value_iteration(level):
    if level.name == "row":
        return helper()
    raise SystemExit(3)


def helper():
    return [1][2]
"""
    found = brl.grade_functions(small, code(tmp_path / "ada", value_iteration=wrong))
    row, lake, policy = found
    assert row.message == "IndexError in value_iteration.py, line 8: list index out of range"
    assert lake.message.startswith("SystemExit in value_iteration.py, line 4: 3: ")
    assert policy.message == MISSING


@pytest.mark.slow
def test_a_function_that_never_returns_is_ended(small: Path, tmp_path: Path) -> None:
    endless = "def value_iteration(level):\n    while True: pass\n"
    ada = code(tmp_path / "ada", value_iteration=endless)
    found = brl.grade_functions(small, ada, functions=["value_iteration"], seconds=4)
    assert [each.message for each in found] == [
        "it took longer than 4 seconds",
        "it was not run, as it took too long in row",
    ]


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not limit memory")
def test_memory_is_limited(small: Path, tmp_path: Path) -> None:
    large = """\
import numpy as np
def value_iteration(level):
    if level.name == "row":
        return np.ones((64, 2**24))
    return bytearray(2**34)
"""
    ada = code(tmp_path / "ada", value_iteration=large)
    found = brl.grade_functions(small, ada, functions=["value_iteration"], memory=1.5)
    assert [each.message for each in found] == [
        "it took more than 1.5 GiB of memory in value_iteration.py, line 4",
        "it took more than 1.5 GiB of memory in value_iteration.py, line 5",
    ]


@pytest.mark.slow
def test_results_for_other_systems(small: Path) -> None:
    shutil.copy(SOLUTIONS / "value_iteration.py", small)
    found = brl.grade_functions(small)
    scope = json.loads(json.dumps(found.to_gradescope()))
    assert scope["score"] == 8
    assert scope["leaderboard"] == [{"name": "Points", "value": 8}]
    assert [each["visibility"] for each in scope["tests"]] == [
        "visible",
        "after_published",
        "visible",
    ]
    assert scope["tests"][0] == {
        "name": "value_iteration in row",
        "status": "passed",
        "score": 2,
        "max_score": 2,
        "output": "all 4 values are right",
        "visibility": "visible",
    }
    learn = found.to_prairielearn()
    assert learn["score"] == pytest.approx(0.8)
    assert [each["output"] == "" for each in learn["tests"]] == [False, True, False]
    classroom = json.loads(json.dumps(found.to_github_classroom()))
    assert (classroom["version"], classroom["status"], classroom["max_score"]) == (1, "fail", 10)
    assert [each["status"] for each in classroom["tests"]] == ["pass", "pass", "fail"]
    assert [each["score"] for each in classroom["tests"]] == [2, 6, 0]
    assert [each["message"] == "" for each in classroom["tests"]] == [False, True, False]
    assert json.loads(found.to_json())["out_of"] == 10
    assert found.to_csv().splitlines()[0].startswith("function,level,hidden,passed,points")


@pytest.mark.slow
def test_scores_of_classroom50_are_whole_numbers(small: Path) -> None:
    thirds = PACK.replace("points: 4", "points: 5").replace("points: 6", "points: 0.3")
    (small / "pack.yaml").write_text(thirds, "utf-8")
    shutil.copy(SOLUTIONS / "value_iteration.py", small)
    found = brl.grade_functions(small)
    result = json.loads(json.dumps(found.to_classroom50(TOLD)))
    jsonschema.validate(result, RESULT)
    assert (result["owner"], result["submission"]) == ("ada", TOLD["SUBMISSION_TAG"])
    scores = [(each["passed"], each["score"], each["max-score"]) for each in result["tests"]]
    assert scores == [(True, 250, 250), (True, 30, 30), (False, 0, 250)]
    assert (result["score"], result["max-score"]) == (280, 530)
    with pytest.raises(KeyError, match="OWNER"):
        found.to_classroom50({name: TOLD[name] for name in TOLD if name != "OWNER"})


def test_a_course_may_grade_no_function_in_any_level(small: Path) -> None:
    text = (small / "pack.yaml").read_text("utf-8")
    text = text.replace("[value_iteration]", "[]").replace("points: 4", "functions: []")
    (small / "pack.yaml").write_text(text, "utf-8")
    found = brl.grade_functions(small)
    assert str(found) == "0 of 0 points"
    assert found.to_prairielearn() == {"gradable": True, "score": 0, "tests": []}


def test_what_is_no_folder_of_a_student_is_an_error_and_no_mark(
    small: Path, tmp_path: Path
) -> None:
    hand = tmp_path / "hand"
    for folder in (hand, hand / "ada", hand / ".git", hand / "__MACOSX"):
        folder.mkdir()
    (tmp_path / "ada.zip").write_bytes(b"PK")
    with pytest.raises(FileNotFoundError, match="nosuch"):
        brl.grade_functions(small, tmp_path / "nosuch")
    for path, told in {
        tmp_path / "ada.zip": "nothing can be graded in .*ada.zip: the zip file is damaged",
        hand: "nothing can be graded in .*hand: there is no file to grade",
    }.items():
        with pytest.raises(ValueError, match=told):
            brl.grade_functions(small, path)
    # What a zip file puts around the files does not matter.
    code(hand / "ada", notes="")
    found = brl.grade_functions(small, hand)
    assert {each.message[:22] for each in found} == {
        "there is no value_iter",
        "there is no policy_ite",
    }
    code(hand / "ben", notes="")
    with pytest.raises(ValueError, match=r"hand has no value_iteration.py or .* one student"):
        brl.grade_functions(small, hand)


def test_what_is_no_course(small: Path, tmp_path: Path) -> None:
    with pytest.raises(PackError, match=r"there is no pack.yaml in"):
        brl.grade_functions(tmp_path)
    with pytest.raises(ValueError, match="seconds must be above 0, not 0"):
        brl.grade_functions(small, seconds=0)
    with pytest.raises(ValueError, match="memory must be above 0, not -1"):
        brl.grade_functions(small, memory=-1)
    with pytest.raises(ValueError, match="'sarsa' is no function of the course"):
        brl.grade_functions(small, functions=["sarsa"])
    text = (small / "pack.yaml").read_text("utf-8")
    (small / "pack.yaml").write_text(text.partition("functions")[0], "utf-8")
    with pytest.raises(PackError, match="lists no `levels`"):
        brl.grade_functions(small)


@pytest.mark.slow
def test_what_is_graded_so_far_is_told_and_what_is_left_is_not_graded(
    small: Path, tmp_path: Path
) -> None:
    slow = "import time\ndef value_iteration(level): time.sleep(1); return 1\n"
    other = slow.replace("value", "policy")
    ada = code(tmp_path / "ada", value_iteration=slow, policy_iteration=other)
    seen: list[brl.Submission] = []
    found = brl.grade_functions(small, ada, total=0.5, progress=seen.append)
    assert [len(each) for each in seen] == [1, 2, 3]
    assert [each.is_graded for each in found] == [True, False, False]
    assert found[1].message == "not graded: there was no time left"
    assert found.to_dict()["functions"][1]["points"] is None
    assert str(found).endswith("0 of 10 points, 2 not graded")
    with pytest.raises(ValueError, match="total must be above 0"):
        brl.grade_functions(small, ada, total=0)


def test_levels_in_which_answers_are_graded_have_the_limits_at_hand(
    small: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "class" / "ada"
    folder.mkdir(parents=True)
    tables = {"row": brl.solve(small / "row.yaml").values.tolist()}
    (folder / "value_iteration.json").write_text(json.dumps(tables), "utf-8")
    asked: dict[str, Any] = {"functions": ["value_iteration"], "jobs": 1}
    with within(Limits(1_000_000, 1_000)):
        found = brl.grade(folder.parent, small, **asked)
        assert found.submissions["ada"].points == 2
    with within(Limits(10, 1_000)), pytest.raises(OverBudgetError, match="more than 10 steps"):
        brl.grade(folder.parent, small, **asked)
