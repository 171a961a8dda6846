"""Thousands of robots for Stable-Baselines3: a level's vector environment as its `VecEnv`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.vector.env import LevelVectorEnv

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as fault:
    raise ImportError(
        "babyrobot_levels.envs.sb3 needs Stable-Baselines3: pip install 'babyrobot-levels[sb3]'"
    ) from fault

if TYPE_CHECKING:
    from babyrobot_levels.envs.single import LevelLike

_Indices = None | int | Iterable[int]
_Step = tuple[NDArray[Any], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]


class LevelVecEnv(VecEnv):
    """Many robots walk levels, as Stable-Baselines3 and sb3-contrib want to be told of it.

    It is a `LevelVectorEnv` whose episodes begin anew in the step that ends them, and gives what
    a `DummyVecEnv` of single environments gives: float32 rewards, one array of `dones`, and a
    dict for each robot, with `TimeLimit.truncated` and, where an episode is over,
    `terminal_observation`. `VecMonitor` adds the returns of episodes, and `action_masks` is there
    for `MaskablePPO`.

    Attributes:
        envs: the `LevelVectorEnv`.
    """

    def __init__(
        self, level: LevelLike | None = None, *, num_envs: int | None = None, **kwargs: Any
    ) -> None:
        """Make the environment.

        Args:
            level: a name, a path, a mapping or a `Level`.
            num_envs: how many robots there are.
            kwargs: what `LevelVectorEnv` takes beside them, but for `autoreset_mode` and `copy`.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid.
            ValueError: another argument has a value that it cannot have.
        """
        self.envs = LevelVectorEnv(
            level, num_envs=num_envs, autoreset_mode="SameStep", copy=True, **kwargs
        )
        super().__init__(
            self.envs.num_envs, self.envs.single_observation_space, self.envs.single_action_space
        )
        self.metadata = self.envs.metadata
        self._actions: Any = None

    # -- playing ---------------------------------------------------------------------------

    def reset(self) -> NDArray[Any]:
        """Begin episodes, with the seeds and options that `seed` and `set_options` told.

        Returns:
            The observations, `[num_envs, …]`; `reset_infos` has an info for each robot.

        Raises:
            ValueError: the options are not the same for all robots, or cannot be.
        """
        told = self._options
        # Options are for one reset, also if that is refused.
        self._reset_options()
        options = told[0]
        if any(each != options for each in told):
            raise ValueError("all robots begin with the same options: set_options({...})")
        seeds = None if self._seeds[0] is None else self._seeds
        observations: NDArray[Any]
        observations, info = self.envs.reset(seed=seeds, options=options)
        self.reset_infos = _rows(info, slice(None))
        self._reset_seeds()
        return observations

    def step_async(self, actions: Any) -> None:
        """Note the actions, whole numbers `[num_envs]`, that `step_wait` takes."""
        self._actions = actions

    def step_wait(self) -> _Step:
        """Take the actions.

        Returns:
            Observations `[num_envs, …]`, of new episodes where one is over, rewards (float32
            `[num_envs]`), dones (bool `[num_envs]`), and an info for each robot.
        """
        observations, rewards, terminated, truncated, info = self.envs.step(self._actions)
        dones = terminated | truncated
        ends, final = info.pop("final_obs", None), info.pop("final_info", None)
        infos = _rows(info, slice(None))
        if final is not None:
            over = dones.nonzero()[0]
            for robot, told in zip(over.tolist(), _rows(final, over), strict=True):
                # What the step tells of a robot that has begun anew is about the new episode.
                self.reset_infos[robot] = infos[robot]
                infos[robot] = told
                told["terminal_observation"] = ends[robot]
        for told, cut in zip(infos, (truncated & ~terminated).tolist(), strict=True):
            told["TimeLimit.truncated"] = cut
        return observations, rewards.astype(np.float32), dones, infos

    def close(self) -> None:
        """Let go of the pictures."""
        self.envs.close()

    # -- one robot of many -----------------------------------------------------------------

    def has_attr(self, attr_name: str) -> bool:
        """Return whether robots have an attribute or a method, `action_masks` among them."""
        return hasattr(self.envs, attr_name) or attr_name == "level"

    def get_attr(self, attr_name: str, indices: _Indices = None) -> list[Any]:
        """Return what an attribute is for each robot, as `LevelVectorEnv.get_attr` does."""
        if attr_name in ("action_space", "observation_space"):
            attr_name = f"single_{attr_name}"
        return self.env_method(attr_name, indices=indices)

    def set_attr(self, attr_name: str, value: Any, indices: _Indices = None) -> None:
        """Set an attribute of all robots, which share them, as `LevelVectorEnv.set_attr` does.

        Raises:
            AttributeError: it is none that can be set.
            ValueError: only some of the robots are named, or the attribute cannot have this value.
        """
        if set(self._get_indices(indices)) != set(range(self.num_envs)):
            raise ValueError("robots share their attributes: set them for all, without indices")
        self.envs.set_attr(attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: _Indices = None, **method_kwargs: Any
    ) -> list[Any]:
        """Return what a method says for each robot, as `LevelVectorEnv.call` does."""
        answers = self.envs.call(method_name, *method_args, **method_kwargs)
        return [answers[robot] for robot in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: Any, indices: _Indices = None) -> list[bool]:
        """Return False for each robot: there are no wrappers of single environments."""
        return [False for _ in self._get_indices(indices)]

    def get_images(self) -> list[Any]:
        """Return one picture, uint8 `[height, width, 3]`: the first 16 robots side by side."""
        return [self.envs.render()]


def _rows(info: dict[str, Any], which: Any) -> list[dict[str, Any]]:
    """Return what a vector environment's info tells of each robot.

    Args:
        info: values `[num_envs, …]`, and under their names with `_` before it, where they hold.
        which: the robots, as an index of these arrays.
    """
    names = [name for name in info if f"_{name}" in info]
    columns = [info[name][which] for name in names]
    # Lists are what is quick to walk through; of arrays in arrays, robots get the rows.
    lists = [column if column.ndim > 1 else column.tolist() for column in columns]
    rows = [dict(zip(names, values, strict=True)) for values in zip(*lists, strict=True)]
    for name in names:
        for robot in (~info[f"_{name}"][which]).nonzero()[0].tolist():
            del rows[robot][name]
    return rows
