"""Formats whose walls fill whole cells: maze_map, MiniGrid, and maze-dataset's lattices.

- `maze-map`: the `maze_map` of Gymnasium-Robotics, rows of 0, 1, "r", "g" and "c".
- `minigrid`: MiniGrid's text, two characters a cell, as `pprint_grid` prints it.
- `maze-dataset`: mazes in ASCII, as `as_ascii` draws them. These blocks are walls between cells.
"""

import json
from dataclasses import replace
from typing import Any

from babyrobot_levels.extensions.formats.blocks import (
    ENDS,
    Rows,
    block_map,
    drawn,
    from_lattice,
    is_lattice,
    lattice_map,
    place_of,
    replaced,
    text_rows,
    told_starts,
    translated,
    without_margin,
    without_ring,
    without_surroundings,
)
from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    Conversion,
    ConversionError,
    Lost,
    World,
    letters_in,
    on_map,
    read_data,
    sequence,
    shown,
)
from babyrobot_levels.extensions.formats.minigrid_grids import (
    LAVA,
    Cell,
    Object,
    Snapshot,
    moved,
    world_of,
)
from babyrobot_levels.extensions.formats.places import At, cell_of, rows_from
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.cells import Rewards
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile

GOAL_REWARDS = Rewards(step=0, exit=1)
"""The rewards of Gymnasium-Robotics' sparse tasks, and of MiniGrid's goals."""

# -- maze-map --------------------------------------------------------------------------------

_MAZE_MAP = "a maze_map"
_EITHER = "c"
_VALUES: dict[Any, str] = {0: d.PLAIN, 1: d.BLOCKED, "r": d.START, "g": d.EXIT, "c": _EITHER}


def read_maze_map(source: SourceFile) -> World:
    """Return the world of a map: a list of rows, as JSON or as a Python literal."""
    rows = []
    for y, row in enumerate(sequence(plain(read_data(source)), _MAZE_MAP)):
        cells = [_cell_of_value(value, x, y) for x, value in enumerate(sequence(row, f"row {y}"))]
        rows.append("".join(cells))
        if len(cells) != len(rows[0]) or not cells:
            raise ConversionError(f"row {y} has {len(cells)} cells, the first has {len(rows[0])}")
    if not rows:
        raise ConversionError("the map has no rows")
    lost: list[Lost] = []
    world = without_ring(_with_ends(tuple(rows), lost))
    fields = {"version": 1, **drawn(world), "rewards": {"step": 0, "exit": 1}}
    comments = {"rewards": "The rewards of the sparse tasks."}
    return World(fields, "A maze_map of Gymnasium-Robotics.", comments, tuple(lost))


def _cell_of_value(value: Any, x: int, y: int) -> str:
    known = isinstance(value, int | str) and not isinstance(value, bool) and value in _VALUES
    if not known:
        raise ConversionError(
            f'row {y}, column {x}: expected 0, 1, "r", "g" or "c", not {shown(value)}'
        )
    return _VALUES[value]


def _with_ends(rows: Rows, lost: list[Lost]) -> Rows:
    """Return the rows with starts and exits; where none are marked, choose among the free cells."""
    cells = [list(row) for row in rows]
    text = "".join(rows)
    places = {mark: d.cells_with(rows, mark) for mark in (_EITHER, d.PLAIN)}
    count, chosen = len(places[_EITHER]), []
    for name, what, mark, index in (("r", "start", d.START, 0), ("g", "goal", d.EXIT, -1)):
        free = places[_EITHER] or places[d.PLAIN]
        if mark in text or not free:
            continue
        x, y = free.pop(index)
        cells[y][x] = mark
        where = f"row {y}, column {x}"
        if count:
            chosen.append(f"the {what} is {where}")
        else:
            message = f"no cell is marked: any free one may be it; {where} is used"
            lost.append(Lost(name, message, (y, x)))
    if count:
        told = ", ".join([f"{count} of them, each of which may be start or goal there", *chosen])
        message = f"{told}; the others are free"
        lost.append(Lost("c", message, cell_of(rows, _EITHER)[::-1]))
    if (goals := text.count(d.EXIT)) > 1:
        message = f"each of the {goals} goals ends the episode; there, one is drawn at each reset"
        lost.append(Lost("g", message, cell_of(rows, d.EXIT, 1)[::-1]))
    return tuple("".join(row).replace(_EITHER, d.PLAIN) for row in cells)


