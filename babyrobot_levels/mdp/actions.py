"""The actions: numbers, moves, and objects with a policy. Separate, because it needs no NumPy."""

from enum import IntEnum
from operator import index
from typing import Any, Protocol, Self

from babyrobot_levels.text.words import TellingEnum, meant


class _Named(IntEnum, metaclass=TellingEnum):
    """Numbers that are words, too: `str(Action(3))` is `south`, which `Action("south")` takes."""

    def __str__(self) -> str:
        return self.name.lower().replace("_", "-")

    def __format__(self, spec: str) -> str:
        return format(int(self) if spec[-1:].isalpha() else str(self), spec)

    @classmethod
    def _missing_(cls, value: object) -> Self:
        words = {str(each): each for each in cls}
        if found := words.get(str(value).lower()):
            return found
        told = (
            meant(str(value), [each.name for each in cls], "attributes").lower().replace("_", "-")
        )
        raise ValueError(f"there is no {cls.__name__.lower()} {value!r}{told}")


class Action(_Named):
    """The actions, with the numbers that environments use."""

    __module__ = "babyrobot_levels"

    STAY = 0
    NORTH = 1
    EAST = 2
    SOUTH = 3
    WEST = 4
    NORTH_EAST = 5
    SOUTH_EAST = 6
    SOUTH_WEST = 7
    NORTH_WEST = 8


NUM_MOVES = 4
NUM_ACTIONS = NUM_MOVES + 1
"""How many moves and actions a robot has, unless a level says `moves: 8`."""

MOVES = tuple(Action)[1:NUM_ACTIONS]
"""The moves to the sides of a cell."""

DELTAS: dict[Action, tuple[int, int]] = {
    Action.NORTH: (0, -1),
    Action.EAST: (1, 0),
    Action.SOUTH: (0, 1),
    Action.WEST: (-1, 0),
    Action.NORTH_EAST: (1, -1),
    Action.SOUTH_EAST: (1, 1),
    Action.SOUTH_WEST: (-1, 1),
    Action.NORTH_WEST: (-1, -1),
}
"""How each move changes the cell, `(dx, dy)`: x grows to the east, y to the south."""


class Turn(_Named):
    """The actions of a robot that turns, as in MiniGrid."""

    __module__ = "babyrobot_levels"

    LEFT = 0
    RIGHT = 1
    FORWARD = 2


HEADINGS = 4
"""The directions in which a robot that turns can look: 0 N, 1 E, 2 S, 3 W."""


class HasPolicy(Protocol):
    """An object with a policy and the numbering of its actions, such as a `Solution`."""

    @property
    def policy(self) -> Any:
        """An action for each cell, int `[height, width]`."""

    @property
    def first_action(self) -> int:
        """The `Action` that is number 0 in `policy`."""


def unwrapped_policy(policy: Any) -> tuple[Any, int | None]:
    """Return a policy and the `Action` that is number 0 in it.

    The latter is None for a policy without a numbering of its own, such as a plain array.
    """
    first = getattr(policy, "first_action", None)
    return (policy if first is None else getattr(policy, "policy", policy)), first


def drawn_policy(policy: Any) -> tuple[Any, int | None]:
    """Return what a picture shows of a policy: its table, and the `Action` that is number 0 in it.

    Of a solution it shows several actions in a cell, if all of them end the episode soonest.
    """
    table, first = unwrapped_policy(policy)
    return getattr(policy, "fastest", getattr(table, "policy", table)), first


def checked_number(what: str, given: Any, count: int, help_text: str) -> int:
    """Return the number of a state or an action.

    Raises:
        TypeError: it is no whole number.
        IndexError: there is none of this number.
    """
    try:
        number = index(given)
    except TypeError:
        raise TypeError(f"{what} must be 0 to {count - 1}, not {given!r}; {help_text}") from None
    if not 0 <= number < count:
        raise IndexError(f"{what} must be 0 to {count - 1}, not {number}; {help_text}")
    return number
