"""Things in the language: what is read is what is written, drawn, shared and resolved."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from support.things import thing_worlds
from support.worlds import World, level_of, level_of_text

import babyrobot_levels as brl
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.grid import grid_with_doors
from babyrobot_levels.text.errors import LevelError

DRAWN = """\
# A level that is drawn.
version: 1
map: |
  +---+---+---+---+
  | S   k / c   c |
  +   +   +---+-/-+
  | l   ~ : * | E |
  +---+---+---+---+
legend:
  k: {item: key, color: gold}  # opens the door
  c: {item: coin, reward: 2}
  l: {switch: lever, once: true}
  "*": {item: star}
  "~": {reward: -3}
# What opens what.
doors:
  - {at: [1, 0], side: E, needs: key}
  - {at: [3, 1], side: N, needs: [key, lever]}
"""


def drawn(**fields: Any) -> Level:
    return level_of({**level_of_text(DRAWN).to_dict(), **fields})


# -- fields --------------------------------------------------------------------------------


def test_a_level_without_things_has_none() -> None:
    level = level_of({"version": 1})
    assert not level.has_things
    assert (level.items, level.doors, level.switches, level.movers) == ((), (), (), ())
    assert (level.exit_one_of, level.exit_needs, level.heading) == (None, (), "E")
    assert (level.hit.reward, level.hit.ends) == (-1, True)


def test_exits_are_the_cells_that_may_be_drawn() -> None:
    level = level_of({"version": 1, "exit_one_of": [[1, 1], [2, 2]]})
    assert level.has_things
    assert level.exits == ((1, 1), (2, 2))
    assert level.exit == "none"


@pytest.mark.parametrize(
    ("name", "shape", "picture"),
    [("coin", None, "coin"), ("red-key", None, "star"), ("coin", "box", "box")],
)
def test_an_item_is_pictured_by_its_name_or_its_shape(
    name: str, shape: str | None, picture: str
) -> None:
    level = level_of({"version": 1, "items": [{"name": name, "at": [1, 1], "shape": shape}]})
    assert level.items[0].picture == picture


@pytest.mark.parametrize(
    ("mover", "phases"),
    [
        ({"path": [[0, 1]]}, [(0, 1)]),
        ({"path": [[0, 1]], "back": True}, [(0, 1)]),
        ({"path": [[0, 1], [1, 1]], "back": True}, [(0, 1), (1, 1)]),
        ({"path": [[0, 1], [1, 1], [2, 1]], "back": True}, [(0, 1), (1, 1), (2, 1), (1, 1)]),
        ({"path": [[0, 1], [0, 1], [1, 1]]}, [(0, 1), (0, 1), (1, 1)]),
        ({"within": {"at": [1, 0], "size": [2, 2]}}, [(1, 0), (2, 0), (1, 1), (2, 1)]),
    ],
    ids=str,
)
def test_the_phases_of_movers(mover: World, phases: list[tuple[int, int]]) -> None:
    level = level_of({"version": 1, "movers": [mover]})
    assert list(level.movers[0].phases) == phases


@pytest.mark.parametrize("needs", ["key", ["key"]])
def test_one_name_may_be_written_without_a_list(needs: Any) -> None:
    items = [{"name": "key", "at": [1, 0]}]
    doors = [{"at": [0, 0], "side": "S", "needs": needs, "unless": needs}]
    level = level_of({"version": 1, "items": items, "doors": doors, "exit_needs": needs})
    assert (level.doors[0].keys, level.doors[0].locks) == (("key",), ("key",))
    assert level.exit_keys == ("key",)


# -- there and back ------------------------------------------------------------------------


@given(thing_worlds())
def test_a_level_writes_what_it_read(world: World) -> None:
    level = level_of(world)
    assert level_of_text(level.to_yaml()) == level
    assert level_of(level.to_dict()).to_dict() == level.to_dict()


@given(thing_worlds())
def test_drawn_with_its_doors_a_level_has_the_same_sides(world: World) -> None:
    level = level_of(world)
    # A drawing shows targets, and not their names.
    names = {name for door in level.doors for name in (*door.keys, *door.locks)}
    assume(names.isdisjoint(target.name for target in level.targets))
    text = level.draw()
    beside: World = {n: world[n] for n in ("doors", "items", "switches") if n in world}
    # Where there is a start or an exit, the drawing shows it, and lists of things stay lists.
    ends = {"exit_one_of": world["exit_one_of"]} if "exit_one_of" in world else {}
    copy = level_of({"version": 1, "map": text, **beside, **ends})
    assert copy.draw() == text
    assert copy.grid().open_bits == level.grid().open_bits
    assert copy.grid().glass.keys() == level.grid().glass.keys()
    for closed in range(2 ** min(len(level.doors), 3)):
        assert sides_with(copy, closed) == sides_with(level, closed)


def sides_with(level: Level, closed: int) -> bytes:
    each = [bool(closed >> index & 1) for index in range(len(level.doors))]
    return grid_with_doors(level, level.grid(), each).open_bits


def test_the_legend_gives_items_and_switches() -> None:
    level = level_of_text(DRAWN)
    coin, star = level.items[1:]
    assert [(item.name, item.at, item.one_of) for item in level.items] == [
        ("key", (1, 0), None),
        ("coin", None, ((2, 0), (3, 0))),
        ("star", (2, 1), None),
    ]
    assert (coin.reward, star.reward, level.items[0].color) == (2, None, "gold")
    assert [(switch.name, switch.at, switch.once) for switch in level.switches] == [
        ("lever", (0, 1), True)
    ]
    assert [area.at for area in level.areas] == [(1, 1)]


def test_the_drawing_of_things_reads_back() -> None:
    level = level_of_text(DRAWN)
    fields = level.to_dict()
    assert {"map", "legend", "doors"} <= fields.keys()
    assert not {"items", "switches", "areas"} & fields.keys()
    assert level.draw() == fields["map"]
    copy = level_of({**fields, "map": level.draw()})
    assert copy == level
    assert copy.digest == level.digest


def test_drawn_things_are_those_of_lists() -> None:
    level = level_of_text(DRAWN)
    lists = level_of(
        {
            "version": 1,
            "size": [4, 2],
            "exit": [3, 1],
            "walls": [
                {"at": [2, 0], "side": "S"},
                {"at": [1, 1], "side": "E", "pass": 0.5},
                {"at": [2, 1], "side": "E"},
            ],
            "areas": [{"at": [1, 1], "reward": -3}],
            "items": [
                {"name": "key", "at": [1, 0]},
                {"name": "coin", "one_of": [[2, 0], [3, 0]], "reward": 2},
                {"name": "star", "at": [2, 1]},
            ],
            "switches": [{"name": "lever", "at": [0, 1], "once": True}],
            "doors": [
                {"at": [2, 0], "side": "W", "needs": "key"},
                {"at": [3, 0], "side": "S", "needs": ["lever", "key"]},
            ],
        }
    )
    assert lists.digest == level.digest


def test_lists_stand_behind_what_is_drawn() -> None:
    level = drawn(items=[{"name": "box", "at": [0, 0]}], switches=[{"name": "lamp", "at": [1, 1]}])
    assert [item.name for item in level.items] == ["key", "coin", "star", "box"]
    assert level.to_dict()["items"] == [{"name": "box", "at": [0, 0]}]
    assert [switch.name for switch in level.switches] == ["lever", "lamp"]


# -- changes -------------------------------------------------------------------------------


def test_fields_of_things_are_replaced() -> None:
    level = level_of_text(DRAWN)
    richer = level.replace(items=[{"name": "box", "at": [0, 0]}], exit_needs="star", heading="S")
    assert [item.name for item in richer.items] == ["key", "coin", "star", "box"]
    assert (richer.exit_keys, richer.heading) == (("star",), "S")
    assert richer.replace(items=None, exit_needs=None, heading=None) == level


def test_replacing_is_checked_with_the_walls() -> None:
    level = level_of({"version": 1, "doors": [{"at": [0, 0], "side": "E"}]})
    with pytest.raises(LevelError, match="BR322"):
        level.replace(walls=[{"at": [0, 0], "side": "E"}])


def test_comments_stay_beside_things() -> None:
    level = brl.loads(DRAWN)
    assert level.to_yaml(comments=True) == DRAWN
    text = level.replace(hit={"reward": -5}, exit_needs=["key"]).to_yaml(comments=True)
    assert text == DRAWN.replace("# What", "exit_needs: [key]\n# What") + "hit: {reward: -5}\n"


MAZE = """\
version: 1
size: [4, 3]
maze: {seed: 7}
# The cellar.
doors:
  - {at: [0, 0], side: S, needs: key}  # locked
