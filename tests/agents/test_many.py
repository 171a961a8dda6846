"""Many levels: rows equal what single calls say, in order, whoever does the work."""

from __future__ import annotations

import json
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import policies
from support.combinations import combined

import babyrobot_levels as brl
from babyrobot_levels.agents.sent import received, sent
from babyrobot_levels.analysis.solver.compiled import MANY_LEVELS
from babyrobot_levels.parallel import InProcess
from babyrobot_levels.parallel.executor import Executor
from babyrobot_levels.parallel.processes import Processes

BOTH = pytest.mark.parametrize(
    "executor", [InProcess(), Processes(2)], ids=["in process", "processes"]
)
CANCELLING = {
    "version": 1,
    "name": "cancelling",
    "size": [3, 1],
    "start": [1, 0],
    "exit": "none",
    "blocked": [{"at": [2, 0]}],
    "rewards": {"stay": -9, "bump": -9},
    "areas": [{"at": [0, 0], "reward": 1}, {"at": [1, 0], "reward": -1}],
}
"""It has no optimal return: rewards cancel out for ever."""


def value(index: int, level: brl.Level, found: brl.Evaluation) -> brl.LevelValue:
    """Return the row of a level for what a single call has found."""
    return brl.LevelValue(
        index,
        level.name,
        level.digest,
        int(np.isfinite(found.values).sum()),
        found.expected_return,
        found.exit_probability,
        found.expected_steps,
        found.within,
        found.discount,
    )


@pytest.mark.slow
@combined(
    1,
    executor=[InProcess(), Processes(2)],
    options=[{}, {"within": 30, "discount": 0.9}, {"within": "max_steps", "actions": "turns"}],
)
def test_levels_of_a_suite_are_solved(executor: Executor, options: dict[str, Any]) -> None:
    suite = brl.load_suite("small-mazes").split("test")[5:25:2]
    rows = list(brl.solve_many(suite, executor=executor, **options))
    assert rows == [
        value(index, level, brl.solve(level, **options)) for index, level in enumerate(suite)
    ]


VERY_MANY: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "size": [4, 4],
    "puddles": {"min": 0, "max": 4},
    "count": MANY_LEVELS,
}
CROWDED = {**VERY_MANY, "keys": {"min": 0, "max": 1}, "guards": {"min": 0, "max": 1}}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fields", "options"),
    [
        pytest.param(VERY_MANY, {"within": 25}, id="puddles"),
        pytest.param(CROWDED, {"within": 25}, id="things", marks=pytest.mark.sweep),
        pytest.param(
            CROWDED,
            {"within": 9, "discount": 0.9, "actions": "turns"},
            id="turns",
            marks=pytest.mark.sweep,
        ),
    ],
)
def test_very_many_levels_are_solved_with_the_same_result(
    fields: dict[str, Any], options: dict[str, Any]
) -> None:
    suite = brl.load_suite(fields)
    rows = list(brl.solve_many(suite, executor=Processes(2), **options))
    assert rows == list(brl.solve_many(suite, **options))
    for row, level in list(zip(rows, suite, strict=True))[::7]:
        wanted = value(row.index, level, brl.solve(level, **options))
        for name in ("expected_return", "success", "steps"):
            got, exact = getattr(row, name), getattr(wanted, name)
            assert got == pytest.approx(exact, rel=1e-12, abs=1e-12)
        unknown: Any = {"expected_return": None, "success": None, "steps": None}
        assert replace(row, **unknown) == replace(wanted, **unknown)


@pytest.mark.slow
@BOTH
def test_levels_of_all_kinds_are_solved(executor: Executor, here: Path) -> None:
    (here / "themes").mkdir()
    (here / "themes" / "mine.yaml").write_text("colors: {arrows: red}\n", encoding="utf-8")
    (here / "on-ice.yaml").write_text("version: 1\nsize: [3, 3]\ntheme: mine\n", encoding="utf-8")
    levels: list[Any] = [
        "final-maze",
        "gallery/first-key",
        "on-ice.yaml",
        here / "on-ice.yaml",
        brl.load("cliff-walking").share_code(),
        {"version": 1, "size": [4, 1]},
        brl.load("windy-gridworld").replace(name="mine"),
    ]
    rows = list(brl.solve_many(iter(levels), executor=executor))
    assert rows == [
        value(index, level, brl.solve(level)) for index, level in enumerate(map(brl.load, levels))
    ]
    assert rows[2].name == "on-ice"


