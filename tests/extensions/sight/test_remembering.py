"""Rollouts of the best agent of a sight."""

from __future__ import annotations

from typing import Any

import pytest

import babyrobot_levels as brl

SIGHT: Any = {"view_radius": 1}


@pytest.mark.slow
def test_the_best_agent_of_a_sight_earns_its_optimum() -> None:
    agent = brl.solve("shell-game", sight="view", **SIGHT).policy()
    data = brl.rollout("shell-game", agent, 20, 100, seed=1, observation="view", **SIGHT)
    ends = int((data.terminations | data.truncations).sum())
    assert not data.truncations.any()
    # Each of the 20 columns ends within an episode, which adds a little.
    assert data.rewards.sum() / ends == pytest.approx(-6, abs=0.7)
