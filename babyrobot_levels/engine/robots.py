"""Where robots are, and what a step gives: the arrays that engines write."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy import empty
from numpy.typing import NDArray

from babyrobot_levels.engine.tables import Flags, Floats, Ints, Words

if TYPE_CHECKING:
    from babyrobot_levels.engine.draws import Draws

# Looked up once: making small arrays is a good part of a step.
_BOOL, _INT, _WORD = np.dtype(np.bool_), np.dtype(np.int64), np.dtype(np.uint64)


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


class Results:
    """What a step gives, one array a kind, whose values mean nothing before a step.

    Attributes:
        observations: int64 `[robots, numbers]`.
        rewards: float64 `[robots]`.
        terminated: bool `[robots]`.
        truncated: bool `[robots]`.
        acted: bool `[robots]`: whether the robot took its action, and did not begin anew.
        words: uint64 `[robots]`: what is said of the robots.
        signs: the words as `signs_of` tells them apart, a view.
    """

    __slots__ = (
        "acted",
        "observations",
        "rewards",
        "signs",
        "terminated",
        "truncated",
        "words",
    )

    def __init__(self, num_robots: int, numbers: int, signs: np.dtype[np.void]) -> None:
        """Make the arrays.

        Args:
            num_robots: how many robots there are.
            numbers: how many numbers each of them observes.
            signs: what `signs_of` says.
        """
        self.observations: NDArray[np.int64] = empty((num_robots, numbers), _INT)
        self.rewards: Floats = empty(num_robots)
        self.terminated: Flags = empty(num_robots, _BOOL)
        self.truncated: Flags = empty(num_robots, _BOOL)
        self.acted: Flags = empty(num_robots, _BOOL)
        self.words: Words = empty(num_robots, _WORD)
        self.signs: NDArray[np.void] = np.ndarray(num_robots, signs, self.words)


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
        count = num_steps * num_robots
        # One piece of memory: the larger it is, the larger the pages in which systems give it.
        ends = np.cumsum([(count * np.dtype(dtype).itemsize + 63) // 64 * 64 for dtype in dtypes])
        memory = np.empty(ends[-1], np.uint8)
        parts = np.split(memory, ends[:-1])
        return cls(
            *(
                part.view(dtype)[:count].reshape(num_steps, num_robots)
                for part, dtype in zip(parts, dtypes, strict=True)
            )
        )

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
