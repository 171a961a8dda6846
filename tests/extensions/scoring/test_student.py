"""The process of a student's function: whatever it does, its answer is an array or a sentence."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.places import ROOT

from babyrobot_levels.extensions.scoring.student import MAX_PRINTED, answers

LEVEL = ROOT / "course" / "levels" / "first-step.yaml"

SENDS = """\
import gc, socket, time
def f(level):
    for each in gc.get_objects():
        if isinstance(each, socket.socket) and each.fileno() >= 0:
            own = each
    own.sendall({head!r})
    time.sleep(60)
"""


def answered(
    folder: Path, text: str, count: int = 1, seconds: float = 30, memory: float = 2
) -> Any:
    """Return what a function of this text answers in one level, so many times."""
    (folder / "f.py").write_text(text, "utf-8")
    return [*answers(folder, "f", [LEVEL] * count, seconds, memory)]


ODD = {
    "None": "it returns nothing: it has to end with `return`",
    "{(0, 0): 1.0}": "it returns a dict: return an array, a number for each state",
    "[[1], [2, 3]]": "it returns rows that differ in length",
    "[1j]": "it returns a list of complex128: return an array, a number for each state",
    "[10**400]": "it returns a list of int: return an array, a number for each state",
    "level": "it returns a Level: return an array, a number for each state",
    "np.zeros((16_000_000, 0))": "its answer is too large, an array of shape [16000000, 0]",
    "np.zeros(64_000_000, np.int8)": "its answer is too large, an array of shape [64000000]",
    "input()": "EOFError in f.py, line 10: EOF when reading a line: nobody can type while it is "
    "graded",
    "1 / 0": "ZeroDivisionError in f.py, line 11: division by zero",
    # Faults have 500 characters.
    "fail(chr(0x1f916) * 600)": "ValueError in f.py, line 21: " + 471 * "\U0001f916",
    "fail(chr(0) * 600)": "ValueError in f.py, line 21: " + 471 * "\0",
    "fail(chr(0xd800))": "ValueError in f.py, line 21: ?",
}
KEPT: list[Any] = [["north", "east"], [[1, 2], [3, 4]], 3.5, [True], []]


@pytest.mark.slow
def test_answers_are_arrays_of_numbers_or_names(tmp_path: Path) -> None:
    cases = ",\n".join(f"lambda level: {each}" for each in [*ODD, *map(repr, KEPT)])
    text = f"import numpy as np\ncases = iter([{cases}])\ndef f(level): return next(cases)(level)\n"
    text += "def fail(text): raise ValueError(text)\n"
    found = answered(tmp_path, text, len(ODD) + len(KEPT))
    told = [each for each in found if isinstance(each, str)]
    assert told == [*ODD.values()]
    kept = found[len(ODD) :]
    assert [each.tolist() for each in kept] == KEPT
    assert [each.dtype for each in kept] == [np.asarray(each).dtype for each in KEPT]


@pytest.mark.slow
@pytest.mark.parametrize("head", [b"[1]", b'["|O8", [1]]', b'["<f8", [0, 16000000]]', b"x"])
def test_what_is_no_answer_is_a_fault(head: bytes, tmp_path: Path) -> None:
    assert answered(tmp_path, SENDS.format(head=head.ljust(4096)), 2) == [
        "its answer cannot be read",
        "it was not run, as its answer in first-step is none",
    ]


@pytest.mark.slow
def test_half_an_answer_is_not_waited_for(tmp_path: Path) -> None:
    head = b'["<f8", [4]]'.ljust(4096) + bytes(20)
    assert answered(tmp_path, SENDS.format(head=head), seconds=1) == [
        "it took longer than 1 seconds"
    ]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not tell of processes")
@pytest.mark.parametrize(
    ("how", "then"), [("process_group=0", "os._exit(0)"), ("start_new_session=True", "return")]
)
def test_what_a_function_starts_ends_with_it(tmp_path: Path, how: str, then: str) -> None:
    text = """\
import os, subprocess
def f(level):
    child = subprocess.Popen(["sleep", "600"], {how})
    with open("child", "w") as file:
        file.write(str(child.pid))
    {then}
"""
    assert isinstance(answered(tmp_path, text.format(how=how, then=then))[0], str)
    status = Path("/proc", (tmp_path / "child").read_text("utf-8"), "status")
    until = time.monotonic() + 10
    while status.exists() and "zombie" not in status.read_text("utf-8"):
        assert time.monotonic() < until


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not tell of processes")
def test_processes_are_counted_and_what_they_leave_behind_ends(tmp_path: Path) -> None:
    text = """\
import os, subprocess, time
def f(level):
    for number in range(100):
        # A child that ends leaves its own one behind, in a session of its own.
        subprocess.run(["sh", "-c", "setsid sleep 600.25 & exit"])
    time.sleep(60)
"""
    assert answered(tmp_path, text, 2) == [
        "it started more than 64 processes",
        "it was not run, as it started too many processes in first-step",
    ]
    until = time.monotonic() + 10
    while any(b"600.25" in each.read_bytes() for each in Path("/proc").glob("[0-9]*/cmdline")):
        assert time.monotonic() < until


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not limit memory")
def test_memory_counts_that_is_shared_or_of_other_processes(tmp_path: Path) -> None:
    text = """\
import mmap, time
import numpy as np
def f(level):
    np.frombuffer(mmap.mmap(-1, 1 << 30), np.uint8)[:] = 1
    time.sleep(60)
"""
    assert answered(tmp_path, text, 2, memory=0.5) == [
        "it took more than 0.5 GiB of memory",
        "it was not run, as it took too much memory in first-step",
    ]


@pytest.mark.slow
def test_prints_are_shown_in_part_and_as_text(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    text = """\
import os
def f(level):
    print("here\\x1b[31m")
    os.write(1, b"past the stream")
    for number in range(100_000):
        print(number)
    return [1]
"""
    assert answered(tmp_path, text)[0].tolist() == [1]
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("here\\x1b[31m\n0\n1\n2\n")
    assert err.endswith("\n… what else it prints is not shown\n")
    assert len(err) < MAX_PRINTED + 100


@pytest.mark.slow
def test_a_process_that_cannot_start_is_an_error_and_no_fault(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    course, code = str(ROOT / "course"), str(Path(__file__).parent / "solutions")
    program.write_text(
        f"import babyrobot_levels as brl\nbrl.grade_functions({course!r}, {code!r})\n", "utf-8"
    )
    done = subprocess.run(
        [sys.executable, program], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 1
    assert "RuntimeError: the process for the student's code did not start" in done.stderr
    assert '`if __name__ == "__main__":`' in done.stderr
