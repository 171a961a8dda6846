"""The table of kinds against the fields of levels."""

from __future__ import annotations

from typing import get_args

import pytest

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import Model
from babyrobot_levels.language.fields import DRAWN, LevelFields, Role, fields_with
from babyrobot_levels.language.kinds import KIND, KINDS, LEGEND, LISTED, NAMED, NEEDED, THINGS, Kind
from babyrobot_levels.language.things import DRAWN_NAMES, DrawnThing, LegendEntry

BESIDE = {"start_weights", "exit_weights", "tags"}
"""Lists of a level that do not say what stands somewhere."""


def test_each_list_of_a_level_is_that_of_a_kind() -> None:
    lists = {
        name: get_args(info.annotation)[0]
        for name, info in LevelFields.model_fields.items()
        if get_args(info.annotation)[1:] == (...,) and name not in BESIDE
    }
    assert lists == {kind.field: kind.model for kind in LISTED}


def test_each_kind_is_given_by_fields_of_a_level() -> None:
    fields = [field for kind in KINDS for field in kind.fields]
    assert len(fields) == len({*fields})
    assert {*fields} <= {*LevelFields.model_fields}
    # What is left is for the whole level.
    others = {*fields_with(Role.GEOMETRY, Role.DYNAMICS)} - {*fields}
    assert others == {
        *("size", "map", "legend", "heading", "exit_needs", "maze", "hit", "puddle_types", "skid"),
        *("team", "start_weights", "exit_weights", "moves"),
    }


def test_a_level_has_things_if_it_has_one_of_a_kind_with_a_state() -> None:
    level = LevelFields(version=1)
    assert not level.has_things
    for kind in KINDS:
        given = level.model_copy(update={kind.field: (object(),)})
        assert given.has_things is (kind in THINGS), kind.name


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_kind_has_an_article_and_a_plural(kind: Kind) -> None:
    assert kind.one in (f"a {kind.noun}", f"an {kind.noun}")
    assert kind.plural.endswith("s")
    assert KIND[kind.name] is kind


def test_marks_are_those_of_drawings_and_belong_to_one_kind_each() -> None:
    # A target with a box shows both.
    marks = [mark for kind in KINDS for mark in kind.marks if mark != d.COVERED]
    assert len(marks) == len({*marks})
    # Corners and horizontal walls are other characters of the same marks.
    assert {*marks} | {d.PLAIN, "+", "-"} == d.RESERVED | {d.DOOR, d.BOX, d.TARGET}


def test_drawn_fields_are_those_of_kinds_with_marks() -> None:
    drawn = {kind.field for kind in KINDS if any(mark in "SEoO#" for mark in kind.marks)}
    assert {*fields_with(DRAWN)} == drawn | {"size"}


def test_the_legend_knows_the_fields_of_the_kinds_that_it_may_stand_for() -> None:
    assert {kind.name for kind in LEGEND} == {"area", *DRAWN_NAMES}
    assert {*DRAWN_NAMES} <= {*DrawnThing.model_fields}
    assert {field for kind in LEGEND for field in kind.legend} == {*LegendEntry.model_fields}
    for kind in LEGEND:
        assert {*kind.legend} - {kind.name} <= {*kind.properties}


def test_what_can_be_needed_has_a_name_a_state_and_a_cell() -> None:
    for kind in NEEDED:
        assert kind in NAMED
        assert kind in THINGS
        assert "at" in kind.properties


def test_labels_of_entries() -> None:
    entries: list[tuple[str, dict[str, object], str]] = [
        ("item", {"name": "red-key", "at": [0, 0]}, "red-key"),
        ("door", {"at": [0, 0], "side": "E", "needs": ["a", "b"]}, "door, needs a, b"),
        ("door", {"at": [0, 0], "side": "E", "unless": "a"}, "door, unless a"),
        ("switch", {"name": "lever", "at": [0, 0]}, "lever"),
        ("box", {"at": [0, 0]}, "box"),
        ("target", {"at": [0, 0]}, "target"),
        ("target", {"at": [0, 0], "name": "pad"}, "pad"),
        ("robot", {"name": "red"}, "red"),
        ("mover", {"name": "bat", "path": [[0, 0]]}, "bat"),
        ("mover", {"path": [[0, 0]]}, "guard"),
        ("mover", {"within": {"at": [0, 0]}}, "wanderer"),
        ("warp", {"at": [0, 0], "to": "start"}, "warp to start"),
        ("warp", {"at": [0, 0], "to": [2, 1]}, "warp to [2, 1]"),
        ("puddle", {"at": [0, 0], "size": "large"}, "large puddle"),
        ("blocked", {"at": [0, 0]}, "blocked"),
        ("area", {"at": [0, 0]}, "area"),
        ("area", {"at": [0, 0], "label": "ice"}, "ice"),
        ("wall", {"at": [0, 0], "side": "E"}, "wall"),
        ("wall", {"at": [0, 0], "side": "E", "pass": 0.25}, "glass 0.25"),
        ("opening", {"at": [0, 0], "side": "E"}, "opening"),
    ]
    for name, data, label in entries:
        entry: Model = KIND[name].entry(data)
        assert KIND[name].called(entry) == label
    assert {name for name, *_ in entries} == {kind.name for kind in LISTED}
