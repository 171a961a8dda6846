"""Views: what the robot sees around it, as planes of zeros and ones."""

from collections.abc import Callable
from functools import partial
from math import prod
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations.base import BatchObserver, Extent, Observation, Observer
from babyrobot_levels.envs.observations.planes import (
    BOXED,
    closed_doors,
    ground_of,
    held_pictures,
    placed,
)
from babyrobot_levels.envs.observations.sight import barriers, visible
from babyrobot_levels.language.kinds import FIXED_STATES
from babyrobot_levels.language.things import SHAPES
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.compiler.terrain import build_terrain
from babyrobot_levels.mdp.configurations import Configuration
from babyrobot_levels.mdp.grid import grid_with_doors

Bits = NDArray[np.uint8]
"""Zeros and ones."""

MAX_RADIUS = 15

MAX_TABLE_BYTES = 2**30
"""The largest table of views."""

_SIDES = ("up", "right", "down", "left")

VIEW_PLANES = (
    "visible",
    "blocked",
    *(f"open-{side}" for side in _SIDES),
    "exit",
    "exit-locked",
    "ends",
    "puddle-small",
    "puddle-large",
    "ground",
    "warp",
    *SHAPES,
    *FIXED_STATES,
    *(f"door-{side}" for side in _SIDES),
    "mover",
    *(f"held-{shape}" for shape in SHAPES),
)
"""The names of the planes of a view, of every level.

- `visible`: the robot sees the cell. Where it does not, all planes but the held ones are 0.
- `blocked`: the cell is blocked, or off the grid.
- `open-up`, …: no wall, glass, closed door or blocked cell is on that side. Up is north, or with
  `actions="turns"` where the robot looks.
- `exit`: an exit that ends the episode; `exit-locked`: one whose needs are not met.
- `ends`: an area that ends the episode.
- `puddle-small`, `puddle-large`: a puddle.
- `ground`: other ground with a reward of its own.
- `warp`: a warp.
- `key`, `coin`, `gem`, `star`, `box`: an item with this picture lies there.
- `switch-off`, `switch-on`: a switch.
- `door-up`, …: a closed door on that side.
- `mover`: a mover stands there.
- `held-key`, …: 1 everywhere while the robot holds an item with this picture.

Levels with boxes or targets have two more: `pushable`, a box to push, and `target`. With several
robots, the last one is `robot`: another robot stands there.
"""


def view_planes(extent: Extent) -> tuple[str, ...]:
    """Return the names of the planes of a view."""
    boxed = BOXED if extent.has_boxes else ()
    return (*VIEW_PLANES, *boxed, *(["robot"] if extent.robots > 1 else []))


_PLANE = {name: number for number, name in enumerate((*VIEW_PLANES, *BOXED))}
_OPEN = [_PLANE[f"open-{side}"] for side in _SIDES]
_DOOR = [_PLANE[f"door-{side}"] for side in _SIDES]


