"""Where findings are shown in the picture, and those that follow when the editor is idle."""

from __future__ import annotations

from typing import Any

import pytest
from support.gestures import send

from babyrobot_levels import lint
from babyrobot_levels.extensions.editor import findings
from babyrobot_levels.extensions.editor.findings import Linting, findings_of
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.extensions.editor.state import state_of
from babyrobot_levels.linter.runner import Report
from babyrobot_levels.text.diagnostics import Diagnostic, Severity
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import Position, SourceFile

GRID = "version: 1\nsize: [4, 3]\nstart: [0, 0]\nexit: [3, 2]\n"

CASES = {
    "an entry at a cell": (GRID + "puddles:\n- {at: [3, 2]}\n", "puddle", [[3, 2]], []),
    "a wall along a run": (
        GRID + "walls:\n- {at: [3, 0], side: E, length: 2}\n",
        "has no effect",
        [],
        [[3, 0, "E"], [3, 1, "E"]],
    ),
    "an area of several cells": (
        GRID + "areas:\n- {at: [1, 0], size: [2, 1], color: red, reward: -1}\n"
        "- {at: [0, 0], size: [4, 3], color: blue, reward: -2}\n",
        "covered",
        [[1, 0], [2, 0]],
        [],
    ),
    "cells that only the message names": (
        GRID + "walls:\n- {at: [0, 2], side: N}\n- {at: [0, 2], side: E}\n",
        "cannot be reached",
        [[0, 2]],
        [],
    ),
    "one of several exits": (
        GRID.replace("[3, 2]", "[[3, 2], [0, 2]]")
        + "walls:\n- {at: [0, 2], side: N}\n- {at: [0, 2], side: E}\n",
        "exit [0, 2] cannot be reached",
        [[0, 2]],
        [],
    ),
    "a field that is no place": (
        GRID + "max_steps: 20\npuddles:\n- {at: [1, 1]}\n",
        "should come before",
        [],
        [],
    ),
}


def shown(text: str, words: str) -> dict[str, Any]:
    """Return the finding whose message contains some words, as the editor gets it."""
    (found,) = [each for each in state_of(Session(text))["findings"] if words in each["message"]]
    return dict(found)


@pytest.mark.slow
@pytest.mark.parametrize(("text", "words", "cells", "sides"), CASES.values(), ids=CASES)
def test_a_finding_is_shown_at_what_it_is_about(
    text: str, words: str, cells: list[Any], sides: list[Any]
) -> None:
    found = shown(text, words)
    assert (found["cells"], found["sides"]) == (cells, sides)


def test_an_error_is_shown_in_the_last_picture_where_it_is_on_it() -> None:
    session = Session(GRID)
    session.type(GRID + "puddles:\n- {at: [1, 1], size: huge}\n")
    (found,) = state_of(session)["findings"]
    assert (found["severity"], found["cells"]) == ("error", [[1, 1]])
    session.type(GRID.replace("exit: [3, 2]", "exit: [9, 9]"))
    (found,) = state_of(session)["findings"]
    assert (found["cells"], found["sides"]) == ([], [])


DRAWN = """\
version: 1
map: |
  +---+---+---+
  | S         |
  +   +---+   +
  |   |   | E |
  +---+---+---+
"""


def test_a_finding_in_a_drawing_is_shown_at_its_cell() -> None:
    assert shown(DRAWN, "cannot be reached")["cells"] == [[1, 1]]


@pytest.mark.parametrize(
    ("mark", "cells", "sides"),
    [
        ((1, 2), [[0, 0]], []),
        ((1, 0), [], [[0, 0, "W"]]),
        ((3, 4), [], [[0, 1, "E"]]),
        ((0, 5), [], [[1, 0, "N"]]),
        ((2, 6), [], [[1, 0, "S"]]),
        ((2, 4), [], []),
    ],
)
def test_each_character_of_a_drawing_has_its_place(
    mark: tuple[int, int], cells: list[Any], sides: list[Any]
) -> None:
    line, column = 3 + mark[0], 3 + mark[1]
    at = Position(line, column + 1)
    given = Diagnostic("BR000", Severity.ERROR, "wrong", "x", line, column, at)
    source = SourceFile("x", DRAWN)
    (found,) = findings_of(Linting(Report(source, [given], document=read(source))), (3, 2))
    assert (found["cells"], found["sides"]) == (cells, sides)


# -- findings that take long to find ------------------------------------------------------------

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
    monkeypatch.setattr(findings, "LONG", -1.0)
    session = Session(LEVEL)
    ask(session, do="set", route=["title"], value="Before")
    return session


def ask(session: Session, **message: Any) -> Any:
    """Send a message, and return the state that comes back."""
    return send(session, **message)["state"]


def told(state: dict[str, Any]) -> set[tuple[Any, ...]]:
    """Return what is told of each finding, and where."""
    return {(each["code"], each["message"], each["line"], each["column"]) for each in found(state)}


def found(state: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the findings of a state."""
    return [*state["findings"]]


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
    monkeypatch.setattr(findings, "LONG", 60.0)
    assert ask(session, do="set", route=["title"], value="One")["findings_pending"]
    assert not ask(session, do="answers")["findings_pending"]
    state = ask(session, do="set", route=["title"], value="Two")
    assert not state["findings_pending"]
    assert found(state)


def test_broken_facts_are_told_live_at_their_lines() -> None:
    session = Session("version: 1\nsize: [4, 1]\nexpect:\n  path_length: 3\n  lint: clean\n")
    assert found(ask(session, do="answers")) == []
    ask(session, do="resize", size=[5, 1], shift=[0, 0])
    told = [(each["line"], each["message"]) for each in found(ask(session, do="answers"))]
    assert told == [(4, "`path_length` is 4, not 3")]
    assert "expect:\n  path_length: 3\n" in session.text


def test_a_level_is_not_clean_for_what_is_found_late(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(findings, "LONG", 0.0)
    session = Session("version: 1\nsize: [4, 1]\nexpect: {lint: clean}\nmax_steps: 9\n")
    for steps in (8, 2):
        ask(session, do="set", route=["max_steps"], value=steps)
        late = {each["code"] for each in found(ask(session, do="answers"))}
    assert late >= {"BR511", "BR540"}


def test_gestures_keep_facts_as_they_are_written() -> None:
    fact = 'expect:\n  best_steps: 4.00  # why\n  best_return: "-5..-3"\n'
    session = Session(f"version: 1\nsize: [4, 2]\n{fact}")
    ask(session, do="walls", at=[0, 0], side="E", to="wall")
    ask(session, do="set", route=["title"], value="New")
    ask(session, do="resize", size=[5, 2], shift=[0, 0])
    assert fact in session.text
