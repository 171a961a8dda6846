"""Observations in words: a wrapper around the environments of levels and suites."""

import string
from functools import lru_cache
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Text
from gymnasium.utils import RecordConstructorArgs

from babyrobot_levels.envs.observations.sight import barriers, visible
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.sights import RADIUS, SIGHTS, Narrator, Seen, robot_cells
from babyrobot_levels.text.words import check_choice

_MOST_BESIDE = 10_000
"""The most characters of an observation beside its drawing."""


@lru_cache(maxsize=64)
def narrator_of(level: Level, sight: str, robot: int = 0) -> Narrator:
    """Return what tells a level in a sight to a robot; levels that are told again share it.

    Raises:
        ValueError: the level is too large for its drawing to be shown.
    """
    return Narrator(level, sight, _seen(level, robot), robot)


def _seen(level: Level, robot: int) -> Seen:
    """Return a function that returns which cells a robot sees in a state."""

    @lru_cache(maxsize=64)
    def seen(state: int) -> frozenset[Cell]:
        number = level.numbering().configuration(state)
        x, y = robot_cells(level, state)[robot]
        passable = barriers(level.grid_at(number), RADIUS)
        rows, columns = np.nonzero(visible(passable, x, y, RADIUS))
        cells = zip((columns + x - RADIUS).tolist(), (rows + y - RADIUS).tolist(), strict=True)
        width, height = level.size
        return frozenset((i, j) for i, j in cells if 0 <= i < width and 0 <= j < height)

    return seen


class TextObservation(gymnasium.Wrapper[str, Any, Any, Any], RecordConstructorArgs):
    """Gives observations in words, as `brl.TextWorld` tells them.

    The info of `reset` has the rules of the level, as `rules`. Observations are in a
    `gymnasium.spaces.Text` of printable ASCII and of the characters of the level's rules.
    """

    __module__ = "babyrobot_levels"

    def __init__(self, env: gymnasium.Env[Any, Any], sight: str = "map"):
        """Wrap an environment.

        Args:
            env: an environment of this package, of a level or a suite; its own observation may be
                any, `"index"` is the fastest.
            sight: `"map"`, `"view"` or `"words"`; see `brl.TextWorld`.

        Raises:
            TypeError: it is no environment of this package.
            ValueError: there is no such sight, its robot turns, or its level is too large for its
                drawing.
        """
        RecordConstructorArgs.__init__(self, sight=sight)
        check_choice("sight", sight, SIGHTS)
        base = getattr(env, "unwrapped", env)
        if not isinstance(base, LevelEnv):
            what = type(base).__name__
            raise TypeError(f"TextObservation tells environments, as of `level.make()`, not {what}")
        super().__init__(env)
        if base.action_set == "turns":
            raise ValueError("TextObservation tells of robots that do not turn")
        self._base, self._sight = base, sight
        letters = {*string.printable, *narrator_of(base.level, sight).rules()}
        width, height = base.largest_size
        room = _MOST_BESIDE + (2 * height + 1) * (4 * width + 2)
        self.observation_space = Text(room, charset=frozenset(letters))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[str, dict[str, Any]]:
        """Start an episode; the info has its rules."""
        _, info = self.env.reset(seed=seed, options=options)
        return self._told(), {**info, "rules": narrator_of(self._base.level, self._sight).rules()}

    def step(self, action: Any) -> tuple[str, Any, bool, bool, dict[str, Any]]:
        """Take an action."""
        _, reward, terminated, truncated, info = self.env.step(action)
        return self._told(), reward, terminated, truncated, info

    def _told(self) -> str:
        return narrator_of(self._base.level, self._sight).scene(self._base.state)
