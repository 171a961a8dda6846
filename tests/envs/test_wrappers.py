"""Every wrapper of Gymnasium around every kind of observation, for single and vector environments.

Each combination works, or Gymnasium refuses it with the reason in `REFUSED`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from tempfile import mkdtemp
from typing import Any

import cv2
import gymnasium
import numpy as np
import pytest
from gymnasium import spaces, wrappers
from gymnasium.wrappers import vector
from support.each import for_each
from support.ids import KINDS, LEVEL_ID, SUITE_ID
from support.playing import CORNERS

LIMIT, STEPS, SIZE = 5, 12, 3

IS_OLD = gymnasium.__version__.startswith("1.1.")

THINGS: dict[str, Any] = {"id": LEVEL_ID, "level": CORNERS["things of all kinds"]}
"""A level whose infos have all keys, and whose frames are small."""

CASES: dict[str, dict[str, Any]] = {
    **{kind: {**THINGS, **arguments} for kind, arguments in KINDS.items()},
    "a level without things": {"id": "babyrobot/final-maze-v0"},
    "levels of many sizes": {"id": SUITE_ID, "suite": "small-mazes"},
}
"""All kinds of observations; then what infos and frames depend on, which observations do not."""

PASSING_ON = {"AddWhiteNoise", "ClipAction", "ClipReward", "DictInfoToList", "DiscretizeAction",
              "HumanRendering", "NormalizeReward", "ObstructView", "OrderEnforcing", "RecordVideo",
              "RenderCollection",
              "RescaleAction", "StickyAction", "TimeLimit", "TransformAction", "TransformReward",
              "VectorizeTransformAction", "VectorizeTransformReward"}  # fmt: skip
"""The wrappers that pass observations on as they are, or have frames in their place."""

FEW_CASES = ("index", "dict", "a level without things", "levels of many sizes")
"""What differs for those: one number, several arrays, infos and frames."""


def unchanged(value: Any) -> Any:
    return value


def space_of(env: Any) -> Any:
    """Return the observation space of a single environment, or of each in a vector one."""
    return getattr(env, "single_observation_space", env.observation_space)


def shown_fast(env: Any) -> dict[str, Any]:
    env.metadata = {**env.metadata, "render_fps": 1000}
    return {}


ARGUMENTS: dict[str, Callable[[Any], dict[str, Any]]] = {
    "AddRenderObservation": lambda _: {"render_only": False},
    "AddWhiteNoise": lambda _: {"probability_of_noise_per_pixel": 0.1},
    "ClipReward": lambda _: {"min_reward": -1, "max_reward": 1},
    "DelayObservation": lambda _: {"delay": 2},
    "DiscretizeAction": lambda _: {"bins": 3},
    "DiscretizeObservation": lambda _: {"bins": 3, "multidiscrete": True},
    "DtypeObservation": lambda _: {"dtype": np.float32},
    "FilterObservation": lambda _: {"filter_keys": ["position", "vector"]},
    "FrameStackObservation": lambda _: {"stack_size": 3},
    "HumanRendering": shown_fast,
    "MaxAndSkipObservation": lambda _: {"skip": 2},
    "ObstructView": lambda _: {"obstructed_pixels_ratio": 0.1, "obstruction_width": 2},
    "RecordVideo": lambda _: {"video_folder": f"{mkdtemp(dir='.')}/videos"},
    "RepeatAction": lambda _: {"num_repeats": 2},
    "RescaleAction": lambda _: {"min_action": np.float32(0), "max_action": np.float32(1)},
    "RescaleObservation": lambda _: {"min_obs": np.float32(0), "max_obs": np.float32(1)},
    "ReshapeObservation": lambda env: {"shape": (math.prod(space_of(env).shape or ()),)},
    "ResizeObservation": lambda _: {"shape": (3, 3)},
    "StickyAction": lambda _: {"repeat_action_probability": 0.5},
    "TimeLimit": lambda _: {"max_episode_steps": 5},
    "TransformAction": lambda env: {"func": unchanged, "action_space": env.action_space},
    "TransformObservation": lambda env: {
        "func": unchanged,
        "observation_space": env.observation_space,
    },
    "TransformReward": lambda _: {"func": unchanged},
    "VectorizeTransformAction": lambda env: {
        "wrapper": wrappers.TransformAction,
        "func": unchanged,
        "action_space": env.single_action_space,
    },
    "VectorizeTransformObservation": lambda env: {
        "wrapper": wrappers.TransformObservation,
        "func": unchanged,
        "observation_space": env.single_observation_space,
    },
    "VectorizeTransformReward": lambda _: {"wrapper": wrappers.TransformReward, "func": unchanged},
    **dict.fromkeys(
        (
            "AtariPreprocessing",
            "Autoreset",
            "ClipAction",
            "DictInfoToList",
            "FlattenObservation",
            "GrayscaleObservation",
            "NormalizeObservation",
            "NormalizeReward",
            "OrderEnforcing",
            "PassiveEnvChecker",
            "RecordEpisodeStatistics",
            "RenderCollection",
            "TimeAwareObservation",
        ),
        lambda _: {},
    ),
}
"""The arguments of each wrapper, from the environment that it is put around."""

CONVERTING = {"ArrayConversion", "JaxToNumpy", "JaxToTorch", "NumpyToTorch"}
"""The wrappers that need JAX or PyTorch: test_converting_wrappers.py has them."""

RENDERING = {"AddRenderObservation", "AddWhiteNoise", "HumanRendering", "ObstructView",
             "RecordVideo", "RenderCollection"}  # fmt: skip

Refusal = tuple[Callable[[Any], bool], str]
"""Which environments a wrapper refuses, and a part of what Gymnasium says then."""


def is_box(env: Any) -> bool:
    return isinstance(space_of(env), spaces.Box)


def is_image(env: Any) -> bool:
    space = space_of(env)
    return is_box(env) and space.dtype == np.uint8 and (space.high == 255).all()


def is_dict(env: Any) -> bool:
    return isinstance(space_of(env), spaces.Dict)


REFUSED: dict[str, Refusal] = {
    "AtariPreprocessing": (lambda _: True, "Disable frame-skipping in the original env"),
    "ClipAction": (lambda _: True, "requires a Box action space"),
    "DiscretizeAction": (lambda _: True, "only compatible with Box continuous actions"),
    "RescaleAction": (lambda _: True, "requires a Box action space"),
    "DiscretizeObservation": (lambda env: not is_box(env), "only compatible with Box"),
    "DtypeObservation": (
        lambda env: not isinstance(space_of(env), spaces.Box | spaces.Discrete),
        "must be an integer dtype|requires a Box, Discrete|only compatible with",
    ),
    "FilterObservation": (
        lambda env: not is_dict(env),
        "only usable with `Dict` and `Tuple` observations",
    ),
    "GrayscaleObservation": (
        lambda env: not (is_image(env) and space_of(env).shape[-1] == 3),
        "requires a Box observation space|requires an image with 3 channels",
    ),
    "MaxAndSkipObservation": (is_dict, "must have the shape attribute"),
    # The one of vector environments does not check the space: arrays of it have no shape.
    "NormalizeObservation": (is_dict, "to have a shape|axis 0 is out of bounds"),
    "RescaleObservation": (lambda env: not is_box(env), "requires a Box observation space"),
    "ReshapeObservation": (lambda env: not is_box(env), "requires a Box observation space"),
    # OpenCV makes images of up to four channels smaller.
    "ResizeObservation": (
        lambda env: not (is_image(env) and space_of(env).shape[-1] <= 4),
        "requires a (Box observation space|2D or 3D image)|requires observation bounds|cn <= 4",
    ),
}


@pytest.fixture
def no_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let pygame draw without a screen and without a greeting."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setenv("PYGAME_HIDE_SUPPORT_PROMPT", "1")


REASONS: tuple[type[Exception], ...] = (AssertionError, TypeError, ValueError, cv2.error)


def names_in(module: Any) -> list[str]:
    """Return the names of the wrappers in a module of Gymnasium."""
    hidden = ["AddWhiteNoise", "ObstructView", "RepeatAction"]
    found = {*module.__all__, *(name for name in hidden if hasattr(module, name))}
    return sorted(found - {"vector"} - CONVERTING)


def cases_in(module: Any) -> list[Any]:
    """Return these names as parameters; what draws each frame of all cases takes long."""
    long = {"AddRenderObservation", "RecordVideo"}
    return [
        pytest.param(name, marks=pytest.mark.sweep if name in long else ())
        for name in names_in(module)
    ]


# Gymnasium's own, of numbers that a wrapper makes of the observations of a `Discrete`.
casts_are_told = pytest.mark.filterwarnings("ignore:.*Casting input x to numpy array")


def test_every_wrapper_is_known() -> None:
    missing = {*names_in(wrappers), *names_in(vector)} - {*ARGUMENTS}
    assert not missing, "add these wrappers of a new Gymnasium to ARGUMENTS, or to REFUSED too"


@pytest.mark.usefixtures("here", "no_screen")
@casts_are_told
@pytest.mark.parametrize("name", cases_in(wrappers))
@for_each("case", CASES)
def test_a_wrapper_of_single_environments(name: str, case: str) -> None:
    if name in PASSING_ON and case not in FEW_CASES:
        return
    env: Any = gymnasium.make(**CASES[case], **shown(name), max_episode_steps=LIMIT)
    wrapped = wrapped_or_refused(wrappers, name, env)
    if wrapped is None:
        return
    observation, _ = wrapped.reset(seed=1)
    for _ in range(STEPS):
        assert observation in wrapped.observation_space
        observation, _, terminated, truncated, _ = wrapped.step(wrapped.action_space.sample())
        if terminated or truncated:
            observation, _ = wrapped.reset()
    if name in RENDERING:
        wrapped.render()
    wrapped.close()


@pytest.mark.sweep
@pytest.mark.usefixtures("here", "no_screen")
@casts_are_told
@pytest.mark.filterwarnings("ignore:Passing None into shape:DeprecationWarning")
@pytest.mark.parametrize("name", cases_in(vector))
@for_each("case", CASES)
def test_a_wrapper_of_vector_environments(name: str, case: str) -> None:
    if name in PASSING_ON and case not in FEW_CASES:
        return
    wrapped = wrapped_or_refused(vector, name, many(case, **shown(name)))
    if wrapped is None:
        return
    observations, _ = wrapped.reset(seed=1)
    for _ in range(STEPS):
        # Gymnasium 1.1 does not tell the space of what it has normalised.
        if name != "NormalizeObservation" or not IS_OLD:
            assert observations in wrapped.observation_space
        observations, *_ = wrapped.step(wrapped.action_space.sample())
    wrapped.close()


def shown(name: str) -> dict[str, Any]:
    """Return the argument without which a wrapper has no frames."""
    return {"render_mode": "rgb_array"} if name in RENDERING else {}


def many(case: str, mode: str = "vector_entry_point", **kwargs: Any) -> Any:
    """Return the vector environment of a case."""
    return gymnasium.make_vec(
        **CASES[case], num_envs=SIZE, vectorization_mode=mode, max_episode_steps=LIMIT, **kwargs
    )


def wrapped_or_refused(module: Any, name: str, env: Any) -> Any:
    """Return an environment in a wrapper, None if Gymnasium refuses it with the known reason."""
    if IS_OLD and name == "ResizeObservation" and (space_of(env).shape or ())[-1:] == (1,):
        return None  # Its images lose the channel that its space has.
    arguments = ARGUMENTS[name](env)
    is_refused, reason = REFUSED.get(name, (lambda _: False, ""))
    if not is_refused(env):
        return getattr(module, name)(env, **arguments)
    with pytest.raises(REASONS) as caught:
        getattr(module, name)(env, **arguments).reset(seed=1)
    # In earlier versions, most of them assert without a message.
    assert not str(caught.value) or re.search(reason, str(caught.value))
    return None
