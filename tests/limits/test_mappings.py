"""Mappings that no file could hold get a `LevelError` like all others, and soon."""

from __future__ import annotations

import enum
import uuid
from collections import UserDict, UserList, deque
from contextlib import nullcontext
from datetime import date
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.work import Work, counted_calls

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


def shared(width: int, depth: int) -> list[Any]:
    found: list[Any] = [1] * width
    for _ in range(depth - 1):
        found = [found] * width
    return found


def walls(count: int) -> list[Any]:
    return [{"at": [0, 0], "side": "N"}] * count


MAPPINGS: dict[str, tuple[Any, str]] = {
    "large": ({**WHOLE, "max_steps": 10**5000}, "about 5,000 digits is too large"),
    "long": ({**WHOLE, "max_steps": 10**200}, r"the number has too many digits \(201 characters\)"),
    "in itself": (in_itself(), "nested more than 64 deep, or contain themselves"),
    "deep": ({**WHOLE, "walls": nested(100_000)}, "nested more than 64 deep"),
    "rather deep": ({**WHOLE, "walls": nested(40)}, "`walls\\[0\\]` must be a mapping"),
    "long name": ({**WHOLE, "name": "x" * 10**7}, "`name` must have at most 100 characters"),
    "long key": ({**WHOLE, "x" * 10**7: 1}, "unknown field `xxx"),
    "large fraction": ({**WHOLE, "max_steps": Fraction(10**5000, 3)}, "`max_steps`: a `Fraction`"),
    "half a character": ({**WHOLE, "title": "\ud800"}, "`title`: no file can hold .* U\\+D800"),
    "key twice": ({**WHOLE, "legend": {1: {}, "1": {}}}, "`legend`: `1` stands there twice"),
    "shared": ({**WHOLE, "walls": shared(1000, 3)}, "more than 6,000,000 values"),
    "wide array": (
        {**WHOLE, "walls": np.broadcast_to(0, (10**6, 10**6))},
        "more than 6,000,000 values",
    ),
    "nan": ({**WHOLE, "rewards": {"step": float("nan")}}, "must be a finite number, not `nan`"),
    "long list": ({**WHOLE, "tags": [1] * 200_000}, "must be a text, not `1`"),
}


@pytest.mark.sweep
@pytest.mark.parametrize("name", MAPPINGS)
def test_no_mapping_is_too_much_for_an_answer(name: str) -> None:
    data, message = MAPPINGS[name]
    # Where values are counted the message says that it went no further than this.
    counted = nullcontext(Work()) if "more than" in message else counted_calls()
    with counted as work, pytest.raises(brl.LevelError, match=message) as found:
        brl.load(data)
    assert work.calls < 5_000_000, work
    assert len(str(found.value)) < 1000


class Hostile:
    """Answers every question with an error."""

    def __repr__(self) -> str:
        raise RuntimeError

    __str__ = __repr__

    def __getattr__(self, name: str) -> Any:
        raise ZeroDivisionError


class Talkative:
    """Says yes to every question."""

    def __repr__(self) -> str:
        return "x" * 10**6

    def __getattr__(self, name: str) -> Any:
        return lambda *args, **kwargs: self


class Text(str):
    __slots__ = ()
    __str__ = __repr__ = Hostile.__repr__


class Whole(int):
    __str__ = __repr__ = Hostile.__repr__


class Share(float):
    __str__ = __repr__ = Hostile.__repr__


class Size(enum.StrEnum):
    SMALL = "small"


