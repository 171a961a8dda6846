"""Replies that have only what changed in the state."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.gestures import send

from babyrobot_levels.extensions.editor.differences import changes_of
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.extensions.editor.sources import session_of

PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers(0, 2) | st.sampled_from(["", "ab", "abc", "b🤖c"]),
    lambda inner: st.lists(inner, max_size=5) | st.dictionaries(st.sampled_from("abc"), inner),
    max_leaves=12,
)


def changed(value: Any, changes: Any) -> Any:
    """Return a value with changes, as `editor/static/differences.js` does."""
    match changes:
        case [new]:
            return new
        case [first, stop, part]:
            return value[:first] + part + value[stop:]
    parts = dict(value) if isinstance(value, dict) else dict(enumerate(value))
    for name, inner in changes.items():
        key = name if isinstance(value, dict) else int(name)
        if inner == []:
            del parts[key]
        else:
            parts[key] = changed(parts[key], inner) if key in parts else inner[0]
    return parts if isinstance(value, dict) else [*parts.values()]


@given(PLAIN, PLAIN)
def test_changes_lead_from_one_value_to_another(old: Any, new: Any) -> None:
    changes = json.loads(json.dumps(changes_of(old, new)))
    # True is 1 in Python, but not in JSON.
    assert json.dumps(changed(old, changes), sort_keys=True) == json.dumps(new, sort_keys=True)


@pytest.mark.parametrize(
    ("old", "new", "changes"),
    [
        ({"a": 1, "b": [1, 2]}, {"b": [1, 3], "c": 2}, {"a": [], "c": [2], "b": {"1": [3]}}),
        ([1, 2, 3, 4], [1, 2, 5, 3, 4], [2, 2, [5]]),
        ("size: 3", "size: 23", [6, 6, "2"]),
        ("an é", "an è", ["an è"]),
        ({"a": {"b": [1]}}, {"a": {"b": [True]}}, {"a": {"b": [0, 1, [True]]}}),
    ],
)
def test_changes_are_short(old: Any, new: Any, changes: Any) -> None:
    assert changes_of(old, new) == changes


def test_the_reply_to_one_who_has_the_last_state_has_its_changes() -> None:
    session = session_of("gallery/final-maze")
    state = send(session, "state")["state"]
    for cell in ([2, 2], [3, 2]):
        reply = send(session, "paint", brush="small", cells=[cell], has=state["number"])
        assert "state" not in reply
        assert reply["from"] == state["number"]
        state = changed(state, reply["changes"])
        whole = send(session, "state")["state"]
        assert state == {**whole, "number": state["number"]}
        assert len(json.dumps(reply)) < len(json.dumps(whole)) / 3
        state = whole


def test_the_reply_to_one_who_has_another_state_has_all_of_it() -> None:
    session = Session("version: 1\nsize: [4, 3]\n")
    first = send(session, "state")["state"]["number"]
    second = send(session, "state")["state"]["number"]
    assert second != first
    for has in (first, None, "x", second + 1):
        reply = send(session, "paint", brush="small", cells=[[1, 1]], has=has)
        assert reply["state"]["text"] == session.text
        assert "changes" not in reply
    # A question that another page asks shows another state, too.
    last = reply["state"]["number"]
    assert "changes" in send(session, "answers", has=last)
    assert "state" in send(session, "undo", has=last)
