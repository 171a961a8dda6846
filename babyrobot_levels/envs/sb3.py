"""A level's vector environment as a `VecEnv` of Stable-Baselines3."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.vector.base import LEVEL_ATTRIBUTES
from babyrobot_levels.envs.vector.env import LevelVectorEnv
from babyrobot_levels.text.errors import how_to_install

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as fault:
    raise ImportError(
        f"babyrobot_levels.envs.sb3 needs Stable-Baselines3: {how_to_install('sb3')}"
    ) from fault

from babyrobot_levels.envs.single import LevelLike

_Indices = None | int | Iterable[int]
_Step = tuple[Any, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]


class LevelVecEnv(VecEnv):
    """Many environments that step in one call, as a `VecEnv`.

    It is a `LevelVectorEnv` with `SAME_STEP` autoreset that returns what a `DummyVecEnv` of single
    environments returns: float32 rewards, one array of `dones`, and a dict for each environment,
    with `TimeLimit.truncated` and, where an episode is over, `terminal_observation`. It works with
    `VecMonitor`, and has `action_masks` for sb3-contrib's `MaskablePPO`.

    Attributes:
        envs: the `LevelVectorEnv`.
    """

    def __init__(
        self, level: LevelLike | None = None, *, num_envs: int | None = None, **kwargs: Any
    ) -> None:
        """Make the environment.

        Args:
            level: a name, a path, a mapping or a `Level`.
            num_envs: how many environments there are.
            kwargs: the other arguments of `LevelVectorEnv`, except for `autoreset_mode` and
                `copy`.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid.
            ValueError: another argument is invalid.
        """
        self.envs = LevelVectorEnv(
            level, num_envs=num_envs, autoreset_mode="SameStep", copy=True, **kwargs
        )
        super().__init__(
            self.envs.num_envs, self.envs.single_observation_space, self.envs.single_action_space
        )
        self.metadata = self.envs.metadata
        self._actions: Any = None

    # -- episodes --------------------------------------------------------------------------

    def reset(self) -> Any:
        """Start episodes, with the seeds and options of `seed` and `set_options`.

        Returns:
            The observations, `[num_envs, …]`, or a dict of such arrays; `reset_infos` has an info
            for each environment.

        Raises:
            ValueError: the options are invalid, or not the same for all environments.
        """
        given = self._options
        # Options are for one reset, even if it is refused.
        self._reset_options()
        options = given[0]
        if any(each != options for each in given):
            raise ValueError("all environments need the same options: set_options({...})")
        seeds = None if self._seeds[0] is None else self._seeds
        observations, info = self.envs.reset(seed=seeds, options=options)
        self.reset_infos = _rows(info, range(self.num_envs))
        self._reset_seeds()
        return observations

    def step_async(self, actions: Any) -> None:
        """Store the actions, whole numbers `[num_envs]`, for `step_wait`."""
        self._actions = actions

    def step_wait(self) -> _Step:
        """Take the actions.

        Returns:
            Observations `[num_envs, …]`, those of the next episode where one is over, rewards
            (float32 `[num_envs]`), dones (bool `[num_envs]`), and an info for each environment.
        """
        observations, rewards, terminated, truncated, info = self.envs.step(self._actions)
        dones = terminated | truncated
        ends, final = info.pop("final_obs", None), info.pop("final_info", None)
        infos = _rows(info, range(self.num_envs))
        if final is not None:
            done = dones.nonzero()[0].tolist()
            for number, info_of_end in zip(done, _rows(final, done), strict=True):
                # After an autoreset, the info of the step is about the next episode.
                self.reset_infos[number] = infos[number]
                infos[number] = info_of_end
                info_of_end["terminal_observation"] = ends[number]
        for each, is_cut in zip(infos, (truncated & ~terminated).tolist(), strict=True):
            each["TimeLimit.truncated"] = is_cut
        return observations, rewards.astype(np.float32), dones, infos

    def close(self) -> None:
        """Release the painters."""
        self.envs.close()

    # -- attributes ------------------------------------------------------------------------

    def has_attr(self, attr_name: str) -> bool:
        """Return whether environments have an attribute or a method."""
        return hasattr(self.envs, attr_name) or attr_name in LEVEL_ATTRIBUTES

    def get_attr(self, attr_name: str, indices: _Indices = None) -> list[Any]:
        """Return the value of an attribute for each environment; see `LevelVectorEnv.call`."""
        if attr_name in ("action_space", "observation_space"):
            attr_name = f"single_{attr_name}"
        return self.env_method(attr_name, indices=indices)

    def set_attr(self, attr_name: str, value: Any, indices: _Indices = None) -> None:
        """Set an attribute, which all environments share; see `LevelVectorEnv.set_attr`.

        Raises:
            AttributeError: the attribute cannot be set.
            ValueError: the indices are not those of all environments, or the value is invalid.
        """
        if set(self._get_indices(indices)) != set(range(self.num_envs)):
            raise ValueError("environments share their attributes: set them without indices")
        self.envs.set_attr(attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: _Indices = None, **method_kwargs: Any
    ) -> list[Any]:
        """Return the result of a method for each environment; see `LevelVectorEnv.call`."""
        results = self.envs.call(method_name, *method_args, **method_kwargs)
        return [results[number] for number in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: Any, indices: _Indices = None) -> list[bool]:
        """Return False for each environment: single environments are never wrapped."""
        return [False for _ in self._get_indices(indices)]

    def get_images(self) -> list[Any]:
        """Return a picture of each environment, uint8 `[height, width, 3]`; see `render`."""
        return list(self.envs.render() or [None] * self.num_envs)


def _rows(info: dict[str, Any], which: Sequence[int]) -> list[dict[str, Any]]:
    """Return the info of each environment from that of a vector environment.

    Args:
        info: values `[num_envs, …]`, and for each key another one with `_` before it: where the
            value holds.
        which: the environments.
    """
    index = np.asarray(which, np.intp)
    names = [name for name in info if f"_{name}" in info]
    columns = [info[name][index] for name in names]
    # Lists are faster to iterate over; of an array with more dimensions, each gets a row.
    lists = [column if column.ndim > 1 else column.tolist() for column in columns]
    rows = [dict(zip(names, values, strict=True)) for values in zip(*lists, strict=True)]
    for name in names:
        for number in (~info[f"_{name}"][index]).nonzero()[0].tolist():
            del rows[number][name]
    return rows
