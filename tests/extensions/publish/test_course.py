"""Courses: what `new` writes and `build` makes, and what students do not get."""

from __future__ import annotations

import base64
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from hashlib import sha256
from pathlib import Path

import jsonschema
import pytest
from support.classrooms import QUESTION, RESULT, TOLD
from support.places import ROOT
from yaml import safe_load

import babyrobot_levels as brl
from babyrobot_levels.extensions.packs.archive import PackError

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a folder with the example and what is built of it."""
    folder = tmp_path_factory.mktemp("course")
    brl.course(brl.new_course(folder / "robots"), folder / "built")
    return folder


def test_the_example_has_no_findings(built: Path) -> None:
    assert not brl.lint(built / "robots")
    levels = sorted((built / "robots" / "levels").iterdir())
    assert len(levels) == 11
    for path in levels:
        level = brl.load(path)
        assert level.title
        assert len(level.description or "") > 100


def test_what_is_built(built: Path) -> None:
    students, teacher = built / "built" / "students", built / "built" / "teacher"
    assert {path.name for path in students.iterdir()} == {
        "code",
        "codes.txt",
        "robots-1.0.0.brlpack",
        "sheet-a4.pdf",
        "sheet-letter.pdf",
        "site",
    }
    assert {path.name for path in teacher.iterdir()} == {
        "classroom50.zip",
        "github-classroom.yml",
        "gradescope.zip",
        "prairielearn.zip",
        "scorm.zip",
        "sheet-key-a4.pdf",
        "sheet-key-letter.pdf",
        "site",
    }
    data = json.loads((students / "site" / "gallery.json").read_text("utf-8"))
    assert data["title"] == "A robot that decides"
    assert [each["name"] for each in data["levels"]][:3] == ["first-step", "two-ways", "puddles"]
    page = (students / "site" / "index.html").read_text("utf-8")
    told = re.findall(r"(\d+)\. <bdi>(.*?)</bdi>.*?<span>(\d+ points?)</span>", page, re.DOTALL)
    assert told[:3] == [("1", "First steps", "4 points"), ("2", "Two ways", "4 points"),
                        ("3", "Puddles", "8 points")]  # fmt: skip
    code = (students / "codes.txt").read_text("utf-8").split("\n")[1]
    assert brl.load(code).digest == brl.load(built / "robots" / "levels" / "first-step.yaml").digest


@pytest.mark.usefixtures("here")
def test_students_get_nothing_of_hidden_levels(built: Path) -> None:
    students, teacher = built / "built" / "students", built / "built" / "teacher"
    assert (teacher / "site" / "exam").is_dir()
    digest = brl.load(built / "robots" / "levels" / "exam.yaml").digest
    for path in students.rglob("*"):
        assert path.stem != "exam"
        if path.is_file():
            data = path.read_bytes()
            assert b"The exam" not in data
            assert digest.encode() not in data
    assert brl.install(students / "robots-1.0.0.brlpack", force=True).pack.name == "robots"


def test_the_code_of_students_grades_itself(built: Path) -> None:
    done = subprocess.run(
        [sys.executable, "grade.py", "value_iteration"],
        cwd=built / "built" / "students" / "code",
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1, done.stderr
    lines = done.stdout.splitlines()
    assert lines[1].split(None, 4) == ["wrong", "10", "levels", "0/27", "it is not written yet"]


def test_students_install_what_the_course_was_built_with(built: Path) -> None:
    code = built / "built" / "students" / "code"
    (name,) = (code / "requirements.txt").read_text("utf-8").splitlines()
    with zipfile.ZipFile(code / name) as wheel:
        assert wheel.testzip() is None
        names = set(wheel.namelist())
        record = wheel.read(next(each for each in names if each.endswith("RECORD"))).decode()
        about = wheel.read(next(each for each in names if each.endswith("METADATA"))).decode()
    assert {line.split(",")[0] for line in record.splitlines()} == names
    assert {"babyrobot_levels/__init__.py", "babyrobot_levels/data/levels/maze.yaml"} <= names
    assert not any("__pycache__" in each or each.startswith("tests") for each in names)
    assert f"Version: {brl.__version__}\n" in about
    digest = sha256((code / name).read_bytes()).hexdigest()
    for path in (built / "built" / "teacher").glob("*.zip"):
        with zipfile.ZipFile(path) as archive:
            inside = [each for each in archive.namelist() if each.endswith(".whl")]
            assert [sha256(archive.read(each)).hexdigest() for each in inside] == [digest] * (
                path.name != "scorm.zip"
            )
    assert digest in (built / "built" / "teacher" / "github-classroom.yml").read_text("utf-8")


def test_a_course_needs_the_files_that_students_fill_in(built: Path, tmp_path: Path) -> None:
    course = shutil.copytree(built / "robots", tmp_path / "robots")
    (course / "q_learning.py").unlink()
    with pytest.raises(PackError, match=r"there is no q_learning.py in .*robots, which students"):
        brl.course(course, tmp_path / "built")
    assert not (tmp_path / "built").exists()


SOLUTION = ROOT / "tests" / "extensions" / "scoring" / "solutions" / "value_iteration.py"


def run(script: Path, folder: Path, **more: str) -> None:
    """Run an autograder in a folder."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **more}
    subprocess.run([sys.executable, script], env=environment, cwd=folder, check=True)


