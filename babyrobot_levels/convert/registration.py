"""The environment id of PyPI babyrobot, for notebooks that use it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from babyrobot_levels.convert.setups import from_setup
from babyrobot_levels.envs.single import LevelEnv

if TYPE_CHECKING:
    import gymnasium

ID = "BabyRobot-v0"


def register_babyrobot() -> None:
    """Let `gymnasium.make("BabyRobot-v0", **setup)` play a setup of PyPI babyrobot as a level.

    An environment that is already registered under this id is replaced.
    """
    from gymnasium.envs.registration import register, registry

    # Gymnasium warns when an id is registered twice.
    registry.pop(ID, None)
    register(ID, entry_point=f"{__name__}:make_babyrobot", order_enforce=False)


def make_babyrobot(
    render_mode: str | None = None, action_space: str = "dynamic", **setup: Any
) -> gymnasium.Env[Any, Any]:
    """Return the environment of a keyword setup.

    Args:
        render_mode: a render mode of `LevelEnv`.
        action_space: `"dynamic"` samples only valid actions, `"discrete"` all five.
        setup: the keywords of the package; see `from_setup`.
    """
    from gymnasium.wrappers import TimeLimit

    actions = "valid" if action_space == "dynamic" else "all"
    level = from_setup(setup)
    env = LevelEnv(level, render_mode=render_mode, actions=actions)
    # This id's spec does not know the limit of a setup.
    return env if level.max_steps is None else TimeLimit(env, level.max_steps)


make_babyrobot.metadata = LevelEnv.metadata  # type: ignore[attr-defined]