def write_maze_map(level: Level) -> Conversion:
    """Return a level as a list of rows that is JSON and a Python literal at once."""
    ends = f"{_MAZE_MAP} has no cells that end the episode but goals"
    rows, lost = block_map(level, _MAZE_MAP, GOAL_REWARDS, ends=ends, many="SE")
    values = {cell: value for value, cell in _VALUES.items()}
    lines = ",\n  ".join(json.dumps([values[cell] for cell in row]) for row in rows)
    return Conversion(f"[\n  {lines}\n]\n", tuple(lost))


MAZE_MAP = Codec(
    read_maze_map,
    write_maze_map,
    holds=lambda data: set() < letters_in(data) <= set(map(str, _VALUES)),
)

# -- maze-dataset ----------------------------------------------------------------------------

_DATASET = "a maze of maze-dataset"
PATH = {"X", "+"}
"""How maze-dataset and mazelib draw the path of the solution."""

_DATASET_CELLS = {"#": d.BLOCKED, " ": d.PLAIN, "S": d.START, "E": d.EXIT}
_DATASET_CELLS |= dict.fromkeys(PATH, d.PLAIN)
_DATASET_HELP = "`#` wall, a blank free, S start, E end, X or + the path of the solution"


def read_maze_dataset(source: SourceFile) -> World:
    """Return the world of a maze that is drawn on a lattice of walls and cells."""
    lines = text_rows(source)
    lost: list[Lost] = []
    rows = _without_doors(translated(source, lines, _DATASET_CELLS, _DATASET_HELP), lost)
    if not is_lattice(rows):
        raise ConversionError(
            "the map is not a maze of cells with walls between them",
            "an odd number of rows and columns, a cell in every second one, and `#` between four; "
            "for walls that fill cells, use --from sokoban",
        )
    paths = sorted(PATH.intersection("".join(lines)))
    message = "the path of the solution is left out; `babyrobot solve` finds it"
    lost += (Lost(mark, message, cell_of(lines, mark)) for mark in paths)
    cells, east, south = from_lattice(rows)
    cells, has_start = _with_corners(cells, lost)
    fields = {"version": 1, **drawn(cells, east, south)}
    if has_start and not any(d.EXIT in row for row in cells):
        lost.append(Lost("E", "none is drawn, so the level has no exit"))
    lost += told_starts(rows)
    places = rows_from(place_of(source, 0, 0), len(lines))
    return World(fields, "A maze of maze-dataset.", {}, on_map(lost, places))


def _without_doors(rows: Rows, lost: list[Lost]) -> Rows:
    """Return rows with a closed outer wall; a start or exit in it moves into the cell behind it."""
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
            lost.append(Lost(name, f"its door in row {y}, column {x} is closed", (x, y)))
    return tuple("".join(row) for row in cells)


def _with_corners(cells: Rows, lost: list[Lost]) -> tuple[Rows, bool]:
    """Return the cells with start and exit in the corners if no start is marked; whether one is."""
    if any(d.START in row for row in cells):
        return cells, True
    rows = replaced(cells, [(0, 0)], d.START)
    lost.append(Lost("S", "none is drawn, so it is the top-left cell"))
    if not any(d.EXIT in row for row in rows) and len(rows) * len(rows[0]) > 1:
        rows = replaced(rows, [(len(rows[0]) - 1, len(rows) - 1)], d.EXIT)
        lost.append(Lost("E", "none is drawn, so it is the bottom-right cell"))
    return rows, False


def write_maze_dataset(level: Level) -> Conversion:
    """Return a level in ASCII, without the path of the solution."""
    rows, lost = lattice_map(level, _DATASET)
    if not level.exits:
        lost.append(Lost("exit", "the level has none, and a maze there has one"))
    return Conversion("\n".join(rows) + "\n", tuple(lost))


def is_maze(source: SourceFile, letters: set[str]) -> bool:
    """Return whether a text with these characters is a maze of maze-dataset or mazelib."""
    if not letters <= _DATASET_CELLS.keys():
        return False
    return is_lattice(translated(source, text_rows(source), _DATASET_CELLS, _DATASET_HELP))


