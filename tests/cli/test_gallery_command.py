"""`babyrobot gallery`: its arguments, its errors, and what Ctrl-C leaves."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.folders import write_files
from support.packs import pack_text
from support.sessions import Result, babyrobot, environment

pytestmark = pytest.mark.usefixtures("here")

GOOD = "version: 1\nsize: [4, 4]\n"
BAD = "version: 1\nsize: [4, 4]\nexit: [9, 9]\n"


def ids(folder: str) -> list[str]:
    return [each["id"] for each in json.loads(Path(folder, "gallery.json").read_text())["levels"]]


@pytest.mark.slow
def test_levels_of_all_kinds_become_a_gallery() -> None:
    write_files(Path("mine"), {"a.yaml": GOOD, "b/a.yaml": "version: 1\nsize: [5, 5]\n"})
    given = b"version: 1\nname: typed\nsize: [3, 3]\n"
    done = babyrobot("gallery", "mine", "first-key", "-", "-o", "site", given=given)
    assert done == Result("wrote 4 levels to site/index.html\n", "", 0)
    assert ids("site") == ["a", "a-2", "first-key", "typed"]


@pytest.mark.slow
def test_errors_of_files_are_reported_as_by_validate_and_nothing_is_written() -> None:
    write_files(Path("mine"), {"0.yaml": GOOD, "1.yaml": BAD, "2.yaml": BAD})
    report = babyrobot("validate", "mine").out
    done = babyrobot("gallery", "mine", "-o", "site")
    assert (done.out, done.status) == ("", 1)
    assert done.err.startswith(report)
    assert "--keep-going" in done.err
    assert not Path("site").exists()
    done = babyrobot("gallery", "mine", "-o", "site", "--keep-going")
    assert (done.out, done.err, done.status) == ("wrote 1 level to site/index.html\n", report, 1)
    assert ids("site") == ["0"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("jobs", "number"),
    [
        ("2", signal.SIGINT),
        *(
            pytest.param(*each, marks=pytest.mark.sweep)
            for each in (("1", signal.SIGINT), ("1", signal.SIGTERM), ("2", signal.SIGTERM))
        ),
    ],
)
def test_ctrl_c_leaves_what_was_there(jobs: str, number: int) -> None:
    assert babyrobot("gallery", "maze", "-o", "site").status == 0
    Path("many.yaml").write_text("version: 1\nkind: suite\ncount: 1000\nsize: [6, 6]\n")
    call = ["gallery", "many.yaml", "-o", "site", "--jobs", jobs]
    process = subprocess.Popen(
        [sys.executable, "-m", "babyrobot_levels", *call],
        env={**os.environ, **environment(Path.cwd())},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while process.poll() is None and not [*Path().glob(".site.*/new/*/index.html")]:
        time.sleep(0.01)
    process.send_signal(number)
    assert process.communicate(timeout=60) == ("", "")
    assert process.returncode == 128 + number
    assert ids("site") == ["maze"]
    assert sorted(path.name for path in Path().iterdir()) == ["many.yaml", "site"]


@pytest.mark.slow
def test_the_copies_in_a_gallery_below_are_no_levels_of_the_folder() -> None:
    write_files(Path("course"), {"pack.yaml": pack_text("course"), "levels/a.yaml": GOOD})
    for _ in range(2):
        made = babyrobot("gallery", "course", "-o", "course/site")
        assert made.out == "wrote 1 level to course/site/index.html\n"
    assert babyrobot("lint", "course").out == "1 file checked, clean\n"
    assert "left out: site/\n" in babyrobot("pack", "course").out
    assert babyrobot("gallery", "course/site", "-o", "again").status == 0
    write_files(Path("mine"), {"gallery.json": "{}", "b/a.yaml": GOOD})
    assert babyrobot("validate", "mine").out == "1 file checked, valid\n"


def test_the_current_folder_is_not_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("site/inside").mkdir(parents=True)
    for here, folder in (("site/inside", ".."), (".", ".")):
        monkeypatch.chdir(here)
        done = babyrobot("gallery", "maze", "-o", folder)
        assert (done.out, done.status) == ("", 2)
        assert f"error: {folder} is or contains the current folder" in done.err
        assert Path.cwd().is_dir()


def test_a_gallery_cannot_be_piped() -> None:
    done = babyrobot("gallery", "maze", "-o", "-")
    assert (done.status, done.err) == (
        2,
        "error: a gallery is a folder, and cannot be piped\n  help: name the folder: -o DIR\n",
    )
    assert not Path("-").exists()
