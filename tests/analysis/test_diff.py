"""What `diff` says changed: all that the digest sees, and nothing where nothing changed."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.worlds import World, decorated_worlds, level_of, worlds

import babyrobot_levels as brl
from babyrobot_levels.analysis.diff import Change, Difference, diff

PLAIN: World = {"version": 1, "size": [3, 2]}


def changed(**fields: Any) -> Difference:
    """Return what giving some fields changes in a plain level."""
    return diff(PLAIN, {**PLAIN, **fields})


def count_of_game(difference: Difference) -> int:
    listed = (difference.cells, difference.walls, difference.transitions)
    return len(difference.game) + sum(changes.count for changes in listed)


@given(worlds(4), worlds(4))
def test_what_differs_is_told_and_only_that(one: World, two: World) -> None:
    difference = diff(one, two)
    levels = (level_of(one), level_of(two))
    assert difference.digests == tuple(level.digest for level in levels)
    assert difference.same_game is (difference.digests[0] == difference.digests[1])
    if not difference.same_game:
        assert count_of_game(difference) > 0


@given(decorated_worlds())
def test_a_level_does_not_differ_from_itself(world: World) -> None:
    difference = diff(world, level_of(world).share_code())
    assert difference.same_game
    assert count_of_game(difference) == 0
    assert difference.beside == ()
    assert difference.best_return[0] == difference.best_return[1]


@given(worlds(4), st.integers(0, 10**6))
def test_the_transitions_are_those_of_the_tables(world: World, place: int) -> None:
    level = level_of(world)
    other = level.replace(rewards={"step": -1.5, "stay": 3})
    difference = diff(level, other, limit=None)
    tables = [level.compile().to_toy_text(), other.compile().to_toy_text()]
    width = level.size[0]
    expected = [
        ((state % width, state // width), brl.Action(action).name.lower())
        for state, actions in tables[0].items()
        for action in actions
        if tables[0][state][action] != tables[1][state][action]
    ]
    told = difference.transitions
    assert [(change.cell, change.name) for change in told.first] == expected
    assert (told.count, told.total) == (len(expected), 5 * width * level.size[1])


def test_the_other_way_round_is_the_same_the_other_way_round() -> None:
    there, back = diff("maze", "frozen-lake"), diff("frozen-lake", "maze")
    for one, two in (
        (there.cells, back.cells),
        (there.walls, back.walls),
        (there.transitions, back.transitions),
    ):
        assert (one.count, one.total) == (two.count, two.total)
        turned = tuple(Change(c.after, c.before, c.cell, c.name) for c in two.first)
        assert one.first == turned
    assert there.best_return == back.best_return[::-1]


# -- each kind of change ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("fields", "cell", "after"),
    [
        (
            {"puddles": [{"at": [1, 0], "size": "large"}]},
            (1, 0),
            {"puddle": "large", "reward": -4.0, "skid": {"probability": 0.6, "to": "open"}},
        ),
        ({"blocked": [{"at": [1, 1]}]}, (1, 1), {"blocked": True}),
        ({"areas": [{"at": [1, 0], "ends": True}]}, (1, 0), {"ends": True}),
        (
            {"areas": [{"at": [1, 0], "skid": {"probability": 0.5, "to": "sides"}, "reward": 3}]},
            (1, 0),
            {"reward": 3.0, "skid": {"probability": 0.5, "to": "sides"}},
        ),
        (
            {"warps": [{"at": [1, 0], "to": "start", "reward": -7}]},
            (1, 0),
            {"warp": {"to": "start", "when": "enter", "reward": -7.0}},
        ),
        (
            {"warps": [{"at": [0, 1], "to": [2, 0], "when": "leave"}]},
            (0, 1),
            {"warp": {"to": [2, 0], "when": "leave"}},
        ),
    ],
)
def test_cells(fields: World, cell: tuple[int, int], after: dict[str, Any]) -> None:
    difference = changed(**fields)
    assert not difference.same_game
    assert difference.cells.first == (Change({}, after, cell),)
    assert difference.game == ()
    assert difference.walls.count == 0
    assert difference.transitions.count > 0


def test_walls() -> None:
    walls = [{"at": [0, 0], "side": "E"}, {"at": [1, 0], "side": "S", "pass": 0.25}]
    difference = changed(walls=walls)
    assert difference.walls.first == (
        Change("open", "wall", (0, 0), "E"),
        Change("open", {"pass": 0.25}, (1, 0), "S"),
    )
    assert (difference.walls.count, difference.walls.total) == (2, 7)
    assert difference.cells.count == 0
    back = diff({**PLAIN, "walls": walls}, {**PLAIN, "walls": walls[:1], "openings": walls[:1]})
    assert [(change.before, change.after) for change in back.walls.first] == [
        ("wall", "open"),
        ({"pass": 0.25}, "open"),
    ]


def test_glass_that_always_gives_way_is_not_an_open_side() -> None:
    difference = changed(walls=[{"at": [0, 0], "side": "E", "pass": 1}])
    assert difference.walls.first == (Change("open", {"pass": 1.0}, (0, 0), "E"),)


@pytest.mark.parametrize(
    ("fields", "changes"),
    [
        ({"size": [4, 2]}, [("size", [3, 2], [4, 2]), ("exit", [[2, 1]], [[3, 1]])]),
        ({"start": [1, 0]}, [("start", [[0, 0]], [[1, 0]])]),
        ({"start": [[0, 0], [1, 0]]}, [("start", [[0, 0]], [[0, 0], [1, 0]])]),
        ({"exit": "none"}, [("exit", [[2, 1]], [])]),
        ({"rewards": {"step": -2}}, [("rewards.step", -1.0, -2.0)]),
        ({"rewards": {"bump": -5}}, [("rewards.bump", None, -5.0)]),
        ({"skid": 0.5}, [("skid", None, 0.5)]),
        ({"wind": {"north": [0, 1, 0]}}, [("wind", None, {"north": [0, 1, 0]})]),
    ],
)
def test_rules_and_ends(fields: World, changes: list[tuple[str, Any, Any]]) -> None:
    difference = changed(**fields)
    told = [(change.name, change.before, change.after) for change in difference.game]
    assert [(name, before) for name, before, _ in told] == [(n, b) for n, b, _ in changes]
    for (_, _, after), (_, _, expected) in zip(told, changes, strict=True):
        given = (
            {k: v for k, v in after.items() if v is not None} if isinstance(after, dict) else after
        )
        assert given == expected
    assert not difference.same_game
    assert difference.cells.count == 0


def test_returns() -> None:
    difference = changed(rewards={"step": -2})
    assert difference.best_return == (-2.0, -4.0)
    assert difference.random_return[0] == pytest.approx(
        brl.evaluate(level_of(PLAIN), "random").expected_return
    )
    assert changed(exit="none").best_return == (-2.0, -np.inf)


def test_a_return_without_a_value_is_none() -> None:
    # One way round pays what the other costs: +1, -1, +1, ...
    swing = {"areas": [{"at": [0, 0], "reward": 1}, {"at": [1, 0], "reward": -1}]}
    world = {"version": 1, "size": [2, 1], "exit": "none", "rewards": {"bump": -9, "stay": -9}}
    assert diff({**world, **swing}, world).best_return == (None, -np.inf)


def test_what_is_not_the_game_stands_beside_it() -> None:
    difference = changed(
        title="Three by two",
        tags=["small"],
        max_steps=9,
        discount=0.5,
        theme="green",
        display={"compass": True, "robot": {"speed": 2}},
        areas=[{"at": [0, 0], "color": "red"}],
        walls=[{"at": [0, 0], "side": "N", "width": 9}],
    )
    assert difference.same_game
    assert count_of_game(difference) == 0
    assert [change.name for change in difference.beside] == [
        "title",
        "tags",
        "discount",
        "max_steps",
        "theme",
        "display.compass",
        "display.robot.speed",
        "areas.looks",
        "walls.looks",
    ]
    assert difference.beside[0] == Change(None, "Three by two", name="title")


def test_what_has_no_effect_is_told_all_the_same() -> None:
    difference = changed(rewards={"bounce": -5})
    assert difference.same_game
    assert difference.game == (Change(-1.0, -5.0, name="rewards.bounce"),)


def test_one_and_the_same_maze_is_not_the_same_as_another_each_time() -> None:
    one = {**PLAIN, "maze": {"seed": 4}}
    each_time = {**PLAIN, "maze": {"seed": "random"}}
    difference = diff(one, each_time, maze_seed=4)
    assert difference.digests[0] == difference.digests[1]
    assert not difference.same_game
    assert [change.name for change in difference.game] == ["maze"]
    assert diff(each_time, each_time).same_game
    looser = {**PLAIN, "maze": {"seed": "random", "loops": 1}}
    assert diff(each_time, looser).game[0].name == "maze"


def test_limits() -> None:
    assert len(diff("maze", "frozen-lake").transitions.first) == 10
    told = diff("maze", "frozen-lake", limit=3).transitions
    assert (len(told.first), told.count) == (3, 80)
    assert len(diff("maze", "frozen-lake", limit=None).transitions.first) == 80


def test_the_difference_can_be_written_as_json() -> None:
    data = diff("maze", "frozen-lake").to_dict()
    assert json.loads(json.dumps(data)) == data
