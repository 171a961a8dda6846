"""The engine `"jax"` of the extra `jax`: one jitted look-up for each step, on JAX's device.

All numbers are integers of 32 bits there, those of 64 bits as two halves: JAX's x64 mode is neither
needed nor changed, and devices without float64 give the same results.
"""

from __future__ import annotations

import sys
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.draws import Draws
from babyrobot_levels.envs.engine.plain import PlainEngine, reset
from babyrobot_levels.envs.engine.state import EnvStates, Results
from babyrobot_levels.envs.engine.tables import Ints, Span, Tables

_HIGH, _LOW = (1, 0) if sys.byteorder == "little" else (0, 1)
"""Which of two halves is which."""

_SPANS = {
    "next_state": ("rows", "outcomes"),
    "reward": ("rows", "outcomes"),
    "outcome_info": ("rows", "outcomes"),
    "threshold": ("stochastic",),
    "observations": ("states",),
    "held": ("states",),
}
"""The arrays that change when a level is written into a slot, and which parts of them."""


class JittedEngine(PlainEngine):
    """Steps with JAX. What is drawn, for outcomes and resets, is drawn as `PlainEngine` does."""

    name = "jax"

    def __init__(self, tables: Tables, observations: NDArray[np.int64], num_envs: int) -> None:
        """Copy the tables to the device.

        Args:
            tables: the tables of the levels.
            observations: the observation of each state, int64 `[states, numbers]`.
            num_envs: how many environments there are.
        """
        super().__init__(tables, observations, num_envs)
        # Views, so that they show what is written into slots.
        self._sources: dict[str, NDArray[Any]] = {
            "next_state": tables.next_state,
            "reward": _halves(tables.reward),
            "outcome_info": _halves(tables.outcome_info),
            "first": tables.first,
            "threshold": _halves(tables.threshold),
            "observations": observations,
            "held": tables.held,
        }
        # Without a copy, the device could share memory that is written later.
        self._arrays = {name: jnp.array(_short(each)) for name, each in self._sources.items()}

    def update(self, span: Span) -> None:
        """Read a slot of the tables and observations again, after it was written."""
        super().update(span)
        parts = {}
        for name, places in _SPANS.items():
            slices = [getattr(span, place) for place in places]
            parts[name] = [(_short(self._sources[name][each]), each.start) for each in slices]
        self._arrays |= _written({name: self._arrays[name] for name in parts}, parts)

    def _act(
        self, envs: EnvStates, rows: Ints, resetting: Ints, draws: Draws, results: Results
    ) -> None:
        """Look up what the actions lead to, in one call."""
        tables, state = self._tables, envs.state
        drawn = np.zeros(rows.size)
        drawing = self._drawing(rows)
        if drawing.size:
            drawn[drawing] = draws.uniform(drawing)
        started = np.full(rows.size, -1, np.int32)
        if resetting.size:
            reset(tables, envs, resetting, draws)
            started[resetting] = state[resetting]
        found = _looked_up(self._arrays, _short(rows), _halves(drawn), started)
        state[:], reward, words, results.observations[:], held = map(np.asarray, found)
        results.rewards[:] = reward.view(np.float64)[:, 0]
        self._words[:] = words.view(np.uint64)[:, 0]
        self._words[resetting] = tables.state_info.take(state.take(resetting))
        if self._tells_held:
            results.held[:] = held


@jax.jit
def _looked_up(
    arrays: dict[str, Array], rows: Array, drawn: Array, started: Array
) -> tuple[Array, ...]:
    """Return states, the halves of rewards and of info words, observations and items.

    Args:
        arrays: the tables, as `JittedEngine` keeps them.
        rows: int32 `[envs]`: the row of each environment's state and action.
        drawn: uint32 `[envs, 2]`: the halves of its draw.
        started: int32 `[envs]`: the state in which it starts an episode, -1 if it does not.
    """
    if len(arrays["first"]):
        number = arrays["next_state"][rows]
        is_stochastic = number < 0
        number = jnp.minimum(number, -1)
        # Numbers from 0 on are ordered as their bits are.
        high, low = drawn[:, _HIGH, None], drawn[:, _LOW, None]
        threshold = arrays["threshold"][number]
        least_high, least_low = threshold[..., _HIGH], threshold[..., _LOW]
        is_reached = (high > least_high) | ((high == least_high) & (low >= least_low))
        outcome = arrays["first"][number] + is_reached.sum(axis=1, dtype=jnp.int32)
        rows = jnp.where(is_stochastic, outcome, rows)
    state = jnp.where(started >= 0, started, arrays["next_state"][rows])
    return (
        state,
        arrays["reward"][rows],
        arrays["outcome_info"][rows],
        arrays["observations"][state],
        arrays["held"][state],
    )


@jax.jit
def _written(
    arrays: dict[str, Array], parts: dict[str, list[tuple[NDArray[Any], int]]]
) -> dict[str, Array]:
    """Return arrays with parts of them replaced, each from a row on."""
    written = dict(arrays)
    for name, each in parts.items():
        for part, begin in each:
            written[name] = jax.lax.dynamic_update_slice_in_dim(written[name], part, begin, 0)
    return written


def _halves(array: NDArray[Any]) -> NDArray[np.uint32]:
    """Return numbers of 64 bits as two halves each, a view."""
    return array.view(np.uint32).reshape(*array.shape, 2)


def _short(array: NDArray[Any]) -> NDArray[Any]:
    """Return integers of 64 bits as int32; others as they are."""
    return array.astype(np.int32) if array.dtype.kind == "i" else array
