"""The engine `"numpy"`, which looks up whole arrays at once, and the choice of an engine."""

from typing import Any

import numpy as np
from numpy import add, bitwise_and, copyto, greater, greater_equal, multiply, ndarray
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.draws import Draws
from babyrobot_levels.envs.engine.state import Engine, EnvStates, Layout, Record, Results
from babyrobot_levels.envs.engine.tables import (
    END,
    NO_LIMIT,
    TERMINAL,
    Floats,
    Ints,
    Span,
    Tables,
    Words,
    masks_of,
)
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.text.errors import how_to_install
from babyrobot_levels.text.words import check_choice

_UNSIGNED = np.dtype(np.uintp)
_NOBODY = np.empty(0, np.intp)

FEW = 256
"""Up to this many environments, few calls are faster than those that do less for each of them."""


class PlainEngine:
    """Steps with NumPy."""

    name = "numpy"
    writes_records = True

    def __init__(self, tables: Tables, observations: NDArray[np.int64], num_envs: int) -> None:
        """Make the intermediate arrays of steps.

        Args:
            tables: the tables of the levels.
            observations: the observation of each state, int64 `[states, numbers]`.
            num_envs: how many environments there are.
        """
        self._tables, self._observations = tables, observations
        self._rows = np.empty(num_envs, np.intp)
        # Calculating with an array is cheaper than with a number, which NumPy would convert.
        self._num_actions = np.array(tables.num_actions, np.intp)
        self._too_large = self._num_actions.astype(_UNSIGNED)
        self._sizes = tables.state_info.size, tables.num_actions
        self._words: Words = np.empty(num_envs, np.uint64)
        self._width = tables.mask_width
        # Wider masks are bits, and no part of a word as it is.
        self._is_wide = self._width > NUM_ACTIONS
        if not self._is_wide:
            self._masks = ndarray(num_envs, f"V{self._width}", self._words, strides=8)
        # `end`, `reached` and `skidded` of all words.
        self._flags = self._words.view(np.uint8).reshape(num_envs, 8)[:, END:].T
        self._terminal = np.array(TERMINAL, np.uint8)
        self._tells_hits, self._tells_held = tables.tells_hits, tables.held.shape[1] > 0
        self._is_stochastic = tables.next_state[: tables.idle_row + 1] < 0
        self._has_limits = bool((tables.limit < NO_LIMIT).any())
        self._which = np.empty(num_envs, np.bool_)

    def __reduce__(self) -> Any:
        # Copies of the intermediate arrays would not be views of one another.
        return type(self), (self._tables, self._observations, self._rows.size)

    def update(self, span: Span) -> None:
        """Read a slot of the tables and observations again, after it was written."""
        self._is_stochastic[span.rows] = self._tables.next_state[span.rows] < 0
        self._has_limits |= bool(self._tables.limit[span.level] < NO_LIMIT)

    def reset(self, envs: EnvStates, which: Ints, draws: Draws) -> None:
        """Start new episodes in the environments with these indices."""
        reset(self._tables, envs, which, draws)

    def step(self, envs: EnvStates, actions: Ints, draws: Draws, results: Results) -> bool:
        """Take an action in each environment, or start a new episode; see `Engine`."""
        tables, rows, words, state = self._tables, self._rows, self._words, envs.state
        if rows.size <= FEW:
            try:
                rows = np.ravel_multi_index((state, actions), self._sizes)
            except ValueError:
                return False
        else:
            # Without their sign, negative numbers are large ones.
            greater_equal(ndarray(rows.size, _UNSIGNED, actions), self._too_large, self._which)
            if self._which.nonzero()[0].size:
                return False
            multiply(state, self._num_actions, rows)
            add(rows, actions, rows)
        envs.clock += 1
        resetting = envs.done.nonzero()[0]
        if resetting.size:
            rows[resetting] = tables.idle_row
        self._act(envs, rows, resetting, draws, results)
        record = results.record
        if self._is_wide:
            results.masks[:] = masks_of(words, self._width)
        elif rows.size <= FEW:
            record["mask_bytes"] = self._masks
        else:
            # Words are longer than masks: each writes over the end of the one before, and the last
            # one over flags, which are written afterwards.
            copyto(results.words_at_masks(), words)
        record["flags"] = self._flags
        if self._tells_hits:
            flags = record["flags"]
            greater(flags[0], self._terminal, results.hit)
            bitwise_and(flags[0], self._terminal, flags[0])
        results.all_true.fill(True)
        terminated, truncated = results.terminated, results.truncated
        if self._has_limits:
            np.less_equal(envs.deadline, np.array(envs.clock), truncated)
            np.logical_or(terminated, truncated, envs.done)
        else:
            truncated.fill(False)
            envs.done[:] = terminated
        return True

    def run(
        self, envs: EnvStates, policy: Floats, chances: Floats, draws: Draws, record: Record
    ) -> None:
        """Follow a policy for several steps and record them; see `Engine`."""
        tables, state, level = self._tables, envs.state, envs.level
        numbers, num_items = self._observations.shape[1], tables.held.shape[1]
        layout = Layout(state.size, numbers, tables.mask_width, num_items, tables.tells_hits)
        results = Results(layout)
        thresholds = np.ascontiguousarray(policy.T)
        for row in range(len(chances)):
            base = tables.offset.take(level)
            record.observations[row] = state - base
            tables.state_info.take(state, out=record.words[row], mode="clip")
            actions = np.zeros(state.size, np.intp)
            for threshold in thresholds:
                actions += chances[row] >= threshold.take(state)
            self.step(envs, actions, draws, results)
            record.actions[row] = actions
            record.rewards[row] = results.rewards
            record.terminations[row] = results.terminated
            record.truncations[row] = results.truncated
            record.next_observations[row] = state - base
            if (done := envs.done.nonzero()[0]).size:
                reset(tables, envs, done, draws)

    def _act(
        self, envs: EnvStates, rows: Ints, resetting: Ints, draws: Draws, results: Results
    ) -> None:
        """Change the states, and write rewards, info words, observations and items.

        Args:
            envs: the environments.
            rows: the row of each environment's state and action; changed in place.
            resetting: those that start a new episode; their rows are the idle one.
            draws: the source of randomness.
            results: where to write.
        """
        tables, words, state = self._tables, self._words, envs.state
        if (drawing := self._drawing(rows)).size:
            number = tables.next_state.take(rows.take(drawing))
            threshold = tables.threshold.take(number, axis=0)
            # Repeating is cheaper than comparing arrays of different shapes.
            drawn = draws.uniform(drawing).repeat(threshold.shape[1]).reshape(threshold.shape)
            rows[drawing] = tables.first.take(number) + (drawn >= threshold).argmin(axis=1)
        # With `mode="raise"`, NumPy would not write into `out` directly. All rows are in bounds.
        tables.next_state.take(rows, out=state, mode="clip")
        tables.reward.take(rows, out=results.rewards, mode="clip")
        tables.outcome_info.take(rows, out=words, mode="clip")
        if resetting.size:
            reset(tables, envs, resetting, draws)
            words[resetting] = tables.state_info.take(state.take(resetting))
        self._observations.take(state, axis=0, out=results.observations, mode="clip")
        if self._tells_held:
            tables.held.take(state, axis=0, out=results.held, mode="clip")

    def _drawing(self, rows: Ints) -> Ints:
        """Return the environments whose action has several outcomes."""
        if not self._tables.first.size:
            return _NOBODY
        return self._is_stochastic.take(rows, out=self._which, mode="clip").nonzero()[0]


