"""Where robots are, and what a step gives: the arrays that engines write."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.engine.tables import Flags, Floats, Ints, Words

if TYPE_CHECKING:
    from babyrobot_levels.engine.draws import Draws


class Robots:
    """Where robots are. Engines change the arrays in place.

    Attributes:
        state: intp `[robots]`, in the numbering of the tables; -1 before the first episode.
        level: intp `[robots]`: which level each robot plays.
        deadline: int64 `[robots]`: the step at which its episode is cut off.
        over: bool `[robots]`: whether its episode is over.
        clock: how many steps have been taken.
    """

    def __init__(self, num_robots: int, num_levels: int) -> None:
        """Put robot i into level `i % num_levels`, its episode over."""
        self.level: Ints = np.arange(num_robots, dtype=np.intp) % num_levels
        self.state: Ints = np.full(num_robots, -1, np.intp)
        self.deadline: NDArray[np.int64] = np.zeros(num_robots, np.int64)
        self.over: Flags = np.ones(num_robots, np.bool_)
        self.clock = 0


@dataclass(slots=True)
class Results:
    """What a step gives, one array a kind.

    Attributes:
        observations: int64 `[robots, numbers]`.
        rewards: float64 `[robots]`.
        terminated: bool `[robots]`.
        truncated: bool `[robots]`.
        words: uint64 `[robots]`: what is said of the robots, to be viewed as `signs_of` tells.
        acted: bool `[robots]`: whether the robot took its action, and did not begin anew.
    """

    observations: NDArray[np.int64]
    rewards: Floats
    terminated: Flags
    truncated: Flags
    words: Words
    acted: Flags

    @classmethod
    def empty(cls, num_robots: int, numbers: int) -> Results:
        """Return arrays whose values mean nothing yet."""
        return cls(
            np.empty((num_robots, numbers), np.int64),
            np.empty(num_robots),
            np.empty(num_robots, np.bool_),
            np.empty(num_robots, np.bool_),
            np.empty(num_robots, np.uint64),
            np.empty(num_robots, np.bool_),
        )


@dataclass(slots=True)
class Record:
    """What robots did, one row a step; all arrays are `[steps, robots]`.

    Attributes:
        observations: int32: the state before the action, in its level's own numbering.
        actions: int8.
        rewards: float64.
        terminations: bool.
        truncations: bool.
        next_observations: int32: the state after the action.
        words: uint64: what is said of the robots before the action.
    """

    observations: NDArray[np.int32]
    actions: NDArray[np.int8]
    rewards: Floats
    terminations: Flags
    truncations: Flags
    next_observations: NDArray[np.int32]
    words: Words

    @classmethod
    def empty(cls, num_steps: int, num_robots: int) -> Record:
        """Return arrays whose values mean nothing yet."""
        dtypes = (np.int32, np.int8, np.float64, np.bool_, np.bool_, np.int32, np.uint64)
        return cls(*(np.empty((num_steps, num_robots), dtype) for dtype in dtypes))

    def rows(self, begin: int, end: int) -> Record:
        """Return some of the steps, as views."""
        return Record(*(getattr(self, name)[begin:end] for name in Record.__slots__))


class Engine(Protocol):
    """Walks robots through tables. All engines do the same with the same draws."""

    name: str

    def begin(self, robots: Robots, which: Ints, draws: Draws) -> None:
        """Begin new episodes for the robots of these numbers, one after the other.

        Each draws its level, if levels are drawn, and then, if any level has more than one, its
        start.
        """

    def step(self, robots: Robots, actions: Ints, draws: Draws, results: Results) -> bool:
        """Have robots act, and those whose episodes are over begin anew in the place of it.

        First, in their order, those that act and whose action has more than one outcome draw; then
        those that begin anew.

        Returns:
            Whether all actions are from 0 to `num_actions - 1`. If not, nothing has happened.
        """

    def walk(
        self, robots: Robots, policy: Floats, chances: Floats, draws: Draws, record: Record
    ) -> None:
        """Have robots follow a policy, begin anew where episodes end, and note all of it.

        A robot takes the action whose number is how many of the policy's thresholds in its state
        are not above its chance. In each step, robots draw as they do in `step`, and then those
        whose episodes are over begin anew.

        Args:
            robots: the robots.
            policy: float64 `[states, num_actions - 1]`: thresholds, in rising order.
            chances: float64 `[steps, robots]`, from 0 up to but not including 1.
            draws: what chance is drawn from.
            record: where to note it.
        """
