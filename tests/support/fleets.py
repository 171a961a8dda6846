"""Many robots in tests: levels with limits, and Gymnasium's own vector environment beside ours."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from babyrobot_levels.envs.vector.env import LevelVectorEnv
from babyrobot_levels.library.level import Level
from support.worlds import level_of, worlds

ENGINES = ("numpy", "compiled")
MODES = tuple(AutoresetMode)

SIZE = 5
SEEDS = [3, 2**70, 0, 3, 12345]

Single = Callable[[int], gymnasium.Env[Any, Any]]
"""Makes the single environment of a number."""


@st.composite
def levels(draw: DrawFn, largest: int = 5, moves: int = 4) -> Level:
    """Random levels, some of which cut episodes off after a few steps."""
    world = draw(worlds(largest)) | {"moves": moves}
    if moves > 4:
        world.pop("heading", None)
    world["max_steps"] = draw(st.sampled_from([1, 2, 7, 1000]))
    return level_of(world)


class StartsWhereTold(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Begins episodes at a cell that is told, and so draws nothing for it."""

    start: list[int]

    def reset(self, **_: Any) -> tuple[Any, dict[str, Any]]:
        return self.env.reset(options={"start": self.start})


class Reference:
    """A `SyncVectorEnv` of single environments that use the draws of a vector one.

    Single environments draw one after the other when they act. A vector one lets all draw that
    act, and then those that begin anew; where these stand is then told to the single ones.
    """

    def __init__(self, levels: Sequence[Level], num_envs: int, mode: AutoresetMode, **kwargs: Any):
        def make(number: int) -> StartsWhereTold:
            level = levels[number % len(levels)]
            return StartsWhereTold(gymnasium.make("babyrobot/Level-v0", level=level, **kwargs))

        self.envs = SyncVectorEnv(
            [lambda number=number: make(number) for number in range(num_envs)],  # type: ignore[misc]
            autoreset_mode=mode,
        )
        several = any(len(level.starts) > 1 for level in levels)
        self._draws_to_begin = int(several)
        self._levels = levels

    def reset(self, seed: int, ours: LevelVectorEnv) -> tuple[Any, dict[str, Any]]:
        """Begin where ours has begun with this seed."""
        self._source = np.random.default_rng(seed)
        everyone = np.ones(ours.num_envs, np.bool_)
        self._tell(ours, everyone)
        told = self.envs.reset()
        for env in self.envs.envs:
            env.unwrapped.np_random = self._source
        self._skip(everyone)
        return told

    def reset_some(self, mask: Any, ours: LevelVectorEnv) -> tuple[Any, dict[str, Any]]:
        """Begin where ours has begun with this mask."""
        self._tell(ours, mask)
        told = self.envs.reset(options={"reset_mask": mask})
        self._skip(mask)
        return told

    def step(self, actions: Any, begun: Any, ours: LevelVectorEnv) -> tuple[Any, ...]:
        """Act as ours has acted, of which those in `begun` began anew."""
        self._tell(ours, begun)
        told = self.envs.step(actions)
        self._skip(begun)
        return told

    def _tell(self, ours: LevelVectorEnv, begun: Any) -> None:
        for number in np.flatnonzero(begun):
            env = self.envs.envs[number]
            assert isinstance(env, StartsWhereTold)
            env.start = list(where(ours, int(number)))

    def _skip(self, begun: Any) -> None:
        self._source.random(int(np.sum(begun)) * self._draws_to_begin)


def where(envs: LevelVectorEnv, number: int) -> tuple[int, int]:
    """Return the cell `[x, y]` in which a robot stands."""
    level = envs.call("level")[number]
    state = int(envs._envs.state[number] - envs._tables.offset[envs._envs.level[number]])
    width, height = level.size
    y, x = divmod(state % (width * height), width)
    return x, y


def same(one: Any, other: Any) -> bool:
    """Return whether results of environments are equal, to the type and the last bit."""
    if isinstance(one, dict):
        return list(one) == list(other) and all(same(one[key], other[key]) for key in one)
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray) and one.dtype == object:
        return same(list(one), list(other))
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other)
    return type(one) is type(other) and one == other


def assert_same_info(ours: dict[str, Any], theirs: dict[str, Any]) -> None:
    """Compare infos; what nobody said, Gymnasium leaves out, and ours says of nobody.

    Of several levels, only ours says which one is played.
    """
    assert set(theirs) <= set(ours)
    for key, value in ours.items():
        if key.removeprefix("_") == "level_index" and key not in theirs:
            continue
        if key not in theirs:
            said = value if key.startswith("_") else ours[f"_{key}"]
            assert not said.any(), key
        elif isinstance(value, dict):
            assert_same_info(value, theirs[key])
        else:
            assert same(value, theirs[key]), (key, value, theirs[key])


