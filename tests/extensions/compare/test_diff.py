"""What `diff` says changed: all that the digest sees, and nothing where nothing changed."""

from __future__ import annotations

from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.random_things import random_level
from support.each import for_each
from support.worlds import World, decorated_worlds, level_of, worlds

import babyrobot_levels as brl
from babyrobot_levels.analysis.compare import compare
from babyrobot_levels.extensions.compare.changes import Change
from babyrobot_levels.extensions.compare.commands.diff import thing_lines
from babyrobot_levels.extensions.compare.diff import Difference, diff

PLAIN: World = {"version": 1, "size": [3, 2]}


def changed(**fields: Any) -> Difference:
    """Return what giving some fields changes in a plain level."""
    return diff(PLAIN, {**PLAIN, **fields})


def count_of_game(difference: Difference) -> int:
    listed = (difference.cells, difference.walls, difference.transitions)
    return len(difference.game) + sum(changes.count for changes in listed)


@pytest.mark.slow
@given(worlds(4), worlds(4))
def test_what_differs_is_told_and_only_that(one: World, two: World) -> None:
    difference = diff(one, two)
    levels = (level_of(one), level_of(two))
    assert difference.digests == tuple(level.digest for level in levels)
    assert difference.same_game is (difference.digests[0] == difference.digests[1])
    if not difference.same_game:
        assert count_of_game(difference) > 0


@pytest.mark.slow
@given(decorated_worlds())
def test_a_level_does_not_differ_from_itself(world: World) -> None:
    difference = diff(world, level_of(world).share_code())
    assert difference.same_game
    assert count_of_game(difference) == 0
    assert difference.beside == ()
    assert difference.best_return[0] == difference.best_return[1]


