"""The entry point of levels: it makes the environment that a level needs."""

from typing import Any

from babyrobot_levels.envs.arguments import check_names, checked_given
from babyrobot_levels.envs.single import LevelEnv, LevelLike
from babyrobot_levels.envs.team import TeamEnv
from babyrobot_levels.library.catalogue import load


def make_level(level: LevelLike | None = None, **kwargs: Any) -> LevelEnv:
    """Return a level's environment: the entry point of `babyrobot/Level-v0` and of all levels.

    Gymnasium adds the `TimeLimit`, which the spec knows.

    Args:
        level: a name, a path, a mapping or a `Level`.
        kwargs: the other arguments of `LevelEnv`.

    Raises:
        MissingArgument: there is no level.
        TypeError: there is no such argument.
    """
    check_names(kwargs, LevelEnv.__init__, "max_episode_steps", "level")
    given = load(checked_given("level", level))
    if given.robots:
        check_names(kwargs, TeamEnv.__init__, "max_episode_steps", "level")
        return TeamEnv(given, **kwargs)
    return LevelEnv(given, **kwargs)


make_level.metadata = LevelEnv.metadata  # type: ignore[attr-defined]
