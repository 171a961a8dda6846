"""Findings that take long to find: they follow when the editor is idle."""

from __future__ import annotations

from typing import Any

import pytest

from babyrobot_levels import lint
from babyrobot_levels.editor import findings as linting
from babyrobot_levels.editor.protocol import answer
from babyrobot_levels.editor.session import Session

LEVEL = """\
version: 1
size: [4, 2]
start: [0, 0]
exit: [3, 1]
walls:
- {at: [0, 0], side: N}
- {at: [3, 0], side: W}
- {at: [3, 0], side: S}
"""


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch) -> Session:
    """A session in which all rules take too long from the second gesture on."""
    monkeypatch.setattr(linting, "LONG", -1.0)
    session = Session(LEVEL)
    ask(session, do="set", route=["title"], value="Before")
    return session


def ask(session: Session, **message: Any) -> dict[str, Any]:
    """Send a message, and return the state that comes back."""
    state = answer(session, {"id": 1, "revision": session.revision, **message})["state"]
    assert isinstance(state, dict)
    return state


def told(state: dict[str, Any]) -> set[tuple[Any, ...]]:
    """Return what is told of each finding, and where."""
    return {(each["code"], each["message"], each["line"], each["column"]) for each in found(state)}


def found(state: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the findings of a state."""
    findings: list[dict[str, Any]] = state["findings"]
    return findings


def test_findings_that_take_long_stay_at_their_places_until_they_are_looked_for_again(
    session: Session,
) -> None:
    before = ask(session, do="state")
    assert not before["findings_pending"]
    assert any(each["fix"] for each in found(before))
    state = ask(session, do="set", route=["description"], value="More")
    assert state["findings_pending"]
    assert [each["message"] for each in found(state)] == [each["message"] for each in found(before)]
    assert [each["sides"] for each in found(state)] == [each["sides"] for each in found(before)]
    assert {each["line"] for each in found(state)} != {each["line"] for each in found(before)}
    # Their fixes would be edits of another text.
    assert all(each["is_outdated"] and each["fix"] is None for each in found(state))
    late = ask(session, do="answers")
    assert not late["findings_pending"]
    assert not any(each["is_outdated"] for each in found(late))
    assert any(each["fix"] for each in found(late))


def test_findings_in_what_was_changed_are_dropped(session: Session) -> None:
    gone = ask(session, do="walls", at=[3, 0], side="W", to="glass")
    assert all([3, 0, "W"] not in each["sides"] for each in found(gone))
    assert any([0, 0, "N"] in each["sides"] for each in found(gone))


def test_what_follows_is_all_that_the_linter_finds(session: Session) -> None:
    session.type("# babyrobot: ignore[BR501] no reason\n" + session.text)
    state = ask(session, do="answers")
    everything = lint(session.text)
    assert told(state) == {(each.code, each.message, each.line, each.column) for each in everything}
    assert "BR699" in {each.code for each in everything}


def test_rules_that_became_quick_are_applied_at_once_again(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(linting, "LONG", 60.0)
    assert ask(session, do="set", route=["title"], value="One")["findings_pending"]
    assert not ask(session, do="answers")["findings_pending"]
    state = ask(session, do="set", route=["title"], value="Two")
    assert not state["findings_pending"]
    assert found(state)
