"""One robot in the levels of a suite, another level in each episode."""

from __future__ import annotations

import operator
import os
from collections.abc import Mapping
from typing import Any

import gymnasium
from gymnasium.wrappers import TimeLimit

from babyrobot_levels.envs.arguments import checked_options, checked_start
from babyrobot_levels.envs.observations import Observer
from babyrobot_levels.envs.padding import make_padded_observer
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.generate.suites import Suite, load_suite
from babyrobot_levels.library.level import Level

SuiteLike = str | os.PathLike[str] | Mapping[str, Any] | Suite


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
        self._given_suite, self.suite = suite_and_split(suite, split)
        super().__init__(self.suite[0], **kwargs)
        self._options = ("start", "index")

    def _new_observer(self, level: Level) -> Observer:
        return make_padded_observer(level, self.suite.largest, self._observation, *self._image)

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
            ValueError: there is no such level or option, or the robot cannot start at that cell.
            StarvedError: no level meets the suite's conditions.
        """
        options = checked_options(options, *self._options)
        index = _checked_index(options.get("index"), len(self.suite))
        gymnasium.Env.reset(self, seed=seed)
        if index is None:
            index = int(self.np_random.random() * len(self.suite))
        level = self.suite[index]
        # A refused reset leaves the running episode as it is.
        checked_start(options.get("start"), level)
        self._enter(level)
        observation, info = super().reset(options=options)
        info["level_index"], info["level_digest"] = index, level.digest
        return observation, info

    def _spell_out(self, given: dict[str, Any]) -> None:
        spell_out_suite(given, self._given_suite)


def make_suite(suite: SuiteLike, **kwargs: Any) -> gymnasium.Env[Any, Any]:
    """Return a suite's environment under the time limit that its `max_steps` gives it.

    The entry point of `babyrobot/Suite-v0`.
    """
    loaded = load_suite(suite)
    env, limit = SuiteEnv(loaded, **kwargs), loaded.fields.max_steps
    return env if limit is None else TimeLimit(env, limit)


make_suite.metadata = SuiteEnv.metadata  # type: ignore[attr-defined]


def suite_and_split(suite: SuiteLike, split: str | None) -> tuple[Suite, Suite]:
    """Return a suite, and what is played of it.

    Raises:
        SuiteNotFoundError: there is no such suite.
        LevelError: the suite is not valid.
        ValueError: there is no such split, or no level at all.
    """
    loaded = load_suite(suite)
    played = loaded if split is None else loaded.split(split)
    if not len(played):
        raise ValueError("the suite has no levels: the slice is empty")
    return loaded, played


def spell_out_suite(given: dict[str, Any], suite: Suite) -> None:
    """Put what a suite says, which is JSON, into the place of a suite or a path, which is not.

    A slice of a suite has no such form.

    Args:
        given: the arguments of an environment; changed in place.
        suite: the suite that was loaded from them.
    """
    if not isinstance(given.get("suite"), str):
        given |= suite.to_arguments() or {}


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
