"""Slots: what stands where in a cell, and what gives way."""

from __future__ import annotations

from itertools import combinations, product
from typing import Any

import pytest

from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.scene.layout import CELL, Overlay, layout_of
from babyrobot_levels.render.scene.slots import Box, Slots, standing_cells


def level(**fields: Any) -> Any:
    return Level.from_fields({"version": 1, "size": [4, 3], **fields})


def slots_of(world: Any, **shown: Any) -> Slots:
    overlay = Overlay(**shown)
    return Slots(world, layout_of(world, overlay=overlay), overlay)


def in_each_cell(content: Any) -> list[list[Any]]:
    return [[content] * 4 for _ in range(3)]


def touch(a: Box, b: Box) -> bool:
    return a.left < b.right and b.left < a.right and a.top < b.bottom and b.top < a.bottom


def cross(box: Box) -> list[Box]:
    """Return what arrows to all sides take of their square."""
    (x, y), half = box.centre, 0.3 * box.width / 2 + 2
    return [
        Box(box.left, y - half, box.right, y + half),
        Box(x - half, box.top, x + half, box.bottom),
    ]


KINDS = {
    "values": in_each_cell(1.0),
    "actions": in_each_cell((Action.EAST,)),
    "visits": in_each_cell(3),
    "coordinates": True,
}
COMBINATIONS = [
    {name: KINDS[name] for name, is_shown in zip(KINDS, shown, strict=True) if is_shown}
    for shown in product((False, True), repeat=len(KINDS))
]
LABEL = {"areas": [{"at": [1, 1], "size": [2, 1], "label": "a label"}]}


@pytest.mark.parametrize("fields", [{}, LABEL, {"display": {"coordinates": True}}], ids=str)
@pytest.mark.parametrize("shown", COMBINATIONS, ids=lambda shown: "+".join(shown))
def test_boxes_of_a_cell_do_not_touch(fields: dict[str, Any], shown: dict[str, Any]) -> None:
    world = level(**fields)
    slots = slots_of(world, **shown)
    own = layout_of(world).corner(0, 0)
    for cell in ((0, 0), (1, 0), (1, 1), (2, 1), (3, 2)):
        plan = slots.plan(cell)
        taken: list[list[Box]] = [[plan.icon]]
        if slots.shown.arrows:
            taken.append(cross(plan.arrow))
        if slots.shown.number:
            # Numbers of a common length.
            taken.append([plan.number._replace(left=12, right=52)])
        if slots.shown.second:
            taken.append([plan.second])
        if plan.coordinates is not None:
            taken.append([plan.coordinates._replace(right=26)])
        if plan.word is not None:
            taken.append([plan.word])
        taken += [
            [label.box.moved(-own[0] - CELL * cell[0], -own[1] - CELL * cell[1])]
            for label in slots.labels
        ]
        is_answered = cell in slots.acting and slots.shown.fills_cells
        # Without answers, what the world has in a cell may be as wide as its coordinates.
        parts = taken if is_answered and slots.shown.arrows else taken[1:]
        for first, second in combinations(parts, 2):
            assert not any(touch(a, b) for a in first for b in second), (cell, plan)
        for box in (plan.icon, plan.arrow, plan.number):
            assert 0 <= box.left < box.right <= CELL
            assert 0 <= box.top < box.bottom <= CELL


def test_the_robot_can_act_where_it_can_stand() -> None:
    world = level(
        blocked=[{"at": [1, 0]}],
        warps=[{"at": [1, 1], "to": "start"}, {"at": [2, 1], "to": [0, 2], "when": "leave"}],
    )
    acting, ends = standing_cells(world)
    cells = {(x, y) for x in range(4) for y in range(3)}
    assert cells - acting == {(1, 0), (1, 1), (3, 2)}
    assert ends == {(3, 2)}


def test_the_robot_can_stand_where_it_can_in_any_configuration() -> None:
    world = level(
        items=[{"name": "key", "at": [0, 2]}],
        doors=[{"at": [3, 1], "side": "W", "length": 1, "needs": "key"}],
        walls=[{"at": [2, 0], "side": "E"}, {"at": [2, 2], "side": "E"}],
    )
    acting, ends = standing_cells(world)
    assert (3, 0) in acting
    assert ends == {(3, 2)}
