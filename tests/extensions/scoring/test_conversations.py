"""Agents that read and write are scored by their moves, and nothing that they answer ends it."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.worlds import level

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.results import action_names
from babyrobot_levels.extensions.scoring.conversations import move_of

NAMES = action_names("all", brl.load("maze").compile())


def place_in(text: str) -> tuple[int, int]:
    """Return where the robot is."""
    x, y = re.findall(r"The robot is at \[(\d+), (\d+)\]", text)[-1]
    return int(x), int(y)


def following(policy: Any) -> Callable[[str], str]:
    """Return an agent that answers with the actions of a policy `[height, width]`."""

    def agent(text: str) -> str:
        x, y = place_in(text)
        return NAMES[int(policy[y, x])].replace("stay", "wait")

    return agent


@pytest.mark.parametrize(
    ("reply", "move"),
    [
        ("north", "north"),
        ("  Move EAST.\n\n", "east"),
        ("The exit is east, so I go\n**west**", "west"),
        ("stay", "wait"),
        ("Wait!", "wait"),
        ("north or south", None),
        ("I move north", None),
        ("north\nno, wait a moment", None),
        ("", None),
        ("\n \n", None),
        (None, None),
        (b"north", None),
        ("north " * 10**5, None),
    ],
)
def test_the_last_line_of_a_reply_is_the_move(reply: Any, move: str | None) -> None:
    assert move_of(reply) == move


@pytest.mark.slow
@pytest.mark.parametrize("sight", ["map", "view", "words"])
def test_an_optimal_agent_has_no_regret_in_any_episode(sight: str) -> None:
    lake = brl.load("frozen-lake").replace(max_steps=5000)
    best = brl.solve(lake)
    (score,) = brl.score(lake, following(best.policy), sight=sight, episodes=3)
    assert score.regret == pytest.approx(0, abs=1e-6)
    assert (score.invalid, score.episodes) == (0, 3)


@pytest.mark.slow
def test_regrets_converge_to_the_exact_regret() -> None:
    """Also of a bad agent, and with less spread than returns have."""
    east = np.full((4, 4), brl.Action.EAST)
    (exact,) = brl.score("frozen-lake", east)
    episodes = 400
    (found,) = brl.score("frozen-lake", following(east), sight="words", episodes=episodes)
    assert exact.episodes == 0
    assert found.low < exact.expected_return < found.high
    low, high = found.regret_interval
    assert low < exact.regret < high
    assert found.regret == pytest.approx(exact.regret, abs=0.05)
    assert found.steps == pytest.approx(exact.steps, rel=0.15)
    assert found.optimum == exact.optimum


def test_nonsense_costs_a_step_after_three_replies() -> None:
    texts: list[str] = []

    def agent(text: str) -> str:
        texts.append(text)
        return "What is this?"

    (score,) = brl.score("first-key", agent, sight="map", within=4, episodes=2)
    assert (score.invalid, score.steps, score.success, score.regret) == (12, 4, 0, 0)
    assert len(texts) == 24
    assert "That is no move, and nothing happened." in texts[1]
    assert "The robot waits. Step 1 of 4" in texts[3]


def test_a_chat_model_gets_all_messages() -> None:
    heard: list[list[dict[str, str]]] = []

    def model(messages: list[dict[str, str]]) -> str:
        heard.append(messages)
        messages[0]["content"] = "changed by the model"
        return ["east", "hm", "east"][len(heard) - 1]

    corridor = level(size=[3, 1], exit=[2, 0], max_steps=9)
    (score,) = brl.score(corridor, model, sight="words", chat=True, episodes=1)
    assert (score.success, score.invalid, score.regret) == (1, 1, 0)
    assert [[each["role"] for each in messages] for messages in heard] == [
        ["user"],
        ["user", "assistant", "user"],
        ["user", "assistant", "user", "assistant", "user"],
    ]
    assert heard[2][1:4:2] == [
        {"role": "assistant", "content": "east"},
        {"role": "assistant", "content": "hm"},
    ]
    texts = [message["content"] for message in heard[2]]
    assert texts[2].startswith("The robot moves east.")
    assert "Rules:" not in "".join(texts[1:])


@pytest.mark.slow
def test_episodes_are_plays(tmp_path: Path) -> None:
    file = tmp_path / "east.brlplay"
    lake = brl.load("frozen-lake")
    agent = following(np.full((4, 4), brl.Action.SOUTH))
    scores = brl.score(lake, agent, sight="map", episodes=5, seed=3, record=file)
    again = brl.score(lake, agent, sight="map", episodes=5, seed=3)
    assert scores[0] == again[0]
    replays = brl.replay(file)
    assert len(replays) == 5
    assert all(each.is_valid for each in replays)
    assert sum(each.play.steps for each in replays) == 5 * scores[0].steps
    (grade,) = brl.grade([file], lake)
    assert grade.success == scores[0].success
    assert replays[0].to_gif().startswith(b"GIF")


def test_the_discount_and_the_limit_are_those_that_are_asked_for() -> None:
    corridor = level(size=[4, 1], exit=[3, 0], rewards={"step": 0, "exit": 1}, max_steps=50)
    options: dict[str, Any] = {"sight": "map", "episodes": 1}
    (score,) = brl.score(corridor, lambda _: "east", discount=0.5, within=7, **options)
    assert (score.optimum, score.regret, score.within, score.discount) == (0.25, 0, 7, 0.5)
    (score,) = brl.score(corridor, lambda _: "west", discount=0.5, within=7, **options)
    assert score.regret == pytest.approx(score.optimum)
    assert score.low <= 0 <= score.high == pytest.approx(0.25, abs=0.02)


def test_what_cannot_be_scored_is_refused() -> None:
    with pytest.raises(ValueError, match="sight must be one of"):
        brl.score("first-key", str, sight="ears")
    with pytest.raises(TypeError, match="a function from texts to replies, not 'random'"):
        brl.score("first-key", "random", sight="map")
    with pytest.raises(ValueError, match="actions='all'"):
        brl.score("first-key", str, sight="map", actions="turns")
    with pytest.raises(ValueError, match="has no max_steps"):
        brl.score(level(size=[2, 2]), str, sight="map")
    with pytest.raises(ValueError, match="episodes must be a whole number, at least 1"):
        brl.score("first-key", str, sight="map", episodes=0)
    with pytest.raises(ValueError, match="give a sight, too"):
        brl.score("first-key", "random", chat=True)


def test_the_interval_holds_whatever_has_not_happened_yet() -> None:
    """Even one episode without regret leaves room for the worst."""
    (score,) = brl.score("frozen-lake", lambda _: "east", sight="words", within=1, episodes=1)
    assert score.regret == 0
    assert math.isclose(score.high, score.optimum)
    assert score.low <= score.optimum
