"""Maps of programs with other tasks, a letter for each cell: their geometry.

- `mettagrid`: MettaGrid's drawings with a legend, in YAML.
- `overcooked`: the kitchens of Overcooked-AI.
- `rware`: the layouts of RWARE's warehouses.
- `arc`: the grids of colours of the Abstraction and Reasoning Corpus (ARC-AGI).
- `vglc`: the dungeons of The Legend of Zelda in the Video Game Level Corpus.
"""

import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from babyrobot_levels.extensions.formats.blocks import (
    Rows,
    drawn,
    replaced,
    room,
    told_starts,
    without_ring,
)
from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    ConversionError,
    Lost,
    Part,
    World,
    integer,
    mapping,
    on_map,
    read_data,
    sequence,
    shown,
)
from babyrobot_levels.extensions.formats.places import cell_of, places_of_rows
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.fields import MAX_ROBOTS
from babyrobot_levels.text.reader import read as read_yaml
from babyrobot_levels.text.source import Position, SourceFile

Cell = tuple[int, int]

OBJECT = "&"
"""The meaning of a letter for something that a level does not have, and that blocks the way."""


def world_of_letters(
    source: SourceFile,
    rows: Sequence[str],
    meanings: Mapping[str, str],
    origin: str,
    *,
    names: Mapping[str, str] | None = None,
    lost: Sequence[Lost] = (),
    written: Sequence[str] | None = None,
    robots: Sequence[tuple[str, Cell | None]] = (),
) -> World:
    """Return the world of a map.

    Args:
        source: the text.
        rows: its rows; shorter ones are filled with blanks.
        meanings: what each letter means: a mark of the language, or `OBJECT`.
        origin: where the world comes from, as a sentence.
        names: what letters stand for that are not kept, for the messages.
        lost: what else is not kept.
        written: the rows as the text has them, if they are others.
        robots: several robots, each with its name and the cell of its own exit, in the order of
            the starts in the map.
    """
    width = max(map(len, rows), default=0)
    if not width:
        raise ConversionError("the map has no rows")
    if max(width, len(rows)) > MAX_SIZE + 2:
        raise ConversionError(f"the map is {width} by {len(rows)}; a level is at most {MAX_SIZE}")
    told, places = Counter("".join(rows)), places_of_rows(source, written or rows)
    for letter in told:
        if letter not in meanings:
            x, y = cell_of(rows, letter)
            place = Position(places[y].line, places[y].column + x)
            known = f"those of the format are {' '.join(each for each in meanings if each != ' ')}"
            raise ConversionError.at(source, place, f"unknown character `{letter}`", known)
    blocking = (letter for letter, meaning in meanings.items() if meaning == OBJECT)
    table = str.maketrans({**meanings, **dict.fromkeys(blocking, d.BLOCKED)})
    found = list(lost)
    for letter, name in (names or {}).items():
        if letter in told:
            becomes = "blocked cells" if meanings[letter] in (OBJECT, d.BLOCKED) else "plain cells"
            message = f"{told[letter]} {name} become {becomes}"
            found.append(Lost(f"`{letter}`", message, cell_of(rows, letter)))
    cells = tuple(row.ljust(width).translate(table) for row in rows)
    whole = cells if robots else with_start(cells, found)
    inner = without_ring(whole)
    ring = int(len(inner) < len(whole))
    fields: dict[str, Any] = {"version": 1, **drawn(inner)}
    if robots:
        own = {name: {"exit": [at[0] - ring, at[1] - ring]} if at else {} for name, at in robots}
        fields["robots"] = [{"name": name, **given} for name, given in own.items()]
    return World(fields, origin, {}, on_map(found, places))


def with_start(cells: Rows, lost: list[Lost]) -> Rows:
    """Return cells with a start: if none is marked, the first free one, with a way if there is."""
    text, width = "".join(cells), len(cells[0])
    lost += told_starts(cells)
    if d.START in text:
        return cells
    free = [cell for cell, mark in enumerate(text) if mark == d.PLAIN]
    goals = [cell for cell, mark in enumerate(text) if mark == d.EXIT]
    reached = {*room(text, goals[0], width)} if goals else {*free}
    chosen = next((cell for cell in free if cell in reached), None)
    if chosen is None:
        raise ConversionError("the map has no start, and no free cell that may be one")
    y, x = divmod(chosen, width)
    message = f"none is marked; row {y}, column {x} is used, the first free cell"
    lost.append(Lost("start", message, (x, y)))
    return replaced(cells, [(x, y)], d.START)


# -- mettagrid -------------------------------------------------------------------------------

_FREE = {"empty": d.PLAIN, "wall": d.BLOCKED, "block": d.BLOCKED}


def read_mettagrid(source: SourceFile) -> World:
    """Return the world of a drawing with a legend: agents are starts, what else is there blocks."""
    data = mapping(read_yaml(source).data, "the map")
    text, legend = data.get("map_data"), mapping(data.get("char_to_map_name"), "char_to_map_name")
    if not isinstance(text, str):
        raise ConversionError("map_data must be a drawing")
    meanings, names = {}, {}
    for letter, name in legend.items():
        kind = str(name).partition(".")[0]
        meanings[str(letter)] = d.START if kind == "agent" else _FREE.get(kind, OBJECT)
        if meanings[str(letter)] == OBJECT:
            names[str(letter)] = f"objects {shown(str(name))}"
    rows = [line.strip() for line in text.strip().split("\n")]
    task = Lost("objects", "their tasks are left out: the level has no exit")
    return world_of_letters(source, rows, meanings, "A map of MettaGrid.", names=names, lost=[task])


