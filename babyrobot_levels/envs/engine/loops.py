"""The loops of the compiled engine: Numba turns them into machine code at first use.

All of them are in this file, because Numba's cache is only valid as long as the file is unchanged.
"""

import sys
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.draws import NONE
from babyrobot_levels.envs.engine.tables import (
    END,
    FIRST_BYTE,
    HIT,
    MASK_BITS,
    MOST_ACTIONS,
    NEXT_BYTE,
    REACHED,
    SKIDDED,
    TERMINAL,
    Flags,
    Floats,
    Ints,
    Words,
)
from babyrobot_levels.mdp.actions import NUM_ACTIONS

if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
    raise ImportError("Numba is configured not to compile")

_Function = TypeVar("_Function", bound=Callable[..., Any])

Drawn = NDArray[Any]
"""The `memory` of `SharedDraws`, float64 `[draws]`, or of `OwnDraws`."""

LOWER = 2**32 - 1
"""The lower half of a word."""

IS_TERMINAL, IS_HIT, IS_REACHED, IS_SKIDDED = (
    np.uint64(bit << (FIRST_BYTE + byte * NEXT_BYTE))
    for bit, byte in ((TERMINAL, END), (HIT, END), (1, REACHED), (1, SKIDDED))
)
"""The bits of info words."""

IS_LITTLE = sys.byteorder == "little"

Transitions = tuple[Ints, Floats, Words, Ints, Floats, Words]
"""What acting reads: the attributes of `Tables` from `next_state` to `state_info`, in order.

Arrays are flat here and in `Shown`: reshaping them takes as long as ten steps of an environment.
"""

Shown = tuple[NDArray[np.int64], NDArray[np.uint8], int, bool]
"""What is told of a state: the observations, `held`, how many items, and `tells_hits`."""

Starts = tuple[Ints, Ints, NDArray[np.int64], bool, bool]
"""What a reset reads: `starts`, `first_start`, `limit`, `draws_levels`, `draws_starts`."""


def compiled(function: _Function) -> _Function:
    """Have Numba compile a function at its first call, and keep the machine code on disk."""
    return cast("_Function", numba.njit(cache=True, nogil=True)(function))


@compiled
def unpacked(memory: NDArray[np.int64]) -> tuple[Transitions, Starts, Shown, Ints, int]:
    """Return what acting, resetting and telling read, `offset` and `num_actions`."""
    next_state = memory[13 : memory[0]]
    reward = memory[memory[0] : memory[1]].view(np.float64)
    outcome_info = memory[memory[1] : memory[2]].view(np.uint64)
    first = memory[memory[2] : memory[3]]
    threshold = memory[memory[3] : memory[4]].view(np.float64)
    state_info = memory[memory[4] : memory[5]].view(np.uint64)
    starts = memory[memory[5] : memory[6]]
    first_start = memory[memory[6] : memory[7]]
    limit = memory[memory[7] : memory[8]]
    observations = memory[memory[8] : memory[9]]
    offset = memory[memory[9] : memory[10]]
    held = memory[memory[10] : memory[11]].view(np.uint8)
    num_actions, draws_levels, draws_starts, tells_hits, num_items = memory[memory[11] : memory[12]]
    transitions = (next_state, reward, outcome_info, first, threshold, state_info)
    resetting = (starts, first_start, limit, draws_levels != 0, draws_starts != 0)
    shown = (observations, held, num_items, tells_hits != 0)
    return transitions, resetting, shown, offset, num_actions


@compiled
def uniform(drawn: Drawn, position: int, env: int) -> float:
    """Return an environment's next draw, from 0 up to but not including 1.

    One-dimensional draws are those of `SharedDraws`, and the caller advances `position`; the
    others are those of `OwnDraws`. Numba knows at compile time which of them it has.
    """
    if drawn.ndim == 1:
        return float(drawn[position])
    column = drawn[env, 0]
    drawn[env, 0] = column + 1
    return float((np.uint64(drawn[env, column]) >> np.uint64(11)) * 2.0**-53)


@compiled
def below(drawn: Drawn, position: int, env: int, count: int) -> int:
    """Return a whole number below a count, as `SharedDraws` and `OwnDraws` draw it."""
    if drawn.ndim == 1:
        return int(drawn[position] * count)
    if count == 1:
        return 0
    while True:
        half = drawn[env, 1]
        drawn[env, 1] = NONE
        if half == NONE:
            column = drawn[env, 0]
            drawn[env, 0] = column + 1
            half = drawn[env, column] & LOWER
            drawn[env, 1] = drawn[env, column] >> 32 & LOWER
        product = half * count
        if product & LOWER >= (LOWER + 1) % count:
            return int(product >> 32)


