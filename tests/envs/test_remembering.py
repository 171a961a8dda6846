"""Rollouts of agents with memory: what they earn, and what is recorded."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gymnasium.error import InvalidAction

import babyrobot_levels as brl

SIGHT: Any = {"view_radius": 1}


class Counting:
    """Goes east and west by turns, and counts the steps of each episode."""

    def __init__(self) -> None:
        self.lengths: list[int] = []

    def reset(self) -> None:
        self.lengths.append(0)

    def act(self, observation: Any, mask: Any) -> int:
        assert observation.shape == (2,)
        self.lengths[-1] += 1
        return 2 if self.lengths[-1] % 2 else 4


def test_an_episode_begins_where_the_last_one_ended() -> None:
    agent = Counting()
    data = brl.rollout("frozen-lake", agent, 3, 30, seed=1, max_episode_steps=7)
    ends = data.terminations | data.truncations
    goes_on = ~ends[:-1]
    assert (data.observations[1:] == data.next_observations[:-1])[goes_on].all()
    starts = np.flatnonzero(brl.load("frozen-lake").compile().start)
    assert np.isin(data.observations[1:][ends[:-1]], starts).all()
    assert max(agent.lengths) == 7
    assert len(agent.lengths) == 3 + ends.sum()
    assert sum(agent.lengths) == data.actions.size


def test_steps_are_those_of_the_tables_and_a_seed_repeats_them() -> None:
    level = brl.load("frozen-lake")
    first, again, other = (
        brl.rollout(level, Counting(), 4, 50, seed=seed, actions="all") for seed in (3, 3, 4)
    )
    assert (first.next_observations == again.next_observations).all()
    assert (first.next_observations != other.next_observations).any()
    for state, action, after, reward in zip(
        first.observations.flat,
        first.actions.flat,
        first.next_observations.flat,
        first.rewards.flat,
        strict=True,
    ):
        outcomes = level.compile().outcomes(int(state), int(action))
        assert any(chance and to == after and paid == reward for chance, to, paid, _ in outcomes)
    masks = brl.rollout(level, "random", 1, 200, seed=1)
    allowed = dict(zip(masks.observations.flat, masks.action_masks.reshape(-1, 5), strict=True))
    for state, mask in zip(first.observations.flat, first.action_masks.reshape(-1, 5), strict=True):
        assert state not in allowed or (mask == allowed[state]).all()


@pytest.mark.parametrize("answer", [99, "east", None])
def test_an_answer_that_is_no_action_is_refused(answer: Any) -> None:
    agent = Counting()
    agent.act = lambda observation, mask: answer  # type: ignore[method-assign]
    with pytest.raises(InvalidAction, match=f"{answer!r} is not an action"):
        brl.rollout("frozen-lake", agent, 1, 3)


def test_what_does_not_go_together_is_refused() -> None:
    with pytest.raises(ValueError, match="in one level"):
        brl.rollout(["frozen-lake", "shell-game"], Counting())
    with pytest.raises(TypeError, match="unexpected keyword argument 'observation'"):
        brl.rollout("frozen-lake", "random", observation="view")