items:
  - {name: key, at: [2, 0]}
movers:
  - {path: [[2, 0], [2, 1]], back: true}
"""


def test_a_maze_with_doors_is_written_out_as_walls() -> None:
    level = brl.loads(MAZE)
    resolved = level.resolve()
    assert resolved.maze is None
    assert resolved.doors == level.doors
    assert resolved.digest == level.digest
    assert resolved.draw() == level.draw()
    assert "-/-" in level.draw()
    assert (
        "# The cellar.\ndoors:\n  - {at: [0, 0], side: S, needs: key}  # locked"
        in resolved.to_yaml(comments=True)
    )


def test_a_drawn_maze_with_doors_is_written_out_as_a_drawing() -> None:
    level = drawn(maze={"seed": 1}, openings=[{"at": [1, 0], "side": "E"}])
    resolved = drawn(maze={"seed": 1}, openings=level.to_dict()["openings"]).resolve()
    assert resolved.to_dict()["map"] == level.draw()
    assert resolved.digest == level.digest


@given(thing_worlds(), st.integers(0, 99))
def test_things_in_mazes_stay_where_they_are(world: World, seed: int) -> None:
    # Without doors and paths, which a maze may wall in.
    world = {name: value for name, value in world.items() if name not in ("doors", "walls")}
    movers = [mover for mover in world.get("movers", []) if "within" in mover]
    level = level_of({**world, "movers": movers, "maze": {"seed": seed}})
    assert level.resolve().digest == level.digest


# -- mappings ------------------------------------------------------------------------------


def fault(fields: World) -> LevelError:
    with pytest.raises(LevelError) as caught:
        level_of({"version": 1, **fields})
    return caught.value


def test_faults_of_mappings_point_into_them() -> None:
    doors = [{"at": [0, 0], "side": "E", "needs": "kez"}]
    error = fault({"items": [{"name": "key", "at": [1, 1]}], "doors": doors})
    (found,) = error.diagnostics
    assert found.code == "BR321"
    assert "did you mean `key`?" in found.message
    assert found.source is not None
    assert "kez" in found.source.line(found.line)


def test_faults_with_the_walls_are_faults_of_the_level() -> None:
    error = fault({"doors": [{"at": [0, 0], "side": "E"}], "walls": [{"at": [1, 0], "side": "W"}]})
    assert [found.code for found in error.diagnostics] == ["BR322"]


@pytest.mark.parametrize(
    ("fields", "codes"),
    [
        # A faulty item is not there, but nobody is told that its name is unknown.
        (
            {
                "items": [{"name": "key", "at": [9]}],
                "doors": [{"at": [0, 0], "side": "E", "needs": "key"}],
            },
            ["BR203"],
        ),
        # Nor is a wrong list of exits replaced by the default one.
        ({"exit_one_of": [[1, 1]], "start": [2, 2]}, ["BR205"]),
        ({"exit_one_of": [], "start": [2, 2]}, ["BR203"]),
        ({"items": [{"name": "key", "one_of": [[1, 1]]}]}, ["BR205"]),
        ({"items": [{"name": "key", "one_of": [[1, 1], [1]]}]}, ["BR203"]),
    ],
)
def test_consequences_of_a_fault_are_not_told(fields: World, codes: list[str]) -> None:
    assert [found.code for found in fault(fields).diagnostics] == codes
