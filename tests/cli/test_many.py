"""Many levels in one call: rows that do not depend on who works, in files that can be continued."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.folders import write_files
from support.sessions import Result, babyrobot, environment

import babyrobot_levels as brl

pytestmark = pytest.mark.usefixtures("here")

SUITE = "version: 1\nkind: suite\nname: few\ncount: 12\nsize: [4, 4]\n"
BAD = "version: 1\nsize: [4, 4]\nexit: [9, 9]\n"


LEVEL = "version: 1\nsize: [4, 4]\n"


def written(name: str, text: str = LEVEL) -> None:
    write_files(Path(), {name: text})


def rows(text: str) -> list[dict[str, object]]:
    return [json.loads(line) for line in text.splitlines()]


def test_folders_packs_and_levels_of_all_kinds_have_rows() -> None:
    written("mine/a.yaml")
    written("mine/b/c.yaml", "version: 1\nsize: [5, 5]\n")
    written("mine/list.yaml", "version: 1\nkind: suite\nlevels: [maze]\n")
    code = brl.load("frozen-lake").share_code()
    given = b"version: 1\nname: typed\nsize: [3, 3]\n"
    done = babyrobot("solve", "mine", "final-maze", code, "-", "--format", "json", given=given)
    assert (done.status, done.err) == (0, "")
    found = rows(done.out)
    assert [row["name"] for row in found] == ["a", "c", "final-maze", "frozen-lake", "typed"]
    assert [row["index"] for row in found] == [*range(5)]
    assert found[3]["expected_return"] == pytest.approx(14 / 17)


@pytest.mark.slow
@pytest.mark.parametrize("command", ["solve", "show"])
def test_rows_do_not_depend_on_the_number_of_processes(command: str) -> None:
    written("few.yaml", SUITE + "splits: {train: 0.5, test: 0.5}\n")
    for jobs in ("1", "2"):
        call = (command, "few.yaml", "--split", "test", "--jobs", jobs, "-o", f"{jobs}.jsonl")
        assert babyrobot(*call) == Result(f"wrote 6 rows to {jobs}.jsonl\n", "", 0)
    text = Path("1.jsonl").read_text(encoding="utf-8")
    assert Path("2.jsonl").read_text(encoding="utf-8") == text
    assert [row["name"] for row in rows(text)] == [f"few-{n:05}" for n in range(6, 12)]


def solved(*options: str) -> bytes:
    """Return the rows of the suite."""
    babyrobot("solve", "few.yaml", "-o", "whole.jsonl", *options)
    return Path("whole.jsonl").read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("cut", [5, 13, 600, -1], ids=lambda cut: f"at byte {cut}")
def test_rows_that_are_there_are_kept(cut: int) -> None:
    written("few.yaml", SUITE)
    whole = solved()
    kept = (whole[:cut] if cut >= 0 else whole).count(b"\n")
    Path("rows.jsonl").write_bytes(whole[:cut] if cut >= 0 else whole)
    done = babyrobot("solve", "few.yaml", "-o", "rows.jsonl", "--resume", "--jobs", "2")
    text = f"wrote {12 - kept} rows to rows.jsonl"
    assert done == Result(text + (f"; kept {kept}\n" if kept else "\n"), "", 0)
    assert Path("rows.jsonl").read_bytes() == whole


def test_rows_of_another_call_are_left_alone() -> None:
    written("few.yaml", SUITE + "max_steps: 50\n")
    written("other.yaml", SUITE + "seed: 8\n")
    cut = solved()[:2000]
    Path("rows.jsonl").write_bytes(cut)
    for call in ("few.yaml --within max_steps", "few.yaml --discount 0.5",
                 "few.yaml --actions turns", "other.yaml", "final-maze"):  # fmt: skip
        done = babyrobot("solve", *call.split(), "-o", "rows.jsonl", "--resume")
        assert done.status == 2
        assert "rows.jsonl was written for other levels or with other options" in done.err
        assert Path("rows.jsonl").read_bytes() == cut


def test_a_file_that_is_no_rows_is_left_alone() -> None:
    for text in ("notes", "notes\n", '{"index": 1}\n', '{"index": 0, "name"'):
        written("rows.jsonl", text)
        done = babyrobot("solve", "final-maze", "-o", "rows.jsonl", "--resume")
        is_row = text.endswith('"name"')
        assert (done.status == 0, Path("rows.jsonl").read_text() == text) == (is_row, not is_row)
    before = Path("rows.jsonl").read_bytes()
    done = babyrobot("solve", "final-maze", "-o", "rows.jsonl")
    assert done == Result(
        "",
        "error: rows.jsonl already exists\n"
        "  help: use --resume to continue it, or --force to overwrite\n",
        2,
    )
    assert babyrobot("solve", "frozen-lake", "-o", "rows.jsonl", "--force").status == 0
    assert Path("rows.jsonl").read_bytes() != before


@pytest.mark.sweep
def test_an_interrupted_call_can_be_continued() -> None:
    written("many.yaml", SUITE.replace("12", "2000"))
    call = ["solve", "many.yaml", "-o", "rows.jsonl"]
    process = subprocess.Popen(
        [sys.executable, "-m", "babyrobot_levels", *call, "--jobs", "2"],
        env={**os.environ, **environment(Path.cwd())},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    file = Path("rows.jsonl")
    while not (file.exists() and file.stat().st_size > 5_000) and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    kept = file.read_bytes()
    count = kept.count(b"\n")
    assert (process.returncode, out) == (130, "")
    assert err == (
        f"stopped: {count:,} of 2,000 rows are in rows.jsonl\n"
        "  help: continue with the same call and --resume\n"
    )
    assert 0 < count < 2000
    assert babyrobot(*call, "--resume").out == (
        f"wrote {2000 - count:,} rows to rows.jsonl; kept {count:,}\n"
    )
    whole = file.read_bytes()
    assert whole.startswith(kept)
    assert [row["index"] for row in rows(whole.decode())] == [*range(2000)]


@pytest.mark.slow
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_poisoned_level_is_told_by_its_index(jobs: str) -> None:
    for number in range(6):
        written(f"mine/{number}.yaml", BAD if number == 3 else "version: 1\nsize: [4, 4]\n")
    call = ("solve", "mine", "--jobs", jobs, "-o")
    error = "mine/3.yaml:3:7: the exit [9, 9] is off the grid, which is 4 wide and 4 high"
    done = babyrobot(*call, "rows.jsonl")
    assert done == Result("wrote 3 rows to rows.jsonl\n", f"level 3: {error}\n", 1)
    done = babyrobot(*call, "all.jsonl", "--keep-going")
    assert done == Result("wrote 6 rows to all.jsonl\n", f"level 3: {error}\n", 1)
    found = rows(Path("all.jsonl").read_text(encoding="utf-8"))
    assert [row["error"] for row in found] == [None] * 3 + [error] + [None] * 2
    # What was wrong is put right, and the call continued.
    written("mine/3.yaml")
    assert babyrobot(*call, "rows.jsonl", "--resume").status == 0
    assert len(rows(Path("rows.jsonl").read_text(encoding="utf-8"))) == 6


def test_csv_has_the_same_columns_in_every_row() -> None:
    text = babyrobot("show", "final-maze", "first-key", "--format", "csv").out
    plain, locked = csv.DictReader(text.splitlines())
    assert (plain["doors"], locked["doors"]) == ("", "1")
    assert [row["path_length"] for row in (plain, locked)] == ["17", "8"]
    text = babyrobot("solve", "final-maze", "--format", "csv").out
    (row,) = csv.DictReader(text.splitlines())
    assert row["expected_return"] == "-36.5833333"


def test_a_suite_is_shown_as_a_whole_unless_its_levels_are_asked_for() -> None:
    assert "splits:" in babyrobot("show", "small-mazes").out
    written("few.yaml", SUITE)
    assert len(babyrobot("show", "few.yaml", "--format", "csv").out.splitlines()) == 13


@pytest.mark.slow
@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("solve final-maze small-mazes", "small-mazes is a suite, which stands alone"),
        ("solve final-maze --split test", "--split is a part of a suite, and this is none"),
        ("solve small-mazes --split tset", "there is no split 'tset'"),
        ("solve final-maze maze --held key", "--held is for one level"),
        ("solve final-maze maze --within 0", "--within must be a number of steps from 1 on"),
        ("solve final-maze maze --discount 2", "--discount must be above 0 and at most 1"),
        ("solve final-maze nowhere", "there is no level called 'nowhere'"),
        ("solve final-maze no.yaml", "there is no file 'no.yaml'"),
        ("solve final-maze maze --resume", "--resume continues a file"),
        ("solve maze -o rows.csv --format csv", "--output writes lines of JSON"),
        ("solve maze -o -", "--output is the path of a file"),
        ("solve empty", "no level files (.yaml) in empty"),
        ("show final-maze maze --cite", "--cite is for one level"),
    ],
)
def test_wrong_calls_are_told(call: str, said: str) -> None:
    Path("empty").mkdir()
    done = babyrobot(*call.split())
    assert (done.status, done.out) == (2, "")
    assert said in done.err


def test_a_call_that_cannot_begin_leaves_files_as_they_are() -> None:
    for before in (None, "mine\n"):
        if before:
            written("rows.jsonl", before)
        call = ("solve", "few.yaml", "-o", "rows.jsonl", "--force", "--ray-address", "nowhere")
        written("few.yaml", SUITE)
        assert babyrobot(*call).status == 2
        assert (Path("rows.jsonl").read_text() if before else None) == before
        assert Path("rows.jsonl").exists() is bool(before)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "told"),
    [
        ("preview endless.yaml -o page.html", "wrote page.html"),
        ("score best endless.yaml", "-9e+07  -9e+07   -9e+07"),
        ("solve endless.yaml --within max_steps", "expected return: -9e+07"),
        ("solve endless.yaml --within max_steps --format json", "is too large for JSON"),
        ("solve large.yaml --within max_steps", "within 50,000,000 steps is too large"),
    ],
)
def test_limits_of_millions_of_steps_are_answered_in_time(command: str, told: str) -> None:
    rewards = "rewards: {step: -1}, max_steps: 90000000"
    written("endless.yaml", f"{{version: 1, size: [2, 1], exit: none, {rewards}}}")
    written("large.yaml", "{version: 1, size: [6, 6], max_steps: 50000000}")
    begin = time.perf_counter()
    done = babyrobot(*command.split())
    assert told in done.out + done.err
    assert time.perf_counter() - begin < 30


FULL = """
import os, resource, sys
from babyrobot_levels.__main__ import main

