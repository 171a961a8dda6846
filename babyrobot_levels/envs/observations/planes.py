"""Planes: the whole maze as arrays over its cells, for convolutional networks.

What cells show, by the names that planes and views share, is at the end.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property, lru_cache, partial
from math import prod
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from babyrobot_levels.envs.observations.base import BatchObserver, Extent, Observation, Observer
from babyrobot_levels.language.base import SIDE_NAMES, SIDES
from babyrobot_levels.language.cells import RandomReward, mean_of, shifts
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.kinds import FIXED_STATES
from babyrobot_levels.language.things import SHAPES
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.compiler.terrain import Terrain, build_terrain
from babyrobot_levels.mdp.configurations import Configuration
from babyrobot_levels.mdp.grid import door_sides, grid_with_doors
from babyrobot_levels.mdp.ground import exit_rewards
from babyrobot_levels.mdp.tables import Flags

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
    - `robot-2`, …: the other robots of a team, as long as they are in the level.
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
    - `pushable`, `target`: a box to push, and a target; only of levels with boxes or targets.
    """
    names = ["robot"]
    if extent.headings > 1:
        names += _sided("robot")
    names += [f"robot-{number}" for number in range(2, extent.robots + 1)]
    names += ["start", "exit", "blocked", *_sided("wall"), *_sided("glass")]
    names += ["puddle-small", "puddle-large", "skid", "reward", "ends", "warp"]
    if extent.has_wind:
        names += _sided("wind")
    if extent.has_things:
        names += ["exit-locked", *SHAPES, *FIXED_STATES, *_sided("door"), "mover"]
        names += [f"held-{shape}" for shape in SHAPES]
    if extent.has_boxes:
        names += BOXED
    return tuple(names)


BOXED = ("pushable", "target")
"""The planes that only levels with boxes or targets have."""


def _sided(name: str) -> list[str]:
    """Return the names of the planes of the four sides."""
    return [f"{name}-{side}" for side in SIDE_NAMES]


