"""What vector environments have beside steps: seeds, attributes, specs, and pictures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import logger
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import whole_number
from babyrobot_levels.envs.engine.draws import Draws, OwnDraws, SharedDraws
from babyrobot_levels.envs.engine.tables import Ints, Tables
from babyrobot_levels.envs.observations.base import Extent, LevelCache
from babyrobot_levels.envs.specs import LevelSpec, as_spec
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.words import Telling, check_choice

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.state import EnvStates
    from babyrobot_levels.render.frames import FramePainter

SETTABLE = ("np_random", "render_mode")
"""The attributes that `set_attr` accepts; no tables depend on them."""

LEVEL_ATTRIBUTES: dict[str, Callable[[Any], Any]] = {
    "level": lambda level: level,
    "level_digest": lambda level: level.digest,
    "item_names": lambda level: tuple(item.name for item in level.items),
}
"""The attributes of environments that follow from their current level."""

MOST_TILES = 16
"""How many environments a montage shows at most."""

_SIDE = 1024
"""The longer side of a picture in pixels, unless cells would have less than a pixel."""

_MAX_CELL, _GAP = 64, 4
"""The most pixels of a cell, and those between tiles."""


Shown = tuple[int, Level, int]
"""The number of a level, the level, and a state in its own numbering."""


class SeededVectorEnv(Telling, VectorEnv[Any, Any, Any]):
    """A vector environment with `np_random` and seeds. Subclasses define `reset` and `step`."""

    _most_draws: int
    _draws: Draws

    @property
    def np_random(self) -> Any:
        """The generator that all environments share; after a list of seeds, a tuple of theirs.

        Draws are made ahead of time, so the generator has advanced further than was used.
        """
        if self._np_random is None:
            self._share(*seeding.np_random())
        return self._np_random

    @np_random.setter
    def np_random(self, generator: np.random.Generator) -> None:
        self._share(generator, -1)

    @property
    def np_random_seed(self) -> Any:
        """The seed of `np_random`, -1 if it is unknown, or a tuple of seeds."""
        if self._np_random is None:
            self._share(*seeding.np_random())
        return self._np_random_seed

    def _seed(self, seed: Any, which: Ints) -> None:
        """Set the generators as a reset of these environments requires.

        Raises:
            ValueError: there are more or fewer seeds than environments, or one is invalid.
        """
        if seed is None and self._np_random is not None:
            return
        if seed is None or np.ndim(seed) == 0:
            self._share(*seeding.np_random(seed))
        else:
            self._separate(_checked_seeds(seed, self.num_envs), which)

    def _share(self, generator: np.random.Generator, seed: int) -> None:
        self._np_random, self._np_random_seed = generator, seed
        self._draws = SharedDraws(generator, self._most_draws)

    def _reserve_draws(self, most: int) -> None:
        """Make room for the draws of a step; those that were made and not used stay."""
        self._most_draws = most
        if self._np_random is not None:
            self._draws.enlarge(most)

    def _separate(self, seeds: list[int | None], which: Ints) -> None:
        """Give these environments new generators; those with seed None keep what they have.

        An environment that has none yet gets one in any case: all share a generator, or none does.
        """
        own: list[Any] = [None] * self.num_envs
        draws = OwnDraws(self.num_envs)
        if self._np_random is not None and isinstance(self._draws, OwnDraws):
            draws = self._draws
            own = list(zip(self.np_random, self.np_random_seed, strict=True))
        new = {number: seeds[number] for number in which.tolist()}
        for number, known in enumerate(own):
            seed = new.get(number)
            if known is None or seed is not None:
                own[number] = seeding.np_random(seed)
                draws.follow(number, own[number][0])
        generators_and_seeds: Any = tuple(zip(*own, strict=True))
        self._np_random, self._np_random_seed = generators_and_seeds
        self._draws = draws


def _checked_seeds(seed: Any, num_envs: int) -> list[int | None]:
    """Return seeds, one for each environment, None for those that are not seeded.

    Raises:
        ValueError: there are more or fewer of them, or one is not a whole number from 0 on.
    """
    given = list(seed) if np.iterable(seed) else []
    seeds = [None if each is None else whole_number(each) for each in given]
    wrong = [
        each is not None and (number is None or number < 0)
        for each, number in zip(given, seeds, strict=True)
    ]
    if len(seeds) != num_envs or any(wrong):
        raise ValueError(
            f"seed must be a whole number from 0 on, or a list of {num_envs} such numbers, "
            "of which None leaves an environment's generator as it is"
        )
    return seeds


class RenderedVectorEnv(VectorEnv[Any, Any, Any]):
    """A vector environment that can be rendered. Subclasses define `reset` and `step`."""

    levels: Sequence[Level]
    _playing: Sequence[Level | None]
    _extent: Extent
    _envs: EnvStates
    _tables: Tables
    autoreset_mode: AutoresetMode
    _frames: Frames | None = None
    _tiles: Tiles | None = None
    _spec: EnvSpec | None = None

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Return the result of a method, or the value of an attribute, for each environment.

        There are no single environments inside: all share the attributes and methods of this one,
        except for `level`, `level_digest`, `item_names`, `action_masks` and, after a list of seeds,
        `np_random` and `np_random_seed`.
        """
        if name in LEVEL_ATTRIBUTES:
            numbers = self._envs.level.tolist()
            of = {n: LEVEL_ATTRIBUTES[name](self._playing[n]) for n in dict.fromkeys(numbers)}
            return tuple(of[number] for number in numbers)
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
        """Return a picture of each environment; None without a render mode.

        Returns:
            A tuple of uint8 `[height, width, 3]`, all of one size, in which cells have up to 64
            pixels. Smaller levels are at the upper left, with black around them.
        """
        if not self._is_rendered():
            return None
        if self._frames is None:
            self._frames = Frames(self._extent, _cell(*self._extent.picture), self.num_envs)
        pictures = np.zeros((self.num_envs, *self._frames.shape), np.uint8)
        for picture, shown in zip(pictures, self._shown(self.num_envs), strict=True):
            self._frames.paint(picture, *shown)
        return tuple(pictures)

    def montage(self) -> Any:
        """Return one picture of the first 16 environments, uint8 `[height, width, 3]`.

        They are side by side, row by row, on white. Without a render mode, it is None.
        """
        if not self._is_rendered():
            return None
        if self._tiles is None:
            self._tiles = Tiles(self._extent, min(self.num_envs, MOST_TILES))
        return self._tiles.picture(self._shown(self._tiles.count))

    def _is_rendered(self) -> bool:
        """Tell whether there is a render mode, and warn if there is none."""
        if self.render_mode is None:
            logger.warn("render() needs render_mode='rgb_array', given to make the environment")
        return self.render_mode is not None

    def _shown(self, count: int) -> Iterator[Shown]:
        """Yield what is to be seen of the first environments."""
        tables = self._tables
        level, state = self._envs.level[:count], self._envs.state[:count]
        if state[0] < 0:  # Before the first reset.
            state = tables.starts[tables.first_start[level]]
        numbers, states = level.tolist(), (state - tables.offset[level]).tolist()
        for number, own in zip(numbers, states, strict=True):
            yield number, self._playing[number], own

    def close_extras(self, **kwargs: Any) -> None:
        """Release the painters; there are no other resources."""
        self._frames = self._tiles = None

    @property
    def spec(self) -> EnvSpec | None:
        """The spec from which Gymnasium made the environment; it can be written as JSON."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        if spec is not None:
            self._make_serializable(spec.kwargs)
            spec = as_spec(LevelSpec, spec)
        self._spec = spec

    def _make_serializable(self, given: dict[str, Any]) -> None:
        """Replace arguments that JSON does not have by equivalent ones that it has."""
        if not isinstance(given.get("level"), str | None):
            given["level"] = self.levels[0].to_dict(whole=True)
        if isinstance(self.levels, tuple) and "levels" in given:
            given["levels"] = [level.to_dict(whole=True) for level in self.levels]
        if "autoreset_mode" in given:
            given["autoreset_mode"] = self.autoreset_mode.value

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_frames": None, "_tiles": None}


class Frames:
    """Paints environments, all at one scale: the cells alone, without panels and margin.

    Attributes:
        shape: height, width and channels of the picture of the largest level.
    """

    def __init__(self, extent: Extent, cell: int, most: int) -> None:
        """Compute the shape.

        Args:
            extent: the extent of all levels.
            cell: the side of a cell in pixels.
            most: of how many levels the painters are kept.
        """
        width, height = extent.picture
        self.shape = height * cell, width * cell, 3
        self._headings = extent.headings
        self._painters = LevelCache(partial(_painter, cell=cell), most)

    def paint(self, picture: NDArray[np.uint8], number: int, level: Level, state: int) -> None:
        """Paint an environment into the upper left of a picture.

        Args:
            picture: the picture.
            number: the number of the level.
            level: the level.
            state: the state, in the level's own numbering, with its heading.
        """
        cells = level.size[0] * level.size[1]
        rest, cell = divmod(state, cells)
        configuration, heading = divmod(rest, self._headings)
        frame = self._painters.get(number, level).frame(
            configuration * cells + cell, heading=heading if self._headings > 1 else None
        )
        picture[: frame.shape[0], : frame.shape[1]] = frame


class Tiles:
    """Paints environments as tiles, row by row, in a picture that is as square as possible.

    Attributes:
        count: the number of tiles.
    """

    def __init__(self, extent: Extent, count: int) -> None:
        """Compute the layout.

        Args:
            extent: the extent of all levels.
            count: the number of tiles.
        """
        self.count = count
        width, height = extent.picture
        self._columns = _columns(count, width, height)
        self._rows = math.ceil(count / self._columns)
        self._frames = Frames(extent, _cell(self._columns * width, self._rows * height), count)

    def picture(self, shown: Iterable[Shown]) -> NDArray[np.uint8]:
        """Return the picture of as many environments as there are tiles."""
        height, width = (side + _GAP for side in self._frames.shape[:2])
        shape = self._rows * height - _GAP, self._columns * width - _GAP, 3
        picture = np.full(shape, 255, np.uint8)
        for tile, each in enumerate(shown):
            row, column = divmod(tile, self._columns)
            self._frames.paint(picture[row * height :, column * width :], *each)
        return picture


def _cell(width: int, height: int) -> int:
    """Return the side of a cell in pixels, for a picture of so many cells."""
    return min(_MAX_CELL, max(1, _SIDE // max(width, height)))


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