limit = int(sys.argv.pop(1))
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
main()
"""
"""The command where files can have so many bytes: like a full disk."""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs limits of files")
def test_a_full_disk_leaves_whole_rows_or_what_was_there() -> None:
    written("few.yaml", SUITE)
    whole = solved()
    call = ["solve", "few.yaml", "-o", "rows.jsonl", "--force"]
    for limit, count in ((100, 0), (1000, whole[:1000].count(b"\n"))):
        written("rows.jsonl", "what was there\n")
        done = subprocess.run(
            [sys.executable, "-c", FULL, str(limit), *call],
            env={**os.environ, **environment(Path.cwd())},
            capture_output=True,
            text=True,
            check=False,
        )
        error, *advice = done.stderr.splitlines()
        assert (done.returncode, done.stdout) == (2, "")
        assert error == "error: rows.jsonl cannot be written (File too large)"
        kept = b"".join(whole.splitlines(keepends=True)[:count])
        assert Path("rows.jsonl").read_bytes() == (kept or b"what was there\n")
        assert advice == [f"  help: {count} of 12 rows are in it; use --resume to continue it"] * (
            count > 0
        )
        assert {path.name for path in Path().iterdir() if path.name.startswith(".")} == set()
    babyrobot(*call[:-1], "--resume")
    assert Path("rows.jsonl").read_bytes() == whole
