"""Observations in words, by a wrapper around environments of levels and suites."""

from __future__ import annotations

from typing import Any

import gymnasium
import pytest
from support.worlds import level

import babyrobot_levels as brl


def test_each_level_of_a_suite_has_its_own_rules() -> None:
    env: Any = brl.TextObservation(gymnasium.make("babyrobot/Suite-v0", suite="text-easy"))
    told = [env.reset(options={"index": number}) for number in range(6)]
    assert all(seen in env.observation_space for seen, _ in told)
    assert len({info["rules"] for _, info in told}) > 1
    sizes = {(seen.count("\n"), info["rules"][:60]) for seen, info in told}
    assert len(sizes) > 1


def test_labels_are_in_the_space_whatever_their_characters() -> None:
    world = level(size=[3, 1], areas=[{"at": [1, 0], "reward": -2, "label": "Fluß"}], max_steps=4)
    env: Any = brl.TextObservation(brl.make(world, observation="index"), "words")
    seen, _ = env.reset()
    assert "Fluß" in seen
    assert seen in env.observation_space


def test_what_cannot_be_told_is_refused() -> None:
    with pytest.raises(TypeError, match=r"tells environments, as of .*, not CartPoleEnv"):
        brl.TextObservation(gymnasium.make("CartPole-v1"))
    with pytest.raises(ValueError, match="do not turn"):
        brl.TextObservation(brl.make("first-key", actions="turns"))
    with pytest.raises(ValueError, match="sight must be one of"):
        brl.TextObservation(brl.make("first-key"), "all")
