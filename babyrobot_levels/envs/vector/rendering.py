"""Rendering of vector environments, their attributes and their specs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import logger
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import check_choice
from babyrobot_levels.envs.vector.observations import LevelCache
from babyrobot_levels.library.level import Level

if TYPE_CHECKING:
    from gymnasium.envs.registration import EnvSpec

    from babyrobot_levels.envs.engine.state import EnvStates
    from babyrobot_levels.envs.engine.tables import Tables
    from babyrobot_levels.envs.observations.extent import Extent
    from babyrobot_levels.render.frames import FramePainter

SETTABLE = ("np_random", "render_mode")
"""The attributes that `set_attr` accepts; no tables depend on them."""

MOST_TILES = 16
"""How many environments are shown at most."""

_SIDE = 1024
"""The longer side of the picture in pixels, unless cells would have less than a pixel."""

_MAX_CELL, _GAP = 64, 4
"""The most pixels of a cell, and those between tiles."""


class RenderedVectorEnv(VectorEnv[Any, Any, Any]):
    """A vector environment that can be rendered. Subclasses define `reset` and `step`."""

    levels: Sequence[Level]
    _playing: Sequence[Level | None]
    _extent: Extent
    _envs: EnvStates
    _tables: Tables
    _mode: AutoresetMode
    _tiles: Tiles | None = None
    _spec: EnvSpec | None = None

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Return the result of a method, or the value of an attribute, for each environment.

        There are no single environments inside: all share the attributes and methods of this one,
        except for `level`, `action_masks` and, after a list of seeds, `np_random` and
        `np_random_seed`.
        """
        if name == "level":
            return tuple(self._playing[number] for number in self._envs.level.tolist())
        found = getattr(self, name)
        if name == "action_masks":
            return tuple(found(*args, **kwargs))
        if name in ("np_random", "np_random_seed") and isinstance(found, tuple):
            return found
        return (found(*args, **kwargs) if callable(found) else found,) * self.num_envs

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return the value of an attribute for each environment; see `call`."""
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Set `np_random` or `render_mode`, which all environments share.

        Args:
            name: one of the two.
            values: the value, or a list with the same value for each environment.

        Raises:
            AttributeError: it is another attribute.
            ValueError: the values differ, or are invalid.
        """
        if name not in SETTABLE:
            raise AttributeError(
                f"{name!r} cannot be set, only {' and '.join(SETTABLE)} can; "
                f"make another {type(self).__name__}"
            )
        value, *others = values if isinstance(values, list | tuple) and values else [values]
        if others and (len(others) != self.num_envs - 1 or any(each != value for each in others)):
            raise ValueError(f"all environments share {name!r}: give one value, for all of them")
        if name == "render_mode" and value is not None:
            check_choice(name, value, ("rgb_array",))
        setattr(self, name, value)

    def render(self) -> Any:
        """Return a picture of the first 16 environments, uint8 `[height, width, 3]`."""
        if self.render_mode is None:
            logger.warn("render() needs render_mode='rgb_array', given to make the environment")
            return None
        if self._tiles is None:
            self._tiles = Tiles(self._extent.picture, self._extent.headings, self.num_envs)
        tables = self._tables
        level = self._envs.level[: self._tiles.count]
        state = self._envs.state[: self._tiles.count]
        if state[0] < 0:  # Before the first reset.
            state = tables.starts[tables.first_start[level]]
        numbers, states = level.tolist(), (state - tables.offset[level]).tolist()
        return self._tiles.picture(numbers, [self._playing[n] for n in numbers], states)

    def close_extras(self, **kwargs: Any) -> None:
        """Release the painters; there are no other resources."""
        self._tiles = None

    @property
    def spec(self) -> EnvSpec | None:
        """The spec from which Gymnasium made the environment; it can be written as JSON."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        if spec is not None:
            self._make_serializable(spec.kwargs)
            # JSON has no tuples.
            spec.kwargs |= {
                name: list(value) for name, value in spec.kwargs.items() if isinstance(value, tuple)
            }
        self._spec = spec

    def _make_serializable(self, given: dict[str, Any]) -> None:
        """Replace arguments that JSON does not have by equivalent ones that it has."""
        if not isinstance(given.get("level"), str | None):
            given["level"] = self.levels[0].to_dict(whole=True)
        if isinstance(self.levels, tuple) and "levels" in given:
            given["levels"] = [level.to_dict(whole=True) for level in self.levels]
        if "autoreset_mode" in given:
            given["autoreset_mode"] = self._mode.value

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_tiles": None}


class Tiles:
    """Paints environments as tiles, row by row, in a picture that is as square as possible.

    Attributes:
        count: the number of tiles.
    """

    def __init__(self, largest: tuple[int, int], headings: int, num_envs: int) -> None:
        """Compute the layout.

        Args:
            largest: the width and height of the largest picture, in cells.
            headings: 4 if states have a heading, else 1.
            num_envs: how many environments there are.
        """
        self._headings = headings
        self.count = min(num_envs, MOST_TILES)
        width, height = largest
        self._columns = _columns(self.count, width, height)
        self._rows = math.ceil(self.count / self._columns)
        longer = max(self._columns * width, self._rows * height)
        cell = min(_MAX_CELL, max(1, _SIDE // longer))
        self._step = height * cell + _GAP, width * cell + _GAP
        self._painters = LevelCache(partial(_painter, cell=cell), MOST_TILES)

    def picture(
        self, numbers: Sequence[int], levels: Sequence[Level], states: Sequence[int]
    ) -> NDArray[np.uint8]:
        """Return the picture, uint8 `[height, width, 3]`.

        Args:
            numbers: the number of each environment's level.
            levels: each environment's level.
            states: each environment's state, in its level's own numbering, with its heading.
        """
        height, width = self._step
        shape = (self._rows * height - _GAP, self._columns * width - _GAP, 3)
        picture = np.full(shape, 255, np.uint8)
        for tile, (number, level, state) in enumerate(zip(numbers, levels, states, strict=True)):
            cells = level.size[0] * level.size[1]
            rest, cell = divmod(state, cells)
            configuration, heading = divmod(rest, self._headings)
            frame = self._painters.get(number, level).frame(
                configuration * cells + cell, heading=heading if self._headings > 1 else None
            )
            row, column = divmod(tile, self._columns)
            top, left = row * height, column * width
            picture[top : top + frame.shape[0], left : left + frame.shape[1]] = frame
        return picture


def _painter(level: Level, cell: int) -> FramePainter:
    from babyrobot_levels.render.frames import FramePainter

    width, height = level.size
    return FramePainter(level, (width * cell, (height + bool(level.items)) * cell))


def _columns(count: int, width: int, height: int) -> int:
    """Return the number of columns of tiles for which the longer side is shortest."""
    return min(
        range(1, count + 1),
        key=lambda columns: max(columns * width, math.ceil(count / columns) * height),
    )
