"""Walls, doors and cells after the maze: the first half of compiling.

Plain Python, no NumPy needed.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, compress, islice, pairwise
from typing import TYPE_CHECKING

from babyrobot_levels.language.base import SIDE_NAMES, SIDES, Side
from babyrobot_levels.language.cells import Opening, sides_of
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.things import Door
from babyrobot_levels.text.diagnostics import Issue
from babyrobot_levels.text.errors import RandomMazeError, UnplayableError
from babyrobot_levels.text.words import Telling

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

BIT = {side: 1 << index for index, side in enumerate(SIDES)}
OPPOSITE: dict[str, Side] = {"N": "S", "S": "N", "E": "W", "W": "E"}
ALL_SIDES = 15

_OTHER_SIDES = bytes(ALL_SIDES & ~bits for bits in range(256))
_WITH = {side: bytes(bits | bit for bits in range(256)) for side, bit in BIT.items()}
_WITHOUT = {side: bytes(bits & ~bit for bits in range(256)) for side, bit in BIT.items()}
"""What a cell's walls become when one is added or taken away."""


@dataclass(frozen=True, eq=False)
class Grid(Telling, public=True):
    """Walls and cells. Cells are numbered row by row: `y * width + x`.

    `wall_bits` has a byte for each cell, a bit set of its walls: 1 north, 2 east, 4 south,
    8 west; walls of glass count. `blocked_cells` has 1 for each blocked cell. `glass` maps cell
    and side to the probability of getting through.
    """

    width: int
    height: int
    wall_bits: bytes
    blocked_cells: bytes
    glass: dict[tuple[int, str], float]

    def __repr__(self) -> str:
        """Return its size and what has its cells."""
        shape = [self.height, self.width]
        return f"<Grid: {self.width}x{self.height}; open {[*shape, 4]}, blocked {shape}>"

    @cached_property
    def open_bits(self) -> bytes:
        """For each cell a bit set of the sides that nothing closes: no wall, nothing blocked."""
        open_bits = bytearray(self.wall_bits.translate(_OTHER_SIDES))
        for cell in _ones(self.blocked_cells):
            open_bits[cell] = 0
            for side in SIDES:
                if (other := self.neighbour(cell, side)) is not None:
                    open_bits[other] &= ~BIT[OPPOSITE[side]]
        return bytes(open_bits)

    @property
    def open(self) -> NDArray[np.bool_]:
        """Whether a side is open, `[height, width, 4]`: north, east, south, west.

        A wall of glass is not open; see `pass_probability`.
        """
        import numpy as np

        bits = np.frombuffer(self.open_bits, np.uint8).reshape(self.height, self.width, 1)
        is_open: NDArray[np.bool_] = np.not_equal(bits & np.array([1, 2, 4, 8], np.uint8), 0)
        return is_open

    @property
    def blocked(self) -> NDArray[np.bool_]:
        """Whether a cell is blocked, `[height, width]`."""
        import numpy as np

        cells = np.frombuffer(self.blocked_cells, np.uint8)
        return np.not_equal(cells.reshape(self.height, self.width), 0)

    @property
    def pass_probability(self) -> NDArray[np.float64]:
        """The probability that a side lets the robot through, `[height, width, 4]`.

        1 for an open side, 0 for a wall, between them for a wall of glass.
        """
        import numpy as np

        table = self.open.astype(np.float64).reshape(-1, 4)
        for (cell, side), probability in self.glass.items():
            table[cell, SIDES.index(side)] = probability
        return table.reshape(self.height, self.width, 4)

    def __deepcopy__(self, memo: dict[int, object]) -> Grid:
        return self

    def neighbour(self, cell: int, side: str) -> int | None:
        """Return the cell on that side of a cell, or None where the grid ends."""
        return neighbour(cell, side, self.width, self.height)


def neighbour(cell: int, side: str, width: int, height: int) -> int | None:
    """Return the cell on that side of a cell, or None where the grid ends."""
    if side == "N":
        return cell - width if cell >= width else None
    if side == "S":
        return cell + width if cell < width * (height - 1) else None
    if side == "W":
        return cell - 1 if cell % width else None
    return cell + 1 if (cell + 1) % width else None


