"""Where mazes get their chance from: `Random.getrandbits` alone, the same on every Python.

`getrandbits` hands out the Mersenne Twister's words as they are. What Python makes of them in
`choice`, `shuffle` or `sample` has changed between its versions, and may again.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import chain

BLOCK = 1024
"""So many bytes are drawn at a time. What is left of a block at the end is not used."""

_QUARTERS = bytes(byte & 3 for byte in range(256))


def below(rng: random.Random, count: int) -> int:
    """Draw a number from 0 to count - 1, as `Random.choice` does it, on every Python version.

    It draws also when there is one choice: the ancestor's mazes depend on it.
    """
    bits = count.bit_length()
    number = rng.getrandbits(bits)
    while number >= count:
        number = rng.getrandbits(bits)
    return number


def shuffle(rng: random.Random, items: list[int]) -> None:
    """Bring a list into an order that is drawn: every order is equally likely."""
    for last in range(len(items) - 1, 0, -1):
        chosen = below(rng, last + 1)
        items[last], items[chosen] = items[chosen], items[last]


def quarters(rng: random.Random) -> Iterator[int]:
    """Draw numbers from 0 to 3 without end, one from each byte: faster than one by one."""
    return chain.from_iterable(_blocks(rng))


def _blocks(rng: random.Random) -> Iterator[bytes]:
    while True:
        yield rng.getrandbits(8 * BLOCK).to_bytes(BLOCK, "little").translate(_QUARTERS)
