"""The facts of a level that a gallery tells."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

import babyrobot_levels as brl
from babyrobot_levels.extensions.publish.facts import HARDNESS, Facts, Files, facts_of, measured

FILES = Files("a/index.html", "a/level.yaml", "a/a.svg", "a/a.png", "a/tile.png", None)


def facts(name: str) -> Facts:
    level = brl.load(name)
    return facts_of(level, name, FILES, metrics=measured(level))


@pytest.mark.parametrize(
    ("name", "things", "features"),
    [
        ("final-maze", (), ("maze", "puddles")),
        ("glass-wall", (), ("glass", "puddles")),
        ("treasure-chests", (), ("areas", "ends")),
        ("windy-gridworld", (), ("wind",)),
        ("teleport-pads", (), ("areas", "warps")),
        ("drawbridge", ("doors", "switches", "movers"), ("areas",)),
        ("door-key", ("items", "doors"), ()),
    ],
)
def test_what_is_in_a_level(name: str, things: tuple[str, ...], features: tuple[str, ...]) -> None:
    found = facts(name)
    assert (found.things, found.features) == (things, features)


@pytest.mark.slow
def test_what_is_in_a_level_has_the_words_by_which_people_search_it() -> None:
    assert {"guard", "monster"} <= {*facts("night-watch").words}
    assert "guard" not in facts("bat-cave").words
    assert {"switches", "lever", "boat"} <= {*facts("drawbridge").words}
    assert {"key", "doors", "gate"} <= {*facts("door-key").words}
    assert "portal" in facts("teleport-pads").words


@pytest.mark.parametrize(
    ("name", "deterministic"),
    [("frozen-lake", False), ("frozen-lake-dry", True), ("final-maze", False), ("maze", True)],
)
def test_whether_actions_have_one_outcome(name: str, deterministic: bool) -> None:
    assert facts(name).deterministic is deterministic


@pytest.mark.parametrize("name", ["final-maze", "first-key", "frozen-lake"])
def test_numbers_are_those_of_the_metrics(name: str) -> None:
    found, metrics = facts(name), brl.metrics(name)
    for field in ("best_return", "best_steps", "random_return", "difficulty", "ending"):
        assert getattr(found, field) == getattr(metrics, field)
    assert found.states == next(brl.metrics_many([name])).states
    assert found.hardness == {field: getattr(metrics, field) for field in HARDNESS}
    assert found.digest == brl.load(name).digest


def test_infinite_numbers_are_texts_in_json() -> None:
    fields: dict[str, Any] = {"version": 1, "size": [3, 3], "exit": "none"}
    level = brl.Level.from_fields(fields)
    found = facts_of(level, "odd", FILES, metrics=measured(level))
    assert found.best_return == -math.inf
    data = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert (data["best_return"], data["best_steps"], data["difficulty"]) == ("-inf", "inf", None)
    assert (data["size"], data["title"], data["name"]) == ([3, 3], "odd", "")


def test_large_levels_are_not_solved() -> None:
    level = brl.Level.from_fields({"version": 1, "size": [80, 80]})
    assert measured(level) is None
    assert facts_of(level, "large", FILES).best_return is None