@compiled
def draw_outcomes(rows: Ints, drawn: Drawn, position: int, transitions: Transitions) -> int:
    """Replace stochastic rows by the outcomes drawn; return the position after the draws."""
    next_state, _, _, first, threshold, _ = transitions
    width = threshold.size // max(1, first.size)
    # No branch depends on chance, because processors would often predict it wrongly.
    which = np.empty(rows.size, np.intp)
    count = 0
    for env in range(rows.size):
        which[count] = env
        count += next_state[rows[env]] < 0
    for env in which[:count]:
        number = next_state[rows[env]] + first.size
        outcome = first[number]
        draw = uniform(drawn, position, env)
        for further in range(width - 1):
            outcome += draw >= threshold[number * width + further]
        rows[env] = outcome
        position += 1
    return position


@compiled
def reset_one(
    env: int,
    state: Ints,
    level: Ints,
    deadline: NDArray[np.int64],
    clock: int,
    drawn: Drawn,
    position: int,
    resetting: Starts,
) -> int:
    """Start an episode and return the position after its draws."""
    starts, first_start, limit, draws_levels, draws_starts = resetting
    if draws_levels:
        level[env] = int(uniform(drawn, position, env) * limit.size)
        position += 1
    here = level[env]
    start = first_start[here]
    if draws_starts:
        start += below(drawn, position, env, first_start[here + 1] - start)
        position += 1
    state[env] = starts[start]
    deadline[env] = limit[here] + clock
    return position


@compiled
def arrays_of_states(
    num_envs: int, envs: NDArray[np.int64]
) -> tuple[Ints, Ints, Ints, NDArray[np.uint8]]:
    """Return the arrays of `EnvStates` in its memory; flags are bytes."""
    return (
        envs[:num_envs],
        envs[num_envs : 2 * num_envs],
        envs[2 * num_envs : 3 * num_envs],
        envs[3 * num_envs :].view(np.uint8),
    )


@compiled
def reset_all(
    which: Ints,
    num_envs: int,
    envs: NDArray[np.int64],
    clock: int,
    drawn: Drawn,
    position: int,
    memory: NDArray[np.int64],
) -> int:
    """Start episodes in these environments and return the position after the draws."""
    state, level, deadline, done = arrays_of_states(num_envs, envs)
    _, resetting, _, _, _ = unpacked(memory)
    for env in which:
        position = reset_one(env, state, level, deadline, clock, drawn, position, resetting)
        done[env] = False
    return position


@compiled
def step(
    actions: Ints,
    envs: NDArray[np.int64],
    clock: int,
    drawn: Drawn,
    position: int,
    memory: NDArray[np.int64],
    blocks: NDArray[np.int64],
    row: int,
) -> int:
    """Take a step and return the position after its draws, -1 if an action is invalid.

    Results are written into a row of `blocks`, in the order of `Layout`.
    """
    results = blocks[row]
    transitions, resetting, shown, _, num_actions = unpacked(memory)
    next_state, reward, outcome_info, _, _, state_info = transitions
    observation_of, held_in, num_items, tells_hits = shown
    idle_row = state_info.size * num_actions
    count, numbers = actions.size, observation_of.size // state_info.size
    state, level, deadline, done = arrays_of_states(count, envs)
    end = numbers * count
    observations = results[:end]
    rewards = results[end : end + count].view(np.float64)
    rest = results[end + count :].view(np.uint8)
    width = num_actions if num_actions <= MOST_ACTIONS else NUM_ACTIONS
    masks, rest = rest[: count * width], rest[count * width :]
    terminated, reached, skidded = (
        rest[:count],
        rest[count : 2 * count],
        rest[2 * count : 3 * count],
    )
    truncated, all_true, hit = (
        rest[3 * count : 4 * count],
        rest[4 * count : 5 * count],
        rest[5 * count : 6 * count],
    )
    held = rest[6 * count : (6 + num_items) * count]
    # Separate loops for what the processor can do for several environments at a time.
    wrong = False
    for action in actions:
        wrong |= (action < 0) | (action >= num_actions)
    if wrong:
        return -1
    num_resets = 0
    for env in range(count):
        num_resets += done[env]
    rows, words = np.empty(count, np.intp), np.empty(count, np.uint64)
    for env in range(count):
        rows[env] = idle_row if done[env] else state[env] * num_actions + actions[env]
    position = draw_outcomes(rows, drawn, position, transitions)
    for env in range(count):
        state[env] = next_state[rows[env]]
        rewards[env] = reward[rows[env]]
        words[env] = outcome_info[rows[env]]
    if num_resets:
        for env in range(count):
            if done[env]:
                position = reset_one(env, state, level, deadline, clock, drawn, position, resetting)
                words[env] = state_info[state[env]]
    if width == 5:
        write_masks(words, masks, 5)
    elif width == 4:
        write_masks(words, masks, 4)
    elif width == 3:
        write_masks(words, masks, 3)
    else:
        write_bits(words, masks, width)
    for env in range(count):
        terminated[env] = words[env] & IS_TERMINAL != 0
        reached[env] = words[env] & IS_REACHED != 0
        skidded[env] = words[env] & IS_SKIDDED != 0
        all_true[env] = 1
    if tells_hits:
        for env in range(count):
            hit[env] = words[env] & IS_HIT != 0
    for env in range(count):
        truncated[env] = clock >= deadline[env]
        done[env] = terminated[env] | truncated[env]
    for number in range(numbers):
        for env in range(count):
            observations[env * numbers + number] = observation_of[state[env] * numbers + number]
    for number in range(num_items):
        for env in range(count):
            held[env * num_items + number] = held_in[state[env] * num_items + number]
    return position


