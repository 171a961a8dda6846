"""Specs of levels by name. The file of a level is read when its spec is used."""

from __future__ import annotations

from gymnasium import error
from gymnasium.envs.registration import EnvSpec, parse_env_id

from babyrobot_levels.library.catalogue import find
from babyrobot_levels.text.errors import LevelError, LevelNotFoundError
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.reader import read

SINGLE = "babyrobot_levels.envs.single:LevelEnv"
VECTOR = "babyrobot_levels.envs.vector.env:LevelVectorEnv"


class LevelSpec(EnvSpec):
    """The spec of a level of the catalogue.

    There may be thousands of levels, so importing Gymnasium must not read their files.

    Attributes:
        level: the level's name. `kwargs` has it too, but Gymnasium's `make_vec` empties `kwargs`.
    """

    level: str | None = None

    @property
    def max_episode_steps(self) -> int | None:
        """The time limit of an episode: the one that was set, or the level's `max_steps`."""
        if self._steps is None and self.level is not None:
            return _max_steps(self.level)
        return self._steps

    @max_episode_steps.setter
    def max_episode_steps(self, steps: int | None) -> None:
        self._steps = steps


def is_id(text: str) -> bool:
    """Return whether Gymnasium accepts a text as an id."""
    try:
        parse_env_id(text)
    except error.Error:
        return False
    # Gymnasium would import the part before a colon as a module.
    return ":" not in text


def level_spec(env_id: str, level: str) -> LevelSpec:
    """Return the spec under which a level is registered.

    The environments check the order of calls themselves (`ResetNeeded`), without Gymnasium's
    wrapper for it, because `render` is allowed before `reset`.
    """
    spec = LevelSpec(
        env_id,
        entry_point=SINGLE,
        vector_entry_point=VECTOR,
        order_enforce=False,
        kwargs={"level": level},
    )
    spec.level = level
    return spec


def _max_steps(level: str) -> int | None:
    """Return the `max_steps` of a level's file; None if the file is missing or invalid."""
    try:
        data = read(read_source(find(level))).data
    except (LevelNotFoundError, LevelError):
        return None
    steps = data.get("max_steps") if isinstance(data, dict) else None
    return steps if isinstance(steps, int) else None
