"""Worlds whose walls fill whole cells, from and to the language's walls between cells; edges.

A cell is a character, as in a drawing of the language, or `ENDS`. An edge lies between two cells.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

from babyrobot_levels.extensions.formats.conversion import ConversionError, Lost, fields_lost
from babyrobot_levels.extensions.formats.places import cell_of
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.cells import Rewards
from babyrobot_levels.language.drawing import consecutive
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.language.geometry import painted
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.grid import BIT, Grid
from babyrobot_levels.text.source import Position, SourceFile

Rows = tuple[str, ...]
"""Cells row by row, each as its character in a drawing of the language."""

ENDS = "x"
"""The mark of a cell whose area is terminal."""

HOLE_COLOR, LAVA_COLOR = "#1b3a5c", "orangered"
"""The colours of such cells where the other format shows them in one of its own."""

SPATIAL = frozenset(fields_with(Role.GEOMETRY)) - {"map", "legend", "exit_one_of"}
"""The fields that a map of blocks can hold."""

UNLIKE = frozenset({"areas", "rewards"})
"""Fields of which a part may be kept; they are checked one by one."""


def text_rows(source: SourceFile, *, blanks: bool = False) -> list[str]:
    """Return the lines of a drawn map, padded to the longest, without blank lines around them.

    Args:
        source: the text.
        blanks: whether a blank is a cell: then lines that are all of one length, as programs write
            them, are the map as they are, blank ones included.

    Raises:
        ConversionError: the text is blank.
    """
    _, lines = _lines_of_map(source, blanks)
    # Editors drop blanks at the ends of lines.
    width = max(map(len, lines))
    # A cell of a lattice, or of MiniGrid, has two characters, and there is a ring of walls.
    if max(width, len(lines)) > 2 * (MAX_SIZE + 2):
        raise ConversionError(f"the map is {width} by {len(lines)}; a level is at most {MAX_SIZE}")
    return [line.ljust(width) for line in lines]


def _lines_of_map(source: SourceFile, blanks: bool) -> tuple[int, list[str]]:
    """Return the number of the first line of a drawn map, from 0, and its lines."""
    lines = [line.rstrip() for line in source.lines]
    if not any(lines):
        raise ConversionError("the text has no map")
    if blanks and len({len(line) for line in source.lines if line}) == 1:
        lines = [*source.lines]
    used = [number for number, line in enumerate(lines) if line]
    return used[0], lines[used[0] : used[-1] + 1]


def translated(
    source: SourceFile,
    rows: Sequence[str],
    meanings: dict[str, str],
    known: str,
    *,
    blanks: bool = False,
) -> Rows:
    """Return the rows of `text_rows` with each character replaced by what it means.

    Raises:
        ConversionError: a character has no meaning; `known` lists those that have one.
    """
    for y, row in enumerate(rows):
        for x, character in enumerate(row):
            if character not in meanings:
                place = place_of(source, x, y, blanks=blanks)
                raise ConversionError.at(source, place, f"unknown character `{character}`", known)
    return tuple("".join(map(meanings.__getitem__, row)) for row in rows)


def place_of(source: SourceFile, x: int, y: int, *, blanks: bool = False) -> Position:
    """Return the position of a character of the rows that `text_rows` has returned for a text."""
    above, _ = _lines_of_map(source, blanks)
    return Position(above + y + 1, x + 1)


def told_starts(rows: Rows) -> Iterator[Lost]:
    """Yield what becomes of several starts of formats that have one."""
    if (starts := "".join(rows).count(d.START)) > 1:
        message = f"{starts} are drawn: each reset draws one of them"
        yield Lost("start", message, cell_of(rows, d.START, 1))


def without_ring(rows: Rows) -> Rows:
    """Return rows without a ring of walls around them: there is always a wall around a level."""
    sides = [rows[0], rows[-1], *(row[0] + row[-1] for row in rows)]
    if len(rows) < 3 or len(rows[0]) < 3 or set("".join(sides)) != {d.BLOCKED}:
        return rows
    return tuple(row[1:-1] for row in rows[1:-1])


def room(cells: Sequence[str], first: int, width: int) -> list[int]:
    """Return the numbers of the cells that are connected to one, itself included."""
    found, seen = [first], bytearray(len(cells))
    seen[first] = True
    # The list grows while it is gone through.
    for cell in found:
        column = cell % width
        for near, is_inside in (
            (cell - width, cell >= width),
            (cell + width, cell + width < len(cells)),
            (cell - 1, column > 0),
            (cell + 1, column < width - 1),
        ):
            if is_inside and not seen[near] and cells[near] != d.BLOCKED:
                seen[near] = True
                found.append(near)
    return found


def without_surroundings(rows: Rows) -> Rows:
    """Return rows with the free cells blocked that lie outside of the walls around the world.

    These are the ones connected to the edge, but to no start and to no exit.
    """
    width, height = len(rows[0]), len(rows)
    cells = list("".join(rows))
    seen: set[int] = set()
    for edge in range(len(cells)):
        is_edge = edge % width in (0, width - 1) or edge // width in (0, height - 1)
        if not is_edge or edge in seen or cells[edge] == d.BLOCKED:
            continue
        found = room(cells, edge, width)
        seen.update(found)
        if all(cells[cell] == d.PLAIN for cell in found):
            for cell in found:
                cells[cell] = d.BLOCKED
    return tuple("".join(cells[y * width : (y + 1) * width]) for y in range(height))


def without_margin(rows: Rows, drawn: Rows) -> tuple[Rows, int]:
    """Return rows without those above, below and to the right that are blocked and drawn blank.

    The number is that of the rows above.
    """

    def inside(lines: Rows, shown: Rows) -> list[int]:
        pairs = enumerate(zip(lines, shown, strict=True))
        return [n for n, pair in pairs if [*map(set, pair)] != [{d.BLOCKED}, {d.PLAIN}]]

    kept = inside(rows, drawn)
    if not kept:
        return rows, 0
    part = slice(kept[0], kept[-1] + 1)
    columns = inside(
        *(tuple(map("".join, zip(*each[part], strict=True))) for each in (rows, drawn))
    )
    return tuple(row[: columns[-1] + 1] for row in rows[part]), kept[0]


def replaced(rows: Rows, places: Iterable[tuple[int, int]], mark: str) -> Rows:
    """Return rows with a mark at some places `(x, y)`."""
    cells = [list(row) for row in rows]
    for x, y in places:
        cells[y][x] = mark
    return tuple("".join(row) for row in cells)


def is_lattice(rows: Rows) -> bool:
    """Return whether rows are a lattice, as mazes with walls between cells are drawn in blocks.

    Cells are at the odd columns of the odd rows, walls at the even columns of the even rows.
    """
    width, height = len(rows[0]), len(rows)
    if width % 2 == 0 or height % 2 == 0 or width < 3 or height < 3:
        return False
    posts = {character for row in rows[::2] for character in row[::2]}
    cells = {character for row in rows[1::2] for character in row[1::2]}
    return posts == {d.BLOCKED} and d.BLOCKED not in cells


MAX_DRAWN = 100_000
"""So many cells are drawn, at eight characters each; of more, blocked ones are rectangles."""


MAX_LISTED = 30_000
"""So many starts, exits and rectangles does a file have room for, each with several values."""


def _listed(rows: Rows) -> dict[str, Any]:
    """Return the fields with rows of cells, without a drawing."""
    width, height = len(rows[0]), len(rows)
    found = {mark: d.cells_with(rows, mark) for mark in (d.START, d.EXIT, d.BLOCKED)}
    fields: dict[str, Any] = {"size": [width, height], "start": one_or_all(found[d.START])}
    fields["exit"] = one_or_all(found[d.EXIT]) if found[d.EXIT] else "none"
    blocked = [*islice(filled(found[d.BLOCKED], width, height), MAX_LISTED + 1)]
    if len(blocked) + len(found[d.START]) + len(found[d.EXIT]) > MAX_LISTED:
        message = f"the map is {width} by {height}, with too much on it for a level file"
        raise ConversionError(message, f"at most {MAX_LISTED:,} starts, exits and rectangles")
    return fields | {"blocked": blocked}


def one_or_all(cells: Sequence[tuple[int, int]]) -> list[Any]:
    """Return cells as a field has them: one by itself, several in a list."""
    return [*cells[0]] if len(cells) == 1 else [[*cell] for cell in cells]


def filled(cells: Iterable[tuple[int, int]], width: int, height: int) -> Iterator[dict[str, Any]]:
    """Yield rectangles that cover the cells, as entries of `blocked`."""
    marks = bytearray(width * height)
    for x, y in cells:
        marks[y * width + x] = True
    for x, y, columns, lines in d.rectangles(marks, width):
        yield {"at": [x, y]} | ({} if columns == lines == 1 else {"size": [columns, lines]})


def drawn(rows: Rows, east: Rows | None = None, south: Rows | None = None) -> dict[str, Any]:
    """Return the field `map` with rows of cells, without walls between them if none are given.

    Raises:
        ConversionError: there are too many cells, or none of them is a start.
    """
    width, height = len(rows[0]), len(rows)
    if max(width, height) > MAX_SIZE:
        raise ConversionError(
            f"the map is {width} by {height}; a level is at most {MAX_SIZE} cells wide and high"
        )
    if not any(d.START in row for row in rows):
        raise ConversionError("the map has no start", "mark the cell where episodes start")
    if width * height > MAX_DRAWN and east is None:
        return _listed(rows)
    east = east or (d.OPEN * (width - 1),) * height
    south = south or (d.OPEN * width,) * (height - 1)
    return {"map": d.compose(d.Drawing(rows, east, south))}


def has_walls(grid: Grid) -> bool:
    """Return whether there are walls between free cells, of glass or not."""
    return any(
        bits & BIT[side] and other is not None and not grid.blocked_cells[other]
        for cell, bits in enumerate(grid.wall_bits)
        if not grid.blocked_cells[cell]
        for side in ("E", "S")
        if (other := grid.neighbour(cell, side)) is not None
    )


def as_blocks(grid: Grid, cells: Sequence[str], *, lattice: bool) -> Rows:
    """Return a grid in blocks, with a ring of them around it.

    Args:
        grid: walls and cells.
        cells: what the cells are, row by row; a blocked one is `BLOCKED`.
        lattice: whether walls between cells become blocks too, so that there are two blocks in
            each direction for each cell. Without it, those walls are left out.
    """
    if not lattice:
        border = d.BLOCKED * (grid.width + 2)
        return (border, *(f"{d.BLOCKED}{row}{d.BLOCKED}" for row in cells), border)
    rows = [[d.BLOCKED] * (2 * grid.width + 1) for _ in range(2 * grid.height + 1)]
    for cell, bits in enumerate(grid.open_bits):
        y, x = divmod(cell, grid.width)
        rows[2 * y + 1][2 * x + 1] = cells[y][x]
        if bits & BIT["E"]:
            rows[2 * y + 1][2 * x + 2] = d.PLAIN
        if bits & BIT["S"]:
            rows[2 * y + 2][2 * x + 1] = d.PLAIN
    return tuple("".join(row) for row in rows)


def from_lattice(rows: Rows) -> tuple[Rows, Rows, Rows]:
    """Return the cells of a lattice, and the marks east and south of them; see `Drawing`."""
    columns, lines = range(1, len(rows[0]), 2), range(1, len(rows), 2)

    def mark(x: int, y: int) -> str:
        return d.SOLID if rows[y][x] == d.BLOCKED else d.OPEN

    cells = tuple("".join(rows[y][x] for x in columns) for y in lines)
    east = tuple("".join(mark(x + 1, y) for x in columns[:-1]) for y in lines)
    south = tuple("".join(mark(x, y + 1) for x in columns) for y in lines[:-1])
    return cells, east, south


# -- levels as blocks ------------------------------------------------------------------------


def marked(level: Level) -> Rows:
    """Return the cells row by row: plain, blocked, a start, an exit, or `ENDS`."""
    width, height = level.size
    blocked = level.grid().blocked_cells
    ends = painted(level, ((area, area.ends) for area in level.areas if area.ends is not None))
    rows = [[d.PLAIN] * width for _ in range(height)]
    for y, row in enumerate(rows):
        for x in range(width):
            if blocked[y * width + x]:
                row[x] = d.BLOCKED
            elif ends((x, y)):
                row[x] = ENDS
    for character, cells in ((d.START, level.starts), (d.EXIT, level.exits)):
        for x, y in cells:
            rows[y][x] = character
    return tuple("".join(row) for row in rows)


def block_map(
    level: Level,
    place: str,
    rewards: Rewards,
    *,
    ends: str | None,
    many: str,
    carried: frozenset[str] = frozenset(),
) -> tuple[Rows, list[Lost]]:
    """Return a level in blocks with a ring around it, and what such a map does not keep.

    Args:
        level: the level.
        place: the format, for messages: "a Sokoban map".
        rewards: the rewards of a level that is read from such a map.
        ends: why areas that end the episode are not kept; None if they are.
        many: the marks that may occur more than once: `S`, `E`, both or none.
        carried: fields that the map can hold beside the usual ones.
    """
    lost = list(fields_lost(level, SPATIAL | UNLIKE | carried, place))
    lost += lost_areas(level, ends)
    if level.rewards != rewards:
        lost.append(Lost("rewards", f"{place} cannot hold them"))
    grid, cells = level.grid(), _marked_once(level, place, many, lost)
    lattice = has_walls(grid)
    if lattice:
        lost.append(Lost("walls", "walls between cells become blocks, and each step becomes two"))
    if ends is not None:
        cells = tuple(row.replace(ENDS, d.PLAIN) for row in cells)
    return as_blocks(grid, cells, lattice=lattice), lost


def lattice_map(level: Level, place: str, *, many: str = "") -> tuple[Rows, list[Lost]]:
    """Return a level in blocks that are walls between cells, and what such a map does not keep.

    Args:
        level: the level.
        place: the format, for messages: "a maze of maze-dataset".
        many: the marks that may occur more than once: `E`, or none.
    """
    lost = list(fields_lost(level, SPATIAL | {"areas"}, place))
    lost += lost_areas(level, f"{place} has no cells that end the episode but exits")
    grid = level.grid()
    if any(grid.blocked_cells):
        lost.append(Lost("blocked", "the cells are there, with walls around them"))
    if grid.glass:
        lost.append(Lost("walls.pass", "walls of glass become solid"))
    rows = _marked_once(level, place, many, lost)
    rows = tuple(row.replace(ENDS, d.PLAIN).replace(d.BLOCKED, d.PLAIN) for row in rows)
    return as_blocks(grid, rows, lattice=True), lost


def _marked_once(level: Level, place: str, many: str, lost: list[Lost]) -> Rows:
    """Return the cells of a level, of the marks that are not in `many` only the first."""
    rows = marked(level)
    for mark, name, cells in ((d.START, "start", level.starts), (d.EXIT, "exit", level.exits)):
        if len(cells) > 1 and mark not in many:
            message = f"{place} has one, so only [{cells[0][0]}, {cells[0][1]}] is kept"
            lost.append(Lost(name, message))
            rows = replaced(rows, cells[1:], d.PLAIN)
    return rows


def lost_areas(level: Level, ends: str | None, *, hole: float | None = None) -> Iterator[Lost]:
    """Yield the properties of areas that are not kept.

    Args:
        level: the level.
        ends: why `ends` is not kept; None if it is.
        hole: the reward that is kept where the episode ends; None for that of a step.
    """
    step = level.rewards.step
    hole = step if hole is None else hole
    kept: dict[str, set[object]] = {
        "color": {None, HOLE_COLOR, LAVA_COLOR},
        "skid": {None},
        "ends": {None, False, True} if ends is None else {None, False},
        "label": {None},
    }
    for name, values in kept.items():
        if any(getattr(area, name) not in values for area in level.areas):
            yield Lost(f"areas.{name}", ends if name == "ends" and ends else "the map has no areas")
    rewards = ((area, step if area.reward is None else area.reward) for area in level.areas)
    if any(reward != (hole if area.ends else step) for area, reward in rewards):
        yield Lost("areas.reward", "the map has no areas")


# -- walls between cells ---------------------------------------------------------------------

Edge = tuple[int, int, str]
"""The cell to the west or to the north of an edge, and its side there: `E` or `S`.

