"""What each of several robots sees in the present state of their environment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from babyrobot_levels.envs.observations import make_observer
from babyrobot_levels.envs.observations.base import Extent, Observation
from babyrobot_levels.envs.team import MOST_KEPT, TeamEnv
from babyrobot_levels.library.level import Level


class Sights:
    """The observations of all robots of an environment, made when they are asked for.

    Args:
        env: the environment.
        chosen: what is observed.
    """

    def __init__(self, env: TeamEnv, chosen: Observation) -> None:
        self._env, self._chosen = env, chosen
        self._level: Level | None = None

    def of(self, robot: int) -> Any:
        """Return what a robot sees, by its number."""
        return self._at(self._env.state)[0][robot]()

    def arrived(self) -> list[bool]:
        """Return which robots have arrived."""
        return self._at(self._env.state)[1]

    def _at(self, state: int) -> tuple[list[Callable[[], Any]], list[bool]]:
        if self._level is not self._env.level:
            self._look(self._env.level)
        if state not in self._found:
            if len(self._found) >= MOST_KEPT:
                self._found.clear()
            arrived = self._observers[0].robots(np.array([state]))[1][0].tolist()
            self._found[state] = [each.at(state) for each in self._observers], arrived
        return self._found[state]

    def _look(self, level: Level) -> None:
        """Make what observes a level for each robot."""
        self._level, extent = level, Extent.of([level])
        self._observers = [
            make_observer(level, replace(self._chosen, robot=number), extent)
            for number in range(len(self._env.robot_names))
        ]
        self._found: dict[int, tuple[list[Callable[[], Any]], list[bool]]] = {}