def reset(tables: Tables, envs: EnvStates, which: Ints, draws: Draws) -> None:
    """Start new episodes in the environments with these indices."""
    envs.state[which] = tables.starts.take(draws.starts(which, envs.level, tables))
    envs.deadline[which] = tables.limit.take(envs.level.take(which)) + envs.clock
    envs.done[which] = False


ENGINES = ("numpy", "compiled")


def make_engine(
    name: str | None, tables: Tables, observations: NDArray[np.int64], num_envs: int
) -> Engine:
    """Return an engine.

    Args:
        name: one of `ENGINES`, or None for `"compiled"` where Numba can be used, else `"numpy"`.
        tables: the tables of the levels.
        observations: the observation of each state, int64 `[states, numbers]`.
        num_envs: how many environments there are.

    Raises:
        ValueError: there is no such engine.
        ImportError: an engine is required whose library is missing or cannot be used.
    """
    if name is not None:
        check_choice("engine", name, ENGINES)
    if name != "numpy":
        try:
            from babyrobot_levels.envs.engine.compiled import CompiledEngine
        except (ImportError, RuntimeError) as reason:
            # Numba raises the latter if it finds no folder for its cache.
            if name == "compiled":
                raise ImportError(
                    "engine='compiled' needs Numba, with compiling enabled and a cache folder: "
                    + how_to_install("fast")
                ) from reason
        else:
            return CompiledEngine(tables, observations, num_envs)
    return PlainEngine(tables, observations, num_envs)