def test_files_are_sent_with_what_they_state_and_their_themes(here: Path) -> None:
    (here / "themes").mkdir()
    (here / "themes" / "mine.yaml").write_text("colors: {arrows: red}\n", encoding="utf-8")
    text = "version: 1\nsize: [3, 3]  # small\ntheme: mine\nexpect:\n  success: 1\n"
    (here / "on-ice.yaml").write_text(text, encoding="utf-8")
    (item,) = sent([str(here / "on-ice.yaml")])[1]
    (here / "themes" / "mine.yaml").unlink()
    level = received(None, item)
    assert level.to_yaml(comments=True).startswith("version: 1\nsize: [3, 3]  # small\n")
    assert level.resolved_theme.colors.arrows == "red"
    assert level.expect is not None


def test_levels_that_are_solved_keep_nothing_of_it() -> None:
    level = brl.load({"version": 1, "size": [4, 1]})
    before = dict(vars(level))
    assert len(list(brl.solve_many([level], jobs=1))) == 1
    assert vars(level) == before


@BOTH
def test_a_suite_that_lists_its_levels_is_solved(executor: Executor) -> None:
    suite = {
        "version": 1,
        "kind": "suite",
        "levels": ["final-maze", {"suite": "small-mazes", "split": "test", "count": 3}],
        "max_steps": 77,
    }
    rows = list(brl.solve_many(suite, within="max_steps", executor=executor))
    assert [row.within for row in rows] == [77] * 4
    assert [row.digest for row in rows] == [level.digest for level in brl.load_suite(suite)]


def test_a_suite_without_a_name_is_called_as_its_file(here: Path) -> None:
    text = "version: 1\nkind: suite\ncount: 2\nsize: [4, 4]\n"
    (here / "mine.yaml").write_text(text, encoding="utf-8")
    names = [level.name for level in brl.load_suite("mine.yaml")]
    assert [row.name for row in brl.solve_many("mine.yaml")] == names


@pytest.mark.slow
@combined(1, executor=[InProcess(), Processes(2)], policy=["random", "uniform", policies.optimal])
def test_a_policy_is_evaluated(executor: Executor, policy: Any) -> None:
    suite = brl.load_suite("small-mazes")[:8]
    rows = list(brl.evaluate_many(suite, policy, within=50, executor=executor))
    for index, level in enumerate(suite):
        own = policy if isinstance(policy, str) else policy(level)
        assert rows[index] == value(index, level, brl.evaluate(level, own, within=50))


@BOTH
def test_saved_policies_are_evaluated(executor: Executor, here: Path) -> None:
    levels = list(brl.load_suite("small-mazes")[:4])
    tables = {level.digest: brl.solve(level).policy.tolist() for level in levels[:3]}
    Path("policies.json").write_text(json.dumps(tables), encoding="utf-8")
    rows = list(brl.evaluate_many(levels, "policies.json", executor=executor, keep_going=True))
    assert [row.expected_return for row in rows[:3]] == [
        row.expected_return for row in brl.solve_many(levels[:3])
    ]
    assert str(rows[3].error) == "the agent has no policy for the level 'small-mazes-00003'"


def test_a_file_of_policies_may_not_change(here: Path) -> None:
    for number in range(2):
        Path("policies.json").write_text(json.dumps({"x": number}), encoding="utf-8")
        if number == 0:
            rows = brl.evaluate_many(["final-maze"], "policies.json")
    with pytest.raises(ValueError, match=r"policies\.json has changed, or is another file on"):
        next(rows)