def unpacked(built: Path, name: str, folder: Path) -> dict[str, int]:
    """Unpack an archive for teachers, and return the modes of its files."""
    with zipfile.ZipFile(built / "built" / "teacher" / name) as archive:
        archive.extractall(folder)
        return {each.filename: each.external_attr >> 16 for each in archive.infolist()}


def test_the_autograder_runs_as_gradescope_runs_it(built: Path, tmp_path: Path) -> None:
    """In its folders, with the same script, but under another root."""
    source = tmp_path / "source"
    modes = unpacked(built, "gradescope.zip", source)
    assert modes["setup.sh"] == modes["run_autograder"] == 0o100755
    # Its images have a Python that is too old.
    setup = (source / "setup.sh").read_text("utf-8")
    assert "uv venv --python 3.13 /autograder/venv\n" in setup
    subprocess.run(["bash", "-n", source / "setup.sh"], check=True)
    (tmp_path / "submission").mkdir()
    (tmp_path / "submission" / "value_iteration.py").write_bytes(SOLUTION.read_bytes())
    for name in ("run_autograder", "grade.py"):
        text = (source / name).read_text("utf-8")
        text = text.replace("/autograder/venv/bin/python3", Path(sys.executable).as_posix())
        (source / name).write_text(text.replace("/autograder/", f"{tmp_path.as_posix()}/"), "utf-8")
    # It copies the script out of the folder.
    shutil.move(source / "run_autograder", tmp_path)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    subprocess.run(["bash", tmp_path / "run_autograder"], env=environment, check=True)
    results = json.loads((tmp_path / "results" / "results.json").read_text("utf-8"))
    names = {each["name"]: each for each in results["tests"]}
    assert names["value_iteration in vault"]["status"] == "passed"
    assert names["value_iteration in exam"]["visibility"] == "after_published"
    assert names["q_learning in ice"]["score"] == 0
    assert results["score"] == pytest.approx(32)


def test_an_autograder_installs_by_no_module_of_the_student(built: Path, tmp_path: Path) -> None:
    """A Python without the package is to install a wheel, which is none."""
    unpacked(built, "classroom50.zip", tmp_path)
    (wheel,) = tmp_path.glob("*.whl")
    script = tmp_path / "autograder.py"
    right, none = (sha256(each).hexdigest() for each in (wheel.read_bytes(), b""))
    wheel.write_bytes(b"")
    student = tmp_path / "student"
    student.mkdir()
    (student / "pip.py").write_text("open('mark', 'w')\n", "utf-8")
    python = str(Path(sys.base_prefix, "bin", "python3"))
    for told in ("another wheel than that of the course", "is invalid"):
        # That of a system is not to be changed but on purpose.
        allowed = {**os.environ, "PIP_BREAK_SYSTEM_PACKAGES": "1"}
        done = subprocess.run(
            [python, script], cwd=student, env=allowed, capture_output=True, text=True, check=False
        )
        assert told in done.stderr
        script.write_text(script.read_text("utf-8").replace(right, none), "utf-8")
    assert [each.name for each in student.iterdir()] == ["pip.py"]


@pytest.mark.sweep
def test_the_autograder_runs_as_classroom50_runs_it(built: Path, tmp_path: Path) -> None:
    """From the folder of the student, with what the runner tells."""
    unpacked(built, "classroom50.zip", tmp_path / "bundle")
    student = tmp_path / "student"
    student.mkdir()
    (student / "value_iteration.py").write_bytes(SOLUTION.read_bytes())
    run(tmp_path / "bundle" / "autograder.py", student, **TOLD)
    result = json.loads((student / "result.json").read_text("utf-8"))
    jsonschema.validate(result, RESULT)
    assert (result["score"], result["max-score"]) == (3200, 10000)


def test_the_question_runs_as_prairielearn_runs_it(built: Path, tmp_path: Path) -> None:
    """In its folders, but under another root; and `info.json` has the fields that it knows."""
    unpacked(built, "prairielearn.zip", tmp_path)
    info = json.loads((tmp_path / "info.json").read_text("utf-8"))
    jsonschema.validate(info, QUESTION)
    page = (tmp_path / "question.html").read_text("utf-8")
    assert 'file-names="value_iteration.py,policy_iteration.py,q_learning.py,' in page
    (tmp_path / "student").mkdir()
    (tmp_path / "student" / "value_iteration.py").write_bytes(SOLUTION.read_bytes())
    script = tmp_path / Path(info["externalGradingOptions"]["entrypoint"]).relative_to("/grade")
    assert script.read_bytes().startswith(b"#!/usr/bin/env python3\n")
    text = script.read_text("utf-8").replace("/grade/", f"{tmp_path.as_posix()}/")
    script.write_text(text, "utf-8")
    run(script, tmp_path)
    results = json.loads((tmp_path / "results" / "results.json").read_text("utf-8"))
    assert results["gradable"]
    assert results["score"] == pytest.approx(0.32)
    assert results["tests"][0]["points"] == results["tests"][0]["max_points"] == 1


