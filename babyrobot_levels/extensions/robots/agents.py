"""The function that gives an agent to each robot; it needs PettingZoo only when it is called."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from babyrobot_levels.library.catalogue import LevelLike

if TYPE_CHECKING:
    from babyrobot_levels.extensions.robots.parallel import LevelParallelEnv


def parallel_env(level: LevelLike, **options: Any) -> LevelParallelEnv:
    """Return a level with several robots as PettingZoo's `ParallelEnv`, an agent for each robot.

    Args:
        level: a name, a path, a mapping or a `Level`.
        options: the other arguments of `LevelParallelEnv`: `rewards`, `max_cycles`, `render_mode`,
            and those of observations.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid.
        ValueError: another argument is invalid, or the level has one robot.
        ImportError: PettingZoo is not installed.
    """
    from babyrobot_levels.extensions.robots.parallel import LevelParallelEnv

    return LevelParallelEnv(level, **options)
