"""A vector environment is many single ones: Gymnasium's `SyncVectorEnv` of them says the same."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from hypothesis import given, settings
from hypothesis import strategies as st
from support.combinations import combined
from support.fleets import ENGINES, MODES, Reference, assert_same_info, levels, same
from support.playing import level_named

from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.envs.vector.env import LevelVectorEnv
from babyrobot_levels.library.level import Level


def assert_same_walk(
    played: list[Level], mode: AutoresetMode, engine: str, seed: int, steps: int = 40, **kwargs: Any
) -> None:
    """Walk a vector environment and the single ones, and compare all that they tell."""
    size = 5
    ours: Any = LevelVectorEnv(
        levels=played, num_envs=size, autoreset_mode=mode, engine=engine, **kwargs
    )
    theirs = Reference(played, size, mode, **kwargs)
    observations, info = ours.reset(seed=seed)
    wanted, wanted_info = theirs.reset(seed, ours)
    assert same(observations, wanted)
    assert_same_info(info, wanted_info)
    over = np.zeros(size, np.bool_)
    rng = np.random.default_rng(seed)
    for _ in range(steps):
        if mode is AutoresetMode.DISABLED and over.any():
            observations, info = ours.reset(options={"reset_mask": over})
            wanted, wanted_info = theirs.reset_some(over, ours)
            assert same(observations, wanted)
            assert_same_info(info, wanted_info)
        actions = rng.integers(0, ours.single_action_space.n, size)
        told = ours.step(actions)
        begun = over if mode is AutoresetMode.NEXT_STEP else told[2] | told[3]
        if mode is AutoresetMode.DISABLED:
            begun = np.zeros(size, np.bool_)
        wanted_all = theirs.step(actions, begun, ours)
        for one, other in zip(told[:4], wanted_all[:4], strict=True):
            assert same(one, other), (one, other)
        assert_same_info(told[4], wanted_all[4])
        over = told[2] | told[3]


@pytest.mark.slow
@combined(1, mode=MODES, engine=ENGINES)
@settings(max_examples=8, deadline=None)
@given(level=levels(), actions=st.sampled_from([*ACTION_SETS]), seed=st.integers(0, 99))
def test_it_walks_as_single_environments_do(
    mode: AutoresetMode, engine: str, level: Level, actions: str, seed: int
) -> None:
    assert_same_walk([level], mode, engine, seed, actions=actions, observation="index")


@combined(1, mode=MODES, engine=ENGINES)
@settings(max_examples=2, deadline=None)
@given(level=levels(4, moves=8), seed=st.integers(0, 99))
def test_it_moves_diagonally_as_single_environments_do(
    mode: AutoresetMode, engine: str, level: Level, seed: int
) -> None:
    actions = ("valid", "moves")[seed % 2]
    assert_same_walk([level], mode, engine, seed, 15, actions=actions, observation="vector")


@combined(
    1,
    name=["final-maze", "frozen-lake", "all at once"],
    observation=["position", "walls", "image", "vector", "planes", ("walls", "index", "planes")],
    mode=MODES,
    engine=ENGINES,
)
def test_it_shows_what_single_environments_show(
    name: str, observation: str | tuple[str, ...], mode: AutoresetMode, engine: str
) -> None:
    level = level_named(name).replace(max_steps=15)
    assert_same_walk([level], mode, engine, 3, observation=observation)


@pytest.mark.slow
@combined(1, mode=MODES, engine=ENGINES)
@settings(max_examples=4, deadline=None)
@given(data=st.data(), seed=st.integers(0, 99))
def test_each_of_several_levels_is_what_it_is_alone(
    mode: AutoresetMode, engine: str, data: st.DataObject, seed: int
) -> None:
    # All of one size, because single environments would have other spaces.
    first = data.draw(levels(4))
    others = [
        level for level in data.draw(st.lists(levels(4), max_size=30)) if level.size == first.size
    ]
    assert_same_walk([first, *others], mode, engine, seed)
