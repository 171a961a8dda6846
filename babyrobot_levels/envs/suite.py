"""The Gymnasium environment of a suite: another of its levels in each episode."""

import os
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np

from babyrobot_levels.envs.arguments import (
    check_names,
    checked_given,
    checked_index,
    checked_options,
    start_states,
)
from babyrobot_levels.envs.observations.base import Extent
from babyrobot_levels.envs.samplers import Sampler, checked_sampler, sampled
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.mdp.actions import HEADINGS
from babyrobot_levels.suites.sources import Bounds
from babyrobot_levels.suites.suite import Suite, load_suite
from babyrobot_levels.text.errors import LevelError

SuiteLike = str | os.PathLike[str] | Mapping[str, Any] | Suite


class SuiteEnv(LevelEnv):
    """A robot moves through the levels of a suite: each reset draws one.

    Actions, rewards and ends of episodes are those of `LevelEnv`. The observation space is that of
    the largest level and never changes: a cell has the same observation in levels of all sizes,
    `"index"` is `y * largest width + x`, and images and frames show smaller levels in their upper
    left corner, with black around them.

    Attributes:
        suite: the suite, or the split of it.
        level: the level of the current episode.
    """

    def __init__(
        self,
        suite: SuiteLike,
        *,
        split: str | None = None,
        sampler: Sampler | None = None,
        **kwargs: Any,
    ) -> None:
        """Make the environment of a suite.

        Args:
            suite: a name, a path, a mapping or a `Suite`.
            split: the split that is used; by default, the whole suite.
            sampler: selects the level of each episode. By default, all levels are drawn equally
                often, or by the weights of the suite.
            kwargs: the arguments of `LevelEnv` other than `level`.

        Raises:
            SuiteNotFoundError: there is no such suite.
            LevelError: the suite is not valid.
            ValueError: there is no such split, it has no levels, or another argument is invalid.
        """
        self._given_suite, self.suite = suite_and_split(suite, split)
        self._sampler = checked_sampler(sampler, self.suite)
        super().__init__(self.suite[0], **kwargs)
        self._options = ("start", "index")

    def _extent(self) -> Extent:
        return extent_of(self.suite.bounds, turns=self._actions.turns)

    def _things(self) -> tuple[int, bool]:
        return self.suite.most_items, self.suite.has_guards

    def _frame_size(self) -> tuple[int, int] | None:
        from babyrobot_levels.render.frames import largest_frame

        return largest_frame(self.level, self.suite.largest, self.suite.most_items)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode in another level.

        Args:
            seed: seeds the environment's own generator, the only source of randomness.
            options: `{"index": i}` selects level i of the suite or split; `{"start": [x, y]}`
                starts in that cell.

        Returns:
            The observation, and an info that also has `level_index`, the level's number in the
            suite or split. If levels of the suite can have items, `held` has room for the most that
            a level can have, and if they can have movers, there is always `hit`.

        Raises:
            ValueError: there is no such level or option, or the robot cannot start in that cell.
            UnsatisfiableError: no level meets the suite's conditions.
            LevelError: the level has another number of moves than the first one.
        """
        options = checked_options(options, *self._options)
        index = checked_index(options.get("index"), len(self.suite))
        gymnasium.Env.reset(self, seed=seed)
        if index is None:
            draw = np.array([self.np_random.random()])
            index = int(sampled(self._sampler, draw, len(self.suite))[0])
        level = self.suite[index]
        if level.moves != self._given.moves:
            raise LevelError(
                message=f"level {index} of the suite has `moves: {level.moves}`, and the first one "
                f"{self._given.moves}: an environment has one action space"
            )
        # A refused reset leaves the current episode as it is.
        if options.get("start") is not None:
            start_states(options["start"], level, self._actions.tables(level))
        self._enter(level)
        self._level_number = {"level_index": index}
        return super().reset(options=options)

    def _make_serializable(self, given: dict[str, Any]) -> None:
        make_suite_serializable(given, self._given_suite)


def make_suite(suite: SuiteLike | None = None, **kwargs: Any) -> SuiteEnv:
    """Return a suite's environment: the entry point of `babyrobot/Suite-v0`.

    Gymnasium adds the `TimeLimit`, which the spec knows.

    Args:
        suite: a name, a path, a mapping or a `Suite`.
        kwargs: the other arguments of `SuiteEnv`.

    Raises:
        MissingArgument: there is no suite.
        TypeError: there is no such argument.
    """
    check_names(kwargs, LevelEnv.__init__, "split", "sampler", "max_episode_steps", "suite")
    return SuiteEnv(checked_given("suite", suite), **kwargs)


make_suite.metadata = SuiteEnv.metadata  # type: ignore[attr-defined]


def suite_and_split(suite: SuiteLike, split: str | None) -> tuple[Suite, Suite]:
    """Return a suite, and the split of it (or the suite again).

    Raises:
        SuiteNotFoundError: there is no such suite.
        LevelError: the suite is not valid.
        ValueError: there is no such split, or it has no levels.
    """
    loaded = load_suite(suite)
    played = loaded if split is None else loaded.split(split)
    if not len(played):
        raise ValueError("the suite has no levels: the slice is empty")
    return loaded, played


def extent_of(bounds: Bounds, *, turns: bool) -> Extent:
    """Return the extent of levels that have no more than some bounds.

    Args:
        bounds: those of a suite, whose levels need not be made for it.
        turns: whether the robot turns.
    """
    headings = HEADINGS if turns else 1
    return Extent(
        bounds.size,
        bounds.radices,
        bounds.configurations,
        headings,
        bounds.num_items > 0,
        bounds.has_wind,
        bounds.has_boxes,
        moves=bounds.moves,
    )


def make_suite_serializable(given: dict[str, Any], suite: Suite) -> None:
    """Replace a suite or a path among arguments by the fields of the suite, which JSON has.

    A slice of a suite has no such form and stays.

    Args:
        given: the arguments of an environment; changed in place.
        suite: the suite that was loaded from them.
    """
    if not isinstance(given.get("suite"), str):
        given |= suite.to_arguments() or {}
