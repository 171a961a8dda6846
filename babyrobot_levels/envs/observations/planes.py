"""Planes: the whole maze as arrays over its cells, for convolutional networks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
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
    squashed,
)
from babyrobot_levels.envs.observations.extent import Extent
from babyrobot_levels.language.base import SIDE_NAMES, SIDES
from babyrobot_levels.language.cells import shifts
from babyrobot_levels.language.kinds import FIXED_STATES
from babyrobot_levels.language.things import SHAPES
from babyrobot_levels.mdp.compiler.terrain import build_terrain
from babyrobot_levels.mdp.grid import grid_with_doors

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.mdp.configurations import Configuration

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

DTYPES = ("float32", "uint8")
"""The types of planes: from 0 to 1, or from 0 to 255."""

MAX_GROUND_BYTES = 2**29
"""Vector environments keep the planes of configurations until they take more than this."""

_KEPT_GROUNDS = 256
"""How many configurations a single environment keeps the planes of."""


def plane_names(extent: Extent) -> tuple[str, ...]:
    """Return the names of the planes of levels.

    - `robot`: the robot; with `actions="turns"`, `robot-north`, … as well: the robot, if it looks
      that way.
    - `start`: a start; `exit`: an exit that ends the episode.
    - `blocked`: the cell is blocked, or beyond the grid of a smaller level.
    - `wall-north`, …: nothing gets through that side: a wall, a closed door, a blocked cell, or the
      end of the grid.
    - `glass-north`, …: the chance that the glass on that side stops the robot.
    - `puddle-small`, `puddle-large`: a puddle.
    - `skid`: the chance that a move out of the cell skids.
    - `reward`: what a step onto the cell pays, squashed: that of the cell, the exit, the warp, or
      the item that lies there.
    - `ends`: an area that ends the episode.
    - `warp`: a warp.
    - `wind-north`, …: how many cells n the wind pushes that way, as `n / (1 + n)`. Only if a level
      has wind.

    If a level has things, these follow:

    - `exit-locked`: an exit whose needs are not met.
    - `key`, `coin`, `gem`, `star`, `box`: an item with this picture lies there.
    - `switch-off`, `switch-on`: a switch.
    - `door-north`, …: a closed door on that side.
    - `mover`: a mover stands there.
    - `held-key`, …: 1 everywhere while the robot holds an item with this picture.
    """
    names = ["robot"]
    if extent.headings > 1:
        names += _sided("robot")
    names += ["start", "exit", "blocked", *_sided("wall"), *_sided("glass")]
    names += ["puddle-small", "puddle-large", "skid", "reward", "ends", "warp"]
    if extent.has_wind:
        names += _sided("wind")
    if extent.has_things:
        names += ["exit-locked", *SHAPES, *FIXED_STATES, *_sided("door"), "mover"]
        names += [f"held-{shape}" for shape in SHAPES]
    return tuple(names)


def _sided(name: str) -> list[str]:
    """Return the names of the planes of the four sides."""
    return [f"{name}-{side}" for side in SIDE_NAMES]


@dataclass(frozen=True, slots=True)
class PlaneForm:
    """The form of planes.

    Attributes:
        channels_last: whether the shape is `[height, width, planes]` and not
            `[planes, height, width]`.
        dtype: one of `DTYPES`.
    """

    channels_last: bool = False
    dtype: str = "float32"

    @property
    def one(self) -> int:
        """What stands for 1."""
        return 255 if self.dtype == "uint8" else 1

    def space(self, extent: Extent) -> spaces.Box:
        """Return the space of planes."""
        (width, height), count = extent.size, len(plane_names(extent))
        shape = (height, width, count) if self.channels_last else (count, height, width)
        return spaces.Box(0, self.one, shape, np.dtype(self.dtype).type)

    def of(self, planes: Floats) -> NDArray[Any]:
        """Return planes from 0 to 1, `[planes, height, width]`, in this form, as a new array."""
        if self.dtype == "uint8":
            planes = np.rint(255 * planes)
        ordered = np.moveaxis(planes, 0, -1) if self.channels_last else planes
        return np.array(ordered, self.dtype, order="C")


class PlanePainter:
    """Makes the planes of one level in two parts: all but the robot, and the robot.

    Args:
        level: the level; a maze needs a seed.
        extent: that of all levels.
        form: the form of the planes.
    """

    def __init__(self, level: Level, extent: Extent, form: PlaneForm) -> None:
        self._level, self._extent, self._form = level, extent, form
        self._things = level.things()
        names = plane_names(extent)
        self._plane = {name: number for number, name in enumerate(names)}
        # By the doors that are closed: the planes that other things do not change.
        self._grounds: dict[tuple[bool, ...], Floats] = {}

    def configuration(self, state: int) -> int:
        """Return the number of a state's configuration."""
        return state // self.states

    @property
    def states(self) -> int:
        """The number of states with one configuration."""
        return self._level.size[0] * self._level.size[1] * self._extent.headings

    def ground(self, configuration: int) -> NDArray[Any]:
        """Return the planes of a configuration without the robot, as a new array."""
        level = self._level
        now = self._things.at(level.compile().configurations[configuration].tolist())
        if now.doors not in self._grounds:
            self._grounds[now.doors] = self._paint(now)
        planes = self._grounds[now.doors].copy()
        for name, (x, y) in placed(level, now):
            planes[self._plane[name], y, x] = 1
        self._paint_rewards(planes[self._plane["reward"]], now)
        for picture in held_pictures(level, now):
            planes[self._plane[f"held-{picture}"]] = 1
        return self._form.of(planes)

    def robot(self, states: Ints) -> Ints:
        """Return where planes show the robot, as indices of flat arrays, `[states, places]`."""
        (columns, rows), count = self._extent.size, len(self._plane)
        width, height = self._level.size
        rest, cell = np.divmod(states, width * height)
        y, x = np.divmod(cell, width)
        planes = [np.zeros_like(x)]
        if self._extent.headings > 1:
            planes.append(self._plane["robot-north"] + rest % self._extent.headings)
        if self._form.channels_last:
            return np.stack([(y * columns + x) * count + plane for plane in planes], axis=1)
        return np.stack([(plane * rows + y) * columns + x for plane in planes], axis=1)

    def _paint(self, now: Configuration) -> Floats:
        """Return the planes without things, but with the doors as they are."""
        level, plane = self._level, self._plane
        (width, height), (columns, rows) = level.size, self._extent.size
        planes = np.zeros((len(plane), rows, columns))
        walls = slice(plane["wall-north"], plane["wall-north"] + len(SIDES))
        planes[plane["blocked"]] = planes[walls] = 1
        planes[plane["reward"]] = 0.5
        inner = planes[:, :height, :width]
        terrain = build_terrain(level, level.grid())
        for name, where in ground_of(level, terrain).items():
            inner[plane[name]] = where
        for x, y in level.starts:
            inner[plane["start"], y, x] = 1
        is_free = ~level.grid().blocked
        inner[plane["skid"]] = terrain.skid.reshape(height, width) * is_free
        inner[plane["reward"]] = squashed(terrain.reward.reshape(height, width) * is_free)
        grid = grid_with_doors(level, level.grid(), now.doors)
        inner[walls] = ~np.moveaxis(grid.open, -1, 0)
        for (cell, side), chance in grid.glass.items():
            y, x = divmod(cell, width)
            inner[walls.start + SIDES.index(side), y, x] = 0
            inner[plane["glass-north"] + SIDES.index(side), y, x] = 1 - chance
        if self._extent.has_wind:
            south, east = (np.array(each) for each in shifts(level.wind, width, height))
            pushes = [-south[None], east[:, None], south[None], -east[:, None]]
            for number, push in enumerate(pushes, plane["wind-north"]):
                strength = np.maximum(push, 0)
                inner[number] = strength / (1 + strength)
        if self._extent.has_things:
            doors = slice(plane["door-north"], plane["door-north"] + len(SIDES))
            inner[doors] = np.moveaxis(closed_doors(level, now.doors), -1, 0)
        return planes

    def _paint_rewards(self, rewards: Floats, now: Configuration) -> None:
        """Write the rewards of items, exits and warps, of which the last counts."""
        level = self._level
        paid = [(place, item.reward) for item, place in zip(level.items, now.items, strict=True)]
        paid += [(cell, level.rewards.exit) for cell in now.exits if now.exit_is_open]
        paid += [(warp.at, warp.reward) for warp in level.warps if warp.when == "enter"]
        for cell, reward in paid:
            if cell is not None and reward is not None:
                rewards[cell[1], cell[0]] = squashed(reward)


