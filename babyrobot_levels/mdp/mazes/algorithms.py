"""The algorithms that carve mazes. Depth-first gives PyPI `babyrobot`'s mazes, wall for wall."""

import random
from array import array
from heapq import heappop, heappush

from babyrobot_levels.mdp.mazes.lattice import (
    BACK,
    EAST,
    NORTH,
    SOUTH,
    THERE,
    WAYS,
    WEST,
    Lattice,
    below,
    quarters,
    shuffle,
)

BITS = tuple(count.bit_length() for count in range(5))


def depth_first(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Walk to an unvisited neighbour as long as there is one, else back by one cell.

    The neighbours are listed in the order west, east, south, north. `compiled` does the same, bit
    for bit.
    """
    # `Lattice.ways`, `below` and `Lattice.join`, unrolled: this is the hot loop of most mazes.
    closed, opened, stride = lattice.closed, lattice.open, lattice.stride
    draw, moves = rng.getrandbits, tuple(zip(lattice.steps, THERE, BACK, strict=True))
    choices = tuple(tuple(moves[way] for way in ways) for ways in WAYS)
    path: list[int] = []
    cell = start
    closed[cell] = 1
    while True:
        free = choices[
            closed[cell - 1]
            | closed[cell + 1] << 1
            | closed[cell + stride] << 2
            | closed[cell - stride] << 3
        ]
        if free:
            count = len(free)
            bits = BITS[count]
            number = draw(bits)
            while number >= count:
                number = draw(bits)
            step, there, back = free[number]
            opened[cell] |= there
            path.append(cell)
            cell += step
            opened[cell] = back
            closed[cell] = 1
        elif path:
            cell = path.pop()
        else:
            return


def prim(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Add one of the cells beside the maze, drawn evenly, joined with a neighbour in the maze."""
    listed, steps = lattice.closed, lattice.steps
    outside = bytearray(b"\1") * len(listed)
    beside: list[int] = []
    listed[start] = 1
    cell = start
    while True:
        outside[cell] = 0
        for way in lattice.ways(cell, listed):
            listed[cell + steps[way]] = 1
            beside.append(cell + steps[way])
        if not beside:
            return
        number = below(rng, len(beside))
        cell, beside[number] = beside[number], beside[-1]
        beside.pop()
        ways = lattice.ways(cell, outside)
        lattice.join(cell, ways[below(rng, len(ways))])


def growing_tree(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Go on from the newest cell or, every other time, from any: a mixture of two characters.

    A cell without an unvisited neighbour leaves the list; the last one takes its place.
    """
    closed = lattice.closed
    closed[start] = 1
    active = [start]
    while active:
        number = len(active) - 1 if rng.getrandbits(1) else below(rng, len(active))
        ways = lattice.ways(active[number], closed)
        if ways:
            other = lattice.join(active[number], ways[below(rng, len(ways))])
            closed[other] = 1
            active.append(other)
        else:
            active[number] = active[-1]
            active.pop()


def hunt_and_kill(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Walk to unvisited neighbours until there is none; then hunt for the next cell to go on from.

    That is the first unvisited cell beside a visited one, row by row. It is joined with one of
    its visited neighbours.
    """
    closed, steps = lattice.closed, lattice.steps
    outside = bytearray(b"\1") * len(closed)
    seen: list[int] = []
    """The prey: cells beside visited ones, the first of them on top."""
    cell = start
    while True:
        closed[cell], outside[cell] = 1, 0
        ways = lattice.ways(cell, closed)
        for way in ways:
            heappush(seen, cell + steps[way])
        if ways:
            cell = lattice.join(cell, ways[below(rng, len(ways))])
            continue
        while seen and closed[seen[0]]:
            heappop(seen)
        if not seen:
            return
        cell = heappop(seen)
        ways = lattice.ways(cell, outside)
        lattice.join(cell, ways[below(rng, len(ways))])


EAST_WAY, SOUTH_WAY = 1, 2


def kruskal(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Take away each wall, in an order that is drawn, unless there is a path around it."""
    blocked, steps = lattice.blocked, lattice.steps
    cells = lattice.component(start)
    walls = [
        cell << 2 | way
        for cell in cells
        for way in (EAST_WAY, SOUTH_WAY)
        if not blocked[cell + steps[way]]
    ]
    shuffle(rng, walls)
    parts = array("i", [-1]) * len(blocked)
    """A cell of the same part that is nearer to its root; for a root, minus the part's size."""
    missing = len(cells) - 1
    for wall in walls:
        if not missing:
            return
        cell, way = wall >> 2, wall & 3
        root, other = cell, cell + steps[way]
        while parts[root] >= 0:
            root = parts[root]
        while parts[other] >= 0:
            other = parts[other]
        if root != other:
            lattice.join(cell, way)
            missing -= 1
            if parts[root] > parts[other]:
                root, other = other, root
            parts[root] += parts[other]
            parts[other] = root


OUTSIDE, INSIDE, NO_CELL = 0, 1, 2
_KINDS = bytes([OUTSIDE, NO_CELL]) + bytes(254)


def wilson(lattice: Lattice, start: int, rng: random.Random) -> None:
    """From each cell in turn, walk at random into the maze; the loop-erased walk is added.

    The walk's loops are left out as they close. The maze begins as the start alone; the cells are
    taken row by row. A step that would lead nowhere is drawn again.
    """
    kinds = bytearray(lattice.blocked.translate(_KINDS))
    opened, steps, ways = lattice.open, lattice.steps, quarters(rng)
    left = bytearray(len(kinds))
    """The way by which the walk last left each cell: its loops are erased."""
    kinds[start] = INSIDE
    for first in lattice.component(start):
        if kinds[first]:
            continue
        cell = first
        for way in ways:
            other = cell + steps[way]
            kind = kinds[other]
            if kind == NO_CELL:
                continue
            left[cell] = way
            cell = other
            if kind:
                break
        cell = first
        while not kinds[cell]:
            kinds[cell] = INSIDE
            way = left[cell]
            opened[cell] |= THERE[way]
            cell += steps[way]
            opened[cell] |= BACK[way]


def aldous_broder(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Walk at random until every cell was visited; each is joined with the one it is entered from.

    A step that would lead nowhere is drawn again.
    """
    kinds = bytearray(lattice.blocked.translate(_KINDS))
    steps, missing = lattice.steps, len(lattice.component(start)) - 1
    if not missing:
        return
    cell = start
    kinds[cell] = INSIDE
    for way in quarters(rng):
        other = cell + steps[way]
        kind = kinds[other]
        if kind == INSIDE:
            cell = other
        elif not kind:
            kinds[other] = INSIDE
            lattice.join(cell, way)
            cell = other
            missing -= 1
            if not missing:
                return


def recursive_division(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Divide a chamber in two by a wall with a gap, and do the same with both.

    The wall stands across the longer side; in a square, across one that is drawn. Chambers that
    are one cell wide or high are left as they are. The start does not matter.
    """
    stride, opened = lattice.stride, lattice.open
    width, height = lattice.width, lattice.height
    for y, row in enumerate(lattice.rows()):
        vertical = (NORTH if y else 0) | (SOUTH if y < height - 1 else 0)
        opened[row] = bytes([vertical | EAST | WEST]) * width
        opened[row.start] &= ~WEST
        opened[row.stop - 1] &= ~EAST
    chambers = [(lattice.index(0), width, height)]
    while chambers:
        first, columns, rows = chambers.pop()
        if columns < 2 or rows < 2:
            continue
        if rows > columns or (rows == columns and rng.getrandbits(1)):
            upper = below(rng, rows - 1) + 1
            begin = first + (upper - 1) * stride
            gap = begin + below(rng, columns)
            _close(opened, slice(begin, begin + columns), SOUTH)
            _close(opened, slice(begin + stride, begin + stride + columns), NORTH)
            opened[gap] |= SOUTH
            opened[gap + stride] |= NORTH
            chambers.append((first + upper * stride, columns, rows - upper))
            chambers.append((first, columns, upper))
        else:
            left = below(rng, columns - 1) + 1
            begin = first + left - 1
            end = begin + rows * stride
            gap = begin + below(rng, rows) * stride
            _close(opened, slice(begin, end, stride), EAST)
            _close(opened, slice(begin + 1, end + 1, stride), WEST)
            opened[gap] |= EAST
            opened[gap + 1] |= WEST
            chambers.append((first + left, columns - left, rows))
            chambers.append((first, left, rows))


_WITHOUT = {
    side: bytes(sides & ~side & 255 for sides in range(256)) for side in (NORTH, EAST, SOUTH, WEST)
}


def _close(opened: bytearray, cells: slice, side: int) -> None:
    opened[cells] = opened[cells].translate(_WITHOUT[side])


WEST_WAY, EAST_WAY, SOUTH_WAY, NORTH_WAY = range(4)


def binary_tree(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Open each cell either to the north or to the west. The start does not matter."""
    for y, row in enumerate(lattice.rows()):
        for cell in range(row.start, row.stop):
            if cell == row.start:
                if y:
                    lattice.join(cell, NORTH_WAY)
            elif y and rng.getrandbits(1):
                lattice.join(cell, NORTH_WAY)
            else:
                lattice.join(cell, WEST_WAY)


def sidewinder(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Cut each row into runs, and open one cell of each run to the north.

    The first row is one run. The start does not matter.
    """
    for y, row in enumerate(lattice.rows()):
        first = row.start
        for cell in range(row.start, row.stop):
            is_last = cell == row.stop - 1
            if is_last or (y and rng.getrandbits(1)):
                if y:
                    lattice.join(first + below(rng, cell - first + 1), NORTH_WAY)
                first = cell + 1
            else:
                lattice.join(cell, EAST_WAY)


def eller(lattice: Lattice, start: int, rng: random.Random) -> None:
    """Carve rows knowing only which cells of the last row are connected.

    In a row, neighbours that are not connected yet are joined, every other time. Of the cells
    that are connected then one is opened to the south, and of the others each, every other time.
    In the last row, all neighbours are joined that are not connected yet. The start does not
    matter.
    """
    rows = lattice.rows()
    above = list(range(lattice.width))
    """For each column, a connected one that is nearer to the root; for a root, itself."""
    for y, row in enumerate(rows):
        is_last = y == lattice.height - 1
        for column in range(1, lattice.width):
            root, other = _root(above, column - 1), _root(above, column)
            if root != other and (is_last or rng.getrandbits(1)):
                above[other] = root
                lattice.join(row.start + column - 1, EAST_WAY)
        if is_last:
            return
        parts: dict[int, list[int]] = {}
        for column in range(lattice.width):
            parts.setdefault(_root(above, column), []).append(column)
        above = list(range(lattice.width))
        for columns in parts.values():
            sure = columns[below(rng, len(columns))]
            for column in columns:
                if column == sure or rng.getrandbits(1):
                    lattice.join(row.start + column, SOUTH_WAY)
                    above[column] = sure


def _root(above: list[int], column: int) -> int:
    while above[column] != column:
        above[column] = column = above[above[column]]
    return column
