"""Vectors: what an agent needs to know in a level, as a flat array of numbers from 0 to 1."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations.cells import squashed
from babyrobot_levels.envs.observations.extent import Extent
from babyrobot_levels.envs.observations.numbers import NumericObserver
from babyrobot_levels.language.base import SIDE_NAMES, SIDES
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action

Floats = NDArray[np.float32]

_OPEN = slice(2, 2 + len(SIDES))
"""The columns of the open sides in `"walls"`, and in vectors."""


def vector_names(extent: Extent) -> tuple[str, ...]:
    """Return the names of the entries of vectors.

    - `x`, `y`: the column and the row, divided by their largest values.
    - `open-north`, …: the chance to get through that side: 1 if it is open, 0 at a wall or a closed
      door, between them at glass.
    - `reward-north`, …: the expected reward of a move that way, squashed.
    - `thing-1`, …: the value of each thing, divided by its largest value.
    - `heading-north`, …: with `actions="turns"`, 1 where the robot looks.
    """
    return (
        "x",
        "y",
        *(f"open-{side}" for side in SIDE_NAMES),
        *(f"reward-{side}" for side in SIDE_NAMES),
        *(f"thing-{number}" for number in range(1, len(extent.radices) + 1)),
        *(f"heading-{side}" for side in SIDE_NAMES if extent.headings > 1),
    )


class VectorObserver:
    """Makes the vectors of one level, float32 `[entries]`.

    Attributes:
        space: the space, that of the extent.
    """

    def __init__(self, level: Level, extent: Extent) -> None:
        self.space = vector_space(extent)
        self._level, self._headings = level, extent.headings
        self._walls = NumericObserver(level, "walls", extent)
        largest = np.asarray(self._walls.space.nvec) - 1  # type: ignore[attr-defined]
        self._largest = np.maximum(largest, 1)
        self._cells = level.size[0] * level.size[1]
        grid, mdp = level.grid(), level.compile()
        self._glass = np.where(grid.open, 0, grid.pass_probability).reshape(-1, len(SIDES))
        # Of the level's own tables, in which a state has no heading.
        expected = np.einsum("sao,sao->sa", mdp.probability, mdp.reward)
        self._rewards = squashed(expected[:, Action.NORTH :])
        self._rows: dict[int, Floats] = {}

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new array."""
        block = self._cells * self._headings
        configuration, place = divmod(state, block)
        if configuration not in self._rows:
            first = configuration * block
            self._rows[configuration] = self.rows(np.arange(first, first + block))
        row: Floats = self._rows[configuration][place]
        return row.copy

    def table(self) -> Floats:
        """Return the vectors of all states, float32 `[states, entries]`."""
        configurations = self._level.compile().num_configurations
        return self.rows(np.arange(configurations * self._cells * self._headings))

    def rows(self, states: NDArray[np.int64]) -> Floats:
        """Return the vectors of some states, float32 `[states, entries]`."""
        rest, cell = np.divmod(states, self._cells)
        configuration, heading = np.divmod(rest, self._headings)
        columns = self._walls.rows(states) / self._largest
        columns[:, _OPEN] += self._glass[cell]
        rewards = self._rewards[configuration * self._cells + cell]
        parts = [columns[:, : _OPEN.stop], rewards]
        if self._headings > 1:
            parts += [columns[:, _OPEN.stop : -1], np.eye(self._headings)[heading]]
        else:
            parts.append(columns[:, _OPEN.stop :])
        return np.hstack(parts).astype(np.float32)


def vector_space(extent: Extent) -> spaces.Box:
    """Return the space of vectors."""
    return spaces.Box(0, 1, (len(vector_names(extent)),), np.float32)
