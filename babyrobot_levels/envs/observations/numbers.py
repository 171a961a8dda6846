"""Observations that are rows of numbers: the position, the state, the open sides, vectors."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations.base import BatchObserver, Extent, Observation, Observer
from babyrobot_levels.envs.observations.planes import squashed
from babyrobot_levels.language.base import SIDE_NAMES, SIDES
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import HEADINGS, NUM_ACTIONS, Action

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.state import Results

Ints = NDArray[np.int64]

KEPT_ROWS = 1 << 20
"""How many rows are kept of a level whose states are more than have tables."""


def _open(extent: Extent) -> slice:
    """Return the columns of the open sides in `"walls"`, and in vectors."""
    return slice(2 * extent.robots, 2 * extent.robots + len(SIDES))


class BatchRowObserver(BatchObserver):
    """Keeps the rows of all states; engines write those that are whole numbers."""

    def grow(self, offset: NDArray[np.intp]) -> None:
        """Make room for levels, whose states begin at `offset`."""
        super().grow(offset)
        self._rows = np.zeros((offset[-1], prod(self.space.shape or ())), self.space.dtype)
        self._is_written = self._rows.dtype == np.int64
        if self._is_written:
            self.table = self._rows

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        observer = self._make(level)
        states = observer.states()
        base = self._offset[number]
        self._rows[base : base + states.size] = observer.rows(states).reshape(states.size, -1)

    def observe(self, states: NDArray[np.intp], out: NDArray[Any]) -> None:
        """Write the observations of states into an array `[states, …]`."""
        self._rows.take(states, axis=0, out=out.reshape(states.size, -1), mode="clip")

    def batch(self, results: Results, states: NDArray[np.intp], copy: bool) -> Any:
        """Return the observations, those that an engine wrote if it did."""
        if not self._is_written:
            return self.gather(states, copy)
        return results.observations if self.space.shape else results.observations[:, 0]


class RowObserver(Observer):
    """Makes rows of numbers; those with one configuration are made at once."""

    many = BatchRowObserver

    def __init__(self, level: Level, extent: Extent, observation: Observation) -> None:
        super().__init__(level, extent, observation)
        self._rows: dict[int, NDArray[Any]] = {}

    @abstractmethod
    def rows(self, states: Ints) -> NDArray[Any]:
        """Return the rows of states, `[states, numbers]`."""

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new array, or gives the int of a `Discrete` space."""
        configuration, place = divmod(state, self.block)
        if configuration not in self._rows:
            if len(self._rows) * self.block > KEPT_ROWS:
                self._rows.clear()
            first = configuration * self.block
            self._rows[configuration] = self.rows(np.arange(first, first + self.block))
        row = self._rows[configuration][place]
        return row.copy if self.space.shape else partial(int, row.item())


