"""Observations that are whole numbers: the position, the state, or the open sides as well."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations.extent import Extent
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import HEADINGS

Ints = NDArray[np.int64]

NUMERIC = ("position", "index", "walls")
"""The names of the observations that are numbers."""


class NumericObserver:
    """Makes the observations of one level that are whole numbers.

    In a `Discrete` space, an observation is an int; in a `MultiDiscrete` one, an int64 array.

    Attributes:
        space: the space, that of the extent.
    """

    def __init__(self, level: Level, observation: str, extent: Extent) -> None:
        """Prepare the observations; `observation` is one of `NUMERIC`."""
        self.space = numeric_space(observation, extent)
        self._level, self._name, self._extent = level, observation, extent
        self._block = level.size[0] * level.size[1] * extent.headings
        self._rows: dict[int, Ints] = {}

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new array, or gives the int of a `Discrete` space."""
        configuration, place = divmod(state, self._block)
        if configuration not in self._rows:
            first = configuration * self._block
            self._rows[configuration] = self.rows(np.arange(first, first + self._block))
        row = self._rows[configuration][place]
        return partial(int, row[0].item()) if self._name == "index" else row.copy

    def table(self) -> Ints:
        """Return what each state shows, int64 `[states, numbers]`."""
        configurations = self._level.compile().num_configurations
        return self.rows(np.arange(configurations * self._block))

    def rows(self, states: Ints) -> Ints:
        """Return what some states show, int64 `[states, numbers]`."""
        (width, height), extent = self._level.size, self._extent
        rest, cell = np.divmod(states, width * height)
        configuration, heading = np.divmod(rest, extent.headings)
        y, x = np.divmod(cell, width)
        if self._name == "index":
            index = (rest * extent.size[1] + y) * extent.size[0] + x
            return index[:, None]
        columns = [x, y]
        if self._name == "walls":
            columns += [*self._open_sides(configuration, cell)]
        if extent.radices:
            values = np.zeros((states.size, len(extent.radices)), np.int64)
            known = self._level.compile().configurations
            values[:, : known.shape[1]] = known[configuration]
            columns += [*values.T]
        if extent.headings > 1:
            columns.append(heading)
        return np.stack(columns, axis=1)

    def _open_sides(self, configuration: Ints, cell: Ints) -> Ints:
        """Return which sides of cells are open in configurations, `[4, states]`."""
        seen, which = np.unique(configuration, return_inverse=True)
        # Many configurations have the same doors closed.
        grids: dict[tuple[bool, ...], int] = {}
        bits: list[NDArray[np.uint8]] = []
        place = np.zeros(seen.size, np.int64)
        for index, number in enumerate(seen.tolist()):
            doors = self._level.configuration(number).doors if self._level.doors else ()
            if doors not in grids:
                grids[doors] = len(bits)
                bits.append(np.frombuffer(self._level.grid_at(number).open_bits, np.uint8))
            place[index] = grids[doors]
        open_bits = np.stack(bits)[place[which], cell].astype(np.int64)
        return np.stack([open_bits >> side & 1 for side in range(4)])


def numeric_space(observation: str, extent: Extent) -> spaces.Space[Any]:
    """Return the space of one of the `NUMERIC` observations."""
    if observation == "index":
        return spaces.Discrete(extent.configurations * extent.headings * extent.cells)
    sides = [2] * 4 if observation == "walls" else []
    headings = [HEADINGS] if extent.headings > 1 else []
    return spaces.MultiDiscrete([*extent.size, *sides, *extent.radices, *headings])
