"""The engine of the extra `fast`: one compiled loop a call."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.engine import loops
from babyrobot_levels.envs.engine.draws import Draws
from babyrobot_levels.envs.engine.packing import SPANS, arrays_of, packed
from babyrobot_levels.envs.engine.robots import Record, Results, Robots
from babyrobot_levels.envs.engine.slots import Span
from babyrobot_levels.envs.engine.tables import Floats, Ints, Tables


class CompiledEngine:
    """Steps with compiled loops."""

    name = "compiled"

    def __init__(self, tables: Tables, observations: NDArray[np.int64], num_robots: int) -> None:
        """Put all that the loops read into one array.

        Args:
            tables: what the robots walk in.
            observations: what each state shows, int64 `[states, numbers]`.
            num_robots: how many there are.
        """
        self._memory = packed(tables, observations)
        self._sources = arrays_of(tables, observations)

    def reread(self, span: Span) -> None:
        """Take over what has been written into a slot of the tables and observations."""
        ends = self._memory[: len(self._sources)].tolist()
        for number, names in SPANS.items():
            source = self._sources[number]
            copy = self._memory[ends[number - 1] if number else len(ends) : ends[number]]
            if source.dtype != np.bool_:  # Flags are numbers there.
                copy = copy.view(source.dtype)
            copy = copy.reshape(source.shape)
            for name in names:
                where = getattr(span, name)
                copy[where] = source[where]

    def begin(self, robots: Robots, which: Ints, draws: Draws) -> None:
        """Begin new episodes for the robots of these numbers."""
        draws.position = loops.begin_all(
            which,
            robots.state.size,
            robots.memory,
            robots.clock,
            draws.memory,
            draws.position,
            self._memory,
        )

    def step(self, robots: Robots, actions: Ints, draws: Draws, results: Results) -> bool:
        """Have robots act, and those whose episodes are over begin anew in the place of it."""
        clock = robots.clock + 1
        position = loops.step(
            actions,
            robots.memory,
            clock,
            draws.memory,
            draws.position,
            self._memory,
            results.memory,
        )
        if position < 0:
            return False
        draws.position = position
        robots.clock = clock
        return True

    def walk(
        self, robots: Robots, policy: Floats, chances: Floats, draws: Draws, record: Record
    ) -> None:
        """Have robots follow a policy, begin anew where episodes end, and note all of it."""
        draws.position = loops.walk(
            policy,
            chances,
            robots.state.size,
            robots.memory,
            robots.clock,
            draws.memory,
            draws.position,
            self._memory,
            record.observations,
            record.actions,
            record.rewards,
            record.terminations,
            record.truncations,
            record.next_observations,
            record.words,
        )
        robots.clock += len(record.rewards)
