"""Where robots are, and what a step gives: the arrays that engines write."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy import empty, ndarray
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.tables import Flags, Floats, Ints, Words

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.draws import Draws
    from babyrobot_levels.envs.engine.slots import Span

# Looked up once: making small arrays is a good part of a step.
_INT = np.dtype(np.int64)


class Robots:
    """Where robots are. Engines change the arrays in place.

    Attributes:
        memory: int64: the arrays, one after the other, as the compiled loops read them.
        state: intp `[robots]`, in the numbering of the tables; -1 before the first episode.
        level: intp `[robots]`: which level each robot plays.
        deadline: int64 `[robots]`: the step at which its episode is cut off.
        over: bool `[robots]`: whether its episode is over.
        clock: how many steps have been taken.
    """

    def __init__(self, num_robots: int, num_levels: int) -> None:
        """Put robot i into level `i % num_levels`, its episode over."""
        self.memory: NDArray[np.int64] = np.zeros(num_robots * 3 + -(-num_robots // 8), np.int64)
        self.clock = 0
        self._divide(num_robots)
        self.level[:] = np.arange(num_robots) % num_levels
        self.state.fill(-1)
        self.over.fill(True)

    def _divide(self, num_robots: int) -> None:
        ends = [num_robots, 2 * num_robots, 3 * num_robots]
        state, level, deadline, over = np.split(self.memory, ends)
        self.state: Ints = state.view(np.intp)[:num_robots]
        self.level: Ints = level.view(np.intp)[:num_robots]
        self.deadline: NDArray[np.int64] = deadline
        self.over: Flags = over.view(np.bool_)[:num_robots]

    def __getstate__(self) -> tuple[int, NDArray[np.int64], int]:
        return self.state.size, self.memory, self.clock

    def __setstate__(self, state: tuple[int, NDArray[np.int64], int]) -> None:
        # Copies of views would no longer be views.
        num_robots, self.memory, self.clock = state
        self._divide(num_robots)


class Layout:
    """Where the arrays of `Results` are in their memory, in the order of `Results`' attributes.

    Attributes:
        dtype: one record of all of them.
        words: how many words of eight bytes it takes.
    """

    def __init__(self, num_robots: int, numbers: int, signs: np.dtype[np.void]) -> None:
        """Lay them out.

        Args:
            num_robots: how many robots there are.
            numbers: how many numbers each of them observes.
            signs: what `signs_of` says.
        """
        each = (num_robots,)
        fields: dict[str, tuple[Any, int]] = {}
        end = 0
        for name, dtype, shape in (
            ("observations", np.int64, (num_robots, numbers)),
            ("rewards", np.float64, each),
            ("words", np.uint64, each),
            ("terminated", np.bool_, each),
            ("truncated", np.bool_, each),
            ("acted", np.bool_, each),
            ("everyone", np.bool_, each),
        ):
            fields[name] = np.dtype((dtype, shape)), end
            end += fields[name][0].itemsize
        fields["signs"] = np.dtype((signs, each)), fields["words"][1]
        fields["said"] = np.dtype((np.bool_, (2, num_robots))), fields["acted"][1]
        self.words = -(-end // 8)
        formats, offsets = zip(*fields.values(), strict=True)
        self.dtype = np.dtype(
            {
                "names": list(fields),
                "formats": formats,
                "offsets": offsets,
                "itemsize": 8 * self.words,
            }
        )


class Results:
    """What a step gives, whose values mean nothing before a step: views of one piece of memory.

    Attributes:
        memory: int64: all of it, as the compiled loops write it.
        observations: int64 `[robots, numbers]`.
        rewards: float64 `[robots]`.
        terminated: bool `[robots]`.
        truncated: bool `[robots]`.
        acted: bool `[robots]`: whether the robot took its action, and did not begin anew.
        everyone: bool `[robots]`: all True.
        said: bool `[2, robots]`: the last two together.
        words: uint64 `[robots]`: what is said of the robots.
        signs: the words as `signs_of` tells them apart.
    """

    __slots__ = (
        "acted",
        "everyone",
        "memory",
        "observations",
        "rewards",
        "said",
        "signs",
        "terminated",
        "truncated",
        "words",
    )

    def __init__(self, layout: Layout) -> None:
        """Make the arrays."""
        self.memory: NDArray[np.int64] = empty(layout.words, _INT)
        # To take arrays out of a record is the fastest way to make them.
        record = ndarray((), layout.dtype, self.memory)
        self.observations: NDArray[np.int64] = record["observations"]
        self.rewards: Floats = record["rewards"]
        self.terminated: Flags = record["terminated"]
        self.truncated: Flags = record["truncated"]
        self.acted: Flags = record["acted"]
        self.everyone: Flags = record["everyone"]
        self.said: Flags = record["said"]
        self.words: Words = record["words"]
        self.signs: NDArray[np.void] = record["signs"]


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

    def reread(self, span: Span) -> None:
        """Take over what has been written into a slot of the tables and observations."""

    def begin(self, robots: Robots, which: Ints, draws: Draws) -> None:
        """Begin new episodes for the robots of these numbers, one after the other.

        Each draws its level, if levels are drawn, and then its start; how, `draws` knows.
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
