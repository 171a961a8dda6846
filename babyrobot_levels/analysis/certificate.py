"""The result of a comparison, what refuses one, and environments to compare with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from babyrobot_levels.text.errors import BabyRobotError


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
