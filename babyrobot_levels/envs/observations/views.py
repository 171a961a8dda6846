"""Views: what the robot sees around it, as planes of zeros and ones."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.observations.cells import (
    closed_doors,
    ground_of,
    held_pictures,
    placed,
)
from babyrobot_levels.envs.observations.extent import Extent
from babyrobot_levels.envs.observations.sight import barriers, visible
from babyrobot_levels.language.kinds import FIXED_STATES
from babyrobot_levels.language.things import SHAPES
from babyrobot_levels.mdp.compiler.terrain import build_terrain
from babyrobot_levels.mdp.grid import grid_with_doors

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.mdp.configurations import Configuration

Bits = NDArray[np.uint8]
"""Zeros and ones."""

DEFAULT_RADIUS = 3
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
"""

_PLANE = {name: number for number, name in enumerate(VIEW_PLANES)}
_OPEN = [_PLANE[f"open-{side}"] for side in _SIDES]
_DOOR = [_PLANE[f"door-{side}"] for side in _SIDES]


class ViewPainter:
    """Makes the views of one level, one at a time.

    Args:
        level: the level; a maze needs a seed.
        headings: 4 if states have a heading, else 1.
        radius: how many cells are shown in each direction, 1 to `MAX_RADIUS`.
        see_through: whether nothing hides anything.
    """

    def __init__(self, level: Level, headings: int, radius: int, see_through: bool) -> None:
        self._level, self._headings = level, headings
        self._radius, self._see_through = radius, see_through
        self._width, self._cells = level.size[0], prod(level.size)
        self._things = level.things()
        self._last: tuple[int, Configuration] | None = None
        # By the doors that are closed: the planes that things do not change, and what hides.
        self._grounds: dict[tuple[bool, ...], tuple[Bits, NDArray[np.bool_] | None]] = {}

    def view(self, state: int) -> Bits:
        """Return the view of a state, uint8 `[2 * radius + 1, 2 * radius + 1, planes]`.

        It is a new array. With headings, the state is one of `Mdp.turning`.
        """
        rest, cell = divmod(state, self._cells)
        number, heading = divmod(rest, self._headings)
        y, x = divmod(cell, self._width)
        now = self._configuration(number)
        ground, passable = self._ground(now)
        radius, side = self._radius, 2 * self._radius + 1
        view = ground[y : y + side, x : x + side].copy()
        for name, (at_x, at_y) in placed(self._level, now):
            row, column = at_y - y + radius, at_x - x + radius
            if 0 <= row < side and 0 <= column < side:
                view[row, column, _PLANE[name]] = 1
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
            values = self._level.compile().configurations[number].tolist()
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
        planes = np.zeros((height + 2 * radius, width + 2 * radius, len(VIEW_PLANES)), np.uint8)
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


class ViewObserver:
    """Makes the views of one level, uint8 `[2 * radius + 1, 2 * radius + 1, planes]`."""

    def __init__(self, level: Level, extent: Extent, radius: int, see_through: bool) -> None:
        self.space = view_space(radius)
        self._painter = ViewPainter(level, extent.headings, radius, see_through)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new array."""
        # Kept as bits, of which there are many.
        bits = np.packbits(self._painter.view(state))
        return partial(self._unpacked, bits)

    def _unpacked(self, bits: NDArray[np.uint8]) -> NDArray[np.uint8]:
        shape = self.space.shape
        return np.unpackbits(bits, count=prod(shape)).reshape(shape)


def view_space(radius: int) -> spaces.Box:
    """Return the space of views."""
    side = 2 * radius + 1
    return spaces.Box(0, 1, (side, side, len(VIEW_PLANES)), np.uint8)


class ViewTable:
    """The views of the states of several levels, as bits; each is made when it is first needed.

    A view takes `(2 * radius + 1) ** 2 * planes / 8` bytes: 184 for a radius of 3, and 3604 for the
    largest.

    Args:
        headings: 4 if states have a heading, else 1.
        radius: how many cells are shown in each direction.
        see_through: whether nothing hides anything.
    """

    def __init__(self, headings: int, radius: int, see_through: bool) -> None:
        self._options = headings, radius, see_through
        side = 2 * radius + 1
        self._shape = side, side, len(VIEW_PLANES)
        self._bits = np.zeros((0, -(-prod(self._shape) // 8)), np.uint8)
        self._is_known = np.zeros(0, np.bool_)
        self._offset: NDArray[np.intp] = np.zeros(1, np.intp)
        self._painters: dict[int, ViewPainter] = {}

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
                f"the views of {states:,} states with view_radius={self._options[1]} take "
                f"{states * width / 2**30:.1f} GiB, more than {MAX_TABLE_BYTES / 2**30:.0f}; "
                "use a smaller view_radius, or single environments, which need no table"
            )
        known = self._is_known.size
        # Memory that is not written to takes no room: views are made when they are needed.
        bits, is_known = np.zeros((states, width), np.uint8), np.zeros(states, np.bool_)
        which = self._is_known.nonzero()[0]
        bits[which], is_known[:known] = self._bits[which], self._is_known
        self._bits, self._is_known, self._offset = bits, is_known, offset

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        self._painters[number] = ViewPainter(level, *self._options)
        self._is_known[self._offset[number] : self._offset[number + 1]] = False

    def at(self, states: NDArray[np.intp]) -> Bits:
        """Return the views of states, uint8 `[states, side, side, planes]`, as a new array."""
        new = np.unique(states[~self._is_known[states]])
        levels = np.searchsorted(self._offset, new, side="right") - 1
        for state, number in zip(new.tolist(), levels.tolist(), strict=True):
            view = self._painters[number].view(state - int(self._offset[number]))
            self._bits[state] = np.packbits(view)
        self._is_known[new] = True
        bits = np.unpackbits(self._bits[states], axis=1, count=prod(self._shape))
        return bits.reshape(-1, *self._shape)
