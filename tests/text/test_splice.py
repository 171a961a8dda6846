"""Splicing: what changes is written, and everything else stays as it is."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from babyrobot_levels.text.document import Document, comments
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.splice import splice

ORDER = ("version", "title", "size", "walls", "puddles", "rewards", "display")

TEXT = """\
# A level with remarks.
version: 1
title: Old  # its name

walls:
  # the first room
  - {at: [0, 0], side: E}   # thick
  # the second room
  - at: [1, 1]
    # towards the sea
    side: S
    pass: 0.5  # glass
  - {at: [2, 2], side: N, length: 3}

# What it costs.
rewards:
  step: -1   # each
  # at last
  exit: 10
display: {compass: true}
# The end.
"""


def document_of(text: str) -> Document:
    return read(SourceFile("", text))


def spliced(**changes: Any) -> str:
    data = {**document_of(TEXT).data, **changes}
    found = splice(TEXT, {name: value for name, value in data.items() if value is not None}, ORDER)
    assert found is not None
    return found


def walls(*entries: Any) -> list[Any]:
    return list(entries)


FIRST = {"at": [0, 0], "side": "E"}
SECOND = {"at": [1, 1], "side": "S", "pass": 0.5}
THIRD = {"at": [2, 2], "side": "N", "length": 3}


@pytest.mark.parametrize(
    ("changes", "before", "after"),
    [
        ({"title": "New"}, "title: Old  # its name\n", "title: New  # its name\n"),
        ({"title": None}, "title: Old  # its name\n", "# its name\n"),
        (
            {"walls": [FIRST, SECOND, THIRD, {"at": [3, 3], "side": "W"}]},
            "length: 3}\n",
            "length: 3}\n  - {at: [3, 3], side: W}\n",
        ),
        ({"walls": [FIRST, SECOND]}, "  - {at: [2, 2], side: N, length: 3}\n", ""),
        ({"walls": [SECOND, THIRD]}, "  - {at: [0, 0], side: E}   # thick\n", "  # thick\n"),
        (
            {"walls": [FIRST, {**SECOND, "pass": 0.25}, THIRD]},
            "    pass: 0.5  # glass\n",
            "    pass: 0.25  # glass\n",
        ),
        (
            {"walls": [FIRST, {"at": [1, 1], "side": "S"}, THIRD]},
            "    pass: 0.5  # glass\n",
            "    # glass\n",
        ),
        (
            {"walls": [{"at": [0, 0], "side": "W"}, SECOND, THIRD]},
            "{at: [0, 0], side: E}   # thick",
            "{at: [0, 0], side: W}   # thick",
        ),
        ({"rewards": {"step": -2, "exit": 10}}, "  step: -1   # each\n", "  step: -2   # each\n"),
        (
            {"rewards": {"step": -1, "exit": 10, "wall": -5}},
            "  exit: 10\n",
            "  exit: 10\n  wall: -5\n",
        ),
        ({"size": [3, 3], "puddles": [[0, 1]]}, "# its name\n", "# its name\nsize: [3, 3]\n"),
        ({"display": {"compass": False}}, "{compass: true}", "{compass: false}"),
    ],
)
def test_only_what_changes_is_written(changes: dict[str, Any], before: str, after: str) -> None:
    expected = TEXT.replace(before, after)
    if "puddles" in changes:
        expected = expected.replace("length: 3}\n", "length: 3}\npuddles: [[0, 1]]\n")
    assert spliced(**changes) == expected


def test_comments_of_a_value_that_is_written_anew_stay_above_it() -> None:
    text = "version: 1\nsize: [3,\n  # high\n  4]\n"
    assert splice(text, {"version": 1, "size": [3, 5]}, ORDER) == (
        "version: 1\n# high\nsize: [3, 5]\n"
    )
    emptied = splice(TEXT, {**document_of(TEXT).data, "walls": []}, ORDER)
    assert emptied is not None
    assert "# the first room\n# thick\n# the second room\n# towards the sea\n" in emptied
    assert "\nwalls: []\n" in emptied


def test_entry_that_changes_below_a_removed_one_keeps_its_layout() -> None:
    text = spliced(walls=walls({**SECOND, "pass": 0.25}, THIRD))
    removed = TEXT.replace("- {at: [0, 0], side: E}   # thick\n", "# thick\n")
    assert text == removed.replace("pass: 0.5  # glass", "pass: 0.25  # glass")


def test_new_fields_come_in_their_order() -> None:
    found = splice("version: 1\n", {"version": 1, "size": [2, 2], "title": "T"}, ORDER)
    assert found == "version: 1\ntitle: T\nsize: [2, 2]\n"


def test_aliases_are_not_taken_apart() -> None:
    text = "version: 1\nwalls:\n  - &a {at: [0, 0], side: E}\n  - *a\n"
    wall = {"at": [0, 0], "side": "E"}
    found = splice(text, {"version": 1, "walls": [wall, {**wall, "side": "S"}]}, ORDER)
    assert found is not None
    assert document_of(found).data["walls"] == [wall, {**wall, "side": "S"}]


def test_line_ends_stay() -> None:
    found = splice(TEXT.replace("\n", "\r\n"), {**document_of(TEXT).data, "walls": [SECOND]}, ORDER)
    assert found is not None
    assert found.count("\r\n") == found.count("\n")


# -- laws ----------------------------------------------------------------------------------------

SCALARS = st.one_of(st.integers(-9, 9), st.booleans(), st.text("abc #:-", max_size=4))
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(st.sampled_from("pqrs"), inner, max_size=3)
    ),
    max_leaves=8,
)


@st.composite
def commented(draw: st.DrawFn, value: Any, indent: int) -> list[str]:
    """Return the lines of a value, block or flow, with comments between them."""
    from babyrobot_levels.text.emitter import flow

    lines: list[str] = []
    for key in value if isinstance(value, dict) else range(len(value)):
        if draw(st.booleans()):
            lines.append(" " * indent + f"# c{draw(st.integers(0, 99))}")
        lead = " " * indent + (f"{key}:" if isinstance(value, dict) else "-")
        inner = value[key]
        is_block = isinstance(value, dict) and isinstance(inner, dict | list) and len(inner) > 0
        if is_block and draw(st.booleans()):
            lines += [lead, *draw(commented(inner, indent + 2))]
            continue
        behind = draw(st.sampled_from(["", "  # behind"]))
        lines.append(f"{lead} {flow(inner)}{behind}")
    return lines


@given(st.data())
def test_data_is_what_was_asked_for_and_comments_stay(data: st.DataObject) -> None:
    fields = st.dictionaries(st.sampled_from(ORDER), VALUES, min_size=1)
    before = data.draw(fields)
    text = "\n".join([*data.draw(commented(before, 0)), ""])
    after = dict(before)
    for name in data.draw(st.sets(st.sampled_from(sorted(before)))):
        after[name] = data.draw(VALUES)
    after |= data.draw(fields)
    found = splice(text, after, ORDER)
    assert found is not None
    assert document_of(found).data == after
    written, left = (
        Counter(comment.text for comment in comments(document_of(each))) for each in (text, found)
    )
    assert left >= written
