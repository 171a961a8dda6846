"""The rules about things: their words, what they leave to each other, and their limits."""

from __future__ import annotations

from unittest.mock import patch

import pytest

from babyrobot_levels.linter import optimal_policy, things
from babyrobot_levels.linter.rules import all_rules, select
from babyrobot_levels.linter.runner import apply, fix, lint_source
from babyrobot_levels.linter.things import ThingEffects
from babyrobot_levels.mdp.compiler import layers
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.source import SourceFile


def found(text: str, *rules: str) -> list[Diagnostic]:
    return lint_source(SourceFile("x.yaml", f"version: 1\n{text}"), select(rules)).diagnostics


def codes(text: str, *rules: str) -> list[str]:
    return [each.code for each in found(text, *rules)]


KEY_BEHIND_ITS_DOOR = """
size: [4, 2]
doors:
  - {at: [1, 0], side: E, length: 2, needs: key}
items:
  - {name: key, at: [3, 0]}
"""
WAY_AROUND = """
size: [4, 2]
exit: [3, 0]
doors:
  - {at: [2, 1], side: E, needs: key}
items:
  - {name: key, at: [0, 1]}
"""
BAT_AT_THE_START = """
size: [4, 4]
movers:
  - {name: bat, within: {at: [0, 0], size: [4, 3]}}
"""


# -- one fault, one finding ---------------------------------------------------------------------


def test_cells_behind_a_door_that_never_opens_are_the_fault_of_the_door() -> None:
    assert codes(KEY_BEHIND_ITS_DOOR, "BR5") == ["BR501", "BR530", "BR528"]
    assert codes(KEY_BEHIND_ITS_DOOR, "BR502") == ["BR502"]


def test_starts_without_an_exit_are_the_fault_of_needs_that_are_never_met() -> None:
    text = KEY_BEHIND_ITS_DOOR + "exit_needs: key\nexit: [0, 1]\n"
    assert codes(text, "BR501", "BR534") == ["BR534"]
    assert codes(text, "BR501") == ["BR501"]


# -- words --------------------------------------------------------------------------------------


def effects(text: str) -> ThingEffects:
    level = lint_source(SourceFile("x.yaml", f"version: 1\n{text}"), []).level
    assert level is not None
    return ThingEffects(level, level.compile())


def test_words_name_no_more_than_it_takes() -> None:
    text = (
        "size: [4, 2]\nexit_one_of: [[3, 0], [3, 1]]\nexit_needs: [gem, key]\n"
        "items: [{name: key, at: [1, 1]}, {name: gem, one_of: [[1, 0], [2, 0]]}]\n"
        "switches: [{name: lever, at: [0, 1]}]\n"
        "movers: [{path: [[2, 0], [2, 1]], back: true}]\nhit: {ends: false}\n"
    )
    about = effects(text)
    rows = about.mdp.configurations.tolist()
    states = [number * about.mdp.cells for number in range(len(rows))]

    def told(*values: int, alike: int | None = None) -> str:
        """Return the words for all states that agree in one column, or for a state alone."""
        state = states[rows.index([*values])]
        same = [
            each
            for each, row in zip(states, rows, strict=True)
            if each == state or (alike is not None and row[alike] == values[alike])
        ]
        return about.told(state, same, states)

    # Drawn exit, key, gem, lever, mover.
    assert told(0, 0, 1, 1, 0, alike=0) == "the exit on [3, 0]"
    assert told(0, 0, 1, 1, 0, alike=1) == "`key` not held"
    assert told(0, 1, 1, 1, 0, alike=1) == "`key` held"
    assert told(0, 0, 1, 1, 0, alike=2) == "`gem` on [2, 0]"
    assert told(0, 0, 2, 1, 0, alike=2) == "`gem` held"
    assert told(0, 0, 1, 0, 0, alike=3) == "`lever` off"
    assert told(0, 0, 1, 1, 1, alike=4) == "`mover-1` on [2, 1]"
    assert told(1, 0, 0, 1, 1) == (
        "the exit on [3, 1], `key` not held, `gem` on [1, 0], `lever` on and `mover-1` on [2, 1]"
    )
    assert about.told(states[0], states, states) == ""


# -- fixes --------------------------------------------------------------------------------------


def test_a_door_is_removed_from_the_drawing_as_well() -> None:
    text = (
        "version: 1\nmap: |\n  +---+---+---+\n  | k         |\n  +   +-/-+-/-+\n"
        "  | S /     E |\n  +---+---+---+\nlegend:\n  k: {item: key}\ndoors:\n"
        "  - {at: [1, 1], side: W}\n  - {at: [1, 1], side: N, length: 2, needs: key}\n"
    )
    source = SourceFile("x.yaml", text)
    (first,) = lint_source(source, select(["BR531"])).diagnostics
    assert first.fix is not None
    after = apply(first.fix.edits, source)
    assert "  | S       E |\n" in after
    assert "at: [1, 1], side: W" not in after
    assert lint_source(SourceFile("x.yaml", after), []).is_valid
    (second,) = lint_source(SourceFile("x.yaml", after), select(["BR532"])).diagnostics
    assert second.fix is not None
    assert "  +   +   +   +\n" in apply(second.fix.edits, SourceFile("x.yaml", after))


def test_no_two_needs_that_do_for_each_other_are_removed() -> None:
    """Either of them can go, but not both."""
    text = (
        "version: 1\nsize: [4, 2]\nexit_needs: key\ndoors:\n"
        "  - {at: [2, 0], side: E, length: 2, needs: key}\nitems: [{name: key, at: [0, 1]}]\n"
    )
    fixed = fix(SourceFile("x.yaml", text), all_rules(), unsafe=True)
    assert fixed.count == 1
    assert "needs: key" in fixed.text
    assert "exit_needs" not in fixed.text


# -- limits -------------------------------------------------------------------------------------


def test_levels_that_are_too_large_are_not_solved_for_their_doors() -> None:
    assert codes(WAY_AROUND, "BR532") == ["BR532"]
    with patch.object(optimal_policy, "MAX_SOLVED", 15):
        assert codes(WAY_AROUND, "BR532") == []


def test_only_so_many_variants_are_solved() -> None:
    text = WAY_AROUND.replace("items", "  - {at: [1, 1], side: E, needs: key}\nitems")
    assert codes(text, "BR532") == ["BR532", "BR532"]
    # Each door needs two of them, of 16 states.
    with patch.object(optimal_policy, "MAX_STATES", 31):
        # The variant that reaches the limit is the last one.
        assert codes(text, "BR532") == ["BR532"]


@pytest.mark.parametrize("limit", ["MAX_OUTCOMES", "MAX_ROUNDS"])
def test_what_takes_too_long_is_not_said(limit: str) -> None:
    assert codes(BAT_AT_THE_START, "BR535") == ["BR535"]
    with patch.object(things, limit, 0):
        assert codes(BAT_AT_THE_START, "BR535") == []


def test_variants_may_have_too_many_states() -> None:
    """Without the door, more configurations can be reached."""
    text = KEY_BEHIND_ITS_DOOR + "  - {name: coin, at: [2, 0], reward: 5}\n"
    assert codes(text, "BR502", "BR530") == ["BR530"]
    found_here = found(text, "BR528")
    assert found_here[0].help == "move it, or the door: it lies behind a door that it opens"
    with patch.object(layers, "MAX_STATES", 16):
        assert [*map(str, found(text, "BR528"))] == [*map(str, found_here)]
        assert codes(text, "BR502", "BR530") == ["BR530"]
