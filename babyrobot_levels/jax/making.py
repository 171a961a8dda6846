"""Making environments from levels."""

from __future__ import annotations

from typing import Unpack

from babyrobot_levels.envs.action_sets import ACTION_SETS
from babyrobot_levels.envs.arguments import (
    ObservationOptions,
    check_choice,
    checked_observation,
    takes_observation,
)
from babyrobot_levels.envs.engine.factory import checked_count, limits_of
from babyrobot_levels.envs.suite import extent_of
from babyrobot_levels.jax.env import LevelEnvironment
from babyrobot_levels.jax.loading import MAX_BYTES, Loader, bounds_of, levels_in
from babyrobot_levels.jax.params import EnvParams
from babyrobot_levels.suites.named import Levels
from babyrobot_levels.suites.sources import Bounds
from babyrobot_levels.suites.suite import Suite


@takes_observation
def make(
    levels: Levels,
    *,
    actions: str = "valid",
    draw_levels: bool = True,
    room_for: Levels | None = None,
    max_episode_steps: int | None = None,
    max_bytes: int = MAX_BYTES,
    **options: Unpack[ObservationOptions],
) -> tuple[LevelEnvironment, EnvParams]:
    """Return levels as an environment of gymnax, and as its parameters.

    The tables of all levels are made at once. Observations, actions, rewards and ends of
    episodes are those of `LevelVectorEnv` with the same arguments.

    Args:
        levels: a level, a folder, a pack or a suite: a name, a path, a mapping, a `Level` or a
            `Suite`; or several levels.
        actions: `"valid"`, `"all"`, `"moves"`, `"valid_moves"` or `"turns"`. There is no difference
            between `"valid"` and `"all"`, or `"valid_moves"` and `"moves"`: `sample_action` gives
            valid actions, and the action space all.
        draw_levels: whether each episode draws its level: all equally often, or by the weights of
            the suite. If not, `reset` draws it, and later episodes stay in it.
        room_for: further levels, as `levels`: `load` can then put any levels into the arrays that
            are not larger than the largest of all these. By default, levels that are not larger
            altogether.
        max_episode_steps: the time limit of episodes, -1 for none. By default, each level's
            `max_steps`.
        max_bytes: how much memory the arrays may take; while they are made, it is about three
            times as much. Transitions take 9 bytes for each state and action, and 17 for each
            outcome where there are several. Observations take 4 bytes for each number of each
            state, views an eighth of a byte, images one; planes are kept once for each
            configuration.
        options: the observation, and its options, as `LevelEnv` has them.

    Returns:
        The environment, and the parameters that its methods take.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
        UnsatisfiableError: no level meets the conditions of a suite.
        ValueError: the arrays would take too much memory, there are no levels, one has
            `maze: {seed: random}`, or another argument is invalid.
    """
    chosen = checked_observation(**options)
    check_choice("actions", actions, ACTION_SETS)
    limits_of((), max_episode_steps)
    given = levels_in(levels)
    others = () if room_for is None else levels_in(room_for)
    bounds = Bounds.joined([bounds_of(given), bounds_of(others)])
    action_set = ACTION_SETS[actions]
    loader = Loader(
        chosen,
        bounds,
        extent_of(bounds, turns=action_set.turns),
        action_set,
        bool(draw_levels),
        max_episode_steps,
        checked_count("max_bytes", max_bytes),
    )
    params, room = loader.make(given, others)
    name = given.name if isinstance(given, Suite) else given[0].name if len(given) == 1 else None
    return LevelEnvironment(params, loader, room, name or f"{len(given):,} levels"), params
