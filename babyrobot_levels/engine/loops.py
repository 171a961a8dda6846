"""The loops of the compiled engine: Numba turns them into machine code at first use."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numba
import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.engine.tables import ALWAYS, Flags, Floats, Ints, Tables, Words

_Function = TypeVar("_Function", bound=Callable[..., Any])

World = tuple[Ints, Floats, Words, Floats, Ints, Flags, Words]
Beginning = tuple[Ints, Ints, NDArray[np.int64], bool, bool]


def compiled(function: _Function) -> _Function:
    """Have Numba compile a function when it is first called; the machine code is kept on disk."""
    made: _Function = numba.njit(cache=True, nogil=True)(function)
    return made


def world_of(tables: Tables) -> World:
    """Return the arrays that acting reads."""
    return (
        tables.next_state,
        tables.reward,
        tables.arrival,
        tables.threshold,
        tables.otherwise,
        tables.over,
        tables.standing,
    )


def beginning_of(tables: Tables) -> Beginning:
    """Return what beginning an episode reads."""
    return (
        tables.starts,
        tables.first_start,
        tables.limit,
        tables.draws_levels,
        tables.draws_starts,
    )


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
    beginning: Beginning,
) -> int:
    """Begin episodes for robots of these numbers and return the position after their draws."""
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
    num_actions: int,
    world: World,
    beginning: Beginning,
    shown: NDArray[np.int64],
    observations: NDArray[np.int64],
    rewards: Floats,
    terminated: Flags,
    truncated: Flags,
    words: Words,
    acted: Flags,
) -> int:
    """Take a step and return the position after its draws, -1 if an action is none."""
    next_state, reward, arrival, threshold, otherwise, ends, standing = world
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
    for robot in range(state.size):
        if over[robot]:
            continue
        outcome = state[robot] * num_actions + actions[robot]
        if threshold[outcome] < ALWAYS:
            drawn = block[position]
            position += 1
            while drawn >= threshold[outcome]:
                outcome = otherwise[outcome]
        state[robot] = next_state[outcome]
        rewards[robot] = reward[outcome]
        words[robot] = arrival[outcome]
    if anew:
        for robot in range(state.size):
            if over[robot]:
                position = begin_one(
                    robot, state, level, deadline, clock, block, position, beginning
                )
                rewards[robot] = 0.0
                words[robot] = standing[state[robot]]
    for robot in range(state.size):
        terminated[robot] = ends[state[robot]]
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
    world: World,
    beginning: Beginning,
    offset: Ints,
    observations: NDArray[np.int32],
    actions: NDArray[np.int8],
    rewards: Floats,
    terminations: Flags,
    truncations: Flags,
    next_observations: NDArray[np.int32],
    words: Words,
) -> int:
    """Take steps, as many as there are rows, and return the position after their draws."""
    next_state, reward, _, threshold, otherwise, ends, standing = world
    num_actions = policy.shape[1] + 1
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
            outcome = state[robot] * num_actions + actions[row, robot]
            if threshold[outcome] < ALWAYS:
                drawn = block[position]
                position += 1
                while drawn >= threshold[outcome]:
                    outcome = otherwise[outcome]
            state[robot] = next_state[outcome]
            rewards[row, robot] = reward[outcome]
        num_over = 0
        for robot in range(state.size):
            next_observations[row, robot] = state[robot] - offset[level[robot]]
            terminations[row, robot] = ends[state[robot]]
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
