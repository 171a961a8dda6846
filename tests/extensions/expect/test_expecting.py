"""The facts of today, written into texts: what is new, mended, kept, and gone."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from support.things import thing_worlds
from support.worlds import World, decorated_worlds, level_of

import babyrobot_levels as brl

LEVEL = "version: 1\nsize: [4, 2]\nskid: 0.2\n"


def facts(text: str) -> dict[str, str]:
    """Return the facts of a text, one a line."""
    _, _, below = text.partition("expect:\n")
    lines = (line.partition("#")[0].strip() for line in below.splitlines())
    return {name: value for name, _, value in (line.partition(": ") for line in lines)}


def test_a_level_that_states_nothing_gets_the_usual_facts() -> None:
    assert facts(brl.expect(LEVEL)) == {
        "success": "1",
        "best_return": "-4.18",
        "best_steps": "5.18",
        "path_length": "4",
        "difficulty": "3.09",
    }


def test_of_a_level_with_things_what_is_needed_is_stated_too() -> None:
    things = "items: [{name: key, at: [0, 1]}, {name: coin, at: [1, 1]}]\nexit_needs: key\n"
    assert facts(brl.expect(LEVEL + things))["needs"] == "[key]"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        # What is true stays as it is written.
        ("best_steps: 5", "best_steps: 5"),
        ("best_steps: 5.1797", "best_steps: 5.1797"),
        ("path_length: 3..", "path_length: 3.."),
        # What is not has as many decimals as before.
        ("best_steps: 4", "best_steps: 5"),
        ("best_steps: 5.00", "best_steps: 5.18"),
        ("best_return: -4.20", "best_return: -4.18"),
        # Ranges are widened.
        ("best_steps: 1..5", "best_steps: 1..6"),
        ("best_steps: 1..5.0", "best_steps: 1..5.2"),
        ("best_return: -4.0..-3", "best_return: -4.2..-3"),
        ("path_length: ..3", "path_length: ..4"),
        ("path_length: 5..", "path_length: 4.."),
        ("best_steps: {min: 5.5, max: 7}", "best_steps: {min: 5.1, max: 7}"),
        # Shares are 0 or 1 only if that is exact.
        ("reachable: 0", "reachable: 1"),
    ],
)
def test_facts_are_mended_in_their_form(before: str, after: str) -> None:
    text = f"{LEVEL}expect:\n  {before}  # why\n"
    assert brl.expect(text) == text.replace(before, after)


def test_a_probability_below_one_is_never_rounded_up() -> None:
    text = f"{LEVEL.replace('0.2', '0.001')}exit: [3, 0]\n"
    text += "areas: [{at: [0, 1], ends: true, reward: -9}]\nexpect:\n  success: 1\n"
    assert facts(brl.expect(text))["success"] == "0.999"


@pytest.mark.parametrize(
    ("fields", "fact"),
    [
        ("exit: none\n", "path_length: 2"),
        ("rewards: {step: 1}\n", "best_return: 2"),
        ("rewards: {step: 1}\n", "best_steps: 2.."),
        ("walls: [{at: [0, 0], side: E}, {at: [0, 0], side: S}]\n", "turns: 2"),
    ],
)
def test_facts_without_a_value_go(fields: str, fact: str) -> None:
    text = f"{LEVEL}{fields}expect:\n  {fact}\n  cells: 8\n"
    assert brl.expect(text) == text.replace(f"  {fact}\n", "")


def test_the_last_fact_may_go() -> None:
    text = f"{LEVEL}exit: none\nexpect:\n  success: 1\n"
    assert brl.expect(text) == text.replace("\n  success: 1", " {}")
    assert "expect: {}\n" in brl.format(brl.expect(text))


def test_further_facts_can_be_asked_for() -> None:
    text = f"{LEVEL}expect:\n  cells: 8\n"
    added = brl.expect(text, add=["junctions", "lint", "cells"])
    assert added == f"{text}  junctions: 4\n  lint: clean\n"
    # Metrics of things are those of levels with things.
    assert brl.expect(text, add=["items", "needs"]) == text


def test_files_are_written_on_request_only(tmp_path: Path) -> None:
    path = tmp_path / "level.yaml"
    path.write_text(LEVEL, "utf-8")
    text = brl.expect(path)
    assert path.read_text("utf-8") == LEVEL
    assert brl.expect(path, write=True) == text == path.read_text("utf-8")
    with pytest.raises(ValueError, match="no file"):
        brl.expect(LEVEL, write=True)


def test_suites_state_nothing() -> None:
    suite = "version: 1\nkind: suite\ncount: 3\n"
    assert brl.expect(suite) == suite


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{LEVEL}maze: {{seed: random}}\n", "not drawn yet"),
        ("{version: 1}\n", "in an unusual way"),
        (f"{LEVEL}expect: {{return: 1}}\n", "best_return"),
    ],
)
def test_texts_without_facts_are_refused(text: str, message: str) -> None:
    with pytest.raises(brl.LevelError, match=message):
        brl.expect(text)


def test_unknown_metrics_are_refused() -> None:
    with pytest.raises(ValueError, match="unknown metric `return`; did you mean `best_return`"):
        brl.expect(LEVEL, add=["return"])


@pytest.mark.sweep
@settings(max_examples=40)
@given(decorated_worlds() | thing_worlds())
def test_what_is_stated_is_true(world: World) -> None:
    level = level_of(world)
    stated = brl.loads(brl.expect(level, add=["reachable", "fragility", "random_return"]))
    assert brl.broken_expectations(stated) == []
    assert stated.digest == level.digest
    text = stated.to_yaml(comments=True)
    assert brl.expect(text) == text
