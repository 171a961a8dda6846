"""With a list of seeds, each environment walks as a single one with its seed does."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from hypothesis import given, settings
from hypothesis import strategies as st
from support.combinations import combined
from support.fleets import (
    ENGINES,
    MODES,
    SEEDS,
    SIZE,
    assert_same_from_here,
    assert_same_walks,
    levels,
    single,
    walked,
)
from support.playing import level_named

import babyrobot_levels as brl
from babyrobot_levels.envs.engine import loops
from babyrobot_levels.envs.engine.draws import MOST_WORDS, OwnDraws
from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.envs.vector.env import LevelVectorEnv
from babyrobot_levels.library.level import Level


@combined(1, mode=MODES, engine=ENGINES)
@settings(max_examples=8, deadline=None)
@given(level=levels(), actions=st.sampled_from([*ACTION_SETS]), data=st.data())
def test_each_environment_walks_as_a_single_one_with_its_seed(
    mode: AutoresetMode, engine: str, level: Level, actions: str, data: st.DataObject
) -> None:
    seeds = data.draw(st.lists(st.integers(0, 2**65), min_size=SIZE, max_size=SIZE))
    envs = LevelVectorEnv(level, num_envs=SIZE, engine=engine, autoreset_mode=mode, actions=actions)
    assert_same_walks(envs, single([level], actions=actions), seeds)


@combined(1, mode=MODES, engine=ENGINES)
def test_long_walks_of_several_levels_with_several_starts(mode: AutoresetMode, engine: str) -> None:
    starts = [[0, 0], [1, 0], [2, 0], [0, 1], [0, 2]]
    ice = {"version": 1, "size": [4, 4], "skid": {"probability": 0.5, "to": "others"}}
    played = [
        brl.load({**ice, "start": starts[: 1 + number], "max_steps": 9}) for number in range(SIZE)
    ]
    envs = LevelVectorEnv(levels=played, num_envs=SIZE, engine=engine, autoreset_mode=mode)
    # Words are drawn anew many times.
    assert_same_walks(envs, single(played), SEEDS, 400)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_start_that_is_asked_for_is_not_drawn(engine: str) -> None:
    level = level_named("four-corners")
    envs, alone = LevelVectorEnv(level, num_envs=SIZE, engine=engine), level.make()
    envs.reset(seed=SEEDS, options={"start": [1, 1]})
    alone.reset(seed=SEEDS[1], options={"start": [1, 1]})
    drawn = [(envs.reset()[0][1].tolist(), alone.reset()[0].tolist()) for _ in range(30)]
    assert all(one == other for one, other in drawn)
    assert len({tuple(one) for one, _ in drawn}) == 4


def starts_of(envs: Any, times: int = 8) -> Any:
    """Return where environments begin, `[times, num_envs]`."""
    return np.array([envs.reset()[0] for _ in range(times)])


def corners(engine: str = "numpy", num_envs: int = 4) -> Any:
    return LevelVectorEnv("four-corners", num_envs=num_envs, observation="index", engine=engine)


@pytest.mark.parametrize("engine", ENGINES)
def test_one_seed_for_all_is_shared_again(engine: str) -> None:
    envs, fresh = corners(engine), corners(engine)
    envs.reset(seed=[1, 2, 3, 4])
    envs.reset(seed=5)
    fresh.reset(seed=5)
    assert starts_of(envs).tolist() == starts_of(fresh).tolist()
    assert isinstance(envs.np_random, np.random.Generator)
    assert envs.np_random_seed == 5
    envs.reset(seed=[1, 2, 3, 4])
    envs.np_random = np.random.default_rng(5)
    fresh.reset(seed=5)
    envs.reset()
    assert starts_of(envs).tolist() == starts_of(fresh).tolist()
    assert envs.np_random_seed == -1


def test_generators_are_told() -> None:
    envs = corners()
    assert envs.np_random_seed >= 0
    assert envs.get_attr("np_random") == (envs.np_random,) * 4
    envs.reset(seed=[1, 2, 3, 4])
    assert envs.get_attr("np_random") == envs.np_random
    assert envs.get_attr("np_random_seed") == (1, 2, 3, 4)
    generators = envs.np_random
    assert envs.np_random_seed == (1, 2, 3, 4)
    assert [type(each) for each in generators] == [np.random.Generator] * 4
    envs.reset()
    assert envs.np_random is generators


def test_none_leaves_a_generator_as_it_is() -> None:
    envs, others = corners(), corners()
    envs.reset(seed=[1, None, 3, 4])
    others.reset(seed=[1, None, 3, 4])
    assert envs.np_random_seed[1] not in (1, 3, 4, others.np_random_seed[1])
    envs.reset(seed=[5, 6, 7, 8])
    others.reset(seed=[5, 6, 7, 8])
    envs.reset(seed=[None, None, 1, 2])
    others.reset()
    assert envs.np_random_seed == (5, 6, 1, 2)
    one, other = starts_of(envs), starts_of(others)
    assert one[:, :2].tolist() == other[:, :2].tolist()
    assert one[:, 2:].tolist() != other[:, 2:].tolist()


def test_only_those_that_are_reset_are_seeded() -> None:
    envs, others = corners(), corners()
    envs.reset(seed=[5, 6, 7, 8])
    others.reset(seed=[5, 6, 7, 8])
    mask = np.array([True, False, False, True])
    envs.reset(seed=[1, 2, 3, 4], options={"reset_mask": mask})
    others.reset(options={"reset_mask": mask})
    assert envs.np_random_seed == (1, 6, 7, 4)
    one, other = starts_of(envs), starts_of(others)
    assert one[:, 1:3].tolist() == other[:, 1:3].tolist()
    assert one[:, [0, 3]].tolist() != other[:, [0, 3]].tolist()


def test_environments_that_shared_a_generator_get_their_own() -> None:
    envs, alone = corners(), corners(num_envs=1)
    envs.reset(seed=9)
    mask = np.array([False, True, False, False])
    envs.reset(seed=[1, 2, 3, 4], options={"reset_mask": mask})
    alone.reset(seed=[2])
    assert len(set(envs.np_random_seed)) == 4
    assert starts_of(envs)[:, 1].tolist() == starts_of(alone)[:, 0].tolist()


@combined(1, mode=MODES, engine=ENGINES)
def test_copies_go_on_with_their_generators(mode: AutoresetMode, engine: str) -> None:
    envs = LevelVectorEnv(
        level_named("all at once"),
        num_envs=SIZE,
        engine=engine,
        autoreset_mode=mode,
        max_episode_steps=7,
    )
    walked(envs, 20, SEEDS)
    for again in (copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))):
        one = copy.deepcopy(envs)
        assert_same_from_here(one, again, 30)
        assert [*one.np_random_seed] == [*again.np_random_seed] == SEEDS


def test_levels_without_chance_draw_nothing() -> None:
    envs: Any = LevelVectorEnv("cliff-walking", num_envs=2)
    envs.reset(seed=[4, 5])
    for _ in range(20):
        envs.step([1, 2])
    assert envs.np_random[1].random() == np.random.default_rng(5).random()


def test_many_environments_take_little_memory() -> None:
    draws = OwnDraws(16_384)
    assert draws.memory.nbytes < 10_000_000
    assert OwnDraws(1).memory.nbytes < 4096


def test_there_are_always_words_for_a_step() -> None:
    draws = OwnDraws(2)
    for number, seed in enumerate(SEEDS[:2]):
        draws.follow(number, np.random.default_rng(seed))
    taken: list[list[float]] = [[], []]
    for _ in range(200):
        draws.reserve()
        # One robot takes as many as it can, and the other one as few.
        for number, count in enumerate((MOST_WORDS, 1)):
            taken[number] += [float(draws.uniform(np.array([number]))[0]) for _ in range(count)]
    for seed, drawn in zip(SEEDS, taken, strict=False):
        assert drawn == np.random.default_rng(seed).random(len(drawn)).tolist()


@given(
    seed=st.integers(0, 2**64),
    counts=st.lists(st.just(None) | st.integers(1, 9) | st.integers(1, 2**31), max_size=300),
    is_thrown_away=st.booleans(),
)
def test_draws_are_those_of_a_generator(
    seed: int, counts: list[int | None], is_thrown_away: bool
) -> None:
    theirs = np.random.default_rng(seed)
    ours, loop = OwnDraws(1), OwnDraws(1)
    for draws in (ours, loop):
        draws.follow(0, np.random.default_rng(seed))
        draws.reserve()
    if is_thrown_away:
        # Half a word of zeros is left over: for most counts, numbers would not be equally likely.
        left_over = {"has_uint32": 1, "uinteger": 0}
        theirs.bit_generator.state = {**theirs.bit_generator.state, **left_over}
        ours.memory[0, 1] = loop.memory[0, 1] = 0
    robot = np.zeros(1, np.intp)
    for count in counts:
        ours.reserve()
        loop.reserve()
        if count is None:
            drawn: Any = theirs.random()
            assert ours.uniform(robot)[0] == drawn == loops.uniform(loop.memory, 0, 0)
        else:
            drawn = theirs.integers(count)
            assert ours.below(robot, np.array([count]))[0] == drawn
            assert loops.below(loop.memory, 0, 0, count) == drawn