@pytest.mark.slow
@BOTH
def test_levels_are_measured(executor: Executor) -> None:
    levels = ["final-maze", "first-key"]
    rows = list(brl.metrics_many(levels, executor=executor))
    assert [row.metrics for row in rows] == [brl.metrics(each).to_dict() for each in levels]
    assert [row.states for row in rows] == [40, 23]
    assert rows[1].to_dict()["detour"] == 6
    rows = list(brl.metrics_many(levels, max_states=35, executor=executor))
    assert ["difficulty" in (row.metrics or {}) for row in rows] == [False, True]


@pytest.mark.slow
@BOTH
def test_an_error_is_told_with_the_index_of_its_level(executor: Executor, here: Path) -> None:
    Path("bad.yaml").write_text("version: 1\nsize: [4, 4]\nexit: [9, 9]\n", encoding="utf-8")
    levels: list[Any] = [
        "final-maze",
        "bad.yaml",
        CANCELLING,
        "nowhere",
        "random-maze",
        "frozen-lake",
    ]
    rows = list(brl.solve_many(levels, executor=executor, keep_going=True))
    assert [row.index for row in rows] == [*range(6)]
    errors = {row.index: (type(row.error), row.name) for row in rows if row.error}
    assert errors == {
        1: (brl.LevelError, None),
        2: (brl.UndefinedReturnError, "cancelling"),
        3: (brl.LevelNotFoundError, None),
        4: (brl.RandomMazeError, "random-maze"),
    }
    assert (
        rows[1].to_dict()["error"]
        == "bad.yaml:3:7: the exit [9, 9] is off the grid, which is 4 wide and 4 high"
    )
    taken: list[brl.LevelValue] = []
    with pytest.raises(brl.LevelError, match="off the grid") as caught:
        taken.extend(brl.solve_many(levels, executor=executor))
    assert caught.value.__notes__ == ["in level 1"]
    assert taken == rows[:1]


@BOTH
def test_a_policy_that_fails_is_told_with_its_level(executor: Executor) -> None:
    suite = brl.load_suite("small-mazes")[:6]
    policy = partial(policies.optimal_but, "small-mazes-00004")
    rows = brl.evaluate_many(suite, policy, executor=executor)
    with pytest.raises(ArithmeticError, match="no policy for") as caught:
        list(rows)
    assert caught.value.__notes__ == ["in level 4, small-mazes-00004"]


def test_a_policy_that_others_cannot_import_is_refused() -> None:
    with pytest.raises(TypeError, match="cannot import the policy; define it as a function at"):
        brl.evaluate_many("small-mazes", lambda level: "random", jobs=2)
    first = next(brl.evaluate_many("small-mazes", lambda level: "random", within=50))
    assert first == next(brl.evaluate_many("small-mazes", "random", within=50))


def test_rows_are_made_as_they_are_asked_for() -> None:
    asked = []

    def names() -> Any:
        for number in range(1000):
            asked.append(number)
            yield "frozen-lake"

    with closing(brl.solve_many(names())) as rows:
        first = next(rows)
        assert next(rows) == replace(first, index=1)
    assert asked == [0, 1]


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: brl.solve_many("small-mazes", discount=2), "discount must be above 0"),
        (lambda: brl.solve_many("small-mazes", within=0), "within must be a number of steps"),
        (lambda: brl.solve_many("small-mazes", actions="wings"), "actions must be 'all', "),
        (lambda: brl.solve_many("small-mazes", jobs=0), "jobs must be at least 1"),
        (lambda: brl.evaluate_many("small-mazes", "bets"), "there is no policy 'bets'; use"),
    ],
)
def test_wrong_arguments_are_refused_at_once(call: Any, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        call()


def test_rows_are_plain_data() -> None:
    endless = {"version": 1, "size": [3, 1], "exit": "none", "blocked": [{"at": [2, 0]}]}
    (row,) = brl.solve_many([endless | {"rewards": {"step": -1, "stay": -1}}])
    assert json.loads(json.dumps(row.to_dict(), allow_nan=False))["expected_return"] == "-inf"
