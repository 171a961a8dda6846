"""Mazes of micromouse contests: drawn with posts and walls, or as 256 bytes; and of gym-maze.

Where nothing is drawn, the rules of the contests say it: the mouse starts in the bottom-left cell,
and its goal is the middle.
"""

import re
from dataclasses import replace
from io import BytesIO
from itertools import product

from babyrobot_levels.extensions.formats.blocks import (
    Rows,
    drawn,
    from_lattice,
    lattice_map,
    replaced,
    room,
    told_starts,
)
from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    Conversion,
    ConversionError,
    Lost,
    World,
    on_map,
)
from babyrobot_levels.extensions.formats.places import rows_from
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import Position, SourceFile

_POSTS = re.compile(r"[o+]((---|   )[o+])+")
_CELLS = re.compile(r"[| ]( [ SG] [| ])+")
_MARKS = str.maketrans({**dict.fromkeys("o+-|", d.BLOCKED), "G": d.EXIT})
_HELP = "rows of posts (`o` or `+`) with `---` between them, and rows of cells with `|`, S and G"
_MAZE = "a micromouse maze"


def read_micromouse(source: SourceFile) -> World:
    """Return the world of a drawn maze; what is written around it is its description.

    Raises:
        ConversionError: there is no maze, or it has a faulty line.
    """
    first, last = _frame(source)
    lines = [line.rstrip() for line in source.lines]
    rows: list[str] = []
    for number in range(first, last + 1):
        line = lines[number].ljust(len(lines[first]))
        wanted = _CELLS if (number - first) % 2 else _POSTS
        if not wanted.fullmatch(line) or len(line) > len(lines[first]):
            good = wanted.match(line[: len(lines[first])])
            place = Position(number + 1, good.end() + 1 if good else 1)
            raise ConversionError.at(source, place, "this is no row of a micromouse maze", _HELP)
        rows.append(line[::2].translate(_MARKS))
    text = "\n".join([*lines[:first], *lines[last + 1 :]]).strip()
    lost: list[Lost] = []
    edge = {0, len(rows) - 1}, {0, len(rows[0]) - 1}
    gaps = [
        Position(first + y + 1, 2 * x + 1)
        for y, row in enumerate(rows)
        for x, mark in enumerate(row)
        if mark != d.BLOCKED and (y in edge[0] or x in edge[1])
    ]
    if gaps:
        lost.append(Lost("the outer wall", f"{len(gaps)} openings in it are closed", gaps[0]))
    cells, east, south = from_lattice(tuple(rows))
    lost += told_starts(cells)
    cells = _with_ends(cells, tuple(rows), lost)
    about = {"description": text} if text else {}
    fields = {"version": 1, **about, **drawn(cells, east, south)}
    places = rows_from(Position(first + 2, 3), len(cells), 2)
    return World(fields, "A maze of a micromouse contest.", {}, on_map(lost, places, 4))


def _frame(source: SourceFile) -> tuple[int, int]:
    """Return the numbers of the first and the last line of the maze."""
    posts = [number for number, line in enumerate(source.lines) if _POSTS.fullmatch(line.rstrip())]
    if len(posts) < 2:
        raise ConversionError("the text has no maze of posts and walls", _HELP)
    # Two rows of posts with one missing in between have a row of cells too many or too few.
    last = posts[-1] if (posts[-1] - posts[0]) % 2 == 0 else posts[-1] - 1
    if last == posts[0]:
        raise ConversionError("the maze has no row of cells", _HELP)
    return posts[0], last


