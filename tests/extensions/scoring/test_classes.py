"""A class hands in code: in exports of schools, renamed, wrong, hostile; and all are graded."""

from __future__ import annotations

import io
import json
import shutil
import sys
import threading
import zipfile
from contextlib import suppress
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.places import TESTS
from support.plays import record

import babyrobot_levels as brl
from babyrobot_levels.extensions.scoring.class_page import class_page, student_page, write_pages
from babyrobot_levels.extensions.scoring.rosters import filled
from babyrobot_levels.extensions.scoring.sources import find_sources, write_sources

COURSE = TESTS / "cli" / "files" / "course"
RIGHT = (TESTS / "cli" / "files" / "handed-in" / "ada" / "value_iteration.py").read_text("utf-8")
NAME = "value_iteration"


def hand_in(folder: Path, files: dict[str, Any]) -> Path:
    """Write what a class hands in: texts, bytes, and what JSON can hold."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not isinstance(content, str | bytes):
            content = json.dumps(content)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    return folder


def graded(folder: Path, files: dict[str, Any], **options: Any) -> brl.Grades:
    """Grade the first function of what a class hands in."""
    return brl.grade(hand_in(folder, files), COURSE, functions=[NAME], **options)


def said(grades: brl.Grades) -> dict[str, list[str]]:
    """Return what each student reads in the first level, and the notes."""
    return {name: [each[0].message, *each.notes] for name, each in grades.submissions.items()}


def notebook(*cells: str) -> dict[str, Any]:
    kinds = [{"cell_type": "code", "source": cell.splitlines(keepends=True)} for cell in cells]
    return {"cells": [{"cell_type": "markdown", "source": "# Mine"}, *kinds], "nbformat": 4}


FORMS: dict[str, dict[str, Any]] = {
    "plain": {"value_iteration.py": RIGHT},
    "deep": {"homework/robots/value_iteration.py": RIGHT, "homework/notes.txt": "x"},
    "windows": {"value_iteration.py.txt": b"\xef\xbb\xbf" + RIGHT.encode()},
    "utf16": {"value_iteration.py": RIGHT.encode("utf-16")},
    "copy": {"Value Iteration (1).py": RIGHT},
    "renamed": {"solution.py": RIGHT},
    "draft": {"value_iteration.py": f"def {NAME}(level):\n    raise NotImplementedError\n",
              "final/value_iteration.py": RIGHT},
    "folder": {"value_iteration.py/notes.py": "x = 1", "work.py": RIGHT},
    "helper": {"a/value_iteration.py": f"from tools import {NAME}\n", "a/tools.py": RIGHT},
    "notebook": {"hw.ipynb": notebook(
        "import nowhere\n%matplotlib inline\n1 / 0", RIGHT.replace("100", "SWEEPS"),
        "SWEEPS = 100", f"values = {NAME}(None)", "this is no Python")},
}  # fmt: skip
NOTES: dict[str, list[str]] = {
    "windows": ["value_iteration.py.txt: its name ends in .txt",
                "value_iteration.py.txt: it has a byte order mark"],
    "utf16": ["value_iteration.py: it is encoded as UTF-16"],
    "copy": ["value_iteration was read from Value Iteration (1).py"],
    "renamed": ["value_iteration was read from solution.py"],
    "draft": ["value_iteration is in several files: it was read from final/value_iteration.py, "
              "not value_iteration.py"],
    "folder": ["value_iteration was read from work.py"],
    "notebook": ["value_iteration was read from hw.ipynb"],
    "table": ["answers of value_iteration are in value_iteration.json"],
}  # fmt: skip


@pytest.mark.slow
def test_code_is_found_in_whatever_form_it_is_handed_in(tmp_path: Path) -> None:
    values: Any = {
        each: brl.solve(COURSE / "levels" / f"{each}.yaml").values for each in ("row", "bend")
    }
    tables = {each: np.asarray(table).tolist() for each, table in values.items()}
    np.savez(tmp_path / "tables.npz", **values)
    forms = {
        **FORMS,
        "table": {"value_iteration.json": tables},
        "arrays": {"value_iteration.npz": (tmp_path / "tables.npz").read_bytes()},
    }
    files = {f"{who}/{name}": text for who, each in forms.items() for name, text in each.items()}
    notes = {**NOTES, "arrays": ["answers of value_iteration are in value_iteration.npz"]}
    found = graded(tmp_path / "class", files)
    right = "all 4 values are right"
    assert said(found) == {who: [right, *notes.get(who, [])] for who in sorted(forms)}
    assert {row["total"] for row in found.totals.values()} == {5.0}


EXPORTS = {
    "moodle.zip": "Ada Lovelace_77_assignsubmission_file_/value_iteration.py",
    "moodle-flat.zip": "Ada Lovelace_77_assignsubmission_file_value_iteration.py",
    "canvas.zip": "lovelaceada_LATE_77_8_value_iteration-1.py",
    "brightspace.zip": "77-8 - Ada Lovelace - Sep 25, 2026 1105 PM/value_iteration.py",
    "gradescope.zip": "assignment_1_export/submission_77/value_iteration.py",
    "classroom.zip": "robots-submissions/robots-ada/value_iteration.py",
}
METADATA = """\
---
submission_77:
  :submitters:
  - :name: Ada Lovelace
    :sid: '4711'
    :email: ada@example.org
  :created_at: 2026-09-25 23:05:00.000000000 Z
  :results: {}
