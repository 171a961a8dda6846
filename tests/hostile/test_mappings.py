"""Mappings that no file could hold get a `LevelError` like all others, and soon."""

from __future__ import annotations

import time
from typing import Any

import pytest

import babyrobot_levels as brl

WHOLE = {"version": 1, "size": [3, 3]}


def nested(depth: int) -> list[Any]:
    found: list[Any] = []
    for _ in range(depth):
        found = [found]
    return found


def in_itself() -> dict[str, Any]:
    found: dict[str, Any] = {**WHOLE}
    found["theme"] = found
    return found


def list_in_itself() -> dict[str, Any]:
    found: list[Any] = []
    found.append(found)
    return {**WHOLE, "walls": found}


MAPPINGS: dict[str, tuple[Any, str]] = {
    "large": ({**WHOLE, "max_steps": 10**5000}, "some 5,000 digits is too large"),
    "large cell": ({**WHOLE, "start": [-(10**5000), 0]}, "digits is too large"),
    "large key": ({**WHOLE, 10**5000: 1}, "digits is too large"),
    "long": ({**WHOLE, "max_steps": 10**200}, "a number of 201 characters is too long"),
    "in itself": (in_itself(), "nested more than 64 deep, or contain themselves"),
    "list in itself": (list_in_itself(), "nested more than 64 deep, or contain themselves"),
    "deep": ({**WHOLE, "walls": nested(100_000)}, "nested more than 64 deep"),
    "rather deep": ({**WHOLE, "walls": nested(40)}, "`walls\\[0\\]` must be a mapping"),
    "long name": ({**WHOLE, "name": "x" * 10**7}, "`name` must be at most 100 characters"),
    "long key": ({**WHOLE, "x" * 10**7: 1}, "there is no field `xxx"),
    "long list": ({**WHOLE, "tags": [1] * 200_000}, "must be a text, not `1`"),
}


@pytest.mark.parametrize("name", MAPPINGS)
def test_no_mapping_is_too_much_for_an_answer(name: str) -> None:
    data, message = MAPPINGS[name]
    begin = time.process_time()
    with pytest.raises(brl.LevelError, match=message) as found:
        brl.load(data)
    assert time.process_time() - begin < 5
    assert len(str(found.value)) < 1000


def test_changes_and_suites_are_looked_at_as_well() -> None:
    with pytest.raises(brl.LevelError, match="digits is too large"):
        brl.load("default").replace(max_steps=10**5000)
    with pytest.raises(brl.LevelError, match="digits is too large"):
        brl.load_suite({"version": 1, "kind": "suite", "count": 10**5000})


def test_what_is_missing_is_told_of_large_mappings_too() -> None:
    data = {**WHOLE, "theme": "nobody", "description": "x" * (1 << 21)}
    with pytest.raises(brl.LevelError, match="there is no theme `nobody`"):
        brl.load(data)
