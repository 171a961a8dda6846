"""What earlier rooms ask of the optimum of a sight: by name, in Python and at the command line."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from extensions.sight import cassandra
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats.formats import PARTIAL
from babyrobot_levels.extensions.sight.solve import SightSolution, solve_sight
from babyrobot_levels.extensions.sight.writers import WRITERS
from babyrobot_levels.registry.entries import resolve
from babyrobot_levels.registry.own import PLACES
from babyrobot_levels.text.budget import COMMAND, OverBudgetError, within


@pytest.mark.slow
def test_solve_with_a_sight_is_the_optimum_of_the_sight() -> None:
    how: Any = {"view_radius": 1, "within": "max_steps", "actions": "moves", "discount": 0.9}
    found = brl.solve("shell-game", sight="view", **how)
    assert isinstance(found, SightSolution)
    wanted = solve_sight("shell-game", "view", **how)
    assert (found.lower, found.upper, found.within) == (wanted.lower, wanted.upper, 200)
    assert brl.load("shell-game").solve(sight="view", view_radius=1).upper == pytest.approx(-6)


@pytest.mark.slow
def test_one_of_several_levels_can_be_solved() -> None:
    levels = "frozen-lake", "shell-game"
    assert brl.solve(levels, sight="position").full == pytest.approx(
        sum(brl.solve(level).expected_return for level in levels) / 2
    )


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"view_radius": 1}, "unexpected keyword argument 'view_radius'"),
        ({"sigth": "view"}, "did you mean `sight`"),
        ({"sight": "view", "radius": 1}, "'radius'"),
    ],
)
def test_options_that_there_are_not_are_refused(given: dict[str, object], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        brl.solve("shell-game", **given)  # type: ignore[call-overload]


def test_a_gap_and_a_number_of_beliefs_have_bounds() -> None:
    for wrong in ({"gap": -0.1}, {"beliefs": -1}):
        with pytest.raises(ValueError, match="gap and beliefs must be at least 0"):
            brl.solve("shell-game", sight="view", **wrong)


@pytest.mark.parametrize("command", ["show --sight view", "score east.py:east"])
@pytest.mark.beside("scoring")
def test_a_random_maze_is_told_with_what_to_do(command: str, here: Path) -> None:
    Path("east.py").write_text("def east(observation):\n    return 2\n", "utf-8")
    name, *options = command.split()
    agent, more = ([], options) if name == "show" else (options, [])
    done = run_here([name, *agent, "random-maze", *more], environment(here))
    assert (done.status, done.err) == (
        1,
        "error: the maze of this level is random\n"
        "  help: choose one first: babyrobot resolve LEVEL --maze-seed 0\n",
    )


def test_exact_values_are_those_of_full_sight() -> None:
    with pytest.raises(ValueError, match="full sight"):
        brl.solve("shell-game", sight="view", exact=True)


@pytest.mark.slow
def test_within_a_budget_the_search_ends_with_two_bounds() -> None:
    with within(replace(COMMAND, steps=100_000_000)):
        found = brl.solve("small-corridor", sight="view")
    assert 100 < found.beliefs < 2_000
    assert found.lower < found.upper
    assert found.beliefs == brl.solve("small-corridor", sight="view", beliefs=found.beliefs).beliefs
    with within(replace(COMMAND, steps=1_000)), pytest.raises(OverBudgetError):
        brl.solve("small-corridor", sight="view")


@pytest.mark.slow
@pytest.mark.parametrize("sight", ["planes", "text-words"])
def test_what_is_observed_counts_as_work(sight: str) -> None:
    level = brl.loads("version: 1\nsize: [30, 30]\nmax_steps: 9\n")
    with within(replace(COMMAND, steps=50_000_000)), pytest.raises(OverBudgetError):
        brl.solve(level, sight=sight, beliefs=1)


@pytest.mark.parametrize("to", ["pomdp", "pomdp-prism", "pomdp-drn"])
def test_an_export_is_the_process_that_is_solved(to: str) -> None:
    level = brl.load("shell-game")
    conversion = brl.export(level, to, sight="view", view_radius=1)
    model = solve_sight(level, "view", view_radius=1, beliefs=1).model
    assert conversion.text.endswith(WRITERS[to](model))
    about = conversion.text.removesuffix(WRITERS[to](model)).splitlines()
    assert about[0].lstrip("#/ ") == level.title
    assert str(level.license) in about[-2]
    told = {lost.field for lost in conversion.warnings}
    assert told == {"tags", "expect", "max_steps"} | ({"start"} if to != "pomdp" else set())


def test_an_exported_process_is_read_with_the_same_value() -> None:
    level = brl.load("shell-game").replace(discount=0.5)
    text = brl.export(level, "pomdp", sight="view", view_radius=1).text
    found = brl.solve(level, sight="view", view_radius=1, within=6)
    assert cassandra.read(text).within(6) == pytest.approx(found.upper, abs=1e-9)


def test_what_draws_a_start_and_discounts_are_told() -> None:
    level = {"version": 1, "size": [3, 1], "start": [[0, 0], [1, 0]], "discount": 0.9}
    found = {to: brl.export(level, to, sight="position").warnings for to in PARTIAL}
    told = {to: {lost.field: lost.message for lost in lost} for to, lost in found.items()}
    assert all("and a discount counts it" in each["start"] for each in told.values())
    assert ["discount" in each for each in told.values()] == [False, True, True]


def test_other_formats_hold_no_sight() -> None:
    with pytest.raises(TypeError, match="prism holds no sight"):
        brl.export("frozen-lake", "prism", sight="view")


@pytest.mark.slow
@pytest.mark.beside("scoring")
def test_a_score_says_what_can_be_known() -> None:
    options: Any = {"observation": "view", "view_radius": 1, "actions": "moves", "discount": 0.99}
    seen: Any = {"sight": "view", "view_radius": 1, "actions": "moves", "discount": 0.99}
    best = brl.solve("shell-game", within=40, **seen)
    (row,) = brl.score(
        "shell-game", best.policy(), within=40, episodes=200, knowable=True, **options
    )
    assert row.knowable == best.upper < row.optimum
    assert row.knowable_share is not None
    assert row.share < row.knowable_share == pytest.approx(1, abs=0.03)
    assert brl.Scores([row]).to_dict()["levels"][0]["knowable"] == best.upper


@pytest.mark.beside("scoring")
def test_a_score_does_not_say_what_it_is_not_asked_for() -> None:
    (row,) = brl.score("frozen-lake", lambda place: 1)
    assert row.knowable is None
    assert row.knowable_share is None


@pytest.mark.beside("scoring")
def test_who_sees_where_it_is_can_know_all_of_a_lake() -> None:
    (row,) = brl.score("frozen-lake", lambda place: 1, knowable=True)
    assert row.knowable == pytest.approx(row.optimum)
    assert row.knowable_share == pytest.approx(row.share)


@pytest.mark.slow
@pytest.mark.beside("scoring")
def test_a_score_of_a_reader_is_set_beside_what_its_texts_tell() -> None:
    options: Any = {"within": 10, "episodes": 2}
    (row,) = brl.score("shell-game", lambda text: "east", sight="view", knowable=True, **options)
    assert row.knowable == brl.solve("shell-game", sight="text-view", within=10).upper
    assert row.knowable is not None
    assert row.knowable <= row.optimum


@pytest.mark.slow
@pytest.mark.beside("scoring")
def test_what_can_be_known_in_one_of_several_levels_is_less_than_in_each() -> None:
    mazes = brl.load_suite("small-mazes").split("test")[:4]
    how: Any = {"actions": "moves", "within": 40}
    best = brl.solve(list(mazes), sight="position", **how)
    scores = brl.score(mazes, best.policy(), episodes=100, knowable="suite", **how)
    pooled = scores.pooled
    assert pooled is not None
    assert pooled.knowable == pytest.approx(best.upper)
    assert pooled.expected_return == pytest.approx(pooled.knowable)
    assert pooled.knowable < pooled.optimum - 0.4
    assert pooled.share < 0.99
    assert pooled.knowable_share == pytest.approx(1)
    assert scores.to_dict()["pooled"]["knowable"] == pooled.knowable
    assert brl.score(mazes, best.policy(), episodes=100, **how).pooled is None


@pytest.mark.beside("scoring")
def test_one_of_several_levels_has_one_limit() -> None:
    with pytest.raises(ValueError, match="several max_steps"):
        brl.score(["frozen-lake", "shell-game"], lambda place: 1, knowable="suite")
    with pytest.raises(ValueError, match="knowable must be"):
        brl.score("frozen-lake", lambda place: 1, knowable="all")  # type: ignore[arg-type]


@pytest.mark.beside("scoring")
def test_a_table_of_all_states_has_no_sight() -> None:
    with pytest.raises(ValueError, match="agents that observe"):
        brl.score("frozen-lake", "best", knowable=True)


def test_all_places_of_own_extensions_can_be_imported() -> None:
    for place in PLACES.values():
        assert place.startswith("babyrobot_levels.extensions.")
        assert callable(resolve(place))


@pytest.mark.slow
def test_who_gives_no_sight_loads_nothing_of_it() -> None:
    code = (
        "import sys, babyrobot_levels as brl; brl.solve('frozen-lake');"
        "print([name for name in sys.modules if name.startswith('babyrobot_levels.extensions')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


@pytest.mark.parametrize("to", PARTIAL)
def test_a_sight_of_several_robots_is_refused(to: str) -> None:
    robots = [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [1, 0]}]
    level = brl.load({"version": 1, "size": [3, 1], "robots": robots})
    with pytest.raises(brl.LevelError, match="files of POMDPs are only for levels with one"):
        brl.export(level, to)
    with pytest.raises(brl.LevelError, match="optima of a sight are only for levels with one"):
        brl.solve(level, sight="view")


# -- as a metric -----------------------------------------------------------------------------


def test_what_sight_is_worth_is_a_metric_of_the_sight_view() -> None:
    measured = brl.metrics("shell-game")
    assert measured.sight_cost == pytest.approx(brl.solve("shell-game", sight="view").cost[0])
    assert "sight_cost" not in measured.to_dict()


@pytest.mark.slow
def test_the_metric_has_no_value_where_it_is_not_found_or_makes_no_sense() -> None:
    corridor = brl.metrics("large-corridor")
    assert corridor.sight_cost is None
    least, most = brl.solve("large-corridor", sight="view", beliefs=1000).cost
    assert corridor.why_none("sight_cost") == f"it is between {least:.6g} and {most:.6g}"
    assert brl.metrics("two-pads").sight_cost is None
    cancelling = {"version": 1, "size": [3, 1], "rewards": {"closer": 1, "farther": -1, "exit": -9}}
    assert brl.metrics(cancelling).sight_cost is None


@pytest.mark.slow
def test_a_level_states_what_sight_is_worth(here: Path) -> None:
    Path("doors.yaml").write_text(brl.load("shell-game").to_yaml(), "utf-8")
    brl.expect("doors.yaml", add=["sight_cost"], write=True)
    assert "sight_cost: 0.667" in Path("doors.yaml").read_text("utf-8")
    assert not brl.lint("doors.yaml")
    wrong = Path("doors.yaml").read_text("utf-8").replace("0.667", "0.7..1")
    (finding,) = brl.lint(wrong)
    assert finding.message == "`sight_cost` is 0.666667, not 0.7..1"


@pytest.mark.slow
def test_levels_are_found_in_which_sight_is_worth_something() -> None:
    found = brl.mutate("shell-game", edits=2, seed=0, expect={"sight_cost": "0.8.."})
    cost = brl.metrics(found).sight_cost
    assert cost is not None
    assert cost >= 0.8