submission_78:
  :submitters:
  - :name: Ben
    :sid: 12
  :created_at: 2026-09-25 23:05:00.000000000 Z
"""
ROSTERS = {
    "moodle.zip": ("Identifier,Full name,Grade", "Participant 77,Ada Lovelace,"),
    "moodle-flat.zip": ("Identifier,Full name,Grade", "Participant 77,Ada Lovelace,"),
    "canvas.zip": ("Student,ID,Robots (12)", '"Lovelace, Ada",77,'),
    "brightspace.zip": (
        "OrgDefinedId,Last Name,First Name,Robots Points Grade,End-of-Line Indicator",
        "#4,Lovelace,Ada,,#",
    ),
    "gradescope.zip": ("First Name,Last Name,SID,Email", "Ada,Lovelace,4711,ada@example.org"),
    "classroom.zip": ("identifier;github_username", "Lovelace;ada"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", EXPORTS)
def test_exports_of_schools_are_read_and_their_lists_filled(name: str, tmp_path: Path) -> None:
    own = EXPORTS[name]
    other = own.replace("77", "78").replace("Ada Lovelace", "Ben").replace("lovelaceada", "ben")
    other = other.replace("-ada", "-ben")
    files = {own: RIGHT, other: f"def {NAME}(level): return 3"}
    if "gradescope" in name:
        files["assignment_1_export/submission_metadata.yml"] = METADATA
    with zipfile.ZipFile(tmp_path / name, "w") as archive:
        for inner, text in files.items():
            archive.writestr(inner, text)
    found = brl.grade(tmp_path / name, COURSE, functions=[NAME])
    assert [each["total"] for each in found.totals.values()] == [5, 0]
    ada, ben = found.totals
    assert ada in ("Ada Lovelace", "lovelaceada", "robots-ada")
    heading, row = ROSTERS[name]
    path = tmp_path / "roster.csv"
    path.write_text(f"\ufeff{heading}\n{row}\n", "utf-8")
    column = next((each for each in heading.split(",") if "Robots" in each), None)
    text, missing = filled(path, found, column)
    head, filled_row = text.splitlines()[:2]
    cells = dict(
        zip(head.split(","), filled_row.replace("Lovelace, Ada", "x").split(","), strict=True)
    )
    assert cells[column or "Grade"] == "5"
    assert missing == {ben: "no row is alike"}


HOSTILE = {
    "loops": ("while True: pass", "it took longer than 6 seconds"),
    "allocates": ("bytearray(2 << 30)", "it took more than 0.5 GiB of memory in value_"),
    "shares": ("import mmap; m = mmap.mmap(-1, 4 << 30)\n    while True: m.write(bytes(1 << 26))",
               "it took more than 0.5 GiB of memory"),
    "leaves": ("import os; os._exit(0)", "its process ended, perhaps for want of memory"),
    "answers": ("import numpy; return numpy.zeros((1 << 26, 0))", "its answer is too large"),
    "prints": ("print('\\x1b[2J' * 10 ** 6); return 1", "the values must be an array"),
    "raises": ("raise ValueError('\\x1b[2J<script>')",
               "ValueError in value_iteration.py, line 2: \\x1b[2J<script>"),
    "kills": ("import os, signal; os.kill(os.getppid(), signal.SIGKILL); return 1",
              "the values must be an array"),
    "forks": ("import os, time\n    if os.fork() == 0: os.setsid(); open('PID', 'w').write(\n"
              "        str(os.getpid())); time.sleep(600)\n    time.sleep(0.5); return 1",
              "the values must be an array"),
}  # fmt: skip


def left_processes() -> list[Path]:
    """Return the processes that stay in a folder of a student; those of other tests soon end."""
    found = []
    for each in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if (each / "cwd").readlink().name.startswith("babyrobot-"):
                found.append(each)
    until = monotonic() + 60
    while any(each.exists() for each in found) and monotonic() < until:
        sleep(0.5)
    return [each for each in found if each.exists()]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not limit memory")
def test_hostile_code_is_named_and_touches_nobody_else(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pid = tmp_path / "pid"
    files: dict[str, Any] = {
        f"{who}/value_iteration.py": f"def {NAME}(level):\n    {body}\n".replace("PID", str(pid))
        for who, (body, _) in HOSTILE.items()
    }
    files |= {f"honest-{number}/value_iteration.py": RIGHT for number in range(3)}
    files["bomb/value_iteration.zip"] = b"PK\x03\x04nothing"
    files["pickle/value_iteration.npy"] = b"\x93NUMPY\x01\x00" + b"x" * 40
    files["deep/value_iteration.json"] = "[" * 100_000
    found = graded(tmp_path / "class", files, seconds=6, memory=0.5, jobs=2)
    told = {name: each[0] for name, each in said(found).items()}
    for who, (_, start) in HOSTILE.items():
        assert told[who].startswith(start), (who, told[who])
    assert told["bomb"].startswith("not graded: the zip file is damaged")
    for who in ("pickle", "deep"):
        assert "has no tables" in told[who]
    for number in range(3):
        assert found.totals[f"honest-{number}"]["total"] == 5
    assert capfd.readouterr() == ("", "")
    for page in (class_page(found), student_page(found, "raises")):
        assert "<script" not in page
        assert "\x1b" not in page
    assert not left_processes()
    status = Path("/proc", pid.read_text("utf-8"), "status")
    assert not status.exists() or "zombie" in status.read_text("utf-8")


@pytest.mark.slow
def test_what_could_not_be_graded_is_no_0(tmp_path: Path) -> None:
    files = {"ada/value_iteration.py": RIGHT, "ben/essay.pdf": "x", "cid/work.zip": "PK"}
    found = graded(tmp_path / "class", files)
    told = said(found)
    assert told["ben"][0].startswith("not graded: there is no file to grade, but essay.pdf: ")
    assert told["cid"][0].startswith("not graded: the zip file is damaged")
    assert sorted(found.totals_to_csv().splitlines()) == [
        "ada,5.0,5.0", "ben,,", "cid,,", "player,value_iteration.py,total",
    ]  # fmt: skip
    assert not found.are_valid
    assert (found.submissions["ben"].points, found.submissions["ben"].ungraded) == (0, 2)
    assert "not graded" in class_page(found)
    scope = found.submissions["ben"].to_gradescope()
    assert scope["score"] == 0
    assert json.loads(found.to_json())["totals"]["ben"] == {
        "value_iteration.py": None,
        "total": None,
    }


@pytest.mark.slow
def test_typos_are_errors_and_no_marks(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with zipfile.ZipFile(tmp_path / "empty.zip", "w"):
        pass
    (tmp_path / "text.zip").write_text("x", "utf-8")
    for path, told in {
        "empty": "there is no file to grade",
        "empty.zip": "there is no file to grade",
        "text.zip": "the zip file is damaged",
    }.items():
        with pytest.raises(ValueError, match=f"nothing can be graded in .*{path}: {told}"):
            brl.grade(tmp_path / path, COURSE)
    with pytest.raises(FileNotFoundError):
        brl.grade(tmp_path / "nosuch", COURSE)
    with pytest.raises(brl.LevelNotFoundError):
        brl.grade(tmp_path / "empty", "nosuch")
    for asked in ("sarsa", ["sarsa"]):
        with pytest.raises(ValueError, match="'sarsa' is no function of the course"):
            brl.grade(hand_in(tmp_path / "a", {"ada/x.py": ""}), COURSE, functions=asked)


@pytest.mark.slow
def test_results_are_kept_until_files_change(tmp_path: Path) -> None:
    files = {"ada/value_iteration.py": RIGHT, "ben/value_iteration.py": RIGHT + "# mine\n"}
    kept, steps = tmp_path / "kept", list[tuple[int, int]]()
    first = graded(tmp_path / "class", files, kept=kept, progress=lambda *done: steps.append(done))
    assert steps == [(1, 2), (2, 2)]
    before = {path: path.stat().st_mtime_ns for path in kept.iterdir()}
    assert len(before) == 2
    again = graded(tmp_path / "class", {"ben/value_iteration.py": "x = 1"}, kept=kept)
    after = {path: path.stat().st_mtime_ns for path in kept.iterdir()}
    assert {path: after[path] for path in before} == before
    assert len(after) == 3
    assert [*again.submissions["ada"]] == [*first.submissions["ada"]]
    assert again.totals["ben"]["total"] == 0
    assert first.shared == {"value_iteration.py": [["ada", "ben"]]}


@pytest.mark.slow
def test_an_interrupt_ends_all_that_runs(tmp_path: Path) -> None:
    sleeping = f"import time\ndef {NAME}(level): time.sleep(60)"
    files = {"ada/value_iteration.py": RIGHT, "ben/value_iteration.py": sleeping}

    def interrupted(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        graded(tmp_path / "class", files, progress=interrupted, jobs=2)
    assert not [each for each in threading.enumerate() if each.name.startswith("ThreadPool")]


@pytest.mark.slow
def test_what_students_are_given_is_there_also_if_they_do_not_hand_it_in(tmp_path: Path) -> None:
    course = tmp_path / "course"
    shutil.copytree(COURSE, course)
    (course / "tools.py").write_text(RIGHT, "utf-8")
    text = (course / "pack.yaml").read_text("utf-8")
    (course / "pack.yaml").write_text(f"{text}given: [tools.py, ../missing.py]\n", "utf-8")
    files = {"ada/value_iteration.py": f"from tools import {NAME}\n"}
    found = brl.grade(hand_in(tmp_path / "class", files), course, functions=[NAME])
    assert found.totals["ada"]["total"] == 5


@pytest.mark.slow
def test_plays_count_beside_code(tmp_path: Path) -> None:
    files = {"ada/value_iteration.py": RIGHT, "ben/value_iteration.py": "x = 1"}
    folder = hand_in(tmp_path / "class", files)
    record(folder / "ada" / "row.brlplay", brl.load(COURSE / "levels" / "row.yaml"), episodes=1)
    found = brl.grade(folder, COURSE, functions=[NAME])
    assert [*found.worth.items()] == [("value_iteration.py", 5.0), ("row", 4.0), ("bend", 6.0)]
    assert found.totals["ada"]["value_iteration.py"] == 5
    assert found.totals["ada"]["row"] > 0
    assert found.totals["ben"] == {"value_iteration.py": 0, "row": 0, "bend": 0, "total": 0}


@pytest.mark.slow
def test_pages(tmp_path: Path) -> None:
    files = {f"{who}/value_iteration.py": f"def {NAME}(level): return level.{who[0]}"
             for who in ("Ada <b>", "Adà b", "../x")}  # fmt: skip
    files["Zoe/value_iteration.py"] = RIGHT
    found = graded(
        tmp_path / "class", {name: text for name, text in files.items() if ".." not in name}
    )
    write_pages(found, tmp_path / "out")
    names = sorted(path.name for path in (tmp_path / "out" / "students").iterdir())
    assert names == ["ad-b.html", "ada-b.html", "zoe.html"]
    (tmp_path / "out" / "students" / "gone.html").write_text("", "utf-8")
    write_pages(found, tmp_path / "out")
    assert sorted(path.name for path in (tmp_path / "out" / "students").iterdir()) == names
    page = (tmp_path / "out" / "index.html").read_text("utf-8")
    assert "<b>" not in page
    assert '<a href="students/zoe.html">Zoe</a>' in page
    assert "A small course" in page
    own = (tmp_path / "out" / "students" / "zoe.html").read_text("utf-8")
    assert "5 of 5 points" in own
    assert "all 4 values are right" in own


@pytest.mark.slow
def test_one_folder_is_one_student(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hand_in(tmp_path / "ada", {"value_iteration.py": RIGHT, "extra/notes.py": "x = 1"})
    found = brl.grade(tmp_path / "ada", COURSE, functions=[NAME])
    assert [*found.submissions] == ["ada"]
    monkeypatch.chdir(tmp_path / "ada")
    assert [*brl.grade(".", COURSE, functions=[NAME]).submissions] == ["ada"]
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        archive.writestr("value_iteration.py", RIGHT)
    (tmp_path / "ben.zip").write_bytes(out.getvalue())
    both = brl.grade([tmp_path / "ada", tmp_path / "ben.zip"], COURSE, functions=[NAME])
    assert {name: each["total"] for name, each in both.totals.items()} == {"ada": 5, "ben": 5}
    assert repr(both) == "<Grades of 2 players>"


def test_odd_files_of_plays_are_told(tmp_path: Path) -> None:
    row = brl.load(COURSE / "levels" / "row.yaml")
    record(tmp_path / "row.brlplay", row, episodes=1)
    data = b"\xef\xbb\xbf" + (tmp_path / "row.brlplay").read_bytes()
    found = brl.grade(hand_in(tmp_path / "class", {"ada/row.brlplay.txt": data}), row)
    assert found[0].episodes == 1
    assert found[:1].notes == {
        "ada": [
            "row.brlplay.txt: its name ends in .txt",
            "row.brlplay.txt: it has a byte order mark",
        ]
    }
    with pytest.raises(ValueError, match="there are no functions to grade"):
        brl.grade(tmp_path / "class", row, functions=[NAME])


def test_virtual_environments_are_no_code_of_a_student(tmp_path: Path) -> None:
    files = {"venv/pyvenv.cfg": "", "venv/x.py": RIGHT, "main.py": "x = 1", ".git/y.py": RIGHT}
    found = said(graded(tmp_path / "ada", files))
    assert found["ada"] == [
        "there is no value_iteration.py, but main.py, and none of the files has a function "
        "value_iteration"
    ]


NAMES = st.text(st.sampled_from("ab./ \\\0\n(1)_-é"), min_size=1, max_size=12)
TEXTS = st.sampled_from(
    [
        RIGHT,
        RIGHT[:90],
        json.dumps(notebook(RIGHT)),
        "[[1]]",
        "{",
        "[" * 9999,
        "(" * 999,
        "\ud800",
        "\0",
    ]
) | st.text(max_size=30)


@pytest.mark.slow
@given(
    st.dictionaries(
        st.tuples(NAMES, st.sampled_from([".py", ".ipynb", ".json", ".npy", ".npz", ".py.txt"])),
        TEXTS,
        max_size=4,
    )
)
def test_whatever_is_handed_in_is_read_or_a_fault_and_stays_in_its_folder(
    tmp_path_factory: pytest.TempPathFactory, files: dict[tuple[str, str], str]
) -> None:
    data = {
        "".join(name).replace("..", "").lstrip("/"): text.encode("utf-8", "surrogatepass")
        for name, text in files.items()
    }
    (source,) = find_sources(data, [NAME]).values()
    assert (source.text is None) + (source.tables is None) + (not source.fault) == 2
    around = tmp_path_factory.mktemp("around")
    (around / "code").mkdir()
    write_sources(around / "code", data, {NAME: source})
    assert [each.name for each in around.iterdir()] == ["code"]
    assert (around / "code" / "value_iteration.py").exists() or source.text is None


@pytest.mark.slow
def test_names_of_files_are_shown_as_text_in_reports(tmp_path: Path) -> None:
    name = "x\x1b[2J\nada  right.py"
    with zipfile.ZipFile(tmp_path / "class.zip", "w") as archive:
        archive.writestr(f"ada/{name}", RIGHT)
        archive.writestr("ben/b.py", "x = 1")
    found = brl.grade(tmp_path / "class.zip", COURSE, functions=[NAME])
    report = str(found.submissions["ada"])
    assert "\nnote: value_iteration was read from x\\x1b[2J ada right.py\n" in report
