"""Levels as environments of libraries whose interface is not that of gymnax 1.0."""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
from gymnax.environments import spaces
from jax import Array

from babyrobot_levels.jax.env import EnvState, Info, LevelEnvironment
from babyrobot_levels.jax.params import EnvParams


class UnderspecifiedEnv:
    """Levels as an environment of JaxUED: each episode is in a level that is given.

    It has the methods of JaxUED's class of this name, which wrappers call, and does not need JaxUED
    itself. A level is its number in the params, int32, so that `jnp.arange(params.num_levels)` is
    the batch of all levels.
    """

    def __init__(self, env: LevelEnvironment) -> None:
        """Wrap an environment that `babyrobot_levels.jax.make` returned."""
        self._env = env

    @property
    def default_params(self) -> EnvParams:
        """The levels that the environment was made with."""
        return self._env.default_params

    @partial(jax.jit, static_argnames=("self",))
    def reset_to_level(
        self, rng: Array, level: Any, params: EnvParams | None = None
    ) -> tuple[Any, EnvState]:
        """Start an episode in a level.

        Args:
            rng: the source of randomness.
            level: int32: the number of the level.
            params: the levels.

        Returns:
            The observation and the state.
        """
        begun: tuple[Any, EnvState] = self._env.reset_to_level(rng, level, params)
        return begun

    @partial(jax.jit, static_argnames=("self",))
    def step(
        self, rng: Array, state: EnvState, action: Any, params: EnvParams | None = None
    ) -> tuple[Any, EnvState, Array, Array, Info]:
        """Take an action. There is no reset when the episode is over: wrappers of JaxUED do it.

        Args:
            rng: the source of randomness.
            state: the state.
            action: int32.
            params: the levels.

        Returns:
            The observation, the state, the reward, whether the episode is over, and the info of
            `LevelEnvironment.step` without `final_observation`.
        """
        params = self.default_params if params is None else params
        observation, after, reward, terminated, info = self._env.step_env(
            rng, state, action, params
        )
        truncated = self._env.is_truncated(after, params)
        info |= {"terminated": terminated, "truncated": truncated}
        return observation, after, reward, terminated | truncated, info

    def action_space(self, params: EnvParams | None = None) -> spaces.Discrete:
        """Return the space of actions."""
        return self._env.action_space(params)
