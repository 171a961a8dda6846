"""A thing is whole: what a level may have is seen wherever the level is shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import babyrobot_levels as brl
from babyrobot_levels.language.kinds import THINGS
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.svg import to_svg
from babyrobot_levels.render.text import TextPainter
from babyrobot_levels.render.words.describe import describe
from babyrobot_levels.render.words.rules import rules_of

Fields = dict[str, Any]

BASE: Fields = {
    "version": 1,
    "size": [5, 4],
    "exit": [4, 3],
    "switches": [{"name": "s", "at": [0, 3]}],
}
KEY = {"name": "key", "at": [2, 1]}

PAIRS: dict[str, tuple[Fields, Fields]] = {
    "item": ({"items": [KEY]}, {"items": [{**KEY, "at": [3, 1]}]}),
    "door": (
        {"doors": [{"at": [2, 2], "side": "E", "needs": "s"}]},
        {"doors": [{"at": [1, 2], "side": "E", "needs": "s"}]},
    ),
    "switch": ({}, {"switches": [{"name": "s", "at": [1, 3]}]}),
    "box": ({"boxes": [{"at": [2, 1]}]}, {"boxes": [{"at": [3, 1]}]}),
    "target": (
        {"boxes": [{"at": [1, 1]}], "targets": [{"at": [2, 1]}]},
        {"boxes": [{"at": [1, 1]}], "targets": [{"at": [3, 1]}]},
    ),
    "robot": (
        {"robots": [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [2, 1]}]},
        {"robots": [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [3, 1]}]},
    ),
    "mover": ({"movers": [{"path": [[2, 1]]}]}, {"movers": [{"path": [[3, 1]]}]}),
}
"""For each kind with a state, two levels that differ in where one of it is."""

SURFACES: dict[str, Callable[[brl.Level], Any]] = {
    "picture": lambda level: to_svg(build_scene(level)),
    "frame": lambda level: to_svg(build_scene(level, state=first_state(level))),
    "characters": lambda level: TextPainter(level, plain=True).lines(None),
    "tables": lambda level: level.digest,
    "share code": lambda level: level.share_code(),
}


def first_state(level: brl.Level) -> int:
    return int(level.compile().start.argmax())


def test_every_kind_with_a_state_is_tried() -> None:
    assert PAIRS.keys() == {kind.name for kind in THINGS}


@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize("kind", PAIRS)
def test_where_it_is_can_be_seen(kind: str, surface: str) -> None:
    one, other = (brl.load(BASE | fields) for fields in PAIRS[kind])
    assert SURFACES[surface](one) != SURFACES[surface](other)


@pytest.mark.parametrize("kind", PAIRS)
def test_words_tell_that_it_is_there(kind: str) -> None:
    there = brl.load(BASE | PAIRS[kind][0])
    field = next(each.field for each in THINGS if each.name == kind)
    gone = {name: value for name, value in (BASE | PAIRS[kind][0]).items() if name != field}
    without = brl.load(gone)
    assert (describe(there), rules_of(there)) != (describe(without), rules_of(without))


@pytest.mark.parametrize("kind", PAIRS)
def test_a_difference_names_it(kind: str) -> None:
    one, other = (brl.load(BASE | fields) for fields in PAIRS[kind])
    found = brl.diff(one, other)
    assert not found.same_game
    names = [change.name or "" for change in (*found.things.first, *found.game)]
    field = next(each.field for each in THINGS if each.name == kind)
    assert any(name.startswith(field) for name in names), names


@pytest.mark.parametrize("kind", [kind for kind in PAIRS if kind != "robot"])
@pytest.mark.parametrize("observation", ["planes", "view", "image"])
def test_agents_can_tell_where_it_is(kind: str, observation: str) -> None:
    seen = []
    for fields in PAIRS[kind]:
        env = brl.load(BASE | fields).make(observation=observation)
        row, _ = env.reset(seed=1)
        seen.append(row.tobytes())
    assert seen[0] != seen[1]
