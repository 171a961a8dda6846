"""Drawings in text say everything that is in a level: they show it, or name what they do not."""

from __future__ import annotations

from typing import Any

import pytest
from support.worlds import level

import babyrobot_levels as brl
from babyrobot_levels.analysis.shown import actions_shown
from babyrobot_levels.language.cells import PuddleType, Rewards, Skid
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.language.kinds import KINDS, LOOKS
from babyrobot_levels.language.things import Hit, Team
from babyrobot_levels.mdp.states import initial_configuration
from babyrobot_levels.render.scene.layout import Overlay
from babyrobot_levels.render.text import TextPainter

SIZE = {"size": [4, 3], "exit": [3, 2]}
KEY = {"name": "key", "at": [1, 1]}
DOOR = {"at": [2, 0], "side": "E", "needs": "key"}
LEVER = {"name": "lever", "at": [1, 1]}
GATE = {"at": [2, 0], "side": "E", "needs": "lever"}
PAD = {"name": "pad", "at": [1, 1]}
GUARD = {"path": [[1, 2], [2, 2]]}
BAT = {"within": {"at": [1, 0], "size": [2, 2]}, "start": [1, 0]}
BREEZE = {**SIZE, "wind": {"north": [0, 1, 0, 0]}}
CHOICE = {**SIZE, "start": [[0, 0], [1, 0]]}
SHELLS = {"size": [4, 3], "exit_one_of": [[3, 2], [3, 0]]}
GLASS = {"at": [1, 1], "side": "E", "pass": 0.2}
MAP = "+---+---+---+\n| S   k   E |\n+---+---+---+\n"


def entries(field: str, entry: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {**SIZE, **more, field: [entry]}


def pair(field: str, entry: dict[str, Any], change: dict[str, Any], **more: Any) -> Any:
    """Return the fields of two levels that differ in one property of an entry."""
    changed = {name: value for name, value in (entry | change).items() if value is not None}
    return entries(field, entry, **more), entries(field, changed, **more)


TEAM = {"robots": [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [1, 2]}]}


def team(**changes: Any) -> dict[str, Any]:
    """Return the fields of a level with two robots, of which the second one differs."""
    first, second = TEAM["robots"]
    return {**SIZE, "robots": [first, {**second, **changes}]}


