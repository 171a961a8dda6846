"""Depth-first mazes as machine code. Imports Numba; `compiled` decides whether to use it.

The Mersenne Twister is here a second time, as Python seeds it and draws from it.
"""

import numba
import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.mazes.lattice import BACK, THERE, WAYS

Words = NDArray[np.uint32]

jit = numba.njit(cache=True, nogil=True)

WORDS, AHEAD = 624, 397
LOW_32 = np.uint64(0xFFFFFFFF)
FIRST, SECOND = np.uint64(1664525), np.uint64(1566083941)
LANES = 8
"""So many generators are seeded side by side: each step of seeding waits for the one before it."""


def _first_state() -> Words:
    """Return the state that all seeds are mixed into."""
    words = [19650218]
    for number in range(1, WORDS):
        last = words[-1]
        words.append((1812433253 * (last ^ last >> 30) + number) & 0xFFFFFFFF)
    return np.array(words, np.uint32)


FIRST_STATE = _first_state()
SHIFTS = np.array([32 - count.bit_length() for count in range(5)], np.uint64)
COUNTS = np.array([len(ways) for ways in WAYS])
CHOICES = np.array([(*ways, *[0] * (4 - len(ways))) for ways in WAYS])
SIDES_THERE, SIDES_BACK = np.array(THERE, np.uint8), np.array(BACK, np.uint8)


@jit
def depth_first(
    width: int, height: int, blocked: bytes, start: int, key: bytes, sides: bytearray
) -> int:
    """Carve a maze, as the plain `depth_first` does it.

    Args:
        width: the number of columns.
        height: the number of rows.
        blocked: 1 for each blocked cell, row by row.
        start: the number of the cell to begin with.
        key: the seed's absolute value, least significant byte first, in whole words of 32 bits.
        sides: where the open sides of the cells go, row by row.

    Returns:
        How many words of 32 bits were drawn.
    """
    state = np.empty((WORDS, 1), np.uint32)
    _seed(state, key)
    return _carve(state, 0, width, height, blocked, start, sides, 0)


@jit
def depth_first_many(
    width: int, height: int, blocked: bytes, start: int, keys: NDArray[np.uint64], sides: bytearray
) -> None:
    """Carve a maze for each of many seeds, one after the other in `sides`; see `depth_first`.

    Args:
        width: the number of columns.
        height: the number of rows.
        blocked: 1 for each blocked cell, row by row.
        start: the number of the cell to begin with.
        keys: the absolute values of the seeds.
        sides: where the open sides of the cells go, maze by maze.
    """
    states = np.empty((WORDS, LANES), np.uint32)
    for first in range(0, len(keys), LANES):
        _seed_many(states, keys[first : first + LANES])
        for lane in range(min(LANES, len(keys) - first)):
            begin = (first + lane) * width * height
            _carve(states, lane, width, height, blocked, start, sides, begin)


@jit
def _seed(states: Words, key: bytes) -> None:
    """Seed a single generator, `[WORDS, 1]`."""
    length = len(key) // 4
    states[:, 0] = FIRST_STATE
    place, number = 1, 0
    last = np.uint64(FIRST_STATE[0])
    for _ in range(max(WORDS, length)):
        word = np.uint64(number)
        for byte in range(4):
            word += np.uint64(key[4 * number + byte]) << np.uint64(8 * byte)
        last = ((states[place, 0] ^ ((last ^ (last >> np.uint64(30))) * FIRST)) + word) & LOW_32
        states[place, 0] = last
        place = place + 1 if place < WORDS - 1 else 1
        number = number + 1 if number < length - 1 else 0
    for _ in range(WORDS - 1):
        mixed = states[place, 0] ^ ((last ^ (last >> np.uint64(30))) * SECOND)
        last = (mixed - np.uint64(place)) & LOW_32
        states[place, 0] = last
        place = place + 1 if place < WORDS - 1 else 1
    states[0, 0] = 0x80000000


