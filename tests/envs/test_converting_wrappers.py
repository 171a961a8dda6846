"""Gymnasium's wrappers that convert arrays of NumPy, around every kind of observation."""

from __future__ import annotations

import importlib
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import wrappers
from support.each import for_each
from support.fleets import ENGINES
from support.ids import KINDS, LEVEL_ID
from support.playing import CORNERS

pytestmark = pytest.mark.libraries

LIMIT, STEPS, SIZE = 5, 12, 3


@pytest.fixture(params=["torch", "jax.numpy"])
def module(request: pytest.FixtureRequest) -> Any:
    """A module with a function `asarray`. JAX comes with Minari."""
    return importlib.import_module(request.param)


def arguments(kind: str) -> dict[str, Any]:
    """Return the arguments of an environment whose infos have all keys."""
    level = CORNERS["things of all kinds"]
    return {"id": LEVEL_ID, "level": level, "max_episode_steps": LIMIT, **KINDS[kind]}


def converting(wrappers: Any, env: Any, module: Any) -> Any:
    """Return an environment that takes and gives arrays of a module."""
    if module.__name__ == "torch":
        return wrappers.NumpyToTorch(env)
    # There is no wrapper of its own for this: `JaxToNumpy` is for environments written in JAX.
    return wrappers.ArrayConversion(env, env_xp=np, target_xp=module)


def check_converted(told: Any, wanted: Any, module: Any) -> None:
    """Check that arrays of a module have the values that are wanted."""
    if isinstance(wanted, dict):
        assert list(told) == list(wanted)
        for name, value in wanted.items():
            check_converted(told[name], value, module)
    else:
        assert isinstance(told, type(module.asarray(0)))
        assert told.shape == np.shape(wanted)
        assert np.array_equal(np.asarray(told), wanted)


@for_each("kind", KINDS)
def test_a_single_environment_gives_arrays_of_another_library(module: Any, kind: str) -> None:
    plain: Any = gymnasium.make(**arguments(kind))
    env = converting(wrappers, gymnasium.make(**arguments(kind)), module)
    plain.action_space.seed(1)
    over = True
    for _ in range(STEPS):
        if over:
            told, wanted = env.reset(seed=1), plain.reset(seed=1)
        else:
            action = plain.action_space.sample()
            told, wanted = env.step(module.asarray(action)), plain.step(action)
            assert told[1:4] == wanted[1:4]
        for place in (0, -1):
            check_converted(told[place], wanted[place], module)
        over = not over and any(wanted[2:4])


@pytest.mark.parametrize("engine", ENGINES)
@for_each("kind", KINDS)
def test_a_vector_environment_gives_arrays_of_another_library(
    module: Any, engine: str, kind: str
) -> None:
    def many() -> Any:
        return gymnasium.make_vec(**arguments(kind), num_envs=SIZE, engine=engine)

    plain, env = many(), converting(wrappers.vector, many(), module)
    plain.action_space.seed(1)
    told, wanted = env.reset(seed=1), plain.reset(seed=1)
    for _ in range(STEPS):
        for got, want in zip(told, wanted, strict=True):
            check_converted(got, want, module)
        actions = plain.action_space.sample()
        told, wanted = env.step(module.asarray(actions)), plain.step(actions)
