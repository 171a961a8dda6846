"""Random walks in compiled loops of JAX: the same loop for the environments of every library.

Each pass of the loop draws random actions and the environments' keys, steps all environments, which
start their next episodes by themselves, and carries on the observations, so that none is left out
as unused. Rewards and ends of episodes are added up for each environment. Infos are not used, by no
library.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from timing import Measure, needing

SECONDS = 0.2
"""About how long a measurement lasts."""

Walk = Callable[[int], Measure]
"""Returns a measure of the steps per second of a number of environments."""


def walk(
    num_envs: int,
    num_actions: int,
    reset: Callable[[Any], tuple[Any, Any]],
    step: Callable[[Any, Any, Any], tuple[Any, Any, Any, Any]],
) -> Measure:
    """Return a measure of the steps per second of a walk, which each call carries on.

    Args:
        num_envs: how many environments there are.
        num_actions: how many actions they have.
        reset: takes a key; returns observations and states.
        step: takes a key, states and actions; returns observations, states, rewards and whether
            episodes are over.
    """
    import jax
    import jax.numpy as jnp

    def once(_: Any, carry: Any) -> Any:
        key, state, _, returns, episodes = carry
        key, key_actions, key_step = jax.random.split(key, 3)
        words = jax.random.bits(key_actions, (num_envs,), jnp.uint16)
        actions = words.astype(jnp.int32) * num_actions >> 16
        observation, state, reward, done = step(key_step, state, actions)
        return key, state, observation, returns + reward, episodes + done

    # The number of steps is no constant, so that one compiled loop takes any.
    run = jax.jit(lambda steps, carry: jax.lax.fori_loop(0, steps, once, carry), donate_argnums=1)
    observation, state = jax.jit(reset)(jax.random.key(0))
    # A copy of all: what is donated must not be used elsewhere.
    carry = jax.tree.map(
        jnp.copy,
        (jax.random.key(1), state, observation, jnp.zeros(num_envs), jnp.zeros(num_envs, int)),
    )
    steps = 1

    def took(count: int) -> float:
        nonlocal carry
        begin = time.perf_counter()
        carry = jax.block_until_ready(run(count, carry))
        return time.perf_counter() - begin

    took(steps)
    while (spent := took(steps)) < SECONDS / 2:
        steps = max(2 * steps, int(0.8 * steps * SECONDS / spent))
    return lambda: steps * num_envs / took(steps)


def level_walk(levels: str | Sequence[Any], **options: Any) -> Walk:
    """Return a walk in levels, by random moves.

    Args:
        levels: a level's name, or several levels, of which each episode draws one.
        options: further arguments of `babyrobot_levels.jax.make`.
    """

    def make(num_envs: int) -> Any:
        import babyrobot_levels.jax as brl_jax

        return _gymnax(num_envs, *brl_jax.make(levels, actions="moves", **options))

    return lambda num_envs: needing("jax gymnax", lambda: walk(num_envs, *make(num_envs)))


def team_walk(level: str) -> Walk:
    """Return a walk of several robots, by random actions of each."""

    def make(num_envs: int) -> Any:
        import babyrobot_levels.jax as brl_jax

        env, params = brl_jax.make_team(level)
        actions, reset, step = _gymnax(num_envs, env, params)
        powers = [5**number for number in reversed(range(env.num_robots))]

        def step_all(key: Any, state: Any, joint: Any) -> Any:
            import jax.numpy as jnp

            return step(key, state, joint[:, None] // jnp.array(powers) % 5)

        return actions, reset, step_all

    return lambda num_envs: needing("jax gymnax", lambda: walk(num_envs, *make(num_envs)))


def jaxmarl_walk(name: str, layout: str) -> Walk:
    """Return a walk in a kitchen of JaxMARL, by random actions of each agent."""

    def make(num_envs: int) -> Any:
        import jax
        import jax.numpy as jnp
        import jaxmarl
        from jaxmarl.environments.overcooked import overcooked_layouts

        env = jaxmarl.make(name, layout=overcooked_layouts[layout])
        agents, choices = env.agents, env.action_space(env.agents[0]).n
        powers = jnp.array([choices**number for number in range(len(agents))])

        def reset(key: Any) -> Any:
            return jax.vmap(env.reset)(jax.random.split(key, num_envs))

        def step(key: Any, state: Any, joint: Any) -> Any:
            chosen = joint[:, None] // powers % choices
            actions = dict(zip(agents, chosen.T, strict=True))
            keys = jax.random.split(key, num_envs)
            observation, state, rewards, done, _ = jax.vmap(env.step)(keys, state, actions)
            return observation, state, rewards[agents[0]], done["__all__"]

        return choices ** len(agents), reset, step

    return lambda num_envs: needing("jax jaxmarl", lambda: walk(num_envs, *make(num_envs)))


def gymnax_walk(name: str, **options: Any) -> Walk:
    """Return a walk in an environment of gymnax.

    Args:
        name: `FrozenLake` or `FourRooms`.
        options: arguments of its class.
    """

    def make(num_envs: int) -> Any:
        from gymnax.environments.misc import frozen_lake, rooms

        made = {"FrozenLake": frozen_lake.FrozenLake, "FourRooms": rooms.FourRooms}
        env = made[name](**options)
        return _gymnax(num_envs, env, env.default_params)

    return lambda num_envs: needing("jax gymnax", lambda: walk(num_envs, *make(num_envs)))


def navix_walk(name: str) -> Walk:
    """Return a walk in an environment of navix; with symbolic observations, its default.

    Its states hold the pictures of all cells, 12 kB each. They are left out, for they only serve
    observations that are images, and with them it is many times slower.
    """

    def make(num_envs: int) -> Any:
        import jax
        import navix

        env = navix.make(name)
        pictures = env.reset(jax.random.key(0)).state.cache

        def kept(timestep: Any, cache: Any) -> Any:
            return timestep.replace(state=timestep.state.replace(cache=cache))

        def reset(key: Any) -> Any:
            first = jax.vmap(lambda key: kept(env.reset(key), None))(
                jax.random.split(key, num_envs)
            )
            return first.observation, first

        def one(timestep: Any, action: Any) -> Any:
            return kept(env.step(kept(timestep, pictures), action), None)

        def step(key: Any, timestep: Any, actions: Any) -> Any:
            after = jax.vmap(one)(timestep, actions)
            return after.observation, after, after.reward, after.step_type > 0

        return len(env.action_set), reset, step

    return lambda num_envs: needing("jax navix", lambda: walk(num_envs, *make(num_envs)))


def xminigrid_walk(name: str) -> Walk:
    """Return a walk in an environment of XLand-MiniGrid."""

    def make(num_envs: int) -> Any:
        import jax
        import xminigrid
        from xminigrid.wrappers import GymAutoResetWrapper

        inner, params = xminigrid.make(name)
        env = GymAutoResetWrapper(inner)

        def reset(key: Any) -> Any:
            first = jax.vmap(env.reset, (None, 0))(params, jax.random.split(key, num_envs))
            return first.observation, first

        def step(key: Any, timestep: Any, actions: Any) -> Any:
            after = jax.vmap(env.step, (None, 0, 0))(params, timestep, actions)
            return after.observation, after, after.reward, after.last()

        return env.num_actions(params), reset, step

    return lambda num_envs: needing("jax xminigrid", lambda: walk(num_envs, *make(num_envs)))


def _gymnax(num_envs: int, env: Any, params: Any) -> Any:
    """Return the actions, resets and steps of an environment with gymnax's interface."""
    import jax

    def reset(key: Any) -> Any:
        return jax.vmap(env.reset, (0, None))(jax.random.split(key, num_envs), params)

    def step(key: Any, state: Any, actions: Any) -> Any:
        keys = jax.random.split(key, num_envs)
        observation, state, reward, terminated, truncated, _ = jax.vmap(env.step, (0, 0, 0, None))(
            keys, state, actions, params
        )
        return observation, state, reward, terminated | truncated

    return env.num_actions, reset, step