class ViewObserver(Observer):
    """Makes the views of one level, uint8 `[2 * radius + 1, 2 * radius + 1, planes]`."""

    options = ("view_radius", "see_through")
    space: spaces.Box

    def __init__(self, level: Level, extent: Extent, observation: Observation) -> None:
        super().__init__(level, extent, observation)
        self._radius, self._see_through = observation.view_radius, observation.see_through
        self._width, self._cells = level.size[0], prod(level.size)
        self._things = level.things()
        self._last: tuple[int, Configuration] | None = None
        # By the doors that are closed: the planes that things do not change, and what hides.
        self._grounds: dict[tuple[bool, ...], tuple[Bits, NDArray[np.bool_] | None]] = {}

    @classmethod
    def space_of(cls, extent: Extent, observation: Observation) -> spaces.Box:
        """Return the space of views."""
        side = 2 * observation.view_radius + 1
        return spaces.Box(0, 1, (side, side, len(view_planes(extent))), np.uint8)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new array."""
        # Kept as bits, of which there are many.
        return partial(_unpacked, np.packbits(self.view(state)), self.space.shape)

    def view(self, state: int) -> Bits:
        """Return the view of a state, uint8 `[2 * radius + 1, 2 * radius + 1, planes]`.

        It is a new array. With headings, the state is one of `Mdp.turning`.
        """
        rest, cell = divmod(state, self._cells)
        number, heading = divmod(rest, self._extent.headings)
        others: list[int] = []
        if self._extent.robots > 1:
            cells, is_there = self.standing(np.array([state]))
            cell, *others = cells[is_there].tolist()
        y, x = divmod(cell, self._width)
        now = self._configuration(number)
        ground, passable = self._ground(now)
        radius, side = self._radius, 2 * self._radius + 1
        view = ground[y : y + side, x : x + side].copy()
        for name, (at_x, at_y) in placed(self._level, now):
            row, column = at_y - y + radius, at_x - x + radius
            if 0 <= row < side and 0 <= column < side:
                view[row, column, _PLANE[name]] = 1
        for other in others:
            row, column = other // self._width - y + radius, other % self._width - x + radius
            if 0 <= row < side and 0 <= column < side:
                view[row, column, -1] = 1
        if passable is not None:
            view *= visible(passable, x, y, radius)[..., None]
        if heading:
            view = np.rot90(view, heading).copy()
            for planes in (_OPEN, _DOOR):
                view[..., planes] = view[..., np.roll(planes, -heading)]
        for picture in held_pictures(self._level, now):
            view[..., _PLANE[f"held-{picture}"]] = 1
        return view

    def _configuration(self, number: int) -> Configuration:
        """Return what is where; that of the view before is kept, which mostly is the same."""
        if self._last is None or self._last[0] != number:
            values = self._level.numbering().configurations[number].tolist()
            self._last = number, self._things.at(values)
        return self._last[1]

    def _ground(self, now: Configuration) -> tuple[Bits, NDArray[np.bool_] | None]:
        """Return the planes that do not change while no door does, and what hides other cells.

        The planes reach `radius` cells beyond the grid: uint8 `[rows, columns, planes]`.
        """
        if now.doors not in self._grounds:
            grid = grid_with_doors(self._level, self._level.grid(), now.doors)
            hidden = None if self._see_through else barriers(grid, self._radius)
            self._grounds[now.doors] = self._paint(now.doors), hidden
        return self._grounds[now.doors]

    def _paint(self, closed: tuple[bool, ...]) -> Bits:
        level, radius = self._level, self._radius
        (width, height), open_grid = level.size, level.grid()
        grid = grid_with_doors(level, open_grid, closed)
        count = len(view_planes(self._extent))
        planes = np.zeros((height + 2 * radius, width + 2 * radius, count), np.uint8)
        planes[..., _PLANE["visible"]] = planes[..., _PLANE["blocked"]] = 1
        inner = planes[radius : radius + height, radius : radius + width]
        terrain = build_terrain(level, open_grid)
        ground = ground_of(level, terrain)
        for name, where in ground.items():
            inner[..., _PLANE[name]] = where
        inner[..., _OPEN] = grid.open
        inner[..., _DOOR] = closed_doors(level, closed)
        pays = (terrain.reward != level.rewards.step).reshape(height, width)
        puddles = ground["puddle-small"] | ground["puddle-large"]
        inner[..., _PLANE["ground"]] = pays & ~open_grid.blocked & ~puddles
        return planes


def _unpacked(bits: Bits, shape: tuple[int, ...]) -> Bits:
    return np.unpackbits(bits, count=prod(shape)).reshape(shape)


class ViewTable(BatchObserver):
    """The views of the states of several levels, as bits; each is made when it is first needed.

    A view takes `(2 * radius + 1) ** 2 * planes / 8` bytes: 184 for a radius of 3, and 3604 for the
    largest.
    """

    space: spaces.Box

    def __init__(
        self, kind: type[Observer], extent: Extent, observation: Observation, most: int
    ) -> None:
        super().__init__(kind, extent, observation, most)
        self._radius = observation.view_radius
        self._bits = np.zeros((0, -(-prod(self.space.shape) // 8)), np.uint8)
        self._is_known = np.zeros(0, np.bool_)
        self._painters: dict[int, ViewObserver] = {}

    def grow(self, offset: NDArray[np.intp]) -> None:
        """Make room for more levels.

        Args:
            offset: intp `[levels + 1]`: where each level's states begin. Those of the present
                levels do not change.

        Raises:
            ValueError: the table would be larger than `MAX_TABLE_BYTES`.
        """
        states, width = int(offset[-1]), self._bits.shape[1]
        if states * width > MAX_TABLE_BYTES:
            raise ValueError(
                f"the views of {states:,} states with view_radius={self._radius} take "
                f"{states * width / 2**30:.1f} GiB, more than {MAX_TABLE_BYTES / 2**30:.0f}; "
                "use a smaller view_radius, or single environments, which need no table"
            )
        known = self._is_known.size
        # Memory that is not written to takes no room: views are made when they are needed.
        bits, is_known = np.zeros((states, width), np.uint8), np.zeros(states, np.bool_)
        which = self._is_known.nonzero()[0]
        bits[which], is_known[:known] = self._bits[which], self._is_known
        self._bits, self._is_known = bits, is_known
        super().grow(offset)

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        self._painters[number] = self._make(level)
        self._is_known[self._offset[number] : self._offset[number + 1]] = False

    def observe(self, states: NDArray[np.intp], out: NDArray[Any]) -> None:
        """Write the views of states into an array `[states, side, side, planes]`."""
        out[...] = self._views(states)

    def gather(self, states: NDArray[np.intp], copy: bool = True) -> Any:
        """Return the views of states; see `BatchObserver.gather`."""
        return self._views(states) if copy else super().gather(states, copy)

    def _views(self, states: NDArray[np.intp]) -> Bits:
        new = np.unique(states[~self._is_known[states]])
        for state, (number, own) in zip(new.tolist(), self._own(new), strict=True):
            self._bits[state] = np.packbits(self._painters[number].view(own))
        self._is_known[new] = True
        bits = np.unpackbits(self._bits[states], axis=1, count=prod(self.space.shape))
        return bits.reshape(-1, *self.space.shape)


ViewObserver.many = ViewTable
