"""The states of many environments, and the results of steps: the arrays that engines write."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import repeat
from typing import Any, Protocol

import numpy as np
from numpy import empty, ndarray
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.draws import Draws
from babyrobot_levels.envs.engine.tables import Flags, Floats, Ints, Span, Words

# Looked up once, because making small arrays is a considerable part of a step.
_INT = np.dtype(np.int64)


class EnvStates:
    """The states of many environments. Engines change the arrays in place.

    Attributes:
        memory: int64: all the arrays, one after the other, as the compiled loops read them.
        state: intp `[envs]`, in the numbering of the tables; -1 before the first reset.
        level: intp `[envs]`: the level of each environment.
        deadline: int64 `[envs]`: the value of `clock` at which its episode is truncated.
        done: bool `[envs]`: whether its episode is over, terminated or truncated.
        clock: how many steps have been taken.
    """

    def __init__(self, num_envs: int, num_levels: int) -> None:
        """Assign level `i % num_levels` to environment i."""
        self.memory: NDArray[np.int64] = np.zeros(num_envs * 3 + -(-num_envs // 8), np.int64)
        self.clock = 0
        self._divide(num_envs)
        self.level[:] = np.arange(num_envs) % num_levels
        self.state.fill(-1)
        self.done.fill(True)

    def _divide(self, num_envs: int) -> None:
        state, level, deadline, over = np.split(self.memory, [num_envs, 2 * num_envs, 3 * num_envs])
        self.state: Ints = state.view(np.intp)[:num_envs]
        self.level: Ints = level.view(np.intp)[:num_envs]
        self.deadline: NDArray[np.int64] = deadline
        self.done: Flags = over.view(np.bool_)[:num_envs]

    def __getstate__(self) -> tuple[int, NDArray[np.int64], int]:
        return self.state.size, self.memory, self.clock

    def __setstate__(self, state: tuple[int, NDArray[np.int64], int]) -> None:
        # A copy of a view is not a view.
        num_envs, self.memory, self.clock = state
        self._divide(num_envs)


MOST_WORDS = 8192
"""Arrays for several steps are made at a time if they take no more than these words together."""


class Layout:
    """Where the arrays of `Results` are in its memory.

    Attributes:
        dtype: one record of all of them.
        words: how many words of eight bytes they take.
        ahead: for how many steps arrays are made at a time.
        words_at_masks: shape, dtype, offset and strides of what `Results` has under this name.
        tells_held: whether there are items.
        tells_hits: whether there are movers.
    """

    def __init__(
        self,
        num_envs: int,
        numbers: int,
        num_actions: int,
        num_items: int = 0,
        tells_hits: bool = False,
        has_records: bool = True,
    ) -> None:
        """Compute the layout.

        Args:
            num_envs: how many environments there are.
            numbers: how many numbers an observation has.
            num_actions: how many actions there are.
            num_items: the most items of a level.
            tells_hits: whether a level has movers.
            has_records: whether results have records.
        """
        self.tells_held, self.tells_hits = num_items > 0, tells_hits
        each = (num_envs,)
        fields: dict[str, tuple[Any, int]] = {}
        end = 0
        for name, dtype, shape in (
            ("observations", np.int64, (num_envs, numbers)),
            ("rewards", np.float64, each),
            ("masks", np.int8, (num_envs, num_actions)),
            ("terminated", np.bool_, each),
            ("reached", np.bool_, each),
            ("skidded", np.bool_, each),
            ("truncated", np.bool_, each),
            ("all_true", np.bool_, each),
            ("hit", np.bool_, each),
            ("held", np.bool_, (num_envs, num_items)),
        ):
            fields[name] = np.dtype((dtype, shape)), end
            end += fields[name][0].itemsize
        fields["mask_bytes"] = np.dtype((f"V{num_actions}", each)), fields["masks"][1]
        fields["flags"] = np.dtype((np.uint8, (3, num_envs))), fields["terminated"][1]
        self.words_at_masks = each, np.dtype(np.uint64), fields["masks"][1], (num_actions,)
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
        self.ahead = 1 if has_records else max(1, MOST_WORDS // self.words)

    def tells(self, name: str) -> bool:
        """Return whether there is an array of `Results`."""
        return {"hit": self.tells_hits, "held": self.tells_held}.get(name, True)


_ROW_BY_ROW = (
    *("observations", "rewards", "masks", "terminated", "reached", "skidded"),
    *("truncated", "all_true", "hit", "held"),
)
"""The arrays of `Results` in the order in which those of several steps are taken."""


class Results:
    """The results of a step: arrays that engines fill, views of one piece of memory.

    The object stays, its arrays are replaced: by `renew`, if steps return new ones.

    Attributes:
        memory: int64 `[rows, words]`, in which the arrays are one row, for the compiled loops.
        row: which row.
        observations: int64 `[envs, numbers]`.
        rewards: float64 `[envs]`.
        masks: int8 `[envs, actions]`: the action masks.
        terminated: bool `[envs]`.
        reached: bool `[envs]`: whether the outcome was `Event.REACHED`.
        skidded: bool `[envs]`: whether it was `Event.SKIDDED`.
        truncated: bool `[envs]`.
        all_true: bool `[envs]`.
        hit: bool `[envs]`: whether a mover hit the robot; only if the layout has movers.
        held: bool `[envs, items]`: the items that are held; only if the layout has items.
        record: all of them; also `mask_bytes`, void `[envs]`: `masks`, and `flags`, uint8
            `[3, envs]`: `terminated`, `reached`, `skidded`. Only if the layout has records.
    """

    __slots__ = (
        "_ready",
        "_words",
        "all_true",
        "held",
        "hit",
        "layout",
        "masks",
        "memory",
        "observations",
        "reached",
        "record",
        "rewards",
        "row",
        "skidded",
        "terminated",
        "truncated",
    )

    memory: NDArray[np.int64]
    row: int
    observations: NDArray[np.int64]
    rewards: Floats
    masks: NDArray[np.int8]
    terminated: Flags
    reached: Flags
    skidded: Flags
    truncated: Flags
    all_true: Flags
    hit: Flags
    held: Flags
    record: Any

    def __init__(self, layout: Layout) -> None:
        """Make the arrays, not initialised."""
        self.layout, self.row = layout, 0
        self._ready: list[Any] = []
        self._words: Words | None = None
        self.renew()

    def __reduce__(self) -> Any:
        # Copies of the arrays would not be views of one piece of memory.
        return type(self), (self.layout,)

    def renew(self) -> None:
        """Replace the arrays by new ones."""
        layout = self.layout
        if layout.ahead > 1:
            self._take()
            return
        self._words = None
        self.memory = memory = empty((1, layout.words), _INT)
        # Taking arrays out of a record is the fastest way to make them.
        self.record = record = ndarray((), layout.dtype, memory)
        self.observations = record["observations"]
        self.rewards = record["rewards"]
        self.masks = record["masks"]
        self.terminated = record["terminated"]
        self.reached = record["reached"]
        self.skidded = record["skidded"]
        self.truncated = record["truncated"]
        self.all_true = record["all_true"]
        if layout.tells_hits:
            self.hit = record["hit"]
        if layout.tells_held:
            self.held = record["held"]

    def _take(self) -> None:
        """Replace the arrays by those of the next row, or of the first one of new memory."""
        if not self._ready:
            layout = self.layout
            self.memory = empty((layout.ahead, layout.words), _INT)
            records = ndarray(layout.ahead, layout.dtype, self.memory)
            columns = (
                records[name] if layout.tells(name) else repeat(None) for name in _ROW_BY_ROW
            )
            self._ready = [*zip(range(layout.ahead), *columns, strict=False)]
        (
            self.row,
            self.observations,
            self.rewards,
            self.masks,
            self.terminated,
            self.reached,
            self.skidded,
            self.truncated,
            self.all_true,
            self.hit,
            self.held,
        ) = self._ready.pop()

    def words_at_masks(self) -> Words:
        """Return info words, uint64 `[envs]`, of which each begins where a mask does.

        They overlap: if they are written in their order, the masks are those of the words.
        """
        if self._words is None:
            shape, dtype, offset, strides = self.layout.words_at_masks
            self._words = ndarray(shape, dtype, self.memory, offset, strides)
        return self._words


@dataclass(slots=True)
class Record:
    """The transitions of a rollout; all arrays are `[steps, envs]`.

    Attributes:
        observations: int32: the state before the action, in its level's own numbering.
        actions: int8.
        rewards: float64.
        terminations: bool.
        truncations: bool.
        next_observations: int32: the state after the action.
        words: uint64: the info words before the action.
    """

    observations: NDArray[np.int32]
    actions: NDArray[np.int8]
    rewards: Floats
    terminations: Flags
    truncations: Flags
    next_observations: NDArray[np.int32]
    words: Words

    @classmethod
    def empty(cls, num_steps: int, num_envs: int) -> Record:
        """Return uninitialised arrays."""
        dtypes = (np.int32, np.int8, np.float64, np.bool_, np.bool_, np.int32, np.uint64)
        count = num_steps * num_envs
        # One piece of memory, because systems use larger pages for larger pieces.
        ends = np.cumsum([(count * np.dtype(dtype).itemsize + 63) // 64 * 64 for dtype in dtypes])
        parts = np.split(np.empty(ends[-1], np.uint8), ends[:-1])
        return cls(
            *(
                part.view(dtype)[:count].reshape(num_steps, num_envs)
                for part, dtype in zip(parts, dtypes, strict=True)
            )
        )

    def rows(self, begin: int, end: int) -> Record:
        """Return a range of steps, as views."""
        return Record(*(getattr(self, name)[begin:end] for name in Record.__slots__))


class Engine(Protocol):
    """Steps environments through tables. All engines give the same results with the same draws."""

    name: str
    writes_records: bool
    """Whether it writes into the records of results, or else into their memory."""

    def update(self, span: Span) -> None:
        """Read a slot of the tables and observations again, after it was written."""

    def reset(self, envs: EnvStates, which: Ints, draws: Draws) -> None:
        """Start new episodes in the environments with these indices, one after the other.

        Each draws its level, if levels are drawn, and then its start; see `Draws.starts`.
        """

    def step(self, envs: EnvStates, actions: Ints, draws: Draws, results: Results) -> bool:
        """Take an action in each environment, or start a new episode where the last one is over.

        Draws are taken in the order of environments: first by those that act and whose action has
        several outcomes, then by those that start a new episode.

        Returns:
            Whether all actions are from 0 to `num_actions - 1`. If not, nothing was changed.
        """

    def run(
        self, envs: EnvStates, policy: Floats, chances: Floats, draws: Draws, record: Record
    ) -> None:
        """Follow a policy for several steps, with autoreset in the same step, and record them.

        An environment takes the action whose number is how many of the policy's thresholds in its
        state are at most its chance. In each step, draws are taken as in `step`, and then by those
        whose episode is over.

        Args:
            envs: the environments.
            policy: float64 `[states, num_actions - 1]`: thresholds, in rising order.
            chances: float64 `[steps, envs]`, from 0 up to but not including 1.
            draws: the source of randomness.
            record: where to write the transitions.
        """
