"""The loops of the compiled engine: Numba turns them into machine code at first use."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.engine.tables import Flags, Floats, Ints, Tables, Words

if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
    raise ImportError("Numba is told not to compile")

_Function = TypeVar("_Function", bound=Callable[..., Any])

World = tuple[Ints, Floats, Words, Ints, Ints, Floats, Ints, Words]
"""What acting reads: of `Tables`, `next_state` to `standing` in their order."""

Beginning = tuple[Ints, Ints, NDArray[np.int64], bool, bool]
"""What beginning reads: `starts`, `first_start`, `limit`, `draws_levels`, `draws_starts`."""


def compiled(function: _Function) -> _Function:
    """Have Numba compile a function when it is first called; the machine code is kept on disk."""
    return cast("_Function", numba.njit(cache=True, nogil=True)(function))


def packed(tables: Tables, observations: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return all that loops read, in one array, of which `unpacked` makes the arrays again.

    To hand an array over to compiled code takes as long as several robots' steps.

    Args:
        tables: what the robots walk in.
        observations: what each state shows, int64 `[states, numbers]`.
    """
    arrays = (
        tables.next_state,
        tables.reward,
        tables.arrival,
        tables.chance,
        tables.first,
        tables.threshold,
        tables.over.astype(np.int64),
        tables.standing,
        tables.starts,
        tables.first_start,
        tables.limit,
        observations,
        tables.offset,
        np.array([tables.num_actions, tables.draws_levels, tables.draws_starts]),
    )
    ends = len(arrays) + np.cumsum([array.size for array in arrays])
    return np.concatenate([ends, *(array.ravel().view(np.int64) for array in arrays)])