MAZE_DATASET = Codec(read_maze_dataset, write_maze_dataset, draws=is_maze)

# -- minigrid --------------------------------------------------------------------------------

_AGENTS = {">>": "E", "VV": "S", "<<": "W", "^^": "N"}
_MINIGRID_CELLS = {"W": d.BLOCKED, "G": d.EXIT, "V": LAVA, "F": d.PLAIN}
_OBJECTS = {"D": "door", "L": "door", "K": "key", "A": "ball", "B": "box"}
_DOORS = {"D": "closed", "L": "locked"}
_OBJECT_COLORS = {"R": "red", "G": "green", "B": "blue", "P": "purple", "Y": "yellow"}
"""G is grey as well: the text has one letter for both."""

_MINIGRID_HELP = (
    "two characters a cell: WG wall, GG goal, VR lava, `>>` the agent, two blanks free; "
    "F, D, L, K, A and B with a colour are floor, doors, locked doors, keys, balls and boxes"
)


def read_minigrid(source: SourceFile) -> World:
    """Return the world of a MiniGrid text: its walls are blocked cells."""
    rows: list[str] = []
    objects: list[Object] = []
    agents: dict[Cell, str] = {}
    floor: list[Cell] = []
    for y, line in enumerate(text_rows(source, blanks=True)):
        pairs = [line[x : x + 2].ljust(2) for x in range(0, len(line), 2)]
        marks = [d.PLAIN] * len(pairs)
        for x, pair in enumerate(pairs):
            kind, color = pair[0], pair[1]
            if pair in _AGENTS:
                agents[x, y] = _AGENTS[pair]
            elif pair == "__":
                # An open door has no colour.
                objects.append(Object("door", "grey", (x, y), "open"))
            elif kind in _OBJECTS and color in _OBJECT_COLORS:
                state = _DOORS.get(kind, "")
                objects.append(Object(_OBJECTS[kind], _OBJECT_COLORS[color], (x, y), state))
            elif kind in _MINIGRID_CELLS and color in _OBJECT_COLORS:
                marks[x] = _MINIGRID_CELLS[kind]
                floor += [(x, y)] * (kind == "F")
            elif pair != "  ":
                place = place_of(source, 2 * x, y, blanks=True)
                raise ConversionError.at(source, place, f"unknown cell `{pair}`", _MINIGRID_HELP)
        rows.append("".join(marks))
    drawn_rows = replaced(tuple(rows), agents, d.START)
    whole, above = without_margin(without_surroundings(drawn_rows), drawn_rows)
    inner = without_ring(whole)
    ring = int(len(inner) < len(whole))
    heading = next(iter(agents.values()), "E")
    found = Snapshot(drawn_rows, tuple(objects), tuple(agents), heading, floor=tuple(floor))
    found = moved(found, inner, ring, above + ring)
    world = world_of(found, "A text of MiniGrid's pprint_grid.")
    # Their cells are those of the level.
    lost = [replace(each, at=_moved(each.at, ring, above + ring)) for each in world.lost]
    first = place_of(source, 0, 0, blanks=True)
    return replace(world, lost=on_map(lost, rows_from(first, len(rows)), 2))


def _moved(at: At | None, right: int, down: int) -> At | None:
    return at and (int(at[0]) + right, int(at[1]) + down)


def write_minigrid(level: Level) -> Conversion:
    """Return a level as a MiniGrid text, with a ring of walls."""
    rows, lost = block_map(
        level, "a MiniGrid text", GOAL_REWARDS, ends=None, many="E", carried=frozenset({"heading"})
    )
    agent = next(pair for pair, heading in _AGENTS.items() if heading == level.heading)
    pairs = {d.BLOCKED: "WG", d.PLAIN: "  ", d.START: agent, d.EXIT: "GG", ENDS: "VR"}
    text = "\n".join("".join(map(pairs.__getitem__, row)) for row in rows)
    return Conversion(f"{text}\n", tuple(lost))


MINIGRID = Codec(
    read_minigrid,
    write_minigrid,
    draws=lambda source, letters: "WG" in source.text and letters <= set("WGVFDLKABRPY><^_ "),
)