@pytest.mark.slow
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
            {"warps": [{"at": [1, 0], "to": "start", "reward": -7}]},
            (1, 0),
            {"warp": {"to": "start", "when": "enter", "reward": -7.0}},
        ),
        (
            {"warps": [{"at": [0, 1], "to": [2, 0], "when": "leave"}]},
            (0, 1),
            {"warp": {"to": [2, 0], "when": "leave"}},
        ),
        (
            {"warps": [{"at": [0, 1], "to": [[2, 0], [1, 0]], "weights": [1, 3]}]},
            (0, 1),
            {"warp": {"to": [[2, 0], [1, 0]], "when": "enter", "weights": [1, 3]}},
        ),
        (
            {"warps": [{"at": [0, 1], "to": [2, 0], "probability": 0.5}]},
            (0, 1),
            {"warp": {"to": [2, 0], "when": "enter", "probability": 0.5}},
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


def test_warps_are_not_compared_with_all_others(monkeypatch: pytest.MonkeyPatch) -> None:
    compared = []

    class Counted(dict[str, Any]):
        def __eq__(self, other: object) -> bool:
            compared.append(other)
            return super().__eq__(other)

    module = "babyrobot_levels.extensions.compare.diff"
    monkeypatch.setattr(f"{module}._warp_data", lambda warp: Counted(to=warp.to))
    level = {
        "version": 1,
        "size": [12, 9],
        "warps": [{"at": [x, 0], "to": [x, 1]} for x in range(1, 12)],
    }
    found = diff({"version": 1, "size": [12, 9]}, level, limit=None)
    assert [change.after["warp"]["to"] for change in found.cells.first] == [
        (x, 1) for x in range(1, 12)
    ]
    assert not compared


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
        ({"start": [[0, 0], [1, 0]]}, [("start", [[0, 0]], [[0, 0], [1, 0]])]),
        ({"exit": "none"}, [("exit", [[2, 1]], [])]),
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
            {name: value for name, value in after.items() if value not in (None, False, 1.0)}
            if isinstance(after, dict)
            else after
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
    # Returns are those without a limit, which is said where there is one.
    assert difference.named("Best return") == "Best return"
    assert changed(max_steps=9).named("Best return") == "Best return without a limit"


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


# -- things --------------------------------------------------------------------------------------

THINGS: World = {
    "version": 1,
    "size": [4, 3],
    "items": [{"name": "key", "at": [0, 2]}, {"name": "coin", "at": [1, 0], "reward": 3}],
    "doors": [{"at": [2, 2], "side": "E", "needs": "key"}],
    "switches": [{"name": "lever", "at": [2, 0]}],
    "movers": [{"name": "guard", "path": [[1, 1], [2, 1]], "back": True}],
}


def changed_things(**fields: Any) -> Difference:
    """Return what other fields change in a level with things."""
    return diff(THINGS, THINGS | fields, limit=None)


@pytest.mark.parametrize(
    ("fields", "changes"),
    [
        (
            {"items": [THINGS["items"][0], {"name": "coin", "at": [1, 0], "reward": 5}]},
            [
                Change(
                    {"in": [[1, 0]], "reward": 3.0, "robot": None},
                    {"in": [[1, 0]], "reward": 5.0, "robot": None},
                    name="items.coin",
                )
            ],
        ),
        (
            {"items": [*THINGS["items"], {"name": "gem", "one_of": [[3, 0], [3, 1]]}]},
            [
                Change(
                    None, {"in": [[3, 0], [3, 1]], "reward": None, "robot": None}, name="items.gem"
                )
            ],
        ),
        (
            {"doors": [{"at": [2, 2], "side": "E", "needs": ["key", "coin"]}]},
            [
                Change(
                    {"needs": ["key"], "unless": []},
                    {"needs": ["coin", "key"], "unless": []},
                    (2, 2),
                    "doors.E",
                )
            ],
        ),
        (
            {"movers": [{"name": "guard", "within": {"at": [1, 1], "size": [2, 1]}}]},
            [
                Change(
                    {"path": [[1, 1], [2, 1]], "back": True},
                    {"within": {"at": [1, 1], "size": [2, 1]}, "start": None},
                    name="movers.guard",
                )
            ],
        ),
    ],
)
def test_things(fields: World, changes: list[Change]) -> None:
    difference = changed_things(**fields)
    assert list(difference.things.first) == changes
    assert difference.game == ()
    assert not difference.same_game
    assert difference.to_dict()["things"]["count"] == len(changes)


def test_a_door_is_the_same_from_both_sides_and_in_parts() -> None:
    doors = [{"at": [1, 0], "side": "S", "length": 2, "needs": "key"}]
    parts = [
        {"at": [1, 1], "side": "N", "needs": "key"},
        {"at": [2, 0], "side": "S", "needs": ["key"]},
    ]
    difference = diff(THINGS | {"doors": doors}, THINGS | {"doors": parts})
    assert (difference.same_game, difference.things.count) == (True, 0)


@pytest.mark.parametrize(
    ("fields", "changes"),
    [
        ({"exit_needs": ["lever", "coin"]}, [("exit_needs", [], ["coin", "lever"])]),
        ({"hit": {"reward": -9}}, [("hit.reward", -1.0, -9.0)]),
        ({"heading": "N"}, [("heading", "E", "N")]),
        (
            {"exit_one_of": [[3, 2], [3, 0]]},
            [("exit", [[3, 2]], []), ("exit_one_of", [], [[3, 2], [3, 0]])],
        ),
    ],
)
def test_rules_of_things(fields: World, changes: list[tuple[str, Any, Any]]) -> None:
    difference = changed_things(**fields)
    assert [(change.name, change.before, change.after) for change in difference.game] == changes


def test_looks_of_things_are_beside_the_mdp() -> None:
    difference = changed_things(
        items=[THINGS["items"][0] | {"color": "gold"}, THINGS["items"][1]],
        movers=[THINGS["movers"][0] | {"label": "G"}],
    )
    assert difference.same_game
    assert [change.name for change in difference.beside] == ["items.looks", "movers.looks"]


def test_things_in_another_order_number_other_states() -> None:
    difference = changed_things(items=THINGS["items"][::-1])
    assert not difference.same_game
    assert [change.name for change in difference.things.first] == ["things"]
    assert difference.transitions.count == 0


def test_transitions_are_told_with_their_configuration() -> None:
    coin = {"name": "coin", "at": [1, 0], "reward": 5}
    transitions = changed_things(items=[THINGS["items"][0], coin]).transitions
    mdp = level_of(THINGS).compile()
    assert transitions.total == 5 * mdp.num_states
    first = transitions.first[0]
    held = {"key": "lies", "coin": "held", "lever": "off", "guard": [2, 1]}
    assert (first.cell, first.name) == ((0, 0), "east")
    assert first.things == held | {"coin": "lies", "guard": [1, 1]}
    outcome = {"cell": [1, 0], "things": held, "probability": 1.0, "ends": False}
    assert (first.before, first.after) == ([outcome | {"reward": 3.0}], [outcome | {"reward": 5.0}])
    # Taking the coin is what differs, wherever everything else is.
    assert {c.after[0]["reward"] for c in transitions.first} == {5.0}
    assert {c.after[0]["things"]["coin"] for c in transitions.first} == {"held"}


def test_things_of_one_level_are_as_at_the_beginning() -> None:
    gem = {"name": "gem", "at": [3, 0], "reward": 7}
    difference = changed_things(items=[*THINGS["items"], gem])
    assert difference.transitions.total == 5 * level_of(THINGS).compile().num_states
    # With the gem still there, only its reward differs.
    first = difference.transitions.first
    assert {(change.cell, change.name) for change in first} == {((2, 0), "east"), ((3, 1), "north")}
    assert {change.after[0]["reward"] for change in first} == {7.0}
    plain = {name: THINGS[name] for name in ("version", "size")}
    added = diff(plain, THINGS)
    assert added.transitions.total == 5 * 12
    assert added.things.count == added.things.total == 5


def test_a_mover_with_another_path_changes_where_it_is_met() -> None:
    bat = {"name": "bat", "within": {"at": [2, 0], "size": [2, 1]}, "start": [3, 0]}
    transitions = changed_things(movers=[*THINGS["movers"], bat]).transitions
    # The bat goes one of two ways, which is one and the same where it is not met.
    assert {change.cell for change in transitions.first} <= {(1, 0), (2, 0), (3, 0), (2, 1), (3, 1)}
    assert ((0, 0), "stay") not in {(change.cell, change.name) for change in transitions.first}
    path = [[1, 1], [2, 1], [3, 1]]
    longer = changed_things(movers=[{"name": "guard", "path": path, "back": True}])
    assert longer.transitions.count == 0


@pytest.mark.slow
@for_each("seed", range(3))
def test_random_levels_with_things(seed: int) -> None:
    fields = random_level(Random(seed))
    same = diff(fields, fields)
    assert same.same_game
    assert count_of_game(same) + same.things.count + len(same.beside) == 0
    certificate = compare(fields, fields)
    assert (certificate.equal, certificate.everywhere) == (True, True)
    other = diff(fields, random_level(Random(seed + 100)))
    assert other.same_game or count_of_game(other) + other.things.count > 0


def test_limits() -> None:
    assert len(diff("maze", "frozen-lake").transitions.first) == 10
    told = diff("maze", "frozen-lake", limit=3).transitions
    assert (len(told.first), told.count) == (3, 80)
    assert len(diff("maze", "frozen-lake", limit=None).transitions.first) == 80


def test_names_that_the_program_gives_too_are_kept_apart() -> None:
    def level(*names: str, **fields: Any) -> World:
        items = [{"name": names[0], "at": [1, 0]}, {"name": names[1], "at": [2, 1]}]
        movers = [{"path": [[0, 1], [1, 1]]}]
        ends = {"exit_one_of": [[2, 0], [3, 0]], "exit_needs": names[1]}
        world = {"version": 1, "size": [4, 2], "items": items, "movers": movers, **ends, **fields}
        return {name: value for name, value in world.items() if value is not None}

    found, usual = (
        diff(level(*names), level(*names, rewards={"step": -2})).transitions
        for names in (("exit", "mover-1"), ("key", "gem"))
    )
    assert (found.count, found.total) == (usual.count, usual.total)
    assert found.count > 0
    things = found.first[0].things
    assert things is not None
    assert [*things] == ["the-exit", "exit", "mover-1", "the-mover-1"]
    # An item `exit` is not an exit that is drawn, though both have two values.
    other = {"exit": [3, 0], "exit_one_of": None, "exit_needs": None, "movers": None}
    found, usual = (
        diff(level("a", "b", items=None, exit_needs=None), level(name, "b", **other)).transitions
        for name in ("exit", "key")
    )
    assert (found.count, found.total) == (usual.count, usual.total)


def test_a_share_code_is_a_level_and_facts_change_nothing_else() -> None:
    level = brl.load("maze")
    assert brl.diff(level, level.share_code()).same_game
    bare = brl.Level(version=1)
    difference = brl.diff(bare, bare.replace(expect={"path_length": 4.0}))
    assert difference.same_game
    assert [change.name for change in difference.beside] == ["expect"]


ROBOTS: World = {
    "version": 1,
    "size": [3, 2],
    "items": [{"name": "key", "at": [1, 1], "robot": "red"}],
    "robots": [{"name": "red", "start": [0, 0]}, {"name": "blue", "start": [2, 0], "exit": [0, 1]}],
    "movers": [{"name": "bat", "path": [[1, 0], [1, 1]]}],
}


def test_robots_are_told_and_their_joint_actions() -> None:
    red = ROBOTS["robots"][0]
    moved = ROBOTS | {
        "items": [ROBOTS["items"][0] | {"robot": "blue"}],
        "robots": [red, {"name": "blue", "start": [2, 0]}],
        "team": {"meet": "pass"},
    }
    difference = diff(ROBOTS, moved, limit=None)
    assert [change.name for change in difference.game] == ["exit", "team.meet"]
    assert [line for change in difference.things.first for line in thing_lines(change)] == [
        "the key at [1, 1] is for the robot blue instead of the robot red",
        "the robot blue leaves at the exits of the level instead of at [0, 1]",
    ]
    mdp = level_of(ROBOTS).compile()
    # The bat may be elsewhere where only one of the two can come.
    assert difference.transitions.total % (25 * mdp.cells) == 0
    names = {change.name for change in difference.transitions.first}
    assert "east_west" in names
    assert "stay_stay" not in names


def test_a_robot_more_has_no_transitions_in_common() -> None:
    alone = {name: ROBOTS[name] for name in ("version", "size", "movers")}
    for one, two, state in ((alone, ROBOTS, "new"), (ROBOTS, alone, "removed")):
        difference = diff(one, two, limit=None)
        assert (difference.same_game, difference.transitions.total) == (False, 0)
        lines = [line for change in difference.things.first for line in thing_lines(change)]
        assert lines[1:3] == [
            f"{state}: the robot red, which begins at [0, 0]",
            f"{state}: the robot blue, which begins at [2, 0] and leaves at [0, 1]",
        ]