def build_grid(level: LevelFields) -> Grid:
    """Grow the maze, add the walls, take away the openings, in this order.

    Raises:
        LevelError: the level's maze has no seed yet (`seed: random`).
    """
    width, height = level.size
    blocked = _blocked(level)
    walls = _maze_walls(level, blocked)
    passes: dict[Side, array[float]] = {}
    for wall in level.walls:
        for cells, side in stretches(wall, width, height):
            walls[cells] = walls[cells].translate(_WITH[side])
            # A wall without `pass` keeps glass that is already there.
            if "pass_" in wall.model_fields_set and (wall.pass_ or side in passes):
                table = passes.setdefault(side, array("d", bytes(8 * len(walls))))
                table[cells] = array("d", [wall.pass_]) * wall.length
    for opening in level.openings:
        for cells, side in stretches(opening, width, height):
            walls[cells] = walls[cells].translate(_WITHOUT[side])
            if side in passes:
                passes[side][cells] = array("d", bytes(8 * opening.length))
    _drop_hidden_walls(walls, blocked, width, height)
    real_glass: dict[tuple[int, str], float] = {
        (cell, side): table[cell]
        for side, table in passes.items()
        for cell in compress(range(len(walls)), table)
        if _joins_free_cells(cell, side, blocked, width, height)
    }
    return Grid(width, height, bytes(walls), bytes(blocked), real_glass)


def _blocked(level: LevelFields) -> bytearray:
    width, height = level.size
    blocked = bytearray(width * height)
    for rectangle in level.blocked:
        (x, y), (columns, rows) = rectangle.at, rectangle.size
        first, last = y * width + x, (y + rows) * width
        if rows > columns:
            for cell in range(first, first + columns):
                blocked[cell:last:width] = b"\1" * rows
            continue
        for cell in range(first, last, width):
            blocked[cell : cell + columns] = b"\1" * columns
    return blocked


def _maze_walls(level: LevelFields, blocked: bytearray) -> bytearray:
    """Return the walls to begin with: those of the maze, or only the one around the level."""
    width, height = level.size
    if (maze := level.maze) is not None:
        if isinstance(maze.seed, str):
            raise RandomMazeError(
                message="the level grows another maze at each reset (`seed: random`); "
                "`level.with_maze_seed(n)` gives one of them"
            )
        # Most levels have no maze.
        from babyrobot_levels.mdp.mazes import carve

        x, y = level.starts[0]
        open_sides = carve(
            width, height, bytes(blocked), y * width + x, maze.seed, maze.algorithm, maze.loops
        )
        return bytearray(open_sides.translate(_OTHER_SIDES))
    walls = bytearray(width * height)
    for x in range(width):
        walls[x] |= BIT["N"]
        walls[(height - 1) * width + x] |= BIT["S"]
    for y in range(height):
        walls[y * width] |= BIT["W"]
        walls[(y + 1) * width - 1] |= BIT["E"]
    return walls


def stretches(entry: Opening, width: int, height: int) -> list[tuple[slice, Side]]:
    """Return the cells along which a wall or an opening runs, and their side: from both sides."""
    x, y = entry.at
    first, step = y * width + x, 1 if entry.side in ("N", "S") else width
    found: list[tuple[int | None, Side]] = [
        (first, entry.side),
        (neighbour(first, entry.side, width, height), OPPOSITE[entry.side]),
    ]
    return [
        (slice(begin, begin + step * entry.length, step), side)
        for begin, side in found
        if begin is not None
    ]


def _drop_hidden_walls(walls: bytearray, blocked: bytearray, width: int, height: int) -> None:
    """Remove the walls between two blocked cells, which have no effect."""
    for cell in _ones(blocked):
        for side in SIDES:
            other = neighbour(cell, side, width, height)
            if other is not None and blocked[other]:
                walls[cell] &= ~BIT[side]


def _ones(flags: bytes | bytearray) -> list[int]:
    """Return the cells that have a 1: most levels have few of them, or none."""
    return [cell for cell, flag in enumerate(flags) if flag] if any(flags) else []


def _joins_free_cells(cell: int, side: str, blocked: bytearray, width: int, height: int) -> bool:
    other = neighbour(cell, side, width, height)
    return other is not None and not blocked[cell] and not blocked[other]


def door_name(door: Door) -> str:
    """Return what a door is called in messages: `door east of [4, 2]`."""
    (side,) = (name for name, side in SIDE_NAMES.items() if side == door.side)
    return f"door {side} of [{door.at[0]}, {door.at[1]}]"


def door_sides(level: LevelFields, grid: Grid) -> Iterator[tuple[int, str, int]]:
    """Yield the cells and sides at which doors stand, from both sides, and each door's number."""
    for index, door in enumerate(level.doors):
        for x, y in sides_of(door):
            cell = y * grid.width + x
            yield cell, door.side, index
            if (other := grid.neighbour(cell, door.side)) is not None:
                yield other, OPPOSITE[door.side], index