class PlaneObserver:
    """Makes the planes of one level, in the form that was chosen.

    Attributes:
        space: the space, that of the extent.
    """

    def __init__(self, level: Level, extent: Extent, form: PlaneForm) -> None:
        self.space = form.space(extent)
        self._painter, self._one = PlanePainter(level, extent, form), form.one
        self._ground = lru_cache(_KEPT_GROUNDS)(self._painter.ground)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new array."""
        places = self._painter.robot(np.array([state]))[0]
        return partial(self._planes, self._painter.configuration(state), places)

    def _planes(self, configuration: int, places: Ints) -> NDArray[Any]:
        planes = self._ground(configuration).copy()
        planes.ravel()[places] = self._one
        return planes


class PlaneTable:
    """The planes of the states of several levels, in two parts.

    Grounds, the planes of a configuration without the robot, are painted when they are first
    needed, and kept as long as there is room; the robot is added to a copy of them.

    Args:
        extent: that of all levels.
        form: the form of the planes.
    """

    def __init__(self, extent: Extent, form: PlaneForm) -> None:
        self._extent, self._form = extent, form
        shape = form.space(extent).shape
        self._grounds = np.empty((0, prod(shape)), form.dtype)
        self._free: list[int] = []
        # By state: the row of its ground, -1 if it is not painted, and where the robot is.
        self._row: Ints = np.empty(0, np.intp)
        self._robot: Ints = np.empty((0, 1 + (extent.headings > 1)), np.intp)
        self._offset: Ints = np.zeros(1, np.intp)
        self._painters: dict[int, PlanePainter] = {}

    def grow(self, offset: Ints) -> None:
        """Make room for levels. Those that were set before have to be set again.

        Args:
            offset: intp `[levels + 1]`: where each level's states begin.
        """
        self._offset = offset
        self._row = np.full(offset[-1], -1, np.intp)
        self._robot = np.zeros((offset[-1], self._robot.shape[1]), np.intp)
        self._free = list(range(len(self._grounds)))

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        states = slice(self._offset[number], self._offset[number + 1])
        rows = np.unique(self._row[states])
        self._free += rows[rows >= 0].tolist()
        self._row[states] = -1
        self._painters[number] = painter = PlanePainter(level, self._extent, self._form)
        count = level.compile().num_configurations * painter.states
        self._robot[states.start : states.start + count] = painter.robot(np.arange(count))

    def observe(self, states: Ints, out: NDArray[Any]) -> None:
        """Write the planes of states into an array `[states, …]`."""
        rows = self._row.take(states)
        if (rows < 0).any():
            self._paint(states)
            rows = self._row.take(states)
        flat = out.reshape(states.size, -1)
        self._grounds.take(rows, axis=0, out=flat, mode="clip")
        flat[np.arange(states.size)[:, None], self._robot.take(states, axis=0)] = self._form.one

    def _paint(self, states: Ints) -> None:
        """Paint the grounds of states that have none."""
        new = np.unique(states[self._row.take(states) < 0])
        if new.size > len(self._free) and self._grounds.nbytes > MAX_GROUND_BYTES:
            # All that these states need is painted anew.
            self._free = list(range(len(self._grounds)))
            self._row.fill(-1)
            new = np.unique(states)
        levels = np.searchsorted(self._offset, new, side="right") - 1
        for state, number in zip(new.tolist(), levels.tolist(), strict=True):
            if self._row[state] < 0:
                painter, base = self._painters[number], int(self._offset[number])
                configuration = painter.configuration(state - base)
                row = self._free_row()
                self._grounds[row] = painter.ground(configuration).reshape(-1)
                first = base + configuration * painter.states
                self._row[first : first + painter.states] = row

    def _free_row(self) -> int:
        if not self._free:
            count = len(self._grounds)
            more = np.empty((max(1, count), self._grounds.shape[1]), self._grounds.dtype)
            self._grounds = np.concatenate([self._grounds, more])
            self._free = list(range(count, len(self._grounds)))
        return self._free.pop()

    def __getstate__(self) -> dict[str, Any]:
        # Grounds may be large, and are painted again where they are needed.
        return {**vars(self), "_grounds": self._grounds[:0], "_free": [], "_row": self._row * 0 - 1}
