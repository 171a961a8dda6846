"""The loops of the compiled engine: Numba turns them into machine code at first use.

All of them stand in this file, because Numba takes what it kept for a file that has not changed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.draws import NONE
from babyrobot_levels.envs.engine.tables import Flags, Floats, Ints, Words

if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
    raise ImportError("Numba is told not to compile")

_Function = TypeVar("_Function", bound=Callable[..., Any])

Drawn = NDArray[Any]
"""What is drawn from: the `memory` of `SharedDraws`, float64 `[draws]`, or of `OwnDraws`."""

LOWER = 2**32 - 1
"""The lower half of a word."""

World = tuple[Ints, Floats, Words, Ints, Ints, Floats, Ints, Words]
"""What acting reads: of `Tables`, `next_state` to `standing` in their order."""

Beginning = tuple[Ints, Ints, NDArray[np.int64], bool, bool]
"""What beginning reads: `starts`, `first_start`, `limit`, `draws_levels`, `draws_starts`."""


def compiled(function: _Function) -> _Function:
    """Have Numba compile a function when it is first called; the machine code is kept on disk."""
    return cast("_Function", numba.njit(cache=True, nogil=True)(function))


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
def uniform(drawn: Drawn, position: int, robot: int) -> float:
    """Return a robot's next draw, from 0 up to but not including 1.

    Shared draws are those of `SharedDraws`, and the caller counts them with `position`; others
    those of `OwnDraws`. Which of them there are, Numba knows when it compiles.
    """
    if drawn.ndim == 1:
        return float(drawn[position])
    column = drawn[robot, 0]
    drawn[robot, 0] = column + 1
    return float((np.uint64(drawn[robot, column]) >> np.uint64(11)) * 2.0**-53)


@compiled
def below(drawn: Drawn, position: int, robot: int, count: int) -> int:
    """Return a whole number below a count, as `SharedDraws` and `OwnDraws` draw it."""
    if drawn.ndim == 1:
        return int(drawn[position] * count)
    if count == 1:
        return 0
    while True:
        half = drawn[robot, 1]
        drawn[robot, 1] = NONE
        if half == NONE:
            column = drawn[robot, 0]
            drawn[robot, 0] = column + 1
            half = drawn[robot, column] & LOWER
            drawn[robot, 1] = drawn[robot, column] >> 32 & LOWER
        product = half * count
        if product & LOWER >= (LOWER + 1) % count:
            return int(product >> 32)


@compiled
def settle(rows: Ints, drawn: Drawn, position: int, world: World) -> int:
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
        draw = uniform(drawn, position, robot)
        for further in range(threshold.shape[1] - 1):
            outcome += draw >= threshold[number, further]
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
    drawn: Drawn,
    position: int,
    beginning: Beginning,
) -> int:
    """Begin an episode and return the position after its draws."""
    starts, first_start, limit, draws_levels, draws_starts = beginning
    if draws_levels:
        level[robot] = int(uniform(drawn, position, robot) * limit.size)
        position += 1
    here = level[robot]
    start = first_start[here]
    if draws_starts:
        start += below(drawn, position, robot, first_start[here + 1] - start)
        position += 1
    state[robot] = starts[start]
    deadline[robot] = limit[here] + clock
    return position


@compiled
def places(
    num_robots: int, robots: NDArray[np.int64]
) -> tuple[Ints, Ints, Ints, NDArray[np.uint8]]:
    """Return the arrays of `Robots` in its memory; flags are bytes."""
    return (
        robots[:num_robots],
        robots[num_robots : 2 * num_robots],
        robots[2 * num_robots : 3 * num_robots],
        robots[3 * num_robots :].view(np.uint8),
    )


@compiled
def begin_all(
    which: Ints,
    num_robots: int,
    robots: NDArray[np.int64],
    clock: int,
    drawn: Drawn,
    position: int,
    memory: NDArray[np.int64],
) -> int:
    """Begin episodes for robots of these numbers and return the position after their draws."""
    state, level, deadline, over = places(num_robots, robots)
    _, beginning, _, _, _ = unpacked(memory)
    for robot in which:
        position = begin_one(robot, state, level, deadline, clock, drawn, position, beginning)
        over[robot] = False
    return position


@compiled
def step(
    actions: Ints,
    robots: NDArray[np.int64],
    clock: int,
    drawn: Drawn,
    position: int,
    memory: NDArray[np.int64],
    results: NDArray[np.int64],
) -> int:
    """Take a step and return the position after its draws, -1 if an action is none."""
    world, beginning, shown, _, num_actions = unpacked(memory)
    next_state, reward, arrival, chance, _, _, ends, standing = world
    rest = chance.size - 1
    count, numbers = actions.size, shown.shape[1]
    state, level, deadline, over = places(count, robots)
    # As `Layout` lays them out.
    end = numbers * count
    observations = results[:end].reshape((count, numbers))
    rewards = results[end : end + count].view(np.float64)
    words = results[end + count : end + 2 * count].view(np.uint64)
    flags = results[end + 2 * count :].view(np.uint8)
    terminated, truncated, acted = flags[:count], flags[count : 2 * count], flags[2 * count :]
    # Loops of their own for what the processor can do for several robots at a time.
    wrong = False
    for action in actions:
        wrong |= (action < 0) | (action >= num_actions)
    if wrong:
        return -1
    anew = 0
    for robot in range(count):
        acted[robot] = 1 - over[robot]
        anew += over[robot]
    acted[count : 2 * count] = 1
    rows = np.empty(count, np.intp)
    for robot in range(count):
        rows[robot] = rest if over[robot] else state[robot] * num_actions + actions[robot]
    position = settle(rows, drawn, position, world)
    for robot in range(count):
        state[robot] = next_state[rows[robot]]
        rewards[robot] = reward[rows[robot]]
        words[robot] = arrival[rows[robot]]
    if anew:
        for robot in range(count):
            if over[robot]:
                position = begin_one(
                    robot, state, level, deadline, clock, drawn, position, beginning
                )
                words[robot] = standing[state[robot]]
    for robot in range(count):
        terminated[robot] = ends[state[robot]]
    for robot in range(count):
        truncated[robot] = clock >= deadline[robot]
        over[robot] = terminated[robot] | truncated[robot]
    for number in range(numbers):
        for robot in range(count):
            observations[robot, number] = shown[state[robot], number]
    return position


@compiled
def walk(
    policy: Floats,
    chances: Floats,
    num_robots: int,
    robots: NDArray[np.int64],
    clock: int,
    drawn: Drawn,
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
    state, level, deadline, _ = places(num_robots, robots)
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
        position = settle(rows, drawn, position, world)
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
                        robot, state, level, deadline, clock, drawn, position, beginning
                    )
    return position
