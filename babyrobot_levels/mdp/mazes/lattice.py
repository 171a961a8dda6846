"""What the algorithms share: a padded board, draws from a generator, and braiding."""

import random
from collections.abc import Iterator
from itertools import chain

BLOCK = 1024
"""So many bytes are drawn at a time. What is left of a block at the end is not used."""

_QUARTERS = bytes(byte & 3 for byte in range(256))


def below(rng: random.Random, count: int) -> int:
    """Draw a number from 0 to count - 1, as `Random.choice` does it, on every Python version.

    It draws also when there is one choice: the mazes of PyPI `babyrobot` depend on it.
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


NORTH, EAST, SOUTH, WEST = 1, 2, 4, 8

THERE = (WEST, EAST, SOUTH, NORTH)
"""The side that is opened for each way, in the order on which PyPI `babyrobot`'s mazes depend."""

BACK = (EAST, WEST, NORTH, SOUTH)
"""The side of the neighbour that is opened with it."""

WAYS = tuple(tuple(way for way in range(4) if not bits >> way & 1) for bits in range(16))
"""For four bits, one a way: the ways whose bits are not set."""


class Lattice:
    """Cells with a margin of one around them. Cells are numbered in the padded array.

    The ways out of a cell are numbered 0 west, 1 east, 2 south, 3 north; `steps[way]` is what to
    add to a cell's number. `blocked[cell]` is 1 for cells that are not there: the margin and
    blocked cells. `closed[cell]` begins as the same, for algorithms to mark what they have
    visited. `open[cell]` is a bit set of open sides.
    """

    def __init__(self, width: int, height: int, blocked: bytes):
        self.width, self.height = width, height
        self.stride = width + 2
        self.closed = bytearray(b"\1") * (self.stride * (height + 2))
        self.open = bytearray(len(self.closed))
        for y, row in enumerate(self.rows()):
            self.closed[row] = blocked[y * width : (y + 1) * width]
        self.blocked = bytes(self.closed)
        self.steps = (-1, 1, self.stride, -self.stride)

    def rows(self) -> list[slice]:
        """Return where each row stands in the padded array, without the margin."""
        begins = range(self.stride + 1, self.stride * (self.height + 1), self.stride)
        return [slice(begin, begin + self.width) for begin in begins]

    def index(self, cell: int) -> int:
        """Return the padded number of a cell that is numbered row by row."""
        return (cell // self.width + 1) * self.stride + cell % self.width + 1

    def join(self, cell: int, way: int) -> int:
        """Open the side between a cell and its neighbour, and return the neighbour."""
        other = cell + self.steps[way]
        self.open[cell] |= THERE[way]
        self.open[other] |= BACK[way]
        return other

    def ways(self, cell: int, marks: bytes | bytearray) -> tuple[int, ...]:
        """Return the ways that lead from a cell to neighbours without a mark (1, else 0)."""
        north, south = cell - self.stride, cell + self.stride
        return WAYS[marks[cell - 1] | marks[cell + 1] << 1 | marks[south] << 2 | marks[north] << 3]

    def cells(self) -> list[int]:
        """Return the padded numbers of all cells that are not blocked, row by row."""
        blocked = self.blocked
        rows = (range(row.start, row.stop) for row in self.rows())
        return [cell for row in rows for cell in row if not blocked[cell]]

    def component(self, start: int) -> list[int]:
        """Return the cells that are connected with a cell, row by row."""
        if self.blocked.count(0) == self.width * self.height:
            return self.cells()
        found = bytearray(self.blocked)
        found[start] = 1
        waiting, members = [start], [start]
        while waiting:
            cell = waiting.pop()
            for way in self.ways(cell, found):
                other = cell + self.steps[way]
                found[other] = 1
                waiting.append(other)
                members.append(other)
        return sorted(members)

    def sides(self) -> bytes:
        """Return the open sides of the cells, row by row and without the margin."""
        return b"".join([self.open[row] for row in self.rows()])

    def set_sides(self, sides: bytes) -> None:
        """Take over open sides, as `sides` returns them."""
        for y, row in enumerate(self.rows()):
            self.open[row] = sides[y * self.width : (y + 1) * self.width]


def open_dead_ends(lattice: Lattice, share: float, rng: random.Random) -> None:
    """Open a share of the dead ends, each towards a neighbour that it has a wall to.

    The dead ends are taken in an order that the generator draws. One that another's opening
    has already joined counts as opened; one without a neighbour behind a wall is passed over.
    """
    dead_ends = [cell for cell in lattice.cells() if _is_dead_end(lattice, cell)]
    wanted = int(share * len(dead_ends) + 0.5)
    shuffle(rng, dead_ends)
    for cell in dead_ends[:wanted]:
        if not _is_dead_end(lattice, cell):
            continue
        walled = [
            way
            for way in lattice.ways(cell, lattice.blocked)
            if not lattice.open[cell] & THERE[way]
        ]
        if walled:
            lattice.join(cell, walled[below(rng, len(walled))])


def _is_dead_end(lattice: Lattice, cell: int) -> bool:
    return lattice.open[cell].bit_count() == 1
