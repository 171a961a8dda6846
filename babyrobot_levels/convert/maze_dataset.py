"""maze-dataset: mazes in ASCII, as `as_ascii` draws them, with walls between the cells."""

from __future__ import annotations

from babyrobot_levels.convert.blocks import (
    Rows,
    as_blocks,
    drawn,
    from_lattice,
    is_lattice,
    text_rows,
    translated,
)
from babyrobot_levels.convert.conversion import (
    Conversion,
    ConversionError,
    Lost,
    World,
    fields_lost,
)
from babyrobot_levels.convert.marks import ENDS, SPATIAL, lost_areas, marked
from babyrobot_levels.language import drawing as d
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile

PLACE = "a maze of maze-dataset"
PATH = "X"
_CELLS = {"#": d.BLOCKED, " ": d.PLAIN, "S": d.START, "E": d.EXIT, PATH: d.PLAIN}
_KNOWN = "`#` wall, a blank free, S start, E end, X the path of the solution"


def read_maze_dataset(source: SourceFile) -> World:
    """Return the world of a maze that is drawn on a lattice of walls and cells."""
    lines = text_rows(source)
    lost: list[Lost] = []
    rows = _with_doors_shut(translated(source, lines, _CELLS, _KNOWN), lost)
    if not is_lattice(rows):
        raise ConversionError(
            "this is no maze of cells with walls between them",
            "an odd number of rows and columns, a cell in every second one, and `#` between four; "
            "for walls that fill cells, say --from sokoban",
        )
    if any(PATH in line for line in lines):
        lost.append(Lost(PATH, "the path of the solution is left out; `babyrobot solve` finds it"))
    cells, east, south = from_lattice(rows)
    cells, has_start = _with_start(cells, lost)
    fields = {"version": 1, **drawn(cells, east, south)}
    if has_start and not any(d.EXIT in row for row in cells):
        lost.append(Lost("E", "none is drawn: there is no exit"))
    return World(fields, "A maze of maze-dataset.", {}, tuple(lost))


def _with_doors_shut(rows: Rows, lost: list[Lost]) -> Rows:
    """Return rows in which what stands in the outer wall has moved into the cell behind it."""
    cells = [list(row) for row in rows]
    right, bottom = len(rows[0]) - 1, len(rows) - 1
    for y, row in enumerate(rows):
        for x, character in enumerate(row):
            is_inner = x not in (0, right) and y not in (0, bottom)
            if is_inner or character == d.BLOCKED:
                continue
            inner = min(max(x, 1), right - 1), min(max(y, 1), bottom - 1)
            cells[y][x] = d.BLOCKED
            if character in (d.START, d.EXIT) and right > 1 and bottom > 1:
                cells[inner[1]][inner[0]] = character
            name = character if character != d.PLAIN else "the outer wall"
            lost.append(Lost(name, f"its door in row {y}, column {x} is shut"))
    return tuple("".join(row) for row in cells)


def _with_start(cells: Rows, lost: list[Lost]) -> tuple[Rows, bool]:
    """Return the cells with start and exit in the corners, if they name neither."""
    if any(d.START in row for row in cells):
        return cells, True
    rows = [list(row) for row in cells]
    rows[0][0] = d.START
    lost.append(Lost("S", "none is drawn, so it is the top-left cell"))
    if not any(d.EXIT in row for row in rows) and len(rows) * len(rows[0]) > 1:
        rows[-1][-1] = d.EXIT
        lost.append(Lost("E", "none is drawn, so it is the bottom-right cell"))
    return tuple("".join(row) for row in rows), False


def write_maze_dataset(level: Level) -> Conversion:
    """Return a level in ASCII, without the path of the solution."""
    lost = list(fields_lost(level, SPATIAL | {"areas"}, PLACE))
    lost += lost_areas(level, "it has no cells that end the episode but its end")
    grid, rows = level.grid(), list(marked(level))
    if any(grid.blocked_cells):
        lost.append(Lost("blocked", "the cells are there, with walls around them"))
    if grid.glass:
        lost.append(Lost("walls.pass", "walls of glass become solid"))
    for name, cells in (("start", level.starts), ("exit", level.exits)):
        if len(cells) > 1:
            lost.append(Lost(name, f"there is one, so only [{cells[0][0]}, {cells[0][1]}] is kept"))
        for x, y in cells[1:]:
            rows[y] = rows[y][:x] + d.PLAIN + rows[y][x + 1 :]
    if not level.exits:
        lost.append(Lost("exit", "there is none, and a maze there has one"))
    rows = [row.replace(ENDS, d.PLAIN).replace(d.BLOCKED, d.PLAIN) for row in rows]
    return Conversion("\n".join(as_blocks(grid, rows, lattice=True)) + "\n", tuple(lost))