def kinds_of(info: dict[str, Any], num_envs: int) -> dict[str, Any]:
    """Return the dtype and shape of each info, all of which are arrays as libraries need them."""
    kinds = {}
    for key, value in info.items():
        if key.removeprefix("_") in ("final_obs", "final_info"):
            continue
        assert isinstance(value, np.ndarray), key
        assert value.flags.carray, key
        assert value.flags.aligned, key
        # Other libraries take arrays over by this protocol.
        assert np.array_equal(np.from_dlpack(value), value), key
        kinds[key] = value.dtype.name, value.shape[1:]
        assert value.shape[:1] == (num_envs,), key
    masks = {key for key in kinds if key.startswith("_")}
    assert masks == {f"_{key}" for key in kinds if key not in masks}
    assert {kinds[key] for key in masks} == {("bool", ())}
    return {key: kind for key, kind in kinds.items() if key not in masks}


def copied(told: Any) -> Any:
    """Return a deep copy of what an environment told."""
    if isinstance(told, dict):
        return {key: copied(value) for key, value in told.items()}
    if isinstance(told, tuple | list):
        return tuple(copied(value) for value in told)
    return told.copy() if isinstance(told, np.ndarray) else told


def walked(envs: LevelVectorEnv, steps: int, seed: Any = 0) -> list[Any]:
    """Take sampled actions and return all that is told, beginning anew where that is asked for."""
    told: list[Any] = [copied(envs.reset(seed=seed))]
    envs.action_space.seed(seed if isinstance(seed, int) else None)
    over = np.zeros(envs.num_envs, np.bool_)
    for _ in range(steps):
        if envs.metadata["autoreset_mode"] is AutoresetMode.DISABLED and over.any():
            told.append(copied(envs.reset(options={"reset_mask": over})))
        actions = envs.action_space.sample()
        result = envs.step(actions)
        told.append(copied((actions, *result)))
        over = result[2] | result[3]
    return told


def assert_same_from_here(one: LevelVectorEnv, other: LevelVectorEnv, steps: int) -> None:
    """Take the same sampled actions in two environments, which have to tell the same."""
    over = np.asarray(one._envs.done)
    for _ in range(steps):
        if one.autoreset_mode is AutoresetMode.DISABLED and over.any():
            mask = over.copy()
            assert same(*(each.reset(options={"reset_mask": mask}) for each in (one, other)))
        actions = one.action_space.sample()
        assert same(actions, other.action_space.sample())
        assert same(one.step(actions), other.step(actions))


def single(levels: Sequence[Level], **kwargs: Any) -> Single:
    """Return what makes single environments of levels, as `LevelVectorEnv` has them play these."""
    return lambda number: gymnasium.make(
        "babyrobot/Level-v0", level=levels[number % len(levels)], **kwargs
    )


def assert_same_walks(ours: Any, make: Single, seeds: list[Any], steps: int = 40) -> None:
    """Walk a vector environment and single ones with the same seeds, and compare all they tell."""
    mode = ours.metadata["autoreset_mode"]
    theirs = SyncVectorEnv(
        [lambda number=number: make(number) for number in range(SIZE)],  # type: ignore[misc]
        autoreset_mode=mode,
    )
    rng = np.random.default_rng(1)
    told: Any = ours.reset(seed=seeds)
    wanted: Any = theirs.reset(seed=seeds)
    assert same(told[0], wanted[0])
    assert_same_info(told[1], wanted[1])
    over = np.zeros(SIZE, np.bool_)
    for _ in range(steps):
        if mode is AutoresetMode.DISABLED and over.any():
            # Some begin with new seeds, and the seeds of the others count for nothing.
            new: Any = [*rng.integers(9, size=SIZE - 1).tolist(), None]
            if rng.random() < 0.5:
                new = None
            told = ours.reset(seed=new, options={"reset_mask": over.copy()})
            wanted = theirs.reset(seed=new, options={"reset_mask": over.copy()})
            assert same(told[0], wanted[0])
            assert_same_info(told[1], wanted[1])
        actions = rng.integers(0, ours.single_action_space.n, SIZE)
        told, wanted = ours.step(actions), theirs.step(actions)
        for one, other in zip(told[:4], wanted[:4], strict=True):
            assert same(one, other), (one, other)
        assert_same_info(told[4], wanted[4])
        over = told[2] | told[3]
