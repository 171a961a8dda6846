"""Arrays of `show_info` that differ by configuration or heading: the part that a picture shows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from babyrobot_levels.mdp.actions import HEADINGS, NUM_ACTIONS, Action, Turn, drawn_policy
from babyrobot_levels.mdp.states import initial_configuration
from babyrobot_levels.render.scene.overlay import Overlay

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from babyrobot_levels.mdp.gridworld import GridWorld

_KEYS = {"values": (0,), "visits": (0,), "action_values": (1,), "policy": (0, 1)}
"""The keys of arrays over cells, with the numbers of axes that may come after the cells."""

_CACHED = 64
"""The number of overlays that are cached."""


@dataclass(frozen=True, slots=True)
class _Array:
    """An array over states: whether its first axes are configurations and headings."""

    table: NDArray[Any]
    by_configuration: bool
    by_heading: bool


@dataclass(eq=False)
class InfoParts:
    """The overlays of a mapping in which arrays differ by configuration or heading.

    Args:
        info: the mapping, as for `show_info`.
        level: the level.
        flat: returns the overlay of a mapping whose arrays are over cells alone.
    """

    info: Mapping[str, Any]
    level: GridWorld
    flat: Callable[[Mapping[str, Any], GridWorld], Overlay]
    _made: dict[tuple[int | None, int | None], Overlay] = field(default_factory=dict)

    @cached_property
    def _arrays(self) -> dict[str, _Array]:
        found = ((key, _array_of(self.info, key, self.level)) for key in _KEYS if key in self.info)
        return {key: array for key, array in found if array is not None}

    @cached_property
    def _extent(self) -> tuple[float, float] | None:
        """The lowest and highest finite value of all configurations and headings."""
        tables = [
            self._arrays[key].table for key in ("values", "action_values") if key in self._arrays
        ]
        numbers = [table[np.isfinite(table)] for table in tables]
        found = np.concatenate(numbers) if numbers else np.zeros(0)
        return (float(found.min()), float(found.max())) if found.size else None

    @property
    def differ(self) -> bool:
        """Whether there is such an array."""
        return bool(self._arrays)

    def __call__(self, configuration: int | None, heading: int | None) -> Overlay:
        """Return the overlay of a configuration and heading.

        Args:
            configuration: its number; None for the one in which episodes begin.
            heading: where the robot looks; None shows the largest value over all headings, and the
                moves forward that the policy takes if the robot looks that way.

        Raises:
            ValueError: the mapping does not fit the level.
        """
        if (configuration, heading) not in self._made:
            number = initial_configuration(self.level) if configuration is None else configuration
            parts = {key: _part(key, array, number, heading) for key, array in self._arrays.items()}
            if len(self._made) >= _CACHED:
                del self._made[next(iter(self._made))]
            overlay = replace(self.flat({**self.info, **parts}, self.level), extent=self._extent)
            self._made[configuration, heading] = overlay
        return self._made[configuration, heading]


def _array_of(info: Mapping[str, Any], key: str, level: GridWorld) -> _Array | None:
    """Return an array of a mapping that differs by configuration or heading, else None."""
    given = info[key]
    if key == "policy":
        table, first = drawn_policy(given)
    else:
        table, first = getattr(given, key, given), None
    if not hasattr(table, "shape"):
        return None
    width, height = level.size
    shape, cells = tuple(table.shape), (height, width)
    counts = level.compile().shape[:-2] if level.has_things else ()
    # Numbers of actions come after the cells, and turning has 3 of them.
    for by_heading in (False, True):
        axes = (*counts, *((HEADINGS,) if by_heading else ()), *cells)
        rest = shape[len(axes) :]
        if shape[: len(axes)] == axes and len(axes) > 2 and len(rest) in _KEYS[key]:
            numbers = np.asarray(table)
            if key == "policy" and by_heading and not rest and numbers.dtype.kind == "f":
                # Probabilities of moves, in a level of 4 by 4.
                continue
            if key == "policy" and first and not rest and not by_heading:
                numbers = np.where(numbers >= 0, numbers + first, numbers)
            return _Array(numbers, bool(counts), by_heading)
    return None


def _part(key: str, array: _Array, configuration: int, heading: int | None) -> NDArray[Any]:
    table = array.table[configuration] if array.by_configuration else array.table
    if not array.by_heading:
        return table
    if key == "policy":
        return _moves(_weights(table), heading)
    if key == "action_values":
        return _moves(table, heading)
    if heading is not None:
        return np.asarray(table[heading])
    return np.asarray(np.fmax.reduce(table) if key == "values" else np.nansum(table, axis=0))


def _weights(policy: NDArray[Any]) -> NDArray[np.float64]:
    """Return a policy of turns as the weight of each turn, `[4, height, width, 3]`."""
    if policy.ndim == 4:
        return np.asarray(policy, np.float64)
    weights = policy[..., np.newaxis] == np.arange(len(Turn))
    return np.asarray(weights, np.float64)


def _moves(table: NDArray[Any], heading: int | None) -> NDArray[np.float64]:
    """Return the numbers of turns, `[4, height, width, 3]`, as those of moves.

    The direction of a move is that in which the robot then looks. Without a heading it is that of
    a move forward by a robot that looks there, if there is nothing better for it to do.
    """
    moves = np.full((*table.shape[1:3], NUM_ACTIONS), np.nan)
    if heading is None:
        for looks in range(HEADINGS):
            moves[..., Action.NORTH + looks] = table[looks, ..., Turn.FORWARD]
        return moves
    for turn, shift in ((Turn.LEFT, -1), (Turn.RIGHT, 1), (Turn.FORWARD, 0)):
        moves[..., Action.NORTH + (heading + shift) % HEADINGS] = table[heading, ..., turn]
    return moves