ODDITIES: dict[str, Any] = {
    **{"<int>": Whole(3), "<float>": Share(3), "<str>": Text("at"), "<enum>": Size.SMALL},
    **{"<large>": 10**5000, "<fraction>": Fraction(10**5000, 3), "<third>": Fraction(1, 3)},
    **{"<decimal>": Decimal("1e999999"), "<nan>": Decimal("sNaN"), "<complex>": 1j},
    **{"<bytes>": b"at", "<set>": {1, 2}, "<frozen>": frozenset({1}), "<range>": range(3)},
    **{"<date>": date(2020, 1, 1), "<uuid>": uuid.UUID(int=0), "<path>": Path("x")},
    **{"<deque>": deque([1]), "<mapping>": UserDict(at=1), "<list>": UserList([1]), "<dots>": ...},
    **{"<hostile>": Hostile(), "<talkative>": Talkative(), "<object>": object()},
    **{"<class>": brl.Level, "<int class>": int, "<function>": brl.load},
    **{"<model>": brl.load("default").rewards, "<level>": brl.load("default")},
    **{"<int64>": np.int64(3), "<float32>": np.float32(0.1), "<bool_>": np.bool_(True)},
    **{"<str_>": np.str_("N"), "<bytes_>": np.bytes_(b"x"), "<datetime64>": np.datetime64("2020")},
    **{"<void>": np.void(b"x"), "<complex64>": np.complex64(1), "<array>": np.zeros((2, 3))},
    **{"<number>": np.array(5), "<objects>": np.array([object()], object)},
    **{"<records>": np.zeros(2, [("a", int)]), "<pair>": (1, 2), "<memory>": memoryview(b"xy")},
}


def can_be_a_key(oddity: Any) -> bool:
    try:
        hash(oddity)
    except TypeError:
        return False
    return True


def made(recipe: Any) -> Any:
    """Return data with oddities where their names stand: not all of them can be printed."""
    if isinstance(recipe, dict):
        return {made(key): made(value) for key, value in recipe.items()}
    if isinstance(recipe, list | tuple):
        return type(recipe)(map(made, recipe))
    return ODDITIES.get(recipe, recipe)


texts = st.sampled_from(["small", "N", "start", "none", "#", "", "\ud800", "x" * 2000])
keys = (
    st.sampled_from([*brl.Level.model_fields])
    | st.sampled_from(["at", "side", "to", "size", "length", "x" * 2000, "\ud800"])
    | st.none()
    | st.integers(0, 3)
    | st.sampled_from([name for name, oddity in ODDITIES.items() if can_be_a_key(oddity)])
)
values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-3, 12)
    | st.floats()
    | texts
    | st.sampled_from([*ODDITIES]),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.lists(inner, max_size=3).map(tuple)
        | st.dictionaries(keys, inner, max_size=3)
    ),
    max_leaves=8,
)


@settings(deadline=None, max_examples=200)
@given(st.dictionaries(keys, values, max_size=3).map(lambda recipe: {**WHOLE, **recipe}))
def test_whatever_is_no_level_is_told_shortly(recipe: dict[Any, Any]) -> None:
    data = made(recipe)
    fault = None
    with counted_calls() as work:
        try:
            level = brl.load(data)
        except brl.LevelError as error:
            fault = error
    if fault is None:
        assert brl.loads(level.to_yaml()).to_dict() == level.to_dict()
    assert fault is None or len(str(fault)) < 20_000
    assert fault is None or all(len(found.message) < 600 for found in fault.diagnostics)
    assert work.calls < 1_000_000, work


@pytest.mark.parametrize(
    ("given", "taken"),
    [(Whole(5), 5), (np.int64(5), 5), (np.array(5), 5), (Share(5), 5)],
    ids=["int", "numpy", "array", "float"],
)
def test_numbers_of_other_classes_are_taken_for_what_they_are(given: Any, taken: int) -> None:
    level = brl.load({**WHOLE, "max_steps": given})
    assert level.max_steps == taken
    assert type(level.max_steps) is int
    assert level.to_yaml() == f"version: 1\nsize: [3, 3]\nmax_steps: {taken}\n"


def test_texts_of_other_classes_are_taken_for_what_they_are() -> None:
    level = brl.load({**WHOLE, "title": Text("abc"), "tags": [Size.SMALL, np.str_("large")]})
    assert (level.title, *level.tags) == ("abc", "small", "large")
    assert {type(text) for text in (level.title, *level.tags)} == {str}


def test_changes_and_suites_are_looked_at_as_well() -> None:
    with pytest.raises(brl.LevelError, match="digits is too large"):
        brl.load("default").replace(max_steps=10**5000)
    with pytest.raises(brl.LevelError, match="digits is too large"):
        brl.load_suite({"version": 1, "kind": "suite", "count": 10**5000})


def test_what_is_missing_is_told_of_large_mappings_too() -> None:
    data = {**WHOLE, "theme": "nobody", "description": "x" * (1 << 21)}
    with pytest.raises(brl.LevelError, match="unknown theme `nobody`"):
        brl.load(data)
