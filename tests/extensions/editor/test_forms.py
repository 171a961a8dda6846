"""The fields that an inspector shows."""

from __future__ import annotations

from typing import Any

import pytest
from support.gestures import done, places, send

from babyrobot_levels.extensions.editor.forms import forms
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.language.fields import LevelFields, Role, fields_with
from babyrobot_levels.language.kinds import KINDS

pytestmark = pytest.mark.usefixtures("put_off")

EVERYTHING = """\
version: 1
size: [6, 6]
start: [0, 0]
exit: [5, 5]
maze: {seed: 3}
walls:
  - {at: [1, 4], side: S, pass: 0.5}
openings:
  - {at: [0, 0], side: E}
  - {at: [1, 0], side: E}
  - {at: [2, 0], side: E}
  - {at: [2, 0], side: S}
doors:
  - {at: [1, 0], side: E, needs: key}
items:
  - {name: key, at: [0, 1]}
switches:
  - {name: lever, at: [1, 1]}
boxes:
  - {at: [5, 1]}
targets:
  - {at: [4, 5]}
movers:
  - {path: [[0, 0], [1, 0]], back: true}
  - {within: {at: [4, 2], size: [2, 2]}}
puddles:
  - {at: [2, 2]}
areas:
  - {at: [3, 3], color: red}
blocked:
  - {at: [0, 5]}
warps:
  - {at: [5, 0], to: [0, 0]}
"""

FIELDS = [(kind, field) for kind, form in forms().items() for field in form]

SAMPLES: dict[str, Any] = {
    "number": 1,
    "integer": 1,
    "text": "robot",
    "flag": True,
    "color": "gold",
    "names": ["lever"],
    "texts": ["new", "small"],
    "size": [1, 1],
}

# What has to be where something can stand.
PLACED = {
    "item.at": [3, 1],
    "switch.at": [3, 1],
    "box.at": [3, 2],
    "target.at": [4, 4],
    "mover.within.at": [4, 3],
    "mover.start": [5, 3],
    "warp.at": [5, 1],
    "warp.to": [0, 1],
    "blocked.at": [1, 5],
    "puddle.at": [1, 2],
    "area.at": [1, 2],
    "wall.at": [0, 3],
    "opening.at": [0, 1],
    "door.at": [2, 0],
    "door.side": "E",
    "opening.side": "S",
    "level.theme": "green",
    "level.moves": 4,  # Boxes know no other.
    "level.size": [7, 6],
    "level.maze.algorithm": "wilson",
}

COMPANIONS = {
    "area.skid.to": (["skid"], 0.5),
    "level.skid.to": (["skid"], 0.5),
    "level.display.side_panel.color": (["display", "side_panel"], 100),
    "level.display.side_panel.text_color": (["display", "side_panel"], 100),
    "level.display.bottom_panel.color": (["display", "bottom_panel"], 100),
    "level.display.bottom_panel.text_color": (["display", "bottom_panel"], 100),
}
"""What a field is of no use, or not possible, without."""


def sample(kind: str, field: dict[str, Any]) -> Any:
    name = f"{kind}.{field['name']}"
    if name in PLACED:
        return PLACED[name]
    if field["type"] == "choice":
        return field["choices"][-1]
    return SAMPLES[field["type"]]


@pytest.mark.parametrize(
    ("kind", "field"),
    [
        pytest.param(*each, marks=[] if number % 4 == 0 else pytest.mark.sweep)
        for number, each in enumerate(FIELDS)
        # Boxes know no robots but one.
        if each[0] != "robot" and (each[0], each[1]["name"]) != ("item", "robot")
    ],
    ids=lambda each: each if isinstance(each, str) else each["name"],
)
def test_value_of_each_field_can_be_set_and_reset(kind: str, field: dict[str, Any]) -> None:
    session = Session(EVERYTHING)
    above: list[Any] = []
    if kind != "level":
        owner = field.get("with")
        found = places(session, kind)
        above = next(each["route"] for each in found if owner in (None, *each["fields"]))
    name = f"{kind}.{field['name']}"
    if name in COMPANIONS:
        route, value = COMPANIONS[name]
        done(session, "set", route=[*above, *route], value=value)
    route = [*above, *field["route"]]
    value = sample(kind, field)
    done(session, "set", route=route, value=value)
    shown = value[0] if field["type"] == "names" else value
    assert told(session, above, field["route"]) == shown
    # A maze without a seed is none, and the exit does not fit into a level of the usual size.
    if name not in ("level.maze.seed", "level.size"):
        reply = send(session, "set", route=route, value=None)
        assert ("error" in reply) == field.get("required", False)


def told(session: Session, route: list[Any], inner: list[str]) -> Any:
    """Return a value as the state tells it, of the level or of a place."""
    state = send(session, "state")["state"]
    data = state["fields"]
    if route:
        data = next(each["fields"] for each in state["places"] if each["route"] == route)
    for segment in inner:
        data = data[segment]
    return data


def test_forms_are_those_of_everything_that_can_be_selected() -> None:
    kinds = {each["kind"] for each in send(Session(EVERYTHING), "state")["state"]["places"]}
    # Boxes know no robots but one.
    assert kinds | {"level", "robot"} == {*forms()}


def test_level_has_all_fields_but_those_that_are_drawn() -> None:
    drawn = {field for kind in KINDS for field in kind.fields} | {"map", "legend", "version"}
    drawn |= {*fields_with(Role.EXPECTATION)}
    # Weights are lists that stand in the text; of the wind, all but its lines is a field.
    drawn = (drawn | {"start_weights", "exit_weights"}) - {"wind"}
    shown = {each["route"][0] for each in forms()["level"]}
    assert shown == {*LevelFields.model_fields} - drawn


def test_fields_say_what_they_mean_and_what_is_allowed() -> None:
    fields = {(kind, field["name"]): field for kind, field in FIELDS}
    assert all(field["description"] for field in fields.values())
    skid = fields["level", "puddle_types.small.skid.probability"]
    assert skid["route"] == ["puddle_types", "small", "skid", "probability"]
    assert (skid["minimum"], skid["maximum"], skid["default"]) == (0, 1, 0.4)
    assert fields["door", "side"]["choices"] == ["N", "E", "S", "W"]
    assert fields["level", "maze.seed"]["choices"] == ["random"]
    assert "green" in fields["level", "theme"]["choices"]
    assert fields["mover", "back"]["with"] == "path"
    assert fields["mover", "start"]["with"] == "within"
    assert fields["level", "rewards.step"]["group"] == "reward"


def test_forms_come_with_the_first_state_only() -> None:
    session = Session(EVERYTHING)
    assert send(session, "state")["state"]["forms"] == forms()
    assert "forms" not in send(session, "undo")["state"]
