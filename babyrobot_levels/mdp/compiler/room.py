"""Room for the tables, which are filled part by part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.compiler.outcomes import Flags, Floats, Ints


@dataclass(frozen=True, slots=True)
class Outcomes:
    """Distinct outcomes, sorted by row, next state, reward and whether they end the episode.

    `slot` is the number of each among those of its row.
    """

    row: Ints
    slot: Ints
    probability: Floats
    next_state: Ints
    reward: Floats
    terminal: Flags

    @property
    def width(self) -> int:
        """How many outcomes the longest row has."""
        return int(self.slot.max(initial=0)) + 1


class Room:
    """The tables of some states, with room for a number of outcomes in each row."""

    def __init__(self, states: int, width: int):
        self._shape = states, NUM_ACTIONS, width
        rows = states * NUM_ACTIONS, width
        self._used = 1
        self._tables: dict[str, NDArray[Any]] = {
            "probability": np.zeros(rows),
            "next_state": np.zeros(rows, np.int32),
            "reward": np.zeros(rows),
            "terminal": np.zeros(rows, bool),
        }

    def put(self, outcomes: Outcomes) -> None:
        """Put outcomes in their rows."""
        self._used = max(self._used, outcomes.width)
        place = outcomes.row * self._shape[2] + outcomes.slot
        for name, table in self._tables.items():
            table.reshape(-1)[place] = getattr(outcomes, name)

    def tables(self) -> dict[str, Any]:
        """Return the tables `[states, actions, outcomes]`, as wide as the longest row needs."""
        for name, table in self._tables.items():
            # One after the other: two copies of all of them would need much.
            narrow = np.ascontiguousarray(table[:, : self._used])
            self._tables[name] = narrow.reshape(*self._shape[:2], self._used)
        return self._tables


def merged(
    row: Ints, probability: Floats, next_state: Ints, reward: Floats, terminal: Flags
) -> Outcomes:
    """Return the outcomes sorted, those that are alike as one."""
    order = np.lexsort((terminal, reward, next_state, row))
    row, next_state, reward, terminal = (
        row[order],
        next_state[order],
        reward[order],
        terminal[order],
    )
    is_new = np.ones(row.size, bool)
    is_new[1:] = (
        (row[1:] != row[:-1])
        | (next_state[1:] != next_state[:-1])
        | (reward[1:] != reward[:-1])
        | (terminal[1:] != terminal[:-1])
    )
    first = is_new.nonzero()[0]
    total = np.add.reduceat(probability[order], first)
    row = row[first]
    begins = np.ones(row.size, bool)
    begins[1:] = row[1:] != row[:-1]
    begin = begins.nonzero()[0]
    slot = np.arange(row.size) - np.repeat(begin, np.diff(np.append(begin, row.size)))
    return Outcomes(row, slot, total, next_state[first], reward[first], terminal[first])