DIFFERENT: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    # -- kinds, by their properties
    "items.name": pair("items", KEY, {"name": "gem"}, exit_needs=[]),
    "items.at": pair("items", KEY, {"at": [2, 1]}),
    "items.one_of": pair("items", KEY, {"at": None, "one_of": [[1, 1], [2, 1]]}),
    "items.reward": pair("items", KEY, {"reward": 3}),
    "doors.at": pair("doors", DOOR, {"at": [1, 0]}, items=[KEY]),
    "doors.side": pair("doors", DOOR, {"side": "S"}, items=[KEY]),
    "doors.length": pair("doors", DOOR, {"length": 2}, items=[KEY]),
    "doors.needs": pair("doors", DOOR, {"needs": None, "unless": "key"}, items=[KEY]),
    "doors.unless": pair("doors", {**DOOR, "unless": "lever"}, {"unless": None}, items=[KEY],
                         switches=[{**LEVER, "at": [0, 2]}]),
    "switches.name": pair("switches", LEVER, {"name": "plate"}),
    "switches.at": pair("switches", LEVER, {"at": [2, 1]}),
    "switches.once": pair("switches", LEVER, {"once": True}, doors=[GATE]),
    "switches.on": pair("switches", LEVER, {"on": True}, doors=[GATE]),
    "boxes.at": pair("boxes", {"at": [1, 1]}, {"at": [2, 1]}),
    "targets.at": pair("targets", {"at": [1, 1]}, {"at": [2, 1]}, boxes=[{"at": [1, 0]}]),
    "targets.name": (entries("targets", PAD, exit_needs="pad"),
                     entries("targets", {**PAD, "name": "spot"}, exit_needs="spot")),
    "movers.name": pair("movers", GUARD, {"name": "watchman"}),
    "movers.path": pair("movers", GUARD, {"path": [[1, 2], [1, 1]]}),
    "movers.back": pair("movers", {"path": [[1, 1], [2, 1], [2, 2], [1, 2]]}, {"back": True}),
    "movers.within": pair("movers", BAT, {"within": {"at": [1, 0], "size": [2, 3]}}),
    "movers.start": pair("movers", BAT, {"start": None}),
    "items.robot": pair("items", KEY, {"robot": "a"}, **TEAM),
    "robots.name": (team(), team(name="c")),
    "robots.start": (team(), team(start=[2, 1])),
    "robots.exit": (team(), team(exit=[1, 0])),
    "team.meet": (team(), {**team(), "team": {"meet": "pass"}}),
    "team.arrived": (team(), {**team(), "team": {"arrived": "stay"}}),
    "team.ends": (team(), {**team(), "team": {"ends": "first"}}),
    "warps.at": pair("warps", {"at": [1, 1], "to": [3, 0]}, {"at": [2, 1]}),
    "warps.to": pair("warps", {"at": [1, 1], "to": [3, 0]}, {"to": [2, 0]}),
    "warps.when": pair("warps", {"at": [1, 1], "to": [3, 0]}, {"when": "leave"}),
    "warps.probability": pair("warps", {"at": [1, 1], "to": [3, 0]}, {"probability": 0.5}),
    "warps.weights": pair("warps", {"at": [1, 1], "to": [[3, 0], [2, 0]]}, {"weights": [1, 3]}),
    "warps.reward": pair("warps", {"at": [1, 1], "to": [3, 0]}, {"reward": -7}),
    "puddles.at": pair("puddles", {"at": [1, 1]}, {"at": [2, 1]}),
    "puddles.size": pair("puddles", {"at": [1, 1]}, {"size": "large"}),
    "blocked.at": pair("blocked", {"at": [1, 1]}, {"at": [2, 1]}),
    "blocked.size": pair("blocked", {"at": [1, 1]}, {"size": [2, 1]}),
    "areas.at": pair("areas", {"at": [1, 1], "reward": -9}, {"at": [2, 1]}),
    "areas.size": pair("areas", {"at": [1, 1], "reward": -9}, {"size": [2, 1]}),
    "areas.reward": pair("areas", {"at": [1, 1], "reward": -9}, {"reward": -8}),
    "areas.skid": pair("areas", {"at": [1, 1], "reward": -9}, {"skid": 0.4}),
    "areas.ends": pair("areas", {"at": [1, 1], "reward": -9}, {"ends": True}),
    "walls.at": pair("walls", {"at": [1, 1], "side": "E"}, {"at": [0, 1]}),
    "walls.side": pair("walls", {"at": [1, 1], "side": "E"}, {"side": "S"}),
    "walls.length": pair("walls", {"at": [1, 1], "side": "E"}, {"length": 2}),
    "walls.pass": pair("walls", {"at": [1, 1], "side": "E", "pass": 0.2}, {"pass": 0.3}),
    "openings.at": pair("openings", {"at": [1, 1], "side": "E"}, {"at": [0, 1]},
                        walls=[{"at": [0, 1], "side": "E"}, {"at": [1, 1], "side": "E"}]),
    "openings.side": pair("openings", {"at": [1, 1], "side": "E"}, {"side": "S"},
                          walls=[{"at": [1, 1], "side": "S"}, {"at": [1, 1], "side": "E"}]),
    "openings.length": pair("openings", {"at": [1, 0], "side": "E"}, {"length": 2},
                            walls=[{"at": [1, 0], "side": "E", "length": 3}]),
    **{f"wind.{side}": (SIZE, {**SIZE, "wind": {side: [0, 2, 0, 0][:lines]}})
       for side, lines in (("north", 4), ("east", 3), ("south", 4), ("west", 3))},
    "wind.varies": (BREEZE, {**SIZE, "wind": {"north": [0, 1, 0, 0], "varies": True}}),
    "wind.probability": (BREEZE, {**SIZE, "wind": {"north": [0, 1, 0, 0], "probability": 0.5}}),
    # -- further fields
    "size": (SIZE, {**SIZE, "size": [5, 3]}),
    "moves": (SIZE, {**SIZE, "moves": 8}),
    "map": ({"map": MAP.replace("k", " ")}, {"map": MAP.replace("k", "o")}),
    "legend": ({"map": MAP, "legend": {"k": {"reward": -3}}},
               {"map": MAP, "legend": {"k": {"reward": -4}}}),
    "start": (SIZE, {**SIZE, "start": [1, 1]}),
    "start_weights": (CHOICE, {**CHOICE, "start_weights": [1, 3]}),
    "heading": (SIZE, {**SIZE, "heading": "N"}),
    "exit": (SIZE, {**SIZE, "exit": [2, 2]}),
    "exit_one_of": (SHELLS, {"size": [4, 3], "exit_one_of": [[3, 2], [3, 1]]}),
    "exit_weights": (SHELLS, {**SHELLS, "exit_weights": [1, 3]}),
    "exit_needs": ({**SIZE, "items": [KEY]}, {**SIZE, "items": [KEY], "exit_needs": "key"}),
    "maze": ({**SIZE, "maze": {"seed": 1}}, {**SIZE, "maze": {"seed": 2}}),
    "skid": (SIZE, {**SIZE, "skid": 0.1}),
    "discount": (SIZE, {**SIZE, "discount": 0.9}),
    "max_steps": (SIZE, {**SIZE, "max_steps": 30}),
    # -- mappings, by their fields
    "hit.reward": (entries("movers", GUARD), entries("movers", GUARD, hit={"reward": -5})),
    "hit.ends": (entries("movers", GUARD), entries("movers", GUARD, hit={"ends": False})),
    "puddle_types.reward": pair("puddles", {"at": [1, 1]}, {}, puddle_types={"small": {}}),
    "puddle_types.skid": pair("puddles", {"at": [1, 1]}, {}, puddle_types={"small": {}}),
    "skid.probability": ({**SIZE, "skid": 0.1}, {**SIZE, "skid": 0.2}),
    "skid.to": ({**SIZE, "skid": 0.1}, {**SIZE, "skid": {"probability": 0.1, "to": "sides"}}),
    **{f"rewards.{name}": (entries("walls", GLASS), entries("walls", GLASS, rewards={name: -7}))
       for name in Rewards.model_fields},
}  # fmt: skip
DIFFERENT["puddle_types.reward"][1]["puddle_types"] = {"small": {"reward": -5}}
DIFFERENT["puddle_types.skid"][1]["puddle_types"] = {"small": {"skid": 0.9}}


