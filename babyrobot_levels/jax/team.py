"""Levels with several robots as an environment of gymnax: one agent moves all of them."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Any, Unpack

import jax.numpy as jnp
import numpy as np
from gymnax.environments import spaces
from jax import Array
from jax.tree_util import register_dataclass

from babyrobot_levels.analysis.solver.results import check_count
from babyrobot_levels.envs.arguments import (
    ObservationOptions,
    checked_observation,
    limits_of,
    takes_observation,
)
from babyrobot_levels.envs.observations.base import Extent
from babyrobot_levels.envs.spaces import ActionSet
from babyrobot_levels.jax.env import EnvState, Info, LevelEnvironment
from babyrobot_levels.jax.loading import (
    MAX_BYTES,
    MOST_ROBOTS,
    LevelArrays,
    Loader,
    arrays_of,
    bounds_of,
    levels_in,
)
from babyrobot_levels.jax.observations import Room, look_up
from babyrobot_levels.jax.params import EnvParams, below, draw_words
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action
from babyrobot_levels.suites.suite import Levels


@register_dataclass
@dataclass(frozen=True)
class TeamParams(EnvParams):
    """Levels with several robots as arrays; actions are joint ones, numbered as in `Mdp`.

    Attributes:
        shares: float `[entries, robots]`: what each robot gets, of which `reward` is the sum.
    """

    shares: Array = field(kw_only=True)

    @property
    def num_robots(self) -> int:
        """How many robots there are."""
        return int(self.shares.shape[-1])

    @property
    def allowed(self) -> Array:
        """Which joint actions nothing refuses, bool `[states, actions]`."""
        masks, joint = self.masks(jnp.arange(self.num_states)), jnp.ones((self.num_states, 1), bool)
        for robot in range(self.num_robots):
            own = masks[:, None, robot] > 0
            joint = (joint[:, :, None] & own).reshape(self.num_states, -1)
        return joint

    def masks(self, states: Array) -> Array:
        """Return the action mask of each robot in states, int8 `[…, robots, 5]`."""
        places = np.arange(self.num_robots)[:, None] + MOST_ROBOTS * np.arange(NUM_ACTIONS)
        bits = look_up(self.mask, states)[..., None, None] >> places.astype(np.uint32)
        return (bits & 1).astype(jnp.int8)

    def _single(self, level: Array) -> EnvParams:
        raise ValueError("`take` is for levels with one robot")


class TeamLoader(Loader):
    """Puts levels with several robots into tables."""

    def _build(self, levels: Any, arrays: list[LevelArrays], room: Room) -> EnvParams:
        params = super()._build(levels, arrays, room)
        shares = []
        for robot in range(self.extent.robots):
            own = [*map(partial(self._own, robot), levels, arrays)]
            shares.append(super()._build(levels, own, room).reward)
        given = {each.name: getattr(params, each.name) for each in fields(params)}
        return TeamParams(**given, shares=jnp.stack(shares, -1))

    def _own(self, robot: int, level: Level, arrays: LevelArrays) -> LevelArrays:
        """Return a level whose rewards are what one robot gets."""
        part, mdp = self._part(level), level.compile()
        assert mdp.shares is not None
        own = mdp.shares[..., robot].reshape(part.columns["reward"].shape)
        part = replace(part, columns={**part.columns, "reward": own})
        nowhere = np.zeros(mdp.num_states, bool)
        return arrays_of(part, nowhere, arrays.limit, arrays.discount, arrays.observations)


class TeamEnvironment(LevelEnvironment):
    """Several robots as an environment of gymnax 1.0; made by `babyrobot_levels.jax.make_team`.

    An action is one of each robot, int32 `[robots]`: 0 stay, 1 north, 2 east, 3 south, 4 west.
    Rewards are the sum of what robots get; infos have its parts as `rewards`, float `[robots]`.
    `action_mask` is int8 `[robots, 5]`.
    """

    _params: TeamParams

    @property
    def num_robots(self) -> int:
        """How many robots there are."""
        return self._params.num_robots

    def transition(
        self, words: Array, state: EnvState, action: Any, params: EnvParams
    ) -> tuple[EnvState, Array, Array, Info]:
        """Take an action of each robot; see `LevelEnvironment.transition`."""
        powers = NUM_ACTIONS ** np.arange(self.num_robots - 1, -1, -1)
        each = jnp.clip(jnp.asarray(action, jnp.int32), 0, NUM_ACTIONS - 1)
        joint = (each * powers).sum(-1, dtype=jnp.int32)
        after, reward, terminated, info = super().transition(words, state, joint, params)
        assert isinstance(params, TeamParams)
        info["rewards"] = look_up(params.shares, self._entry(words, state, joint, params))
        return after, reward, terminated, info

    def action_mask(self, state: EnvState, params: EnvParams | None = None) -> Array:
        """Return the action mask of each robot, int8 `[robots, 5]`."""
        params = self._params if params is None else params
        assert isinstance(params, TeamParams)
        return params.masks(state.state)

    def sample_action(self, key: Array, state: EnvState, params: EnvParams | None = None) -> Array:
        """Return an allowed action of each robot, int32 `[robots]`, each as often."""
        counted = jnp.cumsum(self.action_mask(state, params), axis=-1, dtype=jnp.int32)
        place = below(draw_words(key, self.num_robots), counted[..., -1])
        return jnp.argmax(counted > place[..., None], axis=-1).astype(jnp.int32)

    def action_space(self, params: EnvParams | None = None) -> spaces.Box:
        """Return the space of actions."""
        return spaces.Box(0, NUM_ACTIONS - 1, (self.num_robots,), jnp.int32)


@takes_observation
def make_team(
    levels: Levels,
    *,
    draw_levels: bool = True,
    max_episode_steps: int | None = None,
    max_bytes: float = MAX_BYTES,
    **options: Unpack[ObservationOptions],
) -> tuple[TeamEnvironment, TeamParams]:
    """Return levels with several robots as an environment of gymnax, and as its parameters.

    Observations, rewards and ends of episodes are those of `TeamVectorEnv`.

    Args:
        levels: levels with as many robots each, as `make` takes them.
        draw_levels: as for `make`.
        max_episode_steps: as for `make`.
        max_bytes: as for `make`.
        options: the observation, and its options, as `TeamEnv` has them.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid, or has too many joint states for tables.
        ValueError: levels have one robot, or different numbers; the arrays would take too much
            memory; or another argument is invalid.
    """
    chosen = checked_observation(**options)
    limits_of((), max_episode_steps)
    given = [*levels_in(levels)]
    counts = {len(level.robots) for level in given}
    if len(counts) > 1 or 0 in counts:
        raise ValueError("all levels must have several robots, and the same number of them")
    loader = TeamLoader(
        chosen,
        bounds_of(given),
        Extent.of(given),
        ActionSet(Action.STAY, True, team=True),
        bool(draw_levels),
        max_episode_steps,
        check_count("max_bytes", int(max_bytes) if isinstance(max_bytes, float) else max_bytes),
    )
    params, room = loader.make(given, ())
    assert isinstance(params, TeamParams)
    name = given[0].name if len(given) == 1 else None
    return TeamEnvironment(params, loader, room, name or f"{len(given):,} levels"), params