@compiled
def write_masks(words: Words, masks: NDArray[np.uint8], num_actions: int) -> None:
    """Write the action masks of info words, those of one environment after the other.

    Called with a constant number of actions, it is compiled into code without branches.
    """
    bits, full = np.uint64(8 * num_actions), np.uint64(64)
    most = (np.uint64(1) << bits) - np.uint64(1)
    # The masks of eight environments fill as many words as there are actions.
    blocks = words.size // 8 if IS_LITTLE else 0
    packed = masks[: 8 * blocks * num_actions].view(np.uint64)
    for block in range(blocks):
        number, pack, filled = block * num_actions, np.uint64(0), np.uint64(0)
        for env in range(8):
            mask = words[8 * block + env] & most
            pack |= mask << filled
            filled += bits
            if filled >= full:
                packed[number] = pack
                number += 1
                filled -= full
                pack = mask >> (bits - filled)
    for env in range(8 * blocks, words.size):
        for action in range(num_actions):
            shift = np.uint64(FIRST_BYTE + action * NEXT_BYTE)
            masks[env * num_actions + action] = words[env] >> shift


@compiled
def write_bits(words: Words, masks: NDArray[np.uint8], num_actions: int) -> None:
    """Write the action masks of info words that have them as bits."""
    for env in range(words.size):
        bits = words[env] >> np.uint64(MASK_BITS)
        for action in range(num_actions):
            masks[env * num_actions + action] = bits >> np.uint64(action) & np.uint64(1)


@compiled
def run(
    policy: Floats,
    chances: Floats,
    num_envs: int,
    envs: NDArray[np.int64],
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
    state, level, deadline, _ = arrays_of_states(num_envs, envs)
    transitions, resetting, _, offset, num_actions = unpacked(memory)
    next_state, reward, outcome_info, _, _, state_info = transitions
    rows = np.empty(state.size, np.intp)
    for row in range(rewards.shape[0]):
        clock += 1
        for env in range(state.size):
            observations[row, env] = state[env] - offset[level[env]]
            words[row, env] = state_info[state[env]]
        for env in range(state.size):
            action = 0
            for number in range(num_actions - 1):
                action += chances[row, env] >= policy[state[env], number]
            actions[row, env] = action
        for env in range(state.size):
            rows[env] = state[env] * num_actions + actions[row, env]
        position = draw_outcomes(rows, drawn, position, transitions)
        for env in range(state.size):
            state[env] = next_state[rows[env]]
            rewards[row, env] = reward[rows[env]]
            terminations[row, env] = outcome_info[rows[env]] & IS_TERMINAL != 0
        num_done = 0
        for env in range(state.size):
            next_observations[row, env] = state[env] - offset[level[env]]
        for env in range(state.size):
            truncations[row, env] = clock >= deadline[env]
            num_done += terminations[row, env] | truncations[row, env]
        if num_done:
            for env in range(state.size):
                if terminations[row, env] | truncations[row, env]:
                    position = reset_one(
                        env, state, level, deadline, clock, drawn, position, resetting
                    )
    return position
