"""One robot in the levels of a suite, another level in each episode."""

from __future__ import annotations

import operator
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.wrappers import TimeLimit
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import checked_start
from babyrobot_levels.envs.observations import Observer, make_observer
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.level import Level
from babyrobot_levels.suites import Suite, load_suite

if TYPE_CHECKING:
    from gymnasium.envs.registration import EnvSpec

SuiteLike = str | os.PathLike[str] | Mapping[str, Any] | Suite


@dataclass(frozen=True, slots=True)
class PaddedObserver:
    """Shows the states of one level of a suite in a space that all its levels share."""

    space: spaces.Space[Any]
    at: Callable[[int], Callable[[], Any]]


class PaddedIndexObserver:
    """The cell's number in a level of the largest size, `y * largest width + x`."""

    def __init__(self, level: Level, largest: tuple[int, int]) -> None:
        self.columns, self.width = level.size[0], largest[0]
        self.space = spaces.Discrete(largest[0] * largest[1])

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that gives the number."""
        return partial(int, state // self.columns * self.width + state % self.columns)


class PaddedImageObserver:
    """The picture of the level, cells of all levels in one size, black where there are none."""

    def __init__(
        self,
        level: Level,
        largest: tuple[int, int],
        image_size: tuple[int, int] | None,
        grayscale: bool,
    ) -> None:
        from babyrobot_levels.render.frames import FramePainter, default_image_size

        height, width = image_size or default_image_size(*largest)
        self.right = max(1, round(width * level.size[0] / largest[0]))
        self.bottom = max(1, round(height * level.size[1] / largest[1]))
        self.painter = FramePainter(level, (self.right, self.bottom), grayscale)
        self.space = spaces.Box(0, 255, (height, width, 1 if grayscale else 3), np.uint8)

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that paints a new picture."""
        return partial(self._picture, state)

    def _picture(self, state: int) -> NDArray[np.uint8]:
        picture = np.zeros(self.space.shape, np.uint8)
        picture[: self.bottom, : self.right] = self.painter.frame(state)
        return picture


class SuiteEnv(LevelEnv):
    """A robot walks the levels of a suite: each reset draws one, evenly, from `np_random`.

    It is played as `LevelEnv` is. The spaces are those of a level of the largest size, so that
    they never change: a cell has the same observation in levels of all sizes, `"index"` counts
    `y * largest width + x`, and images show smaller levels in their upper left corner, black
    around them.

    Attributes:
        suite: the levels, or the split of them, that are played.
        level: the level of this episode.
    """

    def __init__(self, suite: SuiteLike, *, split: str | None = None, **kwargs: Any) -> None:
        """Make the environment of a suite.

        Args:
            suite: a name, a path, a mapping or a `Suite`.
            split: the split whose levels are played; all of them if left out.
            kwargs: what `LevelEnv` takes beside `level`.

        Raises:
            SuiteNotFoundError: there is no such suite.
            LevelError: the suite is not valid.
            ValueError: there is no such split, no level at all, or another argument has a value
                that it cannot have.
        """
        loaded = load_suite(suite)
        self._given_suite = loaded
        self.suite = loaded if split is None else loaded.split(split)
        if not len(self.suite):
            raise ValueError("the suite has no levels: the slice is empty")
        super().__init__(self.suite[0], **kwargs)

    def _new_observer(self, level: Level) -> Observer:
        width, height = self.suite.largest
        if self._observation == "image":
            return PaddedImageObserver(level, (width, height), *self._image)
        if self._observation == "index":
            return PaddedIndexObserver(level, (width, height))
        own = make_observer(level, self._observation, *self._image)
        sides = [2] * 4 if self._observation == "walls" else []
        return PaddedObserver(spaces.MultiDiscrete([width, height, *sides]), own.at)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode in another level.

        Args:
            seed: for the environment's own generator, from which everything is drawn.
            options: `{"index": i}` asks for level i of the suite or split; `{"start": [x, y]}`
                begins at that cell.

        Returns:
            The observation, and an info with `action_mask`, `level_index` (its number in the suite
            or split) and `level_digest`.

        Raises:
            ValueError: there is no such level, or the robot cannot start at that cell.
            StarvedError: no level meets the suite's conditions.
        """
        options = options or {}
        index = _checked_index(options.get("index"), len(self.suite))
        gymnasium.Env.reset(self, seed=seed)
        if index is None:
            index = int(self.np_random.integers(len(self.suite)))
        level = self.suite[index]
        checked_start(options.get("start"), level)
        self._enter(level)
        observation, info = super().reset(options=options)
        info["level_index"], info["level_digest"] = index, level.digest
        return observation, info

    @property
    def spec(self) -> EnvSpec | None:
        """The spec by which Gymnasium made the environment."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        whole = len(self._given_suite) == self._given_suite.fields.count
        if spec is not None and whole and not isinstance(spec.kwargs.get("suite"), str):
            # A suite or a path is not JSON; what the suite says is.
            spec.kwargs["suite"] = self._given_suite.to_dict()
        self._spec = spec


def make_suite(suite: SuiteLike, **kwargs: Any) -> gymnasium.Env[Any, Any]:
    """Return a suite's environment under the time limit that its `max_steps` gives it.

    The entry point of `babyrobot/Suite-v0`.
    """
    loaded = load_suite(suite)
    env, limit = SuiteEnv(loaded, **kwargs), loaded.fields.max_steps
    return env if limit is None else TimeLimit(env, limit)


make_suite.metadata = SuiteEnv.metadata  # type: ignore[attr-defined]


def _checked_index(index: Any, count: int) -> int | None:
    """Return the number of a level that a reset asks for, None for None.

    Raises:
        ValueError: there is no such level.
    """
    if index is None:
        return None
    try:
        number = operator.index(index)
    except TypeError:
        number = -1
    if not 0 <= number < count:
        raise ValueError(f"options['index'] must be a whole number below {count:,}, not {index!r}")
    return number
