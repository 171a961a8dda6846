"""Rewards that are too large to add up."""

from __future__ import annotations

from babyrobot_levels.extensions.editor.protocol import answer
from babyrobot_levels.extensions.editor.session import Session

LEVEL = "version: 1\nsize: [9, 9]\nskid: 0.5\nrewards: {step: -1e308, exit: 1e308}\n"


def test_the_editor_says_so_and_copies_a_link() -> None:
    session = Session(LEVEL)
    told = answer(session, {"id": 1, "do": "answers", "revision": session.revision})
    assert told["state"]["answers"]["reason"] == (
        "rewards of up to 1e+308 are too large to add up; use at most 1e+140"
    )
    assert answer(session, {"id": 2, "do": "copy", "form": "link"})["copy"].startswith("#")
