"""The movers of a level as one: their joint states, and where these lead."""

from collections import deque
from collections.abc import Sequence
from itertools import product
from math import lcm, prod

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.configurations import MAX_OUTCOMES
from babyrobot_levels.mdp.grid import BIT, Grid
from babyrobot_levels.mdp.tables import Crowded, Ints
from babyrobot_levels.text import budget


class TooManyWays(Exception):
    """The movers have more ways to go than an action may have outcomes; `ways` says how many."""

    def __init__(self, ways: int):
        self.ways = ways
        super().__init__(ways)


class Crowd:
    """All movers of a level together.

    Args:
        level: the level.
        grid: its grid, with all doors open.
        most: how many joint states there may be.

    Attributes:
        values: int64 `[joint states, movers]`: the value of each mover.
        cells: int64 `[joint states, movers]`: the cell in which each one stands.
        crowded: whom they hit.

    Raises:
        OverflowError: there are more joint states.
    """

    def __init__(self, level: LevelFields, grid: Grid, most: int):
        self._grid = grid
        self._phases = [[y * grid.width + x for x, y in mover.phases] for mover in level.movers]
        self._is_random = [mover.within is not None for mover in level.movers]
        # For each mover, the values that it can take: a path has all of them, in turn.
        self._choices: list[list[int]] = []
        for mover, phases, is_random in zip(
            level.movers, self._phases, self._is_random, strict=True
        ):
            if not is_random:
                self._choices.append([*range(len(phases))])
                continue
            starts = (
                phases if mover.start is None else [mover.start[1] * grid.width + mover.start[0]]
            )
            self._choices.append(sorted(self._wander(phases, starts)))
        paths = [n for n, is_random in enumerate(self._is_random) if not is_random]
        wanderers = [n for n, is_random in enumerate(self._is_random) if is_random]
        self._period = lcm(*(len(self._phases[n]) for n in paths))
        self._strides: dict[int, int] = {}
        self._size = 1
        for number in reversed(wanderers):
            self._strides[number] = self._size
            self._size *= len(self._choices[number])
        if self._period * self._size > most:
            raise OverflowError
        count = self._period * self._size
        budget.spend(100 * count * len(level.movers))
        joint = np.arange(count)
        self.values = np.zeros((count, len(level.movers)), np.int64)
        for number in paths:
            self.values[:, number] = joint // self._size % len(self._phases[number])
        for number in wanderers:
            choices = np.array(self._choices[number])
            place = joint // self._strides[number] % choices.size
            self.values[:, number] = choices[place]
        self.cells = np.zeros_like(self.values)
        for number, phases in enumerate(self._phases):
            self.cells[:, number] = np.array(phases)[self.values[:, number]]
        self.crowded = Crowded(self.cells, grid.width * grid.height)

    def __len__(self) -> int:
        return len(self.values)

    def joint(self, values: Sequence[int]) -> int:
        """Return the number of the joint state in which all paths are at their beginning."""
        return sum(
            stride * self._choices[number].index(values[number])
            for number, stride in self._strides.items()
        )

    def _wander(self, phases: list[int], starts: list[int]) -> set[int]:
        """Return the values that a mover may take which walks at random from some cells."""
        number = {cell: value for value, cell in enumerate(phases)}
        found = {number[cell] for cell in starts}
        waiting = deque(starts)
        while waiting:
            cell = waiting.popleft()
            for other in self._ways(self._grid, cell, number):
                if number[other] not in found:
                    found.add(number[other])
                    waiting.append(other)
        return found

    @staticmethod
    def _ways(grid: Grid, cell: int, region: dict[int, int]) -> list[int]:
        open_bits = grid.open_bits[cell]
        ways = [grid.neighbour(cell, side) for side in SIDES if open_bits & BIT[side]]
        return [way for way in ways if way is not None and way in region]

    def steps(self, grid: Grid) -> tuple[Ints, Ints, NDArray[np.float64]]:
        """Return where a step takes the movers: for each joint state several, one after the other.

        Args:
            grid: the grid with walls at closed doors.

        Returns:
            `first` `[joint states + 1]`, where each one's begin in the other two; the next joint
            state; and its probability.

        Raises:
            TooManyWays: from some joint state the movers can go to more than `MAX_OUTCOMES`.
        """
        options: list[list[list[int]]] = []
        # The last mover has stride 1: its choices change fastest in `product`.
        for number, stride in reversed(self._strides.items()):
            region = {cell: value for value, cell in enumerate(self._phases[number])}
            place = {value: index for index, value in enumerate(self._choices[number])}
            options.append(
                [
                    [
                        stride * place[region[to]]
                        for to in sorted([cell, *self._ways(grid, cell, region)])
                    ]
                    for cell in (self._phases[number][value] for value in self._choices[number])
                ]
            )
        ways = prod(max(map(len, each)) for each in options)
        if ways > MAX_OUTCOMES:
            raise TooManyWays(ways)
        wandering: list[tuple[list[int], float]] = [
            ([sum(parts) for parts in product(*each)], 1 / prod(map(len, each)))
            for each in product(*options)
        ]
        count = np.array([len(targets) for targets, _ in wandering])
        targets = np.concatenate([np.array(targets, np.int64) for targets, _ in wandering])
        chance = np.repeat([share for _, share in wandering], count)
        first = np.concatenate([[0], np.cumsum(np.tile(count, self._period))])
        phase = (np.arange(self._period) + 1) % self._period * self._size
        following = (phase[:, None] + targets).reshape(-1)
        return first, following, np.tile(chance, self._period)
