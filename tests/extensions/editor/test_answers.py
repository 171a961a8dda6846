"""The optimum of the level that is edited, and what the last change did to it."""

from __future__ import annotations

from typing import Any

import pytest
from support.gestures import send

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.analysis.solver.evaluation import evaluation_of
from babyrobot_levels.extensions.editor import answers as module
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.render.page import page_data

CORRIDOR = "version: 1\nsize: [5, 1]\nstart: [0, 0]\nexit: [4, 0]\n"


def test_the_state_has_the_optimum_and_the_pages_data_with_its_marks() -> None:
    session = Session(CORRIDOR)
    state = send(session, "state")["state"]
    assert state["answers"] == {
        "status": "done",
        "best": -3.0,
        "best_text": "−3",
        "best_name": "Best average",
        "before": None,
        "changed": [],
        "reason": "",
    }
    assert session.level is not None
    page = page_data(session.level, guide=guide_of(session.level))
    for name in ("policy", "marks", "best", "picture"):
        assert state["level"][name] == page[name]


def test_a_change_is_told_with_the_cells_whose_values_it_changed() -> None:
    session = Session(CORRIDOR)
    state = send(session, "paint", brush="large", cells=[[2, 0]])["state"]
    told = state["answers"]
    assert told["before"] == -3.0
    assert told["best"] < -3.0
    # Nothing changes for a robot that has the puddle behind it.
    assert told["changed"] == [[0, 0], [1, 0], [2, 0]]
    again = send(session, "text", text=session.text + "title: Wet\n")["state"]["answers"]
    assert (again["before"], again["changed"]) == (again["best"], [])


def test_the_best_average_is_that_within_the_time_limit() -> None:
    short = Session(CORRIDOR + "max_steps: 2\n")
    answers = send(short, "state")["state"]["answers"]
    assert (answers["best"], answers["best_name"]) == (-2.0, "Best average within 2 steps")


def test_why_it_is_infinite_is_said_of_what_is_without_the_limit() -> None:
    endless = "version: 1\nsize: [2, 1]\nexit: none\nrewards: {step: -1}\nmax_steps: 90000000\n"
    session = Session(endless)
    answers = send(session, "answers")["state"]["answers"]
    assert answers["best_text"] == "\N{MINUS SIGN}90000000"
    assert answers["best_name"] == "Best average within 90,000,000 steps"
    assert answers["reason"].startswith("without the limit of steps, an episode may go on for ever")


def test_a_best_average_that_takes_too_long_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("babyrobot_levels.analysis.solver.horizon.QUICK_WORK", 0)
    answers = send(Session(CORRIDOR + "max_steps: 2\n"), "state")["state"]["answers"]
    assert (answers["status"], answers["best"], answers["best_text"]) == ("done", None, "")
    assert answers["reason"] == "what is earned within 2 steps takes too long to compute"


def test_another_size_has_no_changed_cells() -> None:
    session = Session(CORRIDOR)
    text = session.text.replace("[5, 1]", "[6, 1]").replace("exit: [4, 0]", "exit: [5, 0]")
    told = send(session, "text", text=text)["state"]["answers"]
    assert (told["best"], told["before"], told["changed"]) == (-4.0, -3.0, [])


def test_an_invalid_text_has_no_optimum_and_the_last_picture() -> None:
    session = Session(CORRIDOR)
    state = send(session, "text", text="version: 1\nsize: [5, x]\n")["state"]
    assert not state["is_valid"]
    assert (state["answers"]["status"], state["answers"]["best_text"]) == ("none", "")
    assert state["level"]["width"] == 5
    assert send(session, "undo")["state"]["answers"]["best"] == -3.0


@pytest.mark.parametrize(
    ("text", "best", "reason"),
    [
        (CORRIDOR + "walls:\n- {at: [1, 0], side: E}\n", "−∞", "may go on for ever around"),
        (CORRIDOR + "areas:\n- {at: [1, 0], color: gold, reward: 5}\n", "∞", "rewards add up"),
        ("version: 1\nmaze: {seed: random}\n", "", "another maze"),
        ("version: 1\nsize: [200, 200]\n", "", "too large for a page"),
    ],
)
def test_why_there_is_no_finite_return_is_told(text: str, best: str, reason: str) -> None:
    told = send(Session(text), "state")["state"]["answers"]
    assert told["best"] is None
    assert told["best_text"] == best
    assert reason in told["reason"]


