"""Levels solved and evaluated on a cluster: the same rows as single calls give."""

from __future__ import annotations

import subprocess
import sys
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from support import policies
from support.sessions import environment, run_here

import babyrobot_levels as brl

pytestmark = pytest.mark.usefixtures("cluster", "here")


def test_a_suite_is_solved() -> None:
    suite = brl.load_suite("small-mazes").split("test")[:300]
    rows = list(brl.solve_many(suite, executor="ray"))
    assert [(row.index, row.name) for row in rows] == [
        (index, f"small-mazes-{8000 + index:05}") for index in range(300)
    ]
    for index in range(0, 300, 50):
        solution = brl.solve(suite[index])
        assert rows[index].digest == suite[index].digest
        assert rows[index].expected_return == solution.expected_return
        assert rows[index].steps == solution.expected_steps
    assert rows == list(brl.solve_many(suite))


@pytest.mark.parametrize("policy", ["random", policies.optimal], ids=["random", "function"])
def test_a_policy_is_evaluated(policy: Any) -> None:
    suite = brl.load_suite("small-mazes")[:20]
    rows = list(brl.evaluate_many(suite, policy, within="max_steps", executor="ray"))
    for row, level in zip(rows, suite, strict=True):
        own = policy if isinstance(policy, str) else policy(level)
        found = brl.evaluate(level, own, within="max_steps")
        assert (row.expected_return, row.success) == (found.expected_return, found.exit_probability)


def test_levels_from_files_need_no_shared_folder(here: Path) -> None:
    (here / "themes").mkdir()
    (here / "themes" / "mine.yaml").write_text("colors: {arrows: red}\n", encoding="utf-8")
    text = "version: 1\nsize: [3, 3]\ntheme: mine\n"
    (here / "mine.yaml").write_text(text, encoding="utf-8")
    # Workers stand elsewhere, so they cannot find these by their names.
    levels: list[Any] = [
        "mine.yaml",
        "final-maze",
        brl.load("mine.yaml"),
        {"version": 1, "size": [2, 1]},
    ]
    rows = list(brl.metrics_many(levels, executor="ray"))
    assert [row.metrics for row in rows] == [brl.metrics(each).to_dict() for each in levels]


def test_a_poisoned_level_is_told_by_its_index() -> None:
    suite = brl.load_suite("small-mazes")[:40]
    policy = partial(policies.optimal_but, "small-mazes-00027")
    taken: list[brl.LevelValue] = []
    with (
        pytest.raises(ArithmeticError, match="no policy for small-mazes-00027") as caught,
        closing(brl.evaluate_many(suite, policy, executor="ray")) as rows,
    ):
        taken.extend(rows)
    assert caught.value.__notes__ == ["in level 27, small-mazes-00027"]
    assert [row.index for row in taken] == [*range(27)]
    rows = brl.evaluate_many(suite, policy, executor="ray", keep_going=True)
    assert [row.index for row in rows if row.error] == [27]


def test_a_call_is_continued_on_a_cluster(cluster: Any, here: Path) -> None:
    text = "version: 1\nkind: suite\nname: few\ncount: 40\nsize: [5, 5]\n"
    (here / "few.yaml").write_text(text, encoding="utf-8")

    def written(*more: str) -> bytes:
        done = run_here(["solve", "few.yaml", "-o", "rows.jsonl", *more], environment(here))
        assert (done.status, done.err) == (0, "")
        return Path("rows.jsonl").read_bytes()

    whole = written("--jobs", "1")
    Path("rows.jsonl").write_bytes(whole[: len(whole) // 2])
    assert written("--resume", "--ray-address", cluster.address) == whole


def test_a_policy_of_a_script_is_sent(cluster: Any, here: Path) -> None:
    script = """
import babyrobot_levels as brl

def optimal(level):
    return brl.solve(level)

suite = brl.load_suite("small-mazes")[:3]
rows = list(brl.evaluate_many(suite, optimal, executor="ray"))
assert [row.states for row in rows] == [row.states for row in brl.solve_many(suite)]
"""
    (here / "script.py").write_text(script, encoding="utf-8")
    variables = {**environment(here), "RAY_ADDRESS": cluster.address}
    done = subprocess.run(
        [sys.executable, "script.py"], env=variables, capture_output=True, timeout=100, check=False
    )
    assert (done.returncode, done.stderr) == (0, b"")