def test_all_kinds_and_fields_are_tried() -> None:
    kinds = {kind.field: kind for kind in KINDS if kind.properties}
    parts: dict[str, Any] = {"hit": Hit, "puddle_types": PuddleType, "rewards": Rewards}
    parts["team"] = Team
    expected = {f"skid.{name}" for name in Skid.model_fields}
    for field in fields_with(Role.GEOMETRY, Role.DYNAMICS, Role.REWARD, Role.LIMIT):
        inner = kinds[field].properties if field in kinds else ()
        inner = tuple(parts[field].model_fields) if field in parts else inner
        expected |= {f"{field}.{name}" for name in inner if name not in LOOKS} or {field}
    assert DIFFERENT.keys() == expected


def text_of(world: brl.Level, *, plain: bool) -> str:
    painter = TextPainter(world, plain=plain)
    return "\n".join([*painter.lines(None, held=False), *painter.explained()])


@pytest.mark.parametrize("plain", [True, False])
@pytest.mark.parametrize("name", DIFFERENT)
def test_levels_that_differ_are_told_apart(name: str, plain: bool) -> None:
    one, two = (level(**fields) for fields in DIFFERENT[name])
    assert text_of(one, plain=plain) != text_of(two, plain=plain)


@pytest.mark.parametrize("plain", [True, False])
@pytest.mark.parametrize("name", DIFFERENT)
def test_policies_beside_it_hide_nothing(name: str, plain: bool) -> None:
    for fields in DIFFERENT[name]:
        world = level(**fields)
        number = initial_configuration(world) if world.has_things else None
        overlay = Overlay(actions=actions_shown(brl.solve(world, 0.9), number))
        painter = TextPainter(world, plain=plain, overlay=overlay)
        told = " ".join(" ".join(painter.explained(configuration=number)).split())
        bare = TextPainter(world, plain=plain).explained(configuration=number)
        for line in bare:
            _, _, words = line.partition("  ")
            assert all(part in told for part in " ".join(words.split()).split("; "))


# -- what lies below something else -------------------------------------------------------------

MUD = {"at": [1, 1], "size": [2, 1], "reward": -9, "label": "mud"}
COVERS: dict[str, dict[str, Any]] = {
    "start": {"start": [1, 1]},
    "item": {"items": [KEY]},
    "switch": {"switches": [LEVER]},
    "mover": {"movers": [{"path": [[1, 1], [1, 2]]}]},
    "warp": {"warps": [{"at": [1, 1], "to": [3, 0], "when": "leave"}]},
}
BELOW: dict[str, dict[str, Any]] = {
    "area": {"areas": [MUD]},
    "puddle": {"puddles": [{"at": [1, 1]}]},
}