def grid_with_doors(level: LevelFields, grid: Grid, closed: Sequence[bool]) -> Grid:
    """Return the grid with a wall at each closed door.

    Args:
        level: the level.
        grid: its grid, in which all doors are open.
        closed: for each door, whether it is closed.
    """
    if not any(closed):
        return grid
    walls = bytearray(grid.wall_bits)
    for door in compress(level.doors, closed):
        for cells, side in stretches(door, grid.width, grid.height):
            walls[cells] = walls[cells].translate(_WITH[side])
    return replace(grid, wall_bits=bytes(walls))


MAX_PROBLEMS = 100
"""At most so many errors are reported."""

Doors = dict[str, "array[int]"]
"""For each side and cell the number of the door there, counted from 1, or 0; from both sides."""


def check_placement(level: LevelFields, grid: Grid) -> None:
    """Check that no doors stand on walls, and no walls or doors cut paths.

    Raises:
        UnplayableError: some do.
    """
    issues = placement_issues(level, grid) if level.stands_on_grid else []
    if issues:
        raise UnplayableError(issues)


def placement_issues(level: LevelFields, grid: Grid) -> list[Issue]:
    """Return the errors of doors that stand on walls, and of paths that walls or doors cut."""
    numbers = bytes(4 * len(grid.wall_bits))
    doors: Doors = {side: array("i", numbers) for side in SIDES if level.doors}
    issues = chain(_door_issues(level, grid, doors), _path_issues(level, grid, doors))
    return [*islice(issues, MAX_PROBLEMS)]


def _door_issues(level: LevelFields, grid: Grid, doors: Doors) -> Iterator[Issue]:
    """Yield the first error of each door, and note where doors stand."""
    for index, door in enumerate(level.doors):
        there = stretches(door, grid.width, grid.height)
        cells, side = there[0]
        bits = grid.open_bits[cells]
        if len(there) == 2 and bits == bits.translate(_WITH[side]) and not any(doors[side][cells]):
            for cells, side in there:
                doors[side][cells] = array("i", [index + 1]) * door.length
            continue
        for x, y in sides_of(door):
            cell = y * grid.width + x
            other = grid.neighbour(cell, door.side)
            if (fault := _fault_of(door, cell, other, grid, doors)) is not None:
                message, help_text = fault
                where = f"side {door.side} of {show_cell((x, y))}"
                yield Issue("BR322", ("doors", index), f"{where} {message}", help_text)
                break
            assert other is not None
            doors[door.side][cell] = doors[OPPOSITE[door.side]][other] = index + 1


def _fault_of(
    door: Door, cell: int, other: int | None, grid: Grid, doors: Doors
) -> tuple[str, str] | None:
    """Return what is wrong with a door between two cells, and what to do about it."""
    if other is None:
        return "is part of the outer wall, which has no doors", "move the door"
    if number := doors[door.side][cell]:
        help_text = "remove one of them; several names in `needs` must all be met"
        return f"already has a door, `doors[{number - 1}]`", help_text
    if (cell, door.side) in grid.glass:
        return "has a wall of glass, so a door cannot stand there", "remove one of them"
    if grid.blocked_cells[cell] or grid.blocked_cells[other]:
        return "is beside a blocked cell, so a door there leads nowhere", "move the door"
    if not grid.open_bits[cell] & BIT[door.side]:
        help_text = "a door stands in an opening: remove the wall, or move the door"
        return "has a wall, so a door cannot stand there", help_text
    return None


def _path_issues(level: LevelFields, grid: Grid, doors: Doors) -> Iterator[Issue]:
    for index, mover in enumerate(level.movers):
        if mover.path is None:
            continue
        cells = [y * grid.width + x for x, y in mover.path]
        # A loop also goes from its last cell to its first.
        ways = pairwise(cells if mover.back else [*cells, cells[0]])
        for number, (one, two) in enumerate(ways, 1):
            if (what := _between(one, two, grid, doors)) is not None:
                at, to = (show_cell((c % grid.width, c // grid.width)) for c in (one, two))
                route = ("movers", index, "path", number % len(cells))
                message = f"the path is cut off by {what} between {at} and {to}"
                help_text = "movers on a path cannot pass walls, glass or doors"
                yield Issue("BR323", route, message, help_text)


def _between(one: int, two: int, grid: Grid, doors: Doors) -> str | None:
    """Return what stands between two neighbours, None if nothing does."""
    for side in SIDES:
        if grid.neighbour(one, side) == two:
            if (one, side) in grid.glass:
                return "a wall of glass"
            if not grid.open_bits[one] & BIT[side]:
                return "a wall"
            if doors and doors[side][one]:
                return "a door"
    return None