def test_a_random_maze_has_the_picture_of_one_maze() -> None:
    state = send(Session("version: 1\nsize: [4, 4]\nmaze: {seed: random}\n"), "state")["state"]
    assert (state["level"]["width"], state["level"]["policy"]) == (4, None)


def test_cells_that_no_episode_comes_to_are_told_but_for_blocked_ones() -> None:
    text = CORRIDOR.replace("[5, 1]", "[5, 2]") + (
        "walls:\n- {at: [4, 1], side: W}\n- {at: [4, 1], side: N}\nblocked:\n- {at: [0, 1]}\n"
    )
    assert send(Session(text), "state")["state"]["unreachable"] == [[4, 1]]


def test_a_level_that_takes_longer_is_solved_when_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "BUDGET", 0.0)
    session = Session(CORRIDOR)
    state = send(session, "state")["state"]
    assert state["answers"]["status"] == "pending"
    assert state["level"]["policy"] is None
    state = send(session, "answers")["state"]
    assert (state["answers"]["status"], state["answers"]["best"]) == ("done", -3.0)
    assert state["level"]["policy"] is not None
    # Changes are told from what was known last.
    send(session, "paint", brush="large", cells=[[1, 0]])
    send(session, "paint", brush="large", cells=[[2, 0]])
    told = send(session, "answers")["state"]["answers"]
    assert (told["before"], told["changed"]) == (-3.0, [[0, 0], [1, 0], [2, 0]])


def test_a_level_that_may_be_large_is_compiled_when_nothing_else_is_to_be_done(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "MAX_STATES", 4)
    session = Session(CORRIDOR + "switches: [{name: lever, at: [1, 0]}]\n")
    assert send(session, "save")["error"] == "this level has no file; download it instead"
    state = send(session, "state")["state"]
    assert (state["level"], state["answers"]["status"]) == (None, "pending")
    assert "is drawn when you pause" in state["too_large"]
    assert state["findings_pending"]
    assert session.level is not None
    assert "_mdp" not in vars(session.level)
    state = send(session, "answers")["state"]
    assert (state["answers"]["best"], state["too_large"]) == (-3.0, None)
    assert state["level"]["width"] == 5
    assert not state["findings_pending"]


def test_guards_that_go_round_together_are_not_many_states(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_STATES", 100)
    path = "movers:\n" + "- {path: [[1, 0], [2, 0], [3, 0]], back: true}\n" * 3
    assert send(Session(CORRIDOR + path), "state")["state"]["too_large"] is None
    walks = "movers:\n" + "- {within: {at: [1, 0], size: [3, 1]}}\n" * 3
    assert "pause" in send(Session(CORRIDOR + walks), "state")["state"]["too_large"]


def test_a_level_that_is_too_large_for_a_page_is_found_so_when_it_is_compiled(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "MAX_STATES", 80)
    monkeypatch.setattr("babyrobot_levels.render.page.MAX_STATES", 80)
    mover = "movers: [{within: {at: [0, 0], size: [3, 3]}}]\n"
    session = Session(f"version: 1\nsize: [3, 3]\n{mover}")
    assert "may have very many states" in send(session, "state")["state"]["too_large"]
    state = send(session, "answers")["state"]
    assert "of 81 states is too large for a page" in state["too_large"]
    assert (state["answers"]["status"], state["findings_pending"]) == ("none", False)
    assert state["answers"]["reason"] == state["too_large"]


def test_a_gesture_does_not_wait_for_episodes_of_many_steps() -> None:
    usual, long = (Session(f"{CORRIDOR}max_steps: {limit}\n") for limit in (500, 50_000))
    assert send(usual, "state")["state"]["answers"]["status"] == "done"
    assert send(long, "state")["state"]["answers"]["status"] == "pending"


# -- policies that are drawn by hand ------------------------------------------------------------

EAST, WEST = 2, 4


def worth(text: str, actions: Any) -> dict[str, Any]:
    """Return the reply to a policy that was drawn in a level."""
    return send(Session(text), "policy", actions=actions)


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
