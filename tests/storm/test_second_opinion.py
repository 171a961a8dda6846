"""What Storm says agrees with what is computed here, and would not if a file said otherwise."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import pytest
import umbi
from oracles.random_teams import random_team
from support.places import DOCS
from support.second_opinion import (
    QUESTIONS,
    RANDOM,
    SUITES,
    Answer,
    Asked,
    answers,
    level_at,
    read,
    value,
    written,
)

import babyrobot_levels as brl

EXACT = [
    "cliff-walking-slippery",
    "four-corners",
    "four-rooms-slippery",
    "frozen-lake",
    "frozen-lake-8x8",
    "gridworld-4-1",
    "ice-rink",
    "russell-norvig-4x3",
    "treasure-chests",
]
"""Levels with chance."""


@pytest.mark.parametrize("name", EXACT)
def test_optimal_returns_are_the_same_fractions(name: str, tmp_path: Path) -> None:
    level = brl.load(name)
    ours = brl.solve(level, 1.0, exact=True).expected_return
    (path, _) = written(level, tmp_path)
    gains = Asked(level).rewards.min() >= 0
    text = 'R{"reward"}max=? [C]' if gains else 'R{"cost"}min=? [F "end"]'
    storm = Fraction(str(value(read(path, exact=True), text, exact=True)))
    assert (storm if gains else -storm) == ours


@pytest.mark.parametrize("seed", [3, 6, 8, 359, 387, 418, 528, 578])
def test_several_robots_have_the_same_optimum(seed: int, tmp_path: Path) -> None:
    fields = random_team(Random(seed))
    assert fields is not None
    level = brl.load(fields)
    found = [*answers(level, written(level, tmp_path))]
    assert found
    assert [each for each in found if not each.is_agreed] == []


def test_what_no_policy_ends_is_infinite_for_both(tmp_path: Path) -> None:
    rewards = {"step": -1}
    closed = {"version": 1, "walls": [{"at": [1, 2], "side": "E"}, {"at": [2, 1], "side": "S"}]}
    level = brl.Level.from_fields({**closed, "rewards": rewards})
    found = [each for each in answers(level, written(level, tmp_path)) if "costs" in each.question]
    assert [(each.storm, each.ours) for each in found] == [(math.inf, math.inf)] * 2


def test_hits_starts_and_things_are_read_as_they_are(tmp_path: Path) -> None:
    for name in ("night-watch", "four-corners", "shell-game", "bat-cave"):
        level = brl.load(name)
        found = [*answers(level, written(level, tmp_path))]
        assert {each.file for each in found} == {"prism", "umb"}
        assert [each for each in found if not each.is_agreed] == []


@pytest.mark.parametrize("name", [*EXACT, "final-maze", "bat-cave"])
def test_both_files_of_a_level_hold_the_same_floats(name: str, tmp_path: Path) -> None:
    text, archive = map(_numbers, map(read, written(brl.load(name), tmp_path)))
    # Of a module, Storm has only the states that can be reached.
    assert text <= archive
    assert {chance for chance, _ in text} == {chance for chance, _ in archive}


def _numbers(model: Any) -> set[tuple[float, float]]:
    """Return each probability of a model, with the reward of its state and action."""
    matrix, paid = model.transition_matrix, model.reward_models["reward"].state_action_rewards
    rows = range(matrix.nr_rows)
    return {(entry.value, paid[row]) for row in rows for entry in matrix.get_row(row)}


# -- what differs is noticed -------------------------------------------------------------------

Change = Callable[[Path], None]


def _disagreed(name: str, change: Change, file: str, folder: Path) -> set[str]:
    """Return the questions whose answers differ if a file of a level is changed."""
    level = brl.load(name)
    path = next(each for each in written(level, folder) if each.suffix == f".{file}")
    change(path)
    found: list[Answer] = [*answers(level, [path])]
    return {each.question for each in found if not each.is_agreed}


def _replacing(old: str, new: str) -> Change:
    def change(path: Path) -> None:
        text = path.read_text("utf-8")
        assert text.count(old) >= 1
        path.write_text(text.replace(old, new), "utf-8")

    return change


def test_another_probability_is_noticed(tmp_path: Path) -> None:
    change = _replacing("2/5:(s'=s-8) + 3/5:(s'=s-1)", "0.400001:(s'=s-8) + 0.599999:(s'=s-1)")
    found = _disagreed("final-maze", change, "prism", tmp_path)
    assert found == {"return, costs only", "return within a limit", "success within a limit"}


def test_another_reward_is_noticed(tmp_path: Path) -> None:
    change = _replacing(": -1;", ": -1.00001;")
    found = _disagreed("walls", change, "prism", tmp_path)
    assert found == {"return, discount 0.95", "return within a limit"}
    change = _replacing(": 1;", ": 1.00001;")
    assert _disagreed("walls", change, "prism", tmp_path) == {"return, costs only"}


def test_another_label_is_noticed(tmp_path: Path) -> None:
    change = _replacing('label "end"', 'label "other"')
    holes = _replacing('label "exit" = s=15', 'label "exit" = s=15 | s=5')
    assert "success" in _disagreed("frozen-lake", holes, "prism", tmp_path)
    with pytest.raises(RuntimeError, match="end"):
        _disagreed("treasure-chests", change, "prism", tmp_path)


def test_another_number_of_an_archive_is_noticed(tmp_path: Path) -> None:
    def change(path: Path) -> None:
        archive = umbi.umb.read(path)
        numbers = archive.branch_to_probability
        for at, target in enumerate(archive.branch_to_target):
            if target == 15 and numbers[at] < 1:
                numbers[at - 1 : at + 1] = [numbers[at - 1] - 1e-5, numbers[at] + 1e-5]
        umbi.umb.write(archive, path)

    assert "success" in _disagreed("frozen-lake", change, "umb", tmp_path)


# -- the page ----------------------------------------------------------------------------------


def test_the_page_tells_what_is_asked_and_of_how_many_levels() -> None:
    page = (DOCS / "exact-answers.md").read_text("utf-8")
    part = " ".join(page.partition("## A second opinion")[2].split())
    assert f"{sum(SUITES.values()):,} levels of the suites" in part
    assert f"{RANDOM} random levels" in part
    others = [info for info in brl.levels() if "boxes" not in info.tags]
    assert f"{len(others)} levels of the gallery (those without boxes)" in part
    rows = {line.split(" | ")[0] for line in page.splitlines() if line.startswith("| ")}
    assert {f"| {name}" for name in QUESTIONS} <= rows
    assert level_at(("frozen-lake", -1)).name == "frozen-lake"
