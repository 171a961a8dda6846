"""Several observations at once: a dict of what each shows alone, in all environments."""

from __future__ import annotations

import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec
from support.fleets import ENGINES, same, walked
from support.playing import level_named

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.envs.vector.env import LevelVectorEnv

NAMES = tuple(reversed([*OBSERVATIONS]))


@pytest.mark.slow
@pytest.mark.parametrize("level", ["final-maze", "things of all kinds", "random mazes with things"])
def test_a_dict_has_what_each_shows_alone(level: str) -> None:
    env: Any = level_named(level).make(observation=NAMES, actions="turns")
    alone = {name: level_named(level).make(observation=name, actions="turns") for name in NAMES}
    assert env.observation_space == spaces.Dict(
        {name: each.observation_space for name, each in alone.items()}
    )
    told = [env.reset(seed=3)[0]]
    wanted = [{name: each.reset(seed=3)[0] for name, each in alone.items()}]
    for action in [2, 2, 1, 2, 0, 2, 2]:
        told.append(env.step(action)[0])
        wanted.append({name: each.step(action)[0] for name, each in alone.items()})
    for one, other in zip(told, wanted, strict=True):
        assert list(one) == list(env.observation_space)
        assert same(dict(sorted(one.items())), dict(sorted(other.items())))


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("copy", [True, False])
def test_vector_environments_give_each_an_array_of_its_own(engine: str, copy: bool) -> None:
    level = level_named("things of all kinds")
    given: dict[str, Any] = {"num_envs": 6, "engine": engine, "copy": copy}
    envs = LevelVectorEnv(level, observation=NAMES, **given)
    first, _ = envs.reset(seed=1)
    for name in NAMES:
        alone = LevelVectorEnv(level, observation=name, **given)
        assert first[name].flags.c_contiguous
        assert same(first[name], alone.reset(seed=1)[0])
    before = {name: each.copy() for name, each in first.items()}
    second, *_ = envs.step(np.full(6, brl.Action.EAST))
    for name in NAMES:
        assert np.shares_memory(first[name], second[name]) is not copy
        assert np.array_equal(first[name], before[name]) is copy or same(first[name], second[name])


def test_they_survive_pickling_and_json() -> None:
    observation = ("planes", "vector", "index")
    envs: Any = LevelVectorEnv(
        "random-maze", num_envs=3, observation=observation, autoreset_mode="SameStep"
    )
    walked(envs, 30)
    again = pickle.loads(pickle.dumps(envs))
    assert same(walked(envs, 20, 5), walked(again, 20, 5))
    env = gymnasium.make("babyrobot/final-maze-v0", observation=observation)
    assert env.spec is not None
    spec = EnvSpec.from_json(env.spec.to_json())
    other = gymnasium.make(spec)
    assert other.observation_space == env.observation_space
    assert other.spec == env.spec
    assert same(other.reset(seed=1)[0], env.reset(seed=1)[0])
    assert same(pickle.loads(pickle.dumps(env)).step(2)[0], env.step(2)[0])


def test_the_order_of_names_and_lists_change_nothing() -> None:
    level = brl.load("final-maze")
    one: Any = level.make(observation=["walls", "index"])
    other: Any = level.make(observation=("index", "walls"))
    assert one.observation_space == other.observation_space
    assert list(one.observation_space) == list(other.observation_space)
    assert same(one.reset(seed=1)[0], other.reset(seed=1)[0])
    alone: Any = level.make(observation=("index",))
    assert list(alone.observation_space) == ["index"]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"observation": ()}, r"observation must name at least one, and each only once, not \(\)"),
        ({"observation": ("index", "index")}, "each only once"),
        ({"observation": ("index", "plane")}, "did you mean `planes`"),
        ({"observation": ("index", ["walls"])}, "observation must be one of"),
        ({"channels_last": True}, "channels_last and planes_dtype need observation='planes'"),
        ({"planes_dtype": "uint8"}, "need observation='planes'"),
        ({"observation": "planes", "planes_dtype": "int8"}, "planes_dtype must be one of"),
        ({"observation": ("planes", "index"), "grayscale": True}, "need observation='image'"),
    ],
)
def test_wrong_arguments_are_named(given: dict[str, Any], message: str) -> None:
    for make in (brl.load("default").make, lambda **k: LevelVectorEnv("default", **k)):
        with pytest.raises(ValueError, match=message):
            make(**given)


def test_options_are_for_each_that_has_them() -> None:
    env: Any = brl.load("default").make(
        observation=("planes", "view", "image"),
        channels_last=True,
        planes_dtype="uint8",
        view_radius=1,
        grayscale=True,
        image_size=(8, 8),
    )
    shapes = {name: space.shape for name, space in env.observation_space.items()}
    planes = len(env.unwrapped.plane_names)
    (width, height) = brl.load("default").size
    assert shapes == {
        "planes": (height, width, planes),
        "view": (3, 3, len(env.unwrapped.view_planes)),
        "image": (8, 8, 1),
    }
