"""Making environments from levels, and exchanging the levels of one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from babyrobot_levels.envs.action_sets import ACTION_SETS
from babyrobot_levels.envs.arguments import check_choice, checked_observation
from babyrobot_levels.envs.engine.factory import limits_of
from babyrobot_levels.envs.engine.tables import part_of
from babyrobot_levels.envs.observations import make_observer
from babyrobot_levels.envs.observations.extent import Extent
from babyrobot_levels.envs.suite import suite_extent
from babyrobot_levels.generate.suites import Suite
from babyrobot_levels.jax.env import LevelEnvironment
from babyrobot_levels.jax.observations import gymnax_space, tables_of
from babyrobot_levels.jax.params import MAX_BYTES, EnvParams, params_of
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level


def make(
    levels: Any,
    *,
    observation: str | Sequence[str] = "position",
    actions: str = "valid",
    draw_levels: bool = True,
    max_episode_steps: int | None = None,
    image_size: tuple[int, int] | None = None,
    grayscale: bool = False,
    view_radius: int | None = None,
    see_through: bool = False,
    channels_last: bool = False,
    planes_dtype: str = "float32",
    max_bytes: int = MAX_BYTES,
) -> tuple[LevelEnvironment, EnvParams]:
    """Return levels as an environment of gymnax, and as its parameters."""
    chosen = checked_observation(
        observation, image_size, grayscale, view_radius, see_through, channels_last, planes_dtype
    )
    check_choice("actions", actions, ACTION_SETS)
    action_set = ACTION_SETS[actions]
    if isinstance(levels, Suite):
        extent = suite_extent(levels, turns=action_set.turns)
        loaded: tuple[Level, ...] = tuple(levels)
        name = levels.name
    else:
        several = isinstance(levels, Sequence) and not isinstance(levels, str)
        loaded = tuple(load(each) for each in (levels if several else [levels]))
        extent = Extent.of(loaded, turns=action_set.turns)
        name = loaded[0].name if len(loaded) == 1 else None
    parts = [part_of(level, action_set.tables(level), action_set.first) for level in loaded]
    counts = [part.state_info.size for part in parts]
    tables = tables_of(loaded, counts, chosen, extent)
    params = params_of(
        parts,
        limits_of(loaded, max_episode_steps),
        [level.discount for level in loaded],
        tables,
        draw_levels and len(loaded) > 1,
    )
    space = gymnax_space(make_observer(loaded[0], chosen, extent).space)
    return LevelEnvironment(params, space, name or f"{len(loaded)} levels"), params