def _with_ends(cells: Rows, lattice: Rows, lost: list[Lost]) -> Rows:
    """Return the cells with a start and with goals, by the rules where none are drawn."""
    width, height, text = len(cells[0]), len(cells), "".join(cells)
    if d.START not in text:
        cells = replaced(cells, [(0, height - 1)], d.START)
        message = "none is drawn, so it is the bottom-left cell, as in contests"
        lost.append(Lost("S", message, (0, height - 1)))
    if d.EXIT in text:
        return cells
    x, y = d.cells_with(cells, d.START)[0]
    columns = len(lattice[0])
    reached = {*room("".join(lattice), (2 * y + 1) * columns + 2 * x + 1, columns)}
    goals = [
        (column, row)
        for column, row in product({(width - 1) // 2, width // 2}, {(height - 1) // 2, height // 2})
        if (column, row) != (x, y) and (2 * row + 1) * columns + 2 * column + 1 in reached
    ]
    told = "it is the middle, as in contests" if goals else "there is no exit: no way to the middle"
    lost.append(Lost("G", f"none is drawn, so {told}", next(iter(goals), None)))
    return replaced(cells, goals, d.EXIT)


def write_micromouse(level: Level) -> Conversion:
    """Return a level as a drawn maze."""
    rows, lost = lattice_map(level, _MAZE, many="E")
    return Conversion(_text_of(rows), tuple(lost))


def _text_of(lattice: Rows) -> str:
    """Return a lattice as it is drawn."""
    thin = {0: {d.BLOCKED: "o"}, 1: {d.BLOCKED: "|", d.PLAIN: " "}}
    wide = {0: {d.BLOCKED: "---", d.PLAIN: "   "}}
    wide[1] = {d.PLAIN: "   ", d.START: " S ", d.EXIT: " G "}
    return "".join(
        "".join((wide if x % 2 else thin)[y % 2][mark] for x, mark in enumerate(row)) + "\n"
        for y, row in enumerate(lattice)
    )


def is_micromouse(source: SourceFile, _: object = None) -> bool:
    """Return whether a text is such a maze, and not one that has a maze as an example.

    With posts `+` it must have nothing else, as it may be a drawing of the language, in which G
    is a mark that is explained below.
    """
    lines = [line.rstrip() for line in source.lines if line.strip()]
    posts = [line for line in lines if _POSTS.fullmatch(line)]
    if len(posts) < 2 or "o" in posts[0]:
        return len(posts) >= 2 and 4 * len(posts) > len(lines)
    cells = "".join(line for line in lines if _CELLS.fullmatch(line))
    is_all = all(_POSTS.fullmatch(line) or _CELLS.fullmatch(line) for line in lines)
    return is_all and ("G" in cells or "S" not in cells)


# -- 256 bytes -------------------------------------------------------------------------------

_BYTES = "a maze of 256 bytes"
_SIDE = 16
_BITS = {"N": 1, "E": 2, "S": 4, "W": 8}
_STEPS = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}


def _places() -> list[tuple[int, int]]:
    """Return the columns and rows of the cells in a lattice, in the order of the bytes."""
    return [(2 * x + 1, 2 * y + 1) for x in range(_SIDE) for y in reversed(range(_SIDE))]


def decode_maz(data: bytes) -> str | None:
    """Return a maze of 256 bytes as it is drawn; None if these are no such maze.

    A byte is a cell, from the bottom up and from the left to the right; its bits are the walls to
    the north, east, south and west.

    Raises:
        ConversionError: two cells disagree about the wall between them.
    """
    if len(data) != _SIDE * _SIDE:
        return None
    walls: dict[tuple[int, int], bool] = {}
    for (x, y), bits in zip(_places(), data, strict=True):
        for side, (right, down) in _STEPS.items():
            wall = bool(bits & _BITS[side])
            if walls.setdefault((x + right, y + down), wall) == wall:
                continue
            if max(data) > sum(_BITS.values()):
                return None
            cell = f"the cells beside column {(x + right) / 2:g}, row {(y + down) / 2:g}"
            raise ConversionError(f"{cell} disagree about the wall there: another order of bits?")
    span = range(2 * _SIDE + 1)
    is_open = {place for place, wall in walls.items() if not wall} | {*_places()}
    return _text_of(
        tuple("".join(d.PLAIN if (x, y) in is_open else d.BLOCKED for x in span) for y in span)
    )


def write_maz(level: Level) -> Conversion:
    """Return a level of 16 by 16 cells as a maze of 256 bytes, and as it is drawn.

    Raises:
        ValueError: it has another size.
    """
    if level.size != (_SIDE, _SIDE):
        width, height = level.size
        raise ValueError(f"{_BYTES} has {_SIDE} by {_SIDE} cells, not {width} by {height}")
    lattice, lost = lattice_map(level, _BYTES, many="E")
    bare = tuple(row.replace(d.START, d.PLAIN).replace(d.EXIT, d.PLAIN) for row in lattice)
    contest = _with_ends(from_lattice(bare)[0], bare, [])
    for mark, name, cells in ((d.START, "start", level.starts), (d.EXIT, "exit", level.exits)):
        if {*d.cells_with(contest, mark)} != {*cells}:
            lost.append(Lost(name, f"{_BYTES} has none: it is where contests have it"))
    data = bytes(
        sum(
            bit
            for side, bit in _BITS.items()
            if lattice[y + _STEPS[side][1]][x + _STEPS[side][0]] == d.BLOCKED
        )
        for x, y in _places()
    )
    return Conversion(_text_of(bare), tuple(lost), data=data)


MICROMOUSE = Codec(read_micromouse, write_micromouse, draws=is_micromouse)
MAZ = Codec(read_micromouse, write_maz, decodes=decode_maz)

# -- gym-maze --------------------------------------------------------------------------------

_ARRAY = b"\x93NUMPY"


def decode_gym_maze(data: bytes) -> str | None:
    """Return a maze of gym-maze, an array of NumPy, as it is drawn; None if it is no such array.

    An element is a cell `[x, y]`; its bits are the open sides to the north, east, south and west.

    Raises:
        ConversionError: the array is damaged.
    """
    if not data.startswith(_ARRAY):
        return None
    # Imported here, as only these files need NumPy.
    import numpy as np

    try:
        cells = np.load(BytesIO(data), allow_pickle=False)
    except (ValueError, EOFError, MemoryError, SyntaxError) as error:
        raise ConversionError(f"this is no array of NumPy that can be read ({error})") from None
    is_maze = isinstance(cells, np.ndarray) and cells.ndim == 2 and cells.dtype.kind in "iu"
    if not is_maze or not 1 <= min(cells.shape) <= max(cells.shape) <= MAX_SIZE or cells.size < 2:
        return None
    width, height = cells.shape
    rows = [[d.BLOCKED] * (2 * width + 1) for _ in range(2 * height + 1)]
    for (x, y), bits in np.ndenumerate(cells):
        rows[2 * y + 1][2 * x + 1] = d.PLAIN
        for side, (right, down) in _STEPS.items():
            if bits & _BITS[side]:
                rows[2 * y + 1 + down][2 * x + 1 + right] = d.PLAIN
    rows[1][1], rows[-2][-2] = d.START, d.EXIT
    return _text_of(tuple("".join(row) for row in rows))


def read_gym_maze(source: SourceFile) -> World:
    """Return the world of a maze, from its top-left cell to the bottom-right one."""
    return replace(read_micromouse(source), origin="A maze of gym-maze.")


GYM_MAZE = Codec(read_gym_maze, decodes=decode_gym_maze)