METTAGRID = Codec(
    read_mettagrid, draws=lambda source, _: re.search(r"(?m)^map_data:", source.text) is not None
)

# -- overcooked ------------------------------------------------------------------------------

_KITCHEN = {" ": d.PLAIN, **dict.fromkeys("XPODTS", OBJECT), **dict.fromkeys("123456789", d.START)}


def read_overcooked(source: SourceFile) -> World:
    """Return the world of a kitchen: its counters are blocked cells, and its players robots."""
    data = mapping(read_data(source), "the layout")
    rows = [row.strip() for row in str(data.get("grid")).strip().split("\n")]
    task = Lost("orders", "the task, to cook, is left out: the level has no exit")
    origin = "A kitchen of Overcooked-AI."
    players = [each for row in rows for each in row if each in "123456789"]
    robots = [(f"player-{each}", None) for each in players if 1 < len(players) <= MAX_ROBOTS]
    return world_of_letters(source, rows, _KITCHEN, origin, lost=[task], robots=robots)


def _is_kitchen(data: Any) -> bool:
    grid = data.get("grid") if isinstance(data, dict) else None
    return isinstance(grid, str) and {*grid} - {"\n"} <= _KITCHEN.keys()


OVERCOOKED = Codec(read_overcooked, holds=_is_kitchen)

# -- rware -----------------------------------------------------------------------------------

_WAREHOUSE = {".": d.PLAIN, "x": d.PLAIN, "g": d.EXIT}


def read_rware(source: SourceFile) -> World:
    """Return the world of a layout: an agent without a load goes below shelves."""
    rows = [line.strip().replace(" ", "") for line in source.text.strip().split("\n")]
    names = {"x": "shelves, which an agent with a load cannot pass,"}
    origin = "A warehouse of RWARE."
    agents = Lost(
        "agents", "not in the layout: there, several begin in cells that are drawn", (0, 0)
    )
    return world_of_letters(source, rows, _WAREHOUSE, origin, names=names, lost=[agents])


RWARE = Codec(read_rware, draws=lambda _, letters: {"x", "g"} <= letters - {" "} <= {*_WAREHOUSE})

# -- arc -------------------------------------------------------------------------------------

_COLORS = (
    *("", "#0074d9", "#ff4136", "#2ecc40", "#ffdc00"),
    *("#aaaaaa", "#f012be", "#ff851b", "#7fdbff", "#870c25"),
)
"""The colours of the cells 1 to 9, as ARC's own page shows them; 0 is the ground."""


def arc_parts(source: SourceFile) -> list[Part]:
    """Return the grids of a task: inputs and outputs of its pairs, one after the other."""
    data = mapping(read_data(source), "the task")
    pairs = [
        ((name, number), mapping(pair, name))
        for name in ("train", "test")
        for number, pair in enumerate(sequence(data.get(name), name))
    ]
    return [
        Part(json.dumps(pair[kind]), route=(*route, kind))
        for route, pair in pairs
        for kind in ("input", "output")
        if kind in pair
    ]


def read_arc(source: SourceFile) -> World:
    """Return the world of a grid: its colours are areas."""
    numbers = [
        [integer(cell, f"row {y}") for cell in sequence(row, f"row {y}")]
        for y, row in enumerate(sequence(read_data(source), "the grid"))
    ]
    rows = ["".join(str(cell) for cell in row if 0 <= cell <= 9) for row in numbers]
    text = "".join(rows)
    if not text or {*map(len, rows), *map(len, numbers)} != {len(rows[0])}:
        raise ConversionError("the grid must be rows of 0 to 9, all of one length")
    x, y = cell_of(rows, "0" if "0" in text else text[0])
    legend = {mark: {"color": _COLORS[int(mark)]} for mark in sorted({*text} - {"0"})}
    cells = tuple(row.replace("0", d.PLAIN) for row in rows)
    fields = {"version": 1, **drawn(replaced(cells, [(x, y)], d.START)), "legend": legend}
    lost = (
        Lost("task", "it is left out: the level has no exit", ()),
        Lost("start", f"none is marked; row {y}, column {x} is used", (y, x)),
    )
    return World(fields, "A grid of ARC.", {}, lost)


def _is_arc(data: Any) -> bool:
    return isinstance(data, dict) and all(isinstance(data.get(n), list) for n in ("train", "test"))


ARC = Codec(read_arc, holds=_is_arc, parts=arc_parts)

# -- vglc ------------------------------------------------------------------------------------

_DUNGEON = {**dict.fromkeys("FDMO", d.PLAIN), **dict.fromkeys("WBPI-", d.BLOCKED), "S": d.EXIT}
_DUNGEON_NAMES = {"D": "parts of doors, which may be locked,", "M": "monsters"}


def read_vglc(source: SourceFile) -> World:
    """Return the world of a dungeon: stairs are exits, walls, blocks and lava blocked cells."""
    origin = "A dungeon of the Video Game Level Corpus."
    rows = source.text.rstrip().split("\n")
    rows = [row.rstrip("\r") for row in rows]
    return world_of_letters(source, rows, _DUNGEON, origin, names=_DUNGEON_NAMES)


VGLC = Codec(
    read_vglc, draws=lambda source, letters: {"W", "F", "D", "-"} <= letters <= {*_DUNGEON}
)