class NumericObserver(RowObserver):
    """Makes the observations of one level that are whole numbers.

    In a `Discrete` space, an observation is an int; in a `MultiDiscrete` one, an int64 array.
    """

    def __init__(self, level: Level, extent: Extent, observation: Observation) -> None:
        super().__init__(level, extent, observation)
        self._name = observation.name

    @classmethod
    def space_of(cls, extent: Extent, observation: Observation) -> spaces.Space[Any]:
        """Return the space of the observation."""
        if observation.name == "index":
            return spaces.Discrete(extent.configurations * extent.headings * extent.cells)
        sides = [2] * 4 if observation.name == "walls" else []
        headings = [HEADINGS] if extent.headings > 1 else []
        places = [*extent.size] * extent.robots
        arrived = [2] * extent.robots if extent.robots > 1 else []
        return spaces.MultiDiscrete([*places, *sides, *arrived, *extent.radices, *headings])

    def rows(self, states: Ints) -> Ints:
        """Return what some states show, int64 `[states, numbers]`, or `[states]`."""
        (width, height), extent = self._level.size, self._extent
        rest, cell = np.divmod(states, width * height)
        configuration, heading = np.divmod(rest, extent.headings)
        if self._name == "index":
            y, x = np.divmod(cell, width)
            return (rest * extent.size[1] + y) * extent.size[0] + x
        cells, arrived = self.robots(states)
        columns = [axis for each in cells.T for axis in (each % width, each // width)]
        if self._name == "walls":
            columns += [*self._open_sides(configuration, cells[:, 0])]
        if extent.robots > 1:
            columns += [*arrived.T.astype(np.int64)]
        if extent.radices:
            values = np.zeros((states.size, len(extent.radices)), np.int64)
            known = self._known(configuration)
            values[:, : known.shape[1]] = known
            columns += [*values.T]
        if extent.headings > 1:
            columns.append(heading)
        return np.stack(columns, axis=1)

    def _known(self, configuration: Ints) -> NDArray[Any]:
        """Return the values of things but robots in configurations."""
        values: NDArray[Any] = self._level.numbering().configurations[configuration]
        if self._extent.robots == 1:
            return values
        return values[:, [kind != "robot" for kind in self._level.things().kinds]]

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


def vector_names(extent: Extent) -> tuple[str, ...]:
    """Return the names of the entries of vectors.

    - `x`, `y`: the column and the row, divided by their largest values.
    - `open-north`, …: the chance to get through that side: 1 if it is open, 0 at a wall or a closed
      door, between them at glass.
    - `reward-north`, …: the expected reward of a move that way, squashed.
    - `thing-1`, …: the value of each thing, divided by its largest value.
    - `heading-north`, …: with `actions="turns"`, 1 where the robot looks.

    Of several robots, `x-2`, `y-2`, … are where the others are, the rewards are the robot's own
    while the others stay, and `arrived`, `arrived-2`, … tell who has arrived.
    """
    others = [f"-{number}" for number in range(2, extent.robots + 1)]
    return (
        *(f"{axis}{number}" for number in ("", *others) for axis in "xy"),
        *(f"open-{side}" for side in SIDE_NAMES),
        *(f"reward-{Action(way)}" for way in range(1, 1 + extent.moves)),
        *(f"arrived{number}" for number in ("", *others) if others),
        *(f"thing-{number}" for number in range(1, len(extent.radices) + 1)),
        *(f"heading-{side}" for side in SIDE_NAMES if extent.headings > 1),
    )


class VectorObserver(RowObserver):
    """Makes vectors: what an agent needs to know, float32 `[entries]`, from 0 to 1."""

    def __init__(self, level: Level, extent: Extent, observation: Observation) -> None:
        super().__init__(level, extent, observation)
        self._walls = NumericObserver(level, extent, replace(observation, name="walls"))
        largest = np.asarray(self._walls.space.nvec) - 1  # type: ignore[attr-defined]
        self._largest = np.maximum(largest, 1)
        grid, mdp = level.grid(), level.compile()
        self._glass = np.where(grid.open, 0, grid.pass_probability).reshape(-1, len(SIDES))
        # Of the level's own tables, in which a state has no heading.
        reward, robot = mdp.reward, observation.robot
        if mdp.shares is not None:
            reward = mdp.shares[..., robot]
        expected = np.einsum("sao,sao->sa", mdp.probability, reward)
        own = NUM_ACTIONS ** (mdp.num_robots - 1 - robot)
        self._rewards = squashed(expected[:, own * np.arange(Action.NORTH, 1 + extent.moves)])

    @classmethod
    def space_of(cls, extent: Extent, observation: Observation) -> spaces.Box:
        """Return the space of vectors."""
        return spaces.Box(0, 1, (len(vector_names(extent)),), np.float32)

    def rows(self, states: Ints) -> NDArray[np.float32]:
        """Return the vectors of some states, float32 `[states, entries]`."""
        cells, headings = prod(self._level.size), self._extent.headings
        rest, cell = np.divmod(states, cells)
        configuration, heading = np.divmod(rest, headings)
        columns = self._walls.rows(states) / self._largest
        sides = _open(self._extent)
        columns[:, sides] += self._glass[self.robots(states)[0][:, 0]]
        parts = [columns[:, : sides.stop], self._rewards[configuration * cells + cell]]
        if headings > 1:
            parts += [columns[:, sides.stop : -1], np.eye(headings)[heading]]
        else:
            parts.append(columns[:, sides.stop :])
        return np.hstack(parts).astype(np.float32)
