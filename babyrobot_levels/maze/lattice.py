"""The board that mazes are carved on: one padded byte array, so that no neighbour needs a check."""

from __future__ import annotations

import random

NORTH, EAST, SOUTH, WEST = 1, 2, 4, 8


class Lattice:
    """Cells with a margin of one around them. Cells are numbered in the padded array.

    `closed[cell]` is 1 for cells that cannot be carved: the margin, blocked cells and, as an
    algorithm goes on, the cells that it has visited. `open[cell]` is a bit set of open sides.
    """

    def __init__(self, width: int, height: int, blocked: bytes):
        self.width, self.height = width, height
        self.stride = width + 2
        self.closed = bytearray(b"\1") * (self.stride * (height + 2))
        self.open = bytearray(len(self.closed))
        for y in range(height):
            first = self.index(y * width)
            self.closed[first : first + width] = blocked[y * width : (y + 1) * width]
        self.blocked = bytes(self.closed)
        # The order of the ancestor, on which the bits of its mazes depend.
        self.steps = (-1, 1, self.stride, -self.stride)
        self.bits = {-1: (WEST, EAST), 1: (EAST, WEST)}
        self.bits[self.stride] = (SOUTH, NORTH)
        self.bits[-self.stride] = (NORTH, SOUTH)

    def index(self, cell: int) -> int:
        """Return the padded number of a cell that is numbered row by row."""
        return (cell // self.width + 1) * self.stride + cell % self.width + 1

    def join(self, cell: int, other: int) -> None:
        """Open the side between two neighbours."""
        there, back = self.bits[other - cell]
        self.open[cell] |= there
        self.open[other] |= back

    def cells(self) -> list[int]:
        """Return the padded numbers of all cells that are not blocked, row by row."""
        return [
            cell
            for y in range(self.height)
            for cell in range((y + 1) * self.stride + 1, (y + 1) * self.stride + 1 + self.width)
            if not self.blocked[cell]
        ]

    def sides(self) -> bytes:
        """Return the open sides of the cells, row by row and without the margin."""
        rows = (
            self.open[(y + 1) * self.stride + 1 : (y + 1) * self.stride + 1 + self.width]
            for y in range(self.height)
        )
        return b"".join(rows)


def below(rng: random.Random, count: int) -> int:
    """Draw a number from 0 to count - 1, as `Random.choice` does it, on every Python version.

    It draws also when there is one choice: the ancestor's mazes depend on it.
    """
    bits = count.bit_length()
    number = rng.getrandbits(bits)
    while number >= count:
        number = rng.getrandbits(bits)
    return number
