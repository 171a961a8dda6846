"""Levels as environments, which a later room has registered with Gymnasium."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from babyrobot_levels.mdp.gridworld import LevelLike, world_of

if TYPE_CHECKING:
    import gymnasium


def make(level: LevelLike, **kwargs: Any) -> gymnasium.Env[Any, Any]:
    """Return a level as a Gymnasium environment; `max_steps` becomes its time limit.

    Args:
        level: a name, a path, a share code, a mapping or a `Level`.
        kwargs: what `gymnasium.make("babyrobot/Level-v0", …)` takes beside `level`:
            `observation`, `actions`, `render_mode`, `image_size`, `grayscale`, `view_radius`,
            `see_through`, `channels_last`, `planes_dtype`. A `max_episode_steps` takes the
            place of the level's `max_steps`, -1 of any limit.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid.
    """
    import gymnasium

    return gymnasium.make("babyrobot/Level-v0", level=world_of(level), **kwargs)
