"""Hostile levels take time that grows with what is in them: calls are counted, not seconds."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import pytest
from limits.drawn import LISTS, hostile
from support.combinations import combined, selected
from support.work import counted_calls

import babyrobot_levels as brl
from babyrobot_levels.extensions.editor.protocol import answer
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.library.level import Level
from babyrobot_levels.suites.checking import formatted
from babyrobot_levels.text.budget import COMMAND, OverBudgetError, within
from babyrobot_levels.text.source import SourceFile

FEW, TIMES = 60, 4

PRODUCTS = ("exit_one_of", "items", "switches", "movers")
"""The fields whose entries multiply the states: they are bounded, and not linear."""


def of_level(look: Callable[[Level], Any]) -> Callable[[str], Any]:
    """Return what looks at the level of a text; what has errors comes to too much."""

    def look_at(text: str) -> None:
        with suppress(brl.LevelError, OverBudgetError, ArithmeticError):
            look(brl.loads(text))

    return look_at


def typed(text: str) -> None:
    """Type a text in the editor."""
    session = Session("version: 1\n")
    answer(session, {"id": 1, "do": "text", "text": text, "revision": session.revision})


LOOKS: dict[str, Callable[[str], Any]] = {
    "validate": brl.validate,
    "lint": brl.lint,
    "show": of_level(brl.show),
    "format": lambda text: formatted(SourceFile("x.yaml", text)),
    "share": of_level(lambda level: level.share_code()),
    "draw": of_level(lambda level: level.to_svg()),
    "solve": of_level(brl.solve),
    "editor": typed,
}


@combined(1, field=[name for name in LISTS if name not in PRODUCTS], look=[*LOOKS])
def test_no_list_takes_time_with_the_square_of_its_length(field: str, look: str) -> None:
    few, many = (hostile(field, count, 0) for count in (FEW, TIMES * FEW))
    calls = []
    for text in (few, many):
        with within(COMMAND):
            LOOKS[look](text)
            with counted_calls() as work:
                LOOKS[look](text)
        calls.append(work.calls)
    # What is quadratic would take 16 times as many. Some things begin from a size on.
    assert calls[1] < 1.5 * TIMES * calls[0] + 20_000


@pytest.mark.parametrize(
    "look", [brl.validate, of_level(lambda level: level.to_svg(coordinates=True))]
)
def test_exits_are_not_listed_again_for_each_cell(
    look: Callable[[str], Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    listed, given = list[LevelFields](), vars(LevelFields)["exits"].fget

    def exits_of(level: LevelFields) -> Any:
        listed.append(level)
        return given(level)

    monkeypatch.setattr(LevelFields, "exits", property(exits_of))
    times = []
    for count in (5, 20):
        listed.clear()
        starts, exits = ([[x, y] for x in range(count)] for y in range(2))
        level = {"version": 1, "size": [count, 3], "start": starts, "exit": exits}
        look(json.dumps(level))
        times.append(len(listed))
    assert times[0] == times[1] > 0


def test_the_measure_sees_what_is_quadratic() -> None:
    def look(count: int) -> int:
        with counted_calls() as work:
            for number in range(count):
                for other in range(number):
                    abs(other)
        return work.calls

    assert look(TIMES * 200) > 1.5 * TIMES * look(200) + 20_000


@selected(
    [("items", "lint"), ("switches", "show"), ("movers", "validate")],
    field=PRODUCTS,
    look=["validate", "lint", "show"],
)
def test_products_are_bounded(field: str, look: str) -> None:
    with counted_calls() as work:
        LOOKS[look](hostile(field, 10 * FEW, 0))
    assert work.calls < 5_000_000


@pytest.mark.parametrize("field", LISTS)
def test_hostile_levels_are_valid_or_too_large(field: str) -> None:
    found = {each.code for each in brl.validate(hostile(field, FEW, 1))}
    assert found <= {"BR404", "BR405"}
