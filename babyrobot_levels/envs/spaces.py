"""Action spaces: what a robot may be told, and what of it is possible where it stands."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.mdp.actions import NUM_ACTIONS, NUM_MOVES, Action

ACTION_SETS = ("valid", "all", "moves")


class ValidActions(spaces.Discrete[Any]):
    """A `Discrete` whose `sample()` gives only actions that are possible where the robot stands.

    It equals a plain `Discrete` of its size, and contains all its actions: an impossible one can
    be taken too and is refused. The environment keeps `mask` up to date.
    """

    mask: NDArray[np.int8] | None = None
    """The possible actions, int8 `[actions]`; None before the environment has begun."""

    def sample(self, mask: Any = None, probability: Any = None) -> Any:
        """Return a possible action, each with equal probability.

        A `mask` or `probability` that is given is used in the place of the robot's.
        """
        if mask is not None or probability is not None or self.mask is None:
            return super().sample(mask, probability)
        possible = self.mask.nonzero()[0]
        return possible[self.np_random.integers(possible.size)]


def make_action_space(actions: str) -> tuple[spaces.Discrete[Any], int]:
    """Return the space of an action set, and the action that is its number 0.

    Args:
        actions: `"valid"`, `"all"` or `"moves"`.
    """
    if actions == "moves":
        return spaces.Discrete(NUM_MOVES), Action.NORTH
    space = ValidActions(NUM_ACTIONS) if actions == "valid" else spaces.Discrete(NUM_ACTIONS)
    return space, Action.STAY


_KEYS = {
    Action.STAY: " ",
    Action.NORTH: "w",
    Action.EAST: "d",
    Action.SOUTH: "s",
    Action.WEST: "a",
}

_ARROW_KEYS = {
    Action.NORTH: 0x40000052,
    Action.EAST: 0x4000004F,
    Action.SOUTH: 0x40000051,
    Action.WEST: 0x40000050,
}
"""Pygame's numbers of the arrow keys (they are SDL's)."""


def keys_of_actions(first_action: int) -> dict[tuple[int, ...], int]:
    """Return the number of the action that each key means, by pygame's number of the key.

    Args:
        first_action: the action that is the space's number 0.
    """
    keys = [(ord(letter), action) for action, letter in _KEYS.items()]
    keys += [(key, action) for action, key in _ARROW_KEYS.items()]
    return {(key,): action - first_action for key, action in keys if action >= first_action}