@compiled
def unpacked(
    memory: NDArray[np.int64],
) -> tuple[World, Beginning, NDArray[np.int64], Ints, int]:
    """Return the world, what beginning reads, what states show, `offset` and `num_actions`."""
    next_state = memory[14 : memory[0]]
    reward = memory[memory[0] : memory[1]].view(np.float64)
    arrival = memory[memory[1] : memory[2]].view(np.uint64)
    chance = memory[memory[2] : memory[3]]
    first = memory[memory[3] : memory[4]]
    threshold = memory[memory[4] : memory[5]].view(np.float64)
    over = memory[memory[5] : memory[6]]
    standing = memory[memory[6] : memory[7]].view(np.uint64)
    starts = memory[memory[7] : memory[8]]
    first_start = memory[memory[8] : memory[9]]
    limit = memory[memory[9] : memory[10]]
    shown = memory[memory[10] : memory[11]]
    offset = memory[memory[11] : memory[12]]
    num_actions, draws_levels, draws_starts = memory[memory[12] : memory[13]]
    world = (
        next_state,
        reward,
        arrival,
        chance,
        first,
        threshold.reshape((first.size, threshold.size // max(1, first.size))),
        over,
        standing,
    )
    beginning = (starts, first_start, limit, draws_levels != 0, draws_starts != 0)
    numbers = shown.size // standing.size
    return world, beginning, shown.reshape((standing.size, numbers)), offset, num_actions


@compiled
def settle(rows: Ints, block: Floats, position: int, world: World) -> int:
    """Put the outcomes that are drawn in the place of rows; return the position after the draws."""
    _, _, _, chance, first, threshold, _, _ = world
    # No branch depends on chance: processors guess which way one goes, and would be wrong.
    which = np.empty(rows.size, np.intp)
    count = 0
    for robot in range(rows.size):
        which[count] = robot
        count += chance[rows[robot]] >= 0
    for robot in which[:count]:
        number = chance[rows[robot]]
        outcome = first[number]
        for further in range(threshold.shape[1] - 1):
            outcome += block[position] >= threshold[number, further]
        rows[robot] = outcome
        position += 1
    return position


@compiled
def begin_one(
    robot: int,
    state: Ints,
    level: Ints,
    deadline: NDArray[np.int64],
    clock: int,
    block: Floats,
    position: int,
    beginning: Beginning,
) -> int:
    """Begin an episode and return the position after its draws."""
    starts, first_start, limit, draws_levels, draws_starts = beginning
    if draws_levels:
        level[robot] = int(block[position] * limit.size)
        position += 1
    here = level[robot]
    start = first_start[here]
    if draws_starts:
        start += int(block[position] * (first_start[here + 1] - start))
        position += 1
    state[robot] = starts[start]
    deadline[robot] = limit[here] + clock
    return position


@compiled
def begin_all(
    which: Ints,
    state: Ints,
    level: Ints,
    deadline: NDArray[np.int64],
    over: Flags,
    clock: int,
    block: Floats,
    position: int,
    memory: NDArray[np.int64],
) -> int:
    """Begin episodes for robots of these numbers and return the position after their draws."""
    _, beginning, _, _, _ = unpacked(memory)
    for robot in which:
        position = begin_one(robot, state, level, deadline, clock, block, position, beginning)
        over[robot] = False
    return position


@compiled
def step(
    actions: Ints,
    state: Ints,
    level: Ints,
    deadline: NDArray[np.int64],
    over: Flags,
    clock: int,
    block: Floats,
    position: int,
    memory: NDArray[np.int64],
    observations: NDArray[np.int64],
    rewards: Floats,
    terminated: Flags,
    truncated: Flags,
    words: Words,
    acted: Flags,
) -> int:
    """Take a step and return the position after its draws, -1 if an action is none."""
    world, beginning, shown, _, num_actions = unpacked(memory)
    next_state, reward, arrival, chance, _, _, ends, standing = world
    rest = chance.size - 1
    # Loops of their own for what the processor can do for several robots at a time.
    wrong = False
    for action in actions:
        wrong |= (action < 0) | (action >= num_actions)
    if wrong:
        return -1
    anew = 0
    for robot in range(state.size):
        acted[robot] = not over[robot]
        anew += over[robot]
    rows = np.empty(state.size, np.intp)
    for robot in range(state.size):
        rows[robot] = rest if over[robot] else state[robot] * num_actions + actions[robot]
    position = settle(rows, block, position, world)
    for robot in range(state.size):
        state[robot] = next_state[rows[robot]]
        rewards[robot] = reward[rows[robot]]
        words[robot] = arrival[rows[robot]]
    if anew:
        for robot in range(state.size):
            if over[robot]:
                position = begin_one(
                    robot, state, level, deadline, clock, block, position, beginning
                )
                words[robot] = standing[state[robot]]
    for robot in range(state.size):
        terminated[robot] = ends[state[robot]] != 0
    for robot in range(state.size):
        truncated[robot] = clock >= deadline[robot]
        over[robot] = terminated[robot] | truncated[robot]
    for number in range(shown.shape[1]):
        for robot in range(state.size):
            observations[robot, number] = shown[state[robot], number]
    return position


@compiled
def walk(
    policy: Floats,
    chances: Floats,
    state: Ints,
    level: Ints,
    deadline: NDArray[np.int64],
    clock: int,
    block: Floats,
    position: int,
    memory: NDArray[np.int64],
    observations: NDArray[np.int32],
    actions: NDArray[np.int8],
    rewards: Floats,
    terminations: Flags,
    truncations: Flags,
    next_observations: NDArray[np.int32],
    words: Words,
) -> int:
    """Take steps, as many as there are rows, and return the position after their draws."""
    world, beginning, _, offset, num_actions = unpacked(memory)
    next_state, reward, _, _, _, _, ends, standing = world
    rows = np.empty(state.size, np.intp)
    for row in range(rewards.shape[0]):
        clock += 1
        for robot in range(state.size):
            observations[row, robot] = state[robot] - offset[level[robot]]
            words[row, robot] = standing[state[robot]]
        for robot in range(state.size):
            action = 0
            for number in range(num_actions - 1):
                action += chances[row, robot] >= policy[state[robot], number]
            actions[row, robot] = action
        for robot in range(state.size):
            rows[robot] = state[robot] * num_actions + actions[row, robot]
        position = settle(rows, block, position, world)
        for robot in range(state.size):
            state[robot] = next_state[rows[robot]]
            rewards[row, robot] = reward[rows[robot]]
        num_over = 0
        for robot in range(state.size):
            next_observations[row, robot] = state[robot] - offset[level[robot]]
            terminations[row, robot] = ends[state[robot]] != 0
        for robot in range(state.size):
            truncations[row, robot] = clock >= deadline[robot]
            num_over += terminations[row, robot] | truncations[row, robot]
        if num_over:
            for robot in range(state.size):
                if terminations[row, robot] | truncations[row, robot]:
                    position = begin_one(
                        robot, state, level, deadline, clock, block, position, beginning
                    )
    return position
