"""The engine `"compiled"` of the extra `fast`: one compiled loop for each call."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.engine import loops
from babyrobot_levels.envs.engine.draws import Draws
from babyrobot_levels.envs.engine.state import EnvStates, Record, Results
from babyrobot_levels.envs.engine.tables import Floats, Ints, Span, Tables


class CompiledEngine:
    """Steps with compiled loops."""

    name = "compiled"
    writes_records = False

    def __init__(self, tables: Tables, observations: NDArray[np.int64], num_envs: int) -> None:
        """Pack all that the loops read into one array.

        Args:
            tables: the tables of the levels.
            observations: the observation of each state, int64 `[states, numbers]`.
            num_envs: how many environments there are.
        """
        self._memory = _packed(tables, observations)
        self._sources = _arrays_of(tables, observations)

    def update(self, span: Span) -> None:
        """Read a slot of the tables and observations again, after it was written."""
        ends = self._memory[: len(self._sources)].tolist()
        for number, (source, names) in enumerate(self._sources):
            copy = self._memory[ends[number - 1] if number else len(ends) : ends[number]]
            copy = copy.view(source.dtype)[: source.size].reshape(source.shape)
            for name in names:
                where = getattr(span, name)
                copy[where] = source[where]

    def reset(self, envs: EnvStates, which: Ints, draws: Draws) -> None:
        """Start new episodes in the environments with these indices."""
        draws.position = loops.reset_all(
            which,
            envs.state.size,
            envs.memory,
            envs.clock,
            draws.memory,
            draws.position,
            self._memory,
        )

    def step(self, envs: EnvStates, actions: Ints, draws: Draws, results: Results) -> bool:
        """Take an action in each environment, or start a new episode; see `Engine`."""
        clock = envs.clock + 1
        position = loops.step(
            actions,
            envs.memory,
            clock,
            draws.memory,
            draws.position,
            self._memory,
            results.memory,
            results.row,
        )
        if position < 0:
            return False
        draws.position = position
        envs.clock = clock
        return True

    def run(
        self, envs: EnvStates, policy: Floats, chances: Floats, draws: Draws, record: Record
    ) -> None:
        """Follow a policy for several steps and record them; see `Engine`."""
        draws.position = loops.run(
            policy,
            chances,
            envs.state.size,
            envs.memory,
            envs.clock,
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
        envs.clock += len(record.rewards)


def _packed(tables: Tables, observations: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return all that the loops read, as one array, which `loops.unpacked` divides again.

    Passing an array to compiled code takes as long as several steps of an environment.

    Args:
        tables: the tables of the levels.
        observations: the observation of each state, int64 `[states, numbers]`.
    """
    arrays = [_as_words(array) for array, _ in _arrays_of(tables, observations)]
    ends = len(arrays) + np.cumsum([array.size for array in arrays])
    return np.concatenate([ends, *arrays])


def _as_words(array: NDArray[Any]) -> NDArray[np.int64]:
    """Return an array as words of eight bytes, the last of them filled with zeros."""
    words = np.zeros(-(-array.nbytes // 8), np.int64)
    words.view(array.dtype)[: array.size] = array.ravel()
    return words


def _arrays_of(
    tables: Tables, observations: NDArray[np.int64]
) -> list[tuple[NDArray[Any], tuple[str, ...]]]:
    """Return the arrays that the loops read, in the order of `_packed`.

    With each are the spans of it that change when a level is written into a slot.
    """
    rows = ("rows", "outcomes")
    chosen = (tables.num_actions, tables.draws_levels, tables.draws_starts, tables.tells_hits)
    return [
        (tables.next_state, rows),
        (tables.reward, rows),
        (tables.outcome_info, rows),
        (tables.first, ()),
        (tables.threshold, ("stochastic",)),
        (tables.state_info, ("states",)),
        (tables.starts, ("starts",)),
        (tables.first_start, ("starts",)),
        (tables.limit, ("level",)),
        (observations, ("states",)),
        (tables.offset, ()),
        (tables.held, ("states",)),
        (np.array([*chosen, tables.held.shape[1]], np.int64), ()),
    ]