def test_the_workflow_of_github_classroom_grades_the_code_of_students(
    built: Path, tmp_path: Path
) -> None:
    workflow = safe_load((built / "built" / "teacher" / "github-classroom.yml").read_text("utf-8"))
    # The reporter finds the job by its name, and the results by that of the runner.
    steps = workflow["jobs"]["run-autograding-tests"]["steps"]
    assert steps[-1]["env"] == {"COURSE_RESULTS": "${{ steps.course.outputs.result }}"}
    (step,) = (step for step in steps if step.get("id") == "course" == steps[-1]["with"]["runners"])
    script, output = tmp_path / "script.py", tmp_path / "output"
    script.write_text(step["run"], "utf-8")
    student = shutil.copytree(built / "built" / "students" / "code", tmp_path / "student")
    (student / "value_iteration.py").write_bytes(SOLUTION.read_bytes())
    run(script, student, GITHUB_OUTPUT=str(output))
    name, _, data = output.read_text("utf-8").partition("=")
    results = json.loads(base64.b64decode(data))
    assert (name, results["status"], results["max_score"]) == ("result", "fail", 90)
    # Students have no hidden levels.
    assert sum(each["score"] for each in results["tests"]) == pytest.approx(27)


def test_what_is_built_again_replaces_what_was_built(built: Path, tmp_path: Path) -> None:
    course = tmp_path / "course"
    course.mkdir()
    (course / "row.yaml").write_text("version: 1\nsize: [4, 1]\n", "utf-8")
    text = "name: row\nversion: 1.0.0\ndescription: A row.\nlevels: [{level: row}]\n"
    (course / "pack.yaml").write_text(text, "utf-8")
    parts: list[tuple[int, int]] = []
    first = brl.course(course, tmp_path / "out", progress=lambda *done: parts.append(done))
    assert parts[-1] == (len(parts), len(parts))
    assert "teacher/gradescope.zip" not in first.files
    assert brl.course(course, tmp_path / "out").files == first.files
    (tmp_path / "out" / "notes.txt").write_text("mine", "utf-8")
    with pytest.raises(brl.FolderError, match="there are other files"):
        brl.course(course, tmp_path / "out")
    with pytest.raises(brl.FolderError, match="something else"):
        brl.course(course, built / "robots")
    with pytest.raises(brl.FolderError, match="not apart"):
        brl.course(course, course / "out")
    with pytest.raises(brl.FolderError, match="is there already"):
        brl.new_course(course)
    with pytest.raises(PackError, match="there is no pack"):
        brl.course(tmp_path / "nothing", tmp_path / "other")


def test_students_get_no_other_files(tmp_path: Path) -> None:
    course = tmp_path / "course"
    course.mkdir()
    (course / "row.yaml").write_text("version: 1\nsize: [4, 1]\n", "utf-8")
    for name in ("solve.py", "tools.py", "solutions.py", "grades.csv", "README.md"):
        (course / name).write_text("mine", "utf-8")
    text = "name: row\nversion: 1.0.0\ndescription: A row.\nfunctions: {solve: values}\n"
    text += "levels: [{level: row}]\n"
    (course / "pack.yaml").write_text(f"{text}given: [tools.py]\n", "utf-8")
    built = brl.course(course, tmp_path / "out")
    code = [each.removeprefix("students/code/") for each in built.files if "/code/" in each]
    own = ["README.md", "pack.yaml", "requirements.txt", "row.yaml", "solve.py", "tools.py"]
    assert [each for each in code if not each.endswith(".whl")] == own
    for name in ("missing.py", "../out/contents.txt", "../course/row.yaml", "link.txt"):
        if name == "link.txt":
            (course / name).symlink_to(tmp_path / "out" / "contents.txt")
        (course / "pack.yaml").write_text(f"{text}given: [{name}]\n", "utf-8")
        with pytest.raises(PackError, match="students cannot get"):
            brl.course(course, tmp_path / "other")


@pytest.mark.parametrize(
    ("levels", "said"),
    [
        ("[{level: rwo}]", r"there is no level `rwo` here; did you mean `row`\?"),
        ("[{level: row}, {level: row}]", "`row` is listed twice"),
        ("[{level: row, functions: [value]}]", "unknown function `value`; did you mean `values`"),
        ("[{level: row, points: 0}]", "`points` must be above 0"),
        ("[{levle: row}]", "unknown field `levle`"),
    ],
)
def test_mistakes_in_the_file_are_shown_where_they_are(
    levels: str, said: str, tmp_path: Path
) -> None:
    course = tmp_path / "course"
    course.mkdir()
    (course / "row.yaml").write_text("version: 1\nsize: [4, 1]\n", "utf-8")
    text = "name: row\nversion: 1.0.0\ndescription: A row.\nfunctions: {values: values}\n"
    (course / "pack.yaml").write_text(f"{text}levels: {levels}\n", "utf-8")
    with pytest.raises(brl.LevelError, match=said) as error:
        brl.course(course, tmp_path / "out")
    assert "pack.yaml:5:" in str(error.value)
