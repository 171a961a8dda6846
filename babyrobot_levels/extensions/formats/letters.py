"""Maps of programs with other tasks, a letter for each cell: their geometry.

- `movingai`: the maps of the pathfinding benchmarks, and their scenarios, each with start and goal.
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
from dataclasses import replace
from pathlib import Path
from typing import Any

from babyrobot_levels.extensions.formats.blocks import (
    Rows,
    block_map,
    drawn,
    replaced,
    room,
    told_starts,
    without_ring,
)
from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    Conversion,
    ConversionError,
    Lost,
    Part,
    World,
    file_beside,
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
from babyrobot_levels.language.cells import Rewards
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.reader import read as read_yaml
from babyrobot_levels.text.source import Position, SourceFile

OBJECT = "&"
"""The meaning of a letter for something that a level does not have, and that blocks the way."""


def _world(
    source: SourceFile,
    rows: Sequence[str],
    meanings: Mapping[str, str],
    origin: str,
    *,
    names: Mapping[str, str] | None = None,
    lost: Sequence[Lost] = (),
    written: Sequence[str] | None = None,
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
    fields = {"version": 1, **drawn(without_ring(with_start(cells, found)))}
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


# -- movingai --------------------------------------------------------------------------------

_MOVINGAI = "a map of MovingAI"
_TERRAIN = {".": d.PLAIN, "G": d.PLAIN, "S": d.PLAIN}
_TERRAIN |= dict.fromkeys("@OTW", d.BLOCKED)
_TOLD = {"W": "cells of water, which only lead to other water,"}
_HEADER = re.compile(r"type +([\w-]+)\s+height +(\d{1,6})\s+width +(\d{1,6})\s+map *\n")
_DIAGONAL = Lost("diagonal moves", "there, agents move diagonally, too, at the cost of √2")


def read_movingai(source: SourceFile, folder: Path | None = None) -> World:
    """Return the world of a map, or of one line of a file of scenarios for it.

    Args:
        source: the text.
        folder: the folder of a file of scenarios, in which the map is; None to read no other file.

    Raises:
        ConversionError: it is no such text, or the map of a scenario is not there.
    """
    if not source.text.lstrip().startswith("version"):
        rows, lost = _rows_of_map(source)
        return _world_of_map(source, rows, _with_exit(rows, lost), lost)
    fields = source.text.splitlines()[-1].split()
    if len(fields) != 9 or not all(re.fullmatch(r"\d{1,6}", each) for each in fields[4:8]):
        raise ConversionError(f"this is no line of a scenario: {shown(' '.join(fields))}")
    name = fields[1].replace("\\", "/").rpartition("/")[2]
    if folder is None:
        raise ConversionError(f"the map {shown(name)} is a file of its own, and is not read")
    there = file_beside(folder, name)
    rows, lost = _rows_of_map(there)
    places = [(int(x), int(y)) for x, y in (fields[4:6], fields[6:8])]
    for x, y in places:
        if y >= len(rows) or x >= len(rows[0]) or rows[y][x] in "@OTW":
            raise ConversionError(f"column {x}, row {y} is no free cell of the map {shown(name)}")
    world = _world_of_map(there, rows, places, lost)
    return replace(world, lost=tuple(replace(each, at=Position(2, 1)) for each in world.lost))


def _rows_of_map(source: SourceFile) -> tuple[list[str], list[Lost]]:
    text = source.text.replace("\r\n", "\n")
    header = _HEADER.match(text)
    if header is None:
        help_text = "a map begins with lines for type, height, width, and `map`"
        raise ConversionError(f"{source.name} is not {_MOVINGAI}", help_text)
    if header[1] not in ("tile", "octile", "octile_unicost"):
        raise ConversionError(f"the map's type is {shown(header[1])}, not octile or tile")
    height, width = int(header[2]), int(header[3])
    rows = text[header.end() :].rstrip("\n").split("\n")
    if len(rows) != height or {*map(len, rows)} != {width}:
        sizes = f"{len(rows)} rows of {max(map(len, rows))}"
        raise ConversionError(f"the map has {sizes} cells, not {height} of {width} as it says")
    return rows, [_DIAGONAL] if header[1].startswith("octile") else []


def _plain(text: str) -> str:
    return "".join(_TERRAIN.get(letter, d.BLOCKED) for letter in text)


def _with_exit(rows: Sequence[str], lost: list[Lost]) -> list[tuple[int, int]]:
    """Return the first free cell, and the last one that it is connected to."""
    text, width = _plain("".join(rows)), len(rows[0])
    if d.PLAIN not in text:
        raise ConversionError("the map has no free cell")
    reached = room(text, text.index(d.PLAIN), width)
    places = [(cell % width, cell // width) for cell in (reached[0], max(reached))]
    told = [f"column {x}, row {y}" for x, y in places]
    message = f"not in the map, but in its scenarios (.scen); {told[0]} and {told[1]} are used"
    lost.append(Lost("start, exit", message))
    return places


def _world_of_map(
    source: SourceFile, rows: list[str], ends: Sequence[tuple[int, int]], lost: Sequence[Lost]
) -> World:
    meanings = _TERRAIN | {"s": d.START, "e": d.EXIT}
    origin = "A map of MovingAI's benchmarks."
    marked = _marked(rows, ends)
    return _world(source, marked, meanings, origin, names=_TOLD, lost=lost, written=rows)


def _marked(rows: Sequence[str], ends: Sequence[tuple[int, int]]) -> Rows:
    """Return rows with start and goal; if they are one cell, it is the start."""
    return replaced(replaced(tuple(rows), ends[1:], "e"), ends[:1], "s")


def _scenarios(source: SourceFile) -> list[Part]:
    if not source.text.lstrip().startswith("version"):
        return [Part(source.text)]
    lines = [(number, line) for number, line in enumerate(source.lines, 1) if line.strip()]
    return [Part(f"version 1\n{line}", number - 1) for number, line in lines[1:]]


def write_movingai(level: Level) -> Conversion:
    """Return a level as a map, in which start and exit are where reading has them."""
    ends = f"{_MOVINGAI} has no cells that end the episode"
    rows, lost = block_map(level, _MOVINGAI, Rewards(), ends=ends, many="SE")
    marks = str.maketrans({d.BLOCKED: "@", **dict.fromkeys((d.START, d.EXIT, d.PLAIN), ".")})
    lines = [row.translate(marks) for row in rows]
    start, *exits = _with_exit(lines, [])
    for name, mark, places in (("start", d.START, [start]), ("exit", d.EXIT, exits)):
        drawn_at = [(row.index(mark), y) for y, row in enumerate(rows) if mark in row]
        if drawn_at != places or "".join(rows).count(mark) > 1:
            lost.append(Lost(name, "it stands in scenarios, not in the map"))
    head = f"type tile\nheight {len(rows)}\nwidth {len(rows[0])}\nmap\n"
    return Conversion(head + "".join(f"{line}\n" for line in lines), tuple(lost))


def _is_movingai(source: SourceFile, _: set[str]) -> bool:
    is_scenario = re.match(r"version\s+1(\.\d)?\s*\n\d+\s+\S+\.map\s", source.text) is not None
    return is_scenario or _HEADER.match(source.text.replace("\r\n", "\n")) is not None


MOVINGAI = Codec(read_movingai, write_movingai, draws=_is_movingai, parts=_scenarios)

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
    return _world(source, rows, meanings, "A map of MettaGrid.", names=names, lost=[task])


METTAGRID = Codec(
    read_mettagrid, draws=lambda source, _: re.search(r"(?m)^map_data:", source.text) is not None
)

# -- overcooked ------------------------------------------------------------------------------

_KITCHEN = {" ": d.PLAIN, **dict.fromkeys("XPODTS", OBJECT), **dict.fromkeys("123456789", d.START)}


def read_overcooked(source: SourceFile) -> World:
    """Return the world of a kitchen: its counters are blocked cells, and its players starts."""
    data = mapping(read_data(source), "the layout")
    rows = [row.strip() for row in str(data.get("grid")).strip().split("\n")]
    task = Lost("orders", "the task, to cook, is left out: the level has no exit")
    return _world(source, rows, _KITCHEN, "A kitchen of Overcooked-AI.", lost=[task])


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
    return _world(source, rows, _WAREHOUSE, origin, names=names)


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
    return _world(source, rows, _DUNGEON, origin, names=_DUNGEON_NAMES)


VGLC = Codec(
    read_vglc, draws=lambda source, letters: {"W", "F", "D", "-"} <= letters <= {*_DUNGEON}
)
