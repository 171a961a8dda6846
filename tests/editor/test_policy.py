"""Policies drawn by hand: what they are worth."""

from __future__ import annotations

from typing import Any

import pytest

from babyrobot_levels.analysis.solver.evaluation import evaluation_of
from babyrobot_levels.editor.protocol import answer
from babyrobot_levels.editor.session import Session

CORRIDOR = "version: 1\nsize: [5, 1]\nstart: [0, 0]\nexit: [4, 0]\n"
EAST, WEST = 2, 4


def worth(text: str, actions: list[Any]) -> dict[str, Any]:
    """Return the reply to a policy that was drawn in a level."""
    session = Session(text)
    return answer(
        session, {"id": 1, "do": "policy", "actions": actions, "revision": session.revision}
    )


def test_the_best_policy_is_worth_the_best_average() -> None:
    assert worth(CORRIDOR, [EAST] * 5) == {
        "id": 1,
        "policy": {"worth": "−3", "best": "−3", "share": 1.0, "exits": 1.0, "reason": ""},
    }


@pytest.mark.parametrize("limit", ["", "max_steps: 30\n", "discount: 0.9\n"])
def test_cells_without_an_action_act_at_random(limit: str) -> None:
    session = Session(CORRIDOR + limit)
    told = worth(CORRIDOR + limit, [-1] * 5)["policy"]
    within = "max_steps" if "max_steps" in limit else None
    assert session.level is not None
    random = evaluation_of(session.level, "random", within=within)
    earned = float(told["worth"].partition(" ")[0].replace("−", "-"))
    assert earned == pytest.approx(random.expected_return, abs=0.01)
    assert told["share"] == pytest.approx(0.0)
    assert told["exits"] == pytest.approx(random.exit_probability)


def test_actions_may_depend_on_what_is_held() -> None:
    key = "version: 1\nsize: [3, 1]\nstart: [1, 0]\nexit_needs: key\nitems:\n"
    key += "- {name: key, at: [0, 0]}\n"
    told = worth(key, [WEST] * 3 + [EAST] * 3)["policy"]
    assert (told["worth"], told["share"]) == (told["best"], 1.0)
    assert "for ever" in worth(key, [WEST] * 6)["policy"]["reason"]


def test_what_never_ends_is_told_with_its_cell() -> None:
    told = worth(CORRIDOR, [EAST, EAST, WEST, EAST, EAST])["policy"]
    assert told["worth"] == "−∞"
    assert "for ever around [1, 0], [2, 0]" in told["reason"]
    assert told["share"] is None


def test_what_cancels_out_has_no_return_and_a_reason() -> None:
    areas = "areas:\n- {at: [1, 0], color: gold, reward: 1}\n"
    told = worth(CORRIDOR + areas, [EAST, WEST, EAST, EAST, EAST])["policy"]
    assert told["worth"] == ""
    assert "undefined" in told["reason"]


@pytest.mark.parametrize("actions", [[EAST] * 4, [EAST] * 4 + [9], [EAST] * 4 + ["east"], None])
def test_a_policy_that_does_not_fit_the_level_is_refused(actions: Any) -> None:
    reply = worth(CORRIDOR, actions)
    assert "does not fit" in reply["error"]
    assert "policy" not in reply
