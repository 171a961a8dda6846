"""Budgets: steps are counted, for each level anew, also in other processes."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.places import ROOT
from support.sessions import babyrobot

import babyrobot_levels as brl
from babyrobot_levels.parallel import executor_for
from babyrobot_levels.parallel.executor import Failure
from babyrobot_levels.text.budget import (
    CHECKED,
    COMMAND,
    READ,
    UNLIMITED,
    Limits,
    OverBudgetError,
    fits,
    left,
    limited,
    spend,
    together,
    within,
)

LIMITS = Limits(1000, 50, help="use less")


def spent(steps: int) -> int:
    spend(steps)
    return steps


def test_without_a_budget_nothing_is_refused() -> None:
    spend(10**20)
    with within(UNLIMITED), within(LIMITS):
        spend(10**20)


def test_what_is_spent_adds_up() -> None:
    with within(LIMITS):
        spend(600)
        spend(400)
        assert left() == 0
        with pytest.raises(
            OverBudgetError, match="the level takes more than 1,000 steps"
        ) as caught:
            spend(1)
        assert caught.value.help == "use less"
        # What is spent stays spent.
        with pytest.raises(OverBudgetError):
            spend(0)


def test_each_level_that_is_read_has_a_budget_of_its_own() -> None:
    with within(LIMITS):
        for _ in range(3):
            brl.loads("version: 1\n")
            spend(900)


def test_an_inner_budget_hides_the_outer_one() -> None:
    with within(LIMITS):
        with within(Limits(10, 50)), pytest.raises(OverBudgetError):
            spend(11)
        assert left() == 1000


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2])
def test_each_item_of_many_has_a_budget_of_its_own(jobs: int) -> None:
    with within(LIMITS):
        found = [*executor_for(jobs=jobs).map(spent, [900, 900, 1001, 900])]
    assert [each for each in found if not isinstance(each, Failure)] == [900] * 3
    (failure,) = (each for each in found if isinstance(each, Failure))
    assert isinstance(failure.error, OverBudgetError)
    assert failure.error.help == "use less"


def test_a_function_keeps_the_limits_under_which_it_was_sent() -> None:
    assert limited(spent) is spent
    with within(LIMITS):
        function = limited(spent)
    with pytest.raises(OverBudgetError):
        function(1001)


def test_a_function_may_have_less_room_than_what_sends_it() -> None:
    def compiled(width: int) -> int:
        return brl.load({"version": 1, "size": [width, 1]}).compile().num_states

    with within(Limits(10**6, 8)):
        function = limited(compiled, entries=6)
        assert compiled(8) == 8
    assert function(6) == 6
    with pytest.raises(OverBudgetError, match="at most 6 are allowed here"):
        function(7)
    with within(UNLIMITED):
        assert limited(compiled, entries=6)(7) == 7


def test_tables_are_named() -> None:
    level = brl.load({"version": 1, "size": [5, 4], "skid": 0.5})
    with within(Limits(10**6, 80)):
        level.compile()
        with pytest.raises(OverBudgetError, match="steps of work: it has 20 states, and 4 or more"):
            spend(10**6)
    with (
        within(Limits(10**6, 79)),
        pytest.raises(OverBudgetError, match="20 states, and 4 or more outcomes of an action"),
    ):
        level.compile()


def test_tables_of_several_robots_are_named_with_their_joint_actions() -> None:
    robots = [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [1, 0]}]
    level = brl.load({"version": 1, "size": [3, 1], "robots": robots})
    states = level.compile().num_states
    with (
        within(Limits(10**6, 5 * states - 1)),
        pytest.raises(OverBudgetError, match=f"has {states} states, 25 joint actions, and 1 or"),
    ):
        level.compile()


def test_the_documentation_has_the_limits() -> None:
    text = (ROOT / "docs/level-format.md").read_text("utf-8").partition("#### Work")[2]
    rows = [line.split("|")[2:6] for line in text.splitlines() if line.startswith("|")][2:5]
    told = [tuple(int(cell.replace(",", "")) for cell in row) for row in rows]
    limits = (CHECKED, READ, COMMAND)
    assert told == [(each.steps, each.entries, each.seconds, each.megabytes) for each in limits]


def test_no_limit_is_asked_for_in_the_sentence(tmp_path: Path) -> None:
    path = tmp_path / "level.yaml"
    path.write_text("version: 1\nsize: [700, 700]\nskid: 0.2\n", "utf-8")
    result = babyrobot("solve", path, status=2)
    assert "490,000 states, and 4 or more outcomes of an action; together at most" in result.err
    assert "--no-limit" in result.err


def test_what_fits_counts_for_the_limits_around() -> None:
    def work() -> None:
        spend(40)

    assert fits(Limits(50, 9), work)
    assert not fits(Limits(30, 9), work)
    with within(Limits(100, 9)):
        assert fits(Limits(50, 9), work)
        assert not fits(Limits(30, 9), work)
        with pytest.raises(OverBudgetError, match="more than 100 steps"):
            fits(Limits(50, 9), work)


def test_levels_count_together_where_that_is_asked_for() -> None:
    with within(LIMITS):
        spend(900)
        with together():
            brl.loads("version: 1\n")
            spend(600)
            brl.loads("version: 1\n")
            with pytest.raises(OverBudgetError):
                spend(600)
        brl.loads("version: 1\n")
        spend(900)
    with together():
        spend(10**20)