The outer wall's western and northern edges have x or y -1.
"""


def edge_of(x: int, y: int, side: str) -> Edge:
    """Return the edge at a side of a cell."""
    if side == "N":
        return (x, y - 1, "S")
    return (x - 1, y, "E") if side == "W" else (x, y, side)


def is_inner(x: int, y: int, side: str, width: int, height: int) -> bool:
    """Return whether an edge lies between two cells of the grid."""
    return x >= 0 and y >= 0 and (x < width - 1 if side == "E" else y < height - 1)


def side_entry(x: int, y: int, side: str, length: int = 1) -> dict[str, Any]:
    """Return the entry of `walls` or `openings` for a side of a cell, and of those in its line."""
    return {"at": [x, y], "side": side} | ({"length": length} if length > 1 else {})


def edge_runs(edges: Mapping[Edge, dict[str, Any]]) -> Iterator[tuple[Edge, int, dict[str, Any]]]:
    """Yield for each run of equal edges in a line its first edge, its length and its properties."""

    def line(edge: Edge) -> tuple[str, int, int]:
        x, y, side = edge
        return (side, x, y) if side == "E" else (side, y, x)

    def position(edge: Edge) -> tuple[Any, int]:
        side, across, along = line(edge)
        return (side, across, edges[edge]), along

    for run in consecutive(sorted(edges, key=line), position):
        yield run[0], len(run), edges[run[0]]
