"""Environments of Gymnasium: levels, which a later room has registered, and what is compared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from babyrobot_levels.mdp.gridworld import LevelLike, world_of
from babyrobot_levels.text.errors import BabyRobotError

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


class ComparisonError(BabyRobotError, ValueError):
    """What was given cannot be compared with a level."""

    __module__ = "babyrobot_levels"


@dataclass(frozen=True)
class Certificate:
    """The result of comparing a level with another MDP.

    Attributes:
        equal: whether the two are equivalent: the same starts, and the same outcomes of all
            actions in all states that an episode reaches.
        actions: for each action of the other, the level's own number of it (`brl.Action`; three
            actions are left, right and forward). Where the MDPs differ, those under which they
            differ least; None if no actions were compared.
        states: the number of states whose outcomes were compared: those that an episode reaches,
            without the terminal ones.
        outcomes: the number of distinct outcomes of the level that were compared.
        everywhere: whether the states that no episode reaches agree as well.
        difference: the first difference as text; None if there is none.
        digest: the level's digest.
    """

    __module__ = "babyrobot_levels"

    equal: bool
    actions: tuple[int, ...] | None
    states: int
    outcomes: int
    everywhere: bool
    difference: str | None
    digest: str


def made(env_id: str, kwargs: Mapping[str, Any] | None) -> Any:
    """Return an environment of Gymnasium.

    Raises:
        ComparisonError: it cannot be made.
    """
    import gymnasium

    try:
        return gymnasium.make(env_id, **(kwargs or {}))
    except gymnasium.error.Error as error:
        raise ComparisonError(str(error)) from error
    except Exception as error:  # An environment's own code can raise anything.
        message = f"{type(error).__name__}: {error}"
        raise ComparisonError(f"Gymnasium cannot make {env_id!r}: {message}") from error
