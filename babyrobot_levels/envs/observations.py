"""Observations: each kind is defined once, as a space and as what every state of a level shows.

All environments use these definitions: single and vector ones, both stepping engines, and the
adapter for Stable-Baselines3. Levels that share a space share the one of their `Extent`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from math import prod
from typing import Any, Protocol, Self

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.views import DEFAULT_RADIUS, VIEW_PLANES, ViewPainter
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import HEADINGS
from babyrobot_levels.mdp.compiler.layers import MAX_STATES
from babyrobot_levels.mdp.configurations import largest_radices

Ints = NDArray[np.int64]
Size = tuple[int, int]
"""Width and height in cells."""

NUMERIC = ("position", "index", "walls")
"""The names of the observations that are numbers."""

OBSERVATIONS = ("position", "index", "image", "walls", "view")
"""The names of all observations."""


@dataclass(frozen=True, slots=True)
class Observation:
    """An observation that was chosen, with its options.

    Attributes:
        name: one of `OBSERVATIONS`.
        image_size: `(height, width)` in pixels of images, None for the default.
        grayscale: whether images are grey.
        view_radius: how many cells a view shows in each direction.
        see_through: whether a view shows what walls, doors and blocked cells hide.
    """

    name: str = "position"
    image_size: tuple[int, int] | None = None
    grayscale: bool = False
    view_radius: int = DEFAULT_RADIUS
    see_through: bool = False


@dataclass(frozen=True, slots=True)
class Extent:
    """How much the levels have that share a space of observations, and a way to move.

    Attributes:
        size: the largest width and height, in cells.
        radices: how many values a thing has: in each column of configurations the most of any
            level, for as many columns as the level with the most things has.
        configurations: the most configurations of a level.
        headings: 4 with `actions="turns"`, where states have a heading, else 1.
        has_items: whether a level has items: pictures then have a row below the cells for what is
            held.
    """

    size: Size
    radices: tuple[int, ...] = ()
    configurations: int = 1
    headings: int = 1
    has_items: bool = False

    @classmethod
    def of(cls, levels: Iterable[Level], *, turns: bool = False) -> Self:
        """Return the extent of some levels, at least one.

        A level whose mazes grow at resets counts as having all configurations that its things
        could have.

        Args:
            levels: the levels.
            turns: whether the robot turns.
        """
        size, configurations, has_items = (0, 0), 1, False
        radices: tuple[int, ...] = ()
        for level in levels:
            size = max(size[0], level.size[0]), max(size[1], level.size[1])
            has_items = has_items or bool(level.items)
            if level.has_things:
                radices = largest_radices(radices, level.things().radices)
                configurations = max(configurations, _configurations(level))
        return cls(size, radices, configurations, HEADINGS if turns else 1, has_items)

    @property
    def picture(self) -> Size:
        """The width and height of the largest picture, in cells."""
        return self.size[0], self.size[1] + self.has_items

    @property
    def cells(self) -> int:
        """The number of cells of a level of the largest width and height."""
        return self.size[0] * self.size[1]


def _configurations(level: Level) -> int:
    if level.has_random_maze:
        return min(prod(level.things().radices), MAX_STATES // prod(level.size))
    return level.compile().num_configurations


class Observer(Protocol):
    """Makes the observations of one level."""

    @property
    def space(self) -> spaces.Space[Any]:
        """The space of the observations."""

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new observation of the state at each call.

        With turning, the state is one of `Mdp.turning`, which has a heading.
        """


# -- numbers ---------------------------------------------------------------------------------


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


# -- pictures and views ----------------------------------------------------------------------


class ImageObserver:
    """Paints one level, uint8 `[height, width, 3]`, or `[height, width, 1]` in grey.

    Cells are as large as those of the largest level; where a smaller one has none, the picture is
    black. In a level with items, a row below the cells shows what is held.
    """

    def __init__(
        self, level: Level, extent: Extent, image_size: tuple[int, int] | None, grayscale: bool
    ) -> None:
        # Pictures bring Pillow; the other observations do without it.
        from babyrobot_levels.render.frames import FramePainter
        from babyrobot_levels.render.scene.pose import STANDING

        self.space = image_space(extent, image_size, grayscale)
        height, width = self.space.shape[:2]
        columns, rows = extent.picture
        right = max(1, round(width * level.size[0] / columns))
        bottom = max(1, round(height * (level.size[1] + bool(level.items)) / rows))
        self._painter = FramePainter(level, (right, bottom), grayscale)
        turns = extent.headings > 1
        self._poses = [STANDING.turned(each if turns else None) for each in range(extent.headings)]
        self._cells, self._headings = level.size[0] * level.size[1], extent.headings
        self._is_padded = (bottom, right) != (height, width)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that paints a new picture."""
        return partial(self._padded if self._is_padded else self._frame, state)

    def _frame(self, state: int) -> NDArray[np.uint8]:
        rest, cell = divmod(state, self._cells)
        configuration, heading = divmod(rest, self._headings)
        return self._painter.frame(configuration * self._cells + cell, self._poses[heading])

    def _padded(self, state: int) -> NDArray[np.uint8]:
        frame = self._frame(state)
        picture = np.zeros(self.space.shape, np.uint8)
        picture[: frame.shape[0], : frame.shape[1]] = frame
        return picture


def image_space(extent: Extent, image_size: tuple[int, int] | None, grayscale: bool) -> spaces.Box:
    """Return the space of pictures.

    Args:
        extent: that of the levels.
        image_size: `(height, width)` in pixels, None for the default.
        grayscale: whether the pictures are grey.
    """
    from babyrobot_levels.render.frames import default_image_size

    height, width = image_size or default_image_size(*extent.picture)
    return spaces.Box(0, 255, (height, width, 1 if grayscale else 3), np.uint8)


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


# -- any of them -----------------------------------------------------------------------------


def make_observer(level: Level, observation: Observation, extent: Extent) -> Observer:
    """Return the observer of a level, in the space that the levels of an extent share."""
    match observation.name:
        case "image":
            return ImageObserver(level, extent, observation.image_size, observation.grayscale)
        case "view":
            return ViewObserver(level, extent, observation.view_radius, observation.see_through)
        case _:
            return NumericObserver(level, observation.name, extent)