@pytest.mark.parametrize("plain", [True, False])
@pytest.mark.parametrize("below", BELOW)
@pytest.mark.parametrize("cover", COVERS)
def test_what_something_covers_is_told(cover: str, below: str, plain: bool) -> None:
    dry, wet = (level(**SIZE, **COVERS[cover], **more) for more in ({}, BELOW[below]))
    assert text_of(dry, plain=plain) != text_of(wet, plain=plain)
    elsewhere = {name: [entry | {"at": [2, 1]}] for name, (entry,) in BELOW[below].items()}
    moved = level(**SIZE, **COVERS[cover], **elsewhere)
    assert text_of(moved, plain=plain) != text_of(wet, plain=plain)


def test_the_cells_are_told_that_do_not_show_what_is_in_them() -> None:
    def told(**fields: Any) -> list[str]:
        return TextPainter(level(**SIZE, **fields), plain=True).explained()

    assert "M        mud, also at [1, 1]: costs 9" in told(areas=[MUD], start=[1, 1])
    assert told(puddles=[{"at": [1, 1]}], items=[KEY])[-1] == (
        "not drawn: each step: costs 1; small puddle at [1, 1]: costs 2, skids 4 times in 10"
    )
    assert "E        exit: ends the episode, pays 0" in told(movers=[GUARD])
    assert "not drawn: exit at [3, 2]: ends" in told(movers=[{"path": [[3, 2], [3, 1]]}])[-2]


def test_cells_that_share_a_mark_are_told_apart_by_place() -> None:
    drawn = {"map": "+---+---+---+---+\n| S   A   A   E |\n+---+---+---+---+\n"}
    lava = {"legend": {"A": {"reward": -3, "label": "lava"}}, "areas": [{"at": [2, 0], "skid": 1}]}
    told = TextPainter(level(**drawn, **lava), plain=True).explained()
    assert "A        lava at [1, 0]: costs 3" in told
    assert any(line.startswith("A        lava at [2, 0]: costs 3, skids") for line in told)


def test_where_else_an_exit_may_be_stands_beside_that_which_is_shown() -> None:
    world = level(size=[4, 3], exit_one_of=[[3, 2], [3, 0]])
    told = TextPainter(world, plain=True).explained(configuration=0)
    assert told[0] == "E        exit, else at [3, 0]: in one of 2 cells, ends the episode, pays 0"


def test_each_wind_has_the_arrows_that_go_its_way_and_policies_hide_them() -> None:
    winds = {"east": [0, 1, 0], "north": [0, 1, 1, 0]}
    world = level(**SIZE, wind=winds)
    told = TextPainter(world).explained()
    assert told[1:3] == ["↑ ↗      wind: pushes 1 cell north in columns 1 and 2",
                         "→ ↗      wind: pushes 1 cell east in row 1"]  # fmt: skip
    overlay = Overlay(actions=[[[1]] * 4] * 3)
    *_, last = TextPainter(world, overlay=overlay).explained(columns=200)
    assert last.endswith("in columns 1 and 2; wind: pushes 1 cell east in row 1")


def test_diagonal_moves_are_the_digits_of_a_keypad_where_there_are_no_arrows() -> None:
    overlay = Overlay(actions=[[[6]] * 4] * 3)
    told = [
        TextPainter(level(**SIZE, moves=8), plain=plain, overlay=overlay).explained()[0].split("  ")
        for plain in (True, False)
    ]
    assert told[0] == ["^ > v < 9 3 1 7", told[1][1] + "; digits as on a keypad"]


# -- every mark is explained -------------------------------------------------------------------

WALLS = set("+-|:/ ┌┐└┘├┤┬┴┼─│╵╷╴╶·█╌╎┃━#")


@pytest.mark.parametrize("plain", [True, False])
@pytest.mark.parametrize("name", [info.name for info in brl.levels()])
def test_every_mark_of_the_gallery_is_explained(name: str, plain: bool) -> None:
    world = brl.load(name)
    if world.has_random_maze:
        world = world.with_maze_seed(0)
    painter = TextPainter(world, plain=plain)
    told = painter.explained()
    marks = {mark for line in told for mark in line[:9].split()}
    shown = set("".join(painter.lines(None, held=False))) - WALLS
    assert shown <= marks
