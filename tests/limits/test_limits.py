"""Files that ask for too much get an answer soon, compared with a small level, in 500 MiB."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from support.combinations import swept
from support.hostile import BROKEN, MIB, VALID

TIMES = 15
"""So many times as long as of the smallest level may the checks of a file take."""
MEMORY = 500 * MIB
TRIES = 3

MEASURE = """
import resource, subprocess, sys
done = subprocess.run([sys.executable, "-m", "babyrobot_levels", *sys.argv[1:]])
used = resource.getrusage(resource.RUSAGE_CHILDREN)
unit = 1 if sys.platform == "darwin" else 1024
print(used.ru_utime + used.ru_stime, used.ru_maxrss * unit, file=sys.stderr)
sys.exit(done.returncode)
"""
"""A small process in between: what a child used begins with what its parent had."""

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="has no such measures")


@dataclass(frozen=True)
class Answer:
    """What a command said, and what it took: seconds or times of the smallest level, and bytes."""

    status: int
    out: str
    err: str
    cost: float
    memory: float


Babyrobot = Callable[..., Answer]


@pytest.fixture(scope="module")
def babyrobot(tmp_path_factory: pytest.TempPathFactory) -> Babyrobot:
    """What tells what a command says, and how long it takes, compared with a small level.

    What takes too long is tried again: the machine may have been busy.
    """
    smallest = tmp_path_factory.mktemp("smallest") / "level.yaml"
    smallest.write_bytes(b"version: 1\n")
    usual = measured("validate", str(smallest)).cost

    def answer(*arguments: str) -> Answer:
        answers = [in_times_of(usual, measured(*arguments))]
        while answers[-1].cost >= TIMES and len(answers) < TRIES:
            now = measured("validate", str(smallest)).cost
            answers.append(in_times_of(now, measured(*arguments)))
        return min(answers, key=lambda answer: answer.cost)

    return answer


def in_times_of(usual: float, answer: Answer) -> Answer:
    return replace(answer, cost=answer.cost / usual)


def measured(*arguments: str) -> Answer:
    """Return what a command says, with the seconds that it takes."""
    done = subprocess.run(
        [sys.executable, "-c", MEASURE, *arguments],
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=60,
        check=False,
        env={**os.environ, "PYTHONUTF8": "1"},
    )
    *said, measures = done.stderr.splitlines()
    # Time of the processor. It too is longer when others use its caches.
    seconds, memory = map(float, measures.split())
    return Answer(done.returncode, done.stdout, "\n".join(said), seconds, memory)


def write(folder: Path, data: bytes) -> Path:
    path = folder / "level.yaml"
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("name", swept(list(BROKEN)[::4], BROKEN))
def test_broken_files(name: str, tmp_path: Path, babyrobot: Babyrobot) -> None:
    code, data = BROKEN[name]
    path = write(tmp_path, data())
    answer = babyrobot("validate", "--format", "json", str(path))
    assert (answer.status, answer.err) == (1, "")
    assert answer.cost < TIMES
    assert answer.memory < MEMORY
    found: list[dict[str, Any]] = json.loads(answer.out)["diagnostics"]
    assert code in {each["code"] for each in found}
    assert all(each["line"] >= 1 for each in found)
    # What nobody can read to the end is no answer.
    assert len(found) <= 400
    assert all(len(each["message"]) < 300 for each in found)


@pytest.mark.sweep
@pytest.mark.parametrize("name", VALID)
def test_large_levels(name: str, tmp_path: Path, babyrobot: Babyrobot) -> None:
    path = write(tmp_path, VALID[name]())
    answer = babyrobot("validate", str(path))
    assert (answer.status, answer.out, answer.err) == (0, "1 file checked, valid\n", "")
    assert answer.cost < TIMES
    assert answer.memory < MEMORY


def test_the_measure_sees_what_is_slow_and_large(tmp_path: Path, babyrobot: Babyrobot) -> None:
    small = babyrobot("validate", str(write(tmp_path, b"version: 1\n")))
    large = babyrobot("validate", str(write(tmp_path, BROKEN["items in any order"][1]())))
    assert 0.2 < small.cost < 2 < large.cost
    assert 10 * MIB < small.memory < large.memory - 10 * MIB


@pytest.mark.parametrize(
    "name", swept(["a bomb of aliases", "unknown fields", "brackets"], ["tags"])
)
def test_reports_for_people_are_short_too(name: str, tmp_path: Path, babyrobot: Babyrobot) -> None:
    answer = babyrobot("validate", str(write(tmp_path, BROKEN[name][1]())))
    assert (answer.status, answer.err) == (1, "")
    assert answer.cost < TIMES
    assert len(answer.out) < 200_000