@jit
def _seed_many(states: Words, keys: NDArray[np.uint64]) -> None:
    """Seed generators side by side, `[WORDS, LANES]`."""
    added = np.zeros((2, LANES), np.uint32)
    for lane, key in enumerate(keys):
        high = key >> np.uint64(32)
        added[0, lane] = key
        # A key of one word adds it in each step; one of two adds them in turn, with their number.
        added[1, lane] = high + np.uint64(1) if high else key
    states[0] = FIRST_STATE[0]
    before = 0
    for step in range(WORDS):
        place = step + 1 if step < WORDS - 1 else 1
        for lane in range(LANES):
            last = states[before, lane]
            old = FIRST_STATE[place] if step < WORDS - 1 else states[place, lane]
            mixed = old ^ ((last ^ (last >> np.uint32(30))) * np.uint32(FIRST))
            states[place, lane] = mixed + added[step & 1, lane]
        before = place
    for step in range(WORDS - 1):
        place = step + 2 if step < WORDS - 2 else 1
        for lane in range(LANES):
            last = states[before, lane]
            mixed = states[place, lane] ^ ((last ^ (last >> np.uint32(30))) * np.uint32(SECOND))
            states[place, lane] = mixed - np.uint32(place)
        before = place
    states[0] = 0x80000000


@jit
def _draw(states: Words, lane: int, place: int) -> int:
    """Renew the word at `place` of a generator's state, and return what is drawn from it."""
    following = place + 1 if place < WORDS - 1 else 0
    ahead = place + AHEAD if place < WORDS - AHEAD else place + AHEAD - WORDS
    joined = (states[place, lane] & np.uint64(0x80000000)) | (
        states[following, lane] & np.uint64(0x7FFFFFFF)
    )
    word = states[ahead, lane] ^ (joined >> np.uint64(1))
    if joined & np.uint64(1):
        word ^= np.uint64(0x9908B0DF)
    states[place, lane] = word
    word ^= word >> np.uint64(11)
    word ^= (word << np.uint64(7)) & np.uint64(0x9D2C5680)
    word ^= (word << np.uint64(15)) & np.uint64(0xEFC60000)
    word ^= word >> np.uint64(18)
    return word  # type: ignore[no-any-return]


@jit
def _carve(
    states: Words,
    lane: int,
    width: int,
    height: int,
    blocked: bytes,
    start: int,
    sides: bytearray,
    begin: int,
) -> int:
    """Carve a maze into `sides` from `begin` on, and return how many words were drawn."""
    stride = width + 2
    closed = np.ones(stride * (height + 2), np.uint8)
    opened = np.zeros(stride * (height + 2), np.uint8)
    for y in range(height):
        for x in range(width):
            closed[(y + 1) * stride + x + 1] = blocked[y * width + x]
    path = np.empty(width * height, np.int32)
    steps = np.array([-1, 1, stride, -stride])
    place = words = depth = 0
    cell = (start // width + 1) * stride + start % width + 1
    closed[cell] = 1
    while True:
        beside = closed[cell - 1] | closed[cell + 1] << 1
        beside |= closed[cell + stride] << 2 | closed[cell - stride] << 3
        count = COUNTS[beside]
        if not count:
            if not depth:
                break
            depth -= 1
            cell = path[depth]
            continue
        shift = SHIFTS[count]
        number = count
        while number >= count:
            number = np.int64(_draw(states, lane, place) >> shift)
            place = place + 1 if place < WORDS - 1 else 0
            words += 1
        path[depth] = cell
        depth += 1
        way = CHOICES[beside, number]
        opened[cell] |= SIDES_THERE[way]
        cell += steps[way]
        opened[cell] = SIDES_BACK[way]
        closed[cell] = 1
    for y in range(height):
        for x in range(width):
            sides[begin + y * width + x] = opened[(y + 1) * stride + x + 1]
    return words