class PlaneObserver(Observer):
    """Makes the planes of one level in two parts: all but the robot, and the robot.

    Attributes:
        one: what stands for 1.
    """

    options = ("channels_last", "planes_dtype")
    space: spaces.Box

    def __init__(self, level: Level, extent: Extent, observation: Observation) -> None:
        super().__init__(level, extent, observation)
        self._channels_last, self._dtype = observation.channels_last, observation.planes_dtype
        self.one = int(self.space.high.flat[0])
        self._things = level.things()
        self._plane = {name: number for number, name in enumerate(plane_names(extent))}
        # By the doors that are closed: the planes that other things do not change.
        self._grounds: dict[tuple[bool, ...], Floats] = {}

    @classmethod
    def space_of(cls, extent: Extent, observation: Observation) -> spaces.Box:
        """Return the space of planes."""
        (width, height), count = extent.size, len(plane_names(extent))
        shape = (height, width, count) if observation.channels_last else (count, height, width)
        dtype = np.dtype(observation.planes_dtype).type
        return spaces.Box(0, 255 if dtype is np.uint8 else 1, shape, dtype)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new array."""
        return partial(self._planes, state // self.block, self.robot(np.array([state]))[0])

    def _planes(self, configuration: int, places: Ints) -> NDArray[Any]:
        planes = self._kept(configuration).copy()
        planes.ravel()[places] = self.one
        return planes

    @cached_property
    def _kept(self) -> Callable[[int], NDArray[Any]]:
        return lru_cache(_KEPT_GROUNDS)(self.ground)

    def ground(self, configuration: int) -> NDArray[Any]:
        """Return the planes of a configuration without the robot, as a new array."""
        level = self._level
        now = self._things.at(level.numbering().configurations[configuration].tolist())
        if now.doors not in self._grounds:
            self._grounds[now.doors] = self._paint(now)
        planes = self._grounds[now.doors].copy()
        for name, (x, y) in placed(level, now):
            planes[self._plane[name], y, x] = 1
        self._paint_rewards(planes[self._plane["reward"]], now)
        for picture in held_pictures(level, now):
            planes[self._plane[f"held-{picture}"]] = 1
        if self._dtype == "uint8":
            planes = np.rint(255 * planes)
        ordered = np.moveaxis(planes, 0, -1) if self._channels_last else planes
        return np.array(ordered, self._dtype, order="C")

    def robot(self, states: Ints) -> Ints:
        """Return where planes show the robot, as indices of flat arrays, `[states, places]`."""
        (columns, rows), count = self._extent.size, len(self._plane)
        width, height = self._level.size
        cells, is_there = self.standing(states)
        planes = np.arange(self._extent.robots) + (self._plane.get("robot-2", 1) - 1)
        planes[0] = 0
        # Those that are not there are where the robot is.
        cells, planes = np.where(is_there, cells, cells[:, :1]), np.where(is_there, planes, 0)
        if self._extent.headings > 1:
            heading = states // (width * height) % self._extent.headings
            cells = np.repeat(cells, 2, axis=1)
            planes = np.column_stack([planes, self._plane["robot-north"] + heading])
        y, x = np.divmod(cells, width)
        if self._channels_last:
            return (y * columns + x) * count + planes
        return (planes * rows + y) * columns + x

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
            blows = level.wind.probability if level.wind is not None else 1.0
            pushes = [-south[None], east[:, None], south[None], -east[:, None]]
            for number, push in enumerate(pushes, plane["wind-north"]):
                strength = np.maximum(push, 0) * blows
                inner[number] = strength / (1 + strength)
        if self._extent.has_things:
            doors = slice(plane["door-north"], plane["door-north"] + len(SIDES))
            inner[doors] = np.moveaxis(closed_doors(level, now.doors), -1, 0)
        return planes

    def _paint_rewards(self, rewards: Floats, now: Configuration) -> None:
        """Write the rewards of items, exits and warps, of which the last counts."""
        level = self._level
        paid: list[tuple[Cell | None, float | RandomReward | None]] = [
            (place, item.reward) for item, place in zip(level.items, now.items, strict=True)
        ]
        if now.exit_is_open:
            paid += zip(now.exits, exit_rewards(level, now.exits), strict=True)
        paid += [(warp.at, warp.reward) for warp in level.warps if warp.when == "enter"]
        for cell, reward in paid:
            if cell is not None and reward is not None:
                rewards[cell[1], cell[0]] = squashed(mean_of(reward))


class PlaneTable(BatchObserver):
    """The planes of the states of several levels, in two parts.

    Grounds, the planes of a configuration without the robot, are painted when they are first
    needed, and kept as long as there is room; the robot is added to a copy of them.
    """

    space: spaces.Box

    def __init__(
        self, kind: type[Observer], extent: Extent, observation: Observation, most: int
    ) -> None:
        super().__init__(kind, extent, observation, most)
        self._grounds = np.empty((0, prod(self.space.shape)), observation.planes_dtype)
        self._one = self.space.high.flat[0]
        self._free: list[int] = []
        # By state: the row of its ground, -1 if it is not painted, and where the robot is.
        self._row: Ints = np.empty(0, np.intp)
        self._robot: Ints = np.empty((0, extent.robots + (extent.headings > 1)), np.intp)
        self._painters: dict[int, PlaneObserver] = {}

    def grow(self, offset: Ints) -> None:
        """Make room for levels. Those that were set before have to be set again."""
        super().grow(offset)
        self._row = np.full(offset[-1], -1, np.intp)
        self._robot = np.zeros((offset[-1], self._robot.shape[1]), np.intp)
        self._free = list(range(len(self._grounds)))

    def write(self, number: int, level: Level) -> None:
        """Set the level with a number."""
        states = slice(self._offset[number], self._offset[number + 1])
        rows = np.unique(self._row[states])
        self._free += rows[rows >= 0].tolist()
        self._row[states] = -1
        self._painters[number] = painter = self._make(level)
        own = painter.states()
        self._robot[states.start : states.start + own.size] = painter.robot(own)

    def observe(self, states: Ints, out: NDArray[Any]) -> None:
        """Write the planes of states into an array `[states, …]`."""
        rows = self._row.take(states)
        if (rows < 0).any():
            self._paint(states)
            rows = self._row.take(states)
        flat = out.reshape(states.size, -1)
        self._grounds.take(rows, axis=0, out=flat, mode="clip")
        flat[np.arange(states.size)[:, None], self._robot.take(states, axis=0)] = self._one

    def _paint(self, states: Ints) -> None:
        """Paint the grounds of states that have none."""
        new = np.unique(states[self._row.take(states) < 0])
        if new.size > len(self._free) and self._grounds.nbytes > MAX_GROUND_BYTES:
            # All that these states need is painted anew.
            self._free = list(range(len(self._grounds)))
            self._row.fill(-1)
            new = np.unique(states)
        for state, (number, own) in zip(new.tolist(), self._own(new), strict=True):
            if self._row[state] < 0:
                painter = self._painters[number]
                row = self._free_row()
                self._grounds[row] = painter.ground(own // painter.block).reshape(-1)
                first = state - own % painter.block
                self._row[first : first + painter.block] = row

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


PlaneObserver.many = PlaneTable


# -- cells -----------------------------------------------------------------------------------


def ground_of(level: Level, terrain: Terrain) -> dict[str, Flags]:
    """Return where the ground is what a name says, bool `[height, width]` each.

    The names are `blocked`, `ends` (an area that ends the episode), `puddle-small`, `puddle-large`
    and `warp`.

    Args:
        level: the level; a maze needs a seed.
        terrain: what its cells do.
    """
    blocked = level.grid().blocked
    found = {"blocked": blocked, "ends": terrain.ends.reshape(blocked.shape) & ~blocked}
    for name in ("puddle-small", "puddle-large", "warp"):
        found[name] = np.zeros(blocked.shape, np.bool_)
    for puddle in level.puddles:
        found[f"puddle-{puddle.size}"][puddle.at[1], puddle.at[0]] = True
    for warp in level.warps:
        found["warp"][warp.at[1], warp.at[0]] = True
    return found


def closed_doors(level: Level, closed: Sequence[bool]) -> Flags:
    """Return on which sides of cells a closed door is, bool `[height, width, 4]`.

    Args:
        level: the level.
        closed: for each door, whether it is closed.
    """
    width, height = level.size
    found = np.zeros((height, width, len(SIDES)), np.bool_)
    for cell, side, index in door_sides(level, level.grid()):
        if closed[index]:
            found[cell // width, cell % width, SIDES.index(side)] = True
    return found


def placed(level: Level, now: Configuration) -> Iterator[tuple[str, Cell]]:
    """Yield the names and cells of exits, things that stay or lie in cells, boxes and movers.

    Exits are `exit`, or `exit-locked` while their needs are not met; items are named by their
    pictures; others by their kinds, with `-off` or `-on`.
    """
    exits = "exit" if now.exit_is_open else "exit-locked"
    yield from ((exits, cell) for cell in now.exits)
    for item, place in zip(level.items, now.items, strict=True):
        if place is not None:
            yield item.picture, place
    yield from (("pushable", cell) for cell in now.boxes)
    yield from (("target", target.at) for target in level.targets)
    for thing, value in zip(level.things(), now.values, strict=True):
        cell = thing.cells[value]
        if thing.met == "on" and cell is not None:
            yield f"{thing.kind}-{thing.states[value]}", cell
    yield from (("mover", cell) for cell in now.movers)


def held_pictures(level: Level, now: Configuration) -> set[str]:
    """Return the pictures of the items that are held."""
    return {item.picture for item in level.items if item.name in now.held}


def squashed(values: ArrayLike) -> NDArray[np.float64]:
    """Return rewards as values from 0 to 1, the same in all levels: `0.5 + 0.5 * r / (1 + |r|)`."""
    rewards = np.asarray(values, np.float64)
    return np.asarray(0.5 + 0.5 * rewards / (1 + np.abs(rewards)))
