"""Maps of the pathfinding benchmarks of MovingAI, and their scenarios, with starts and goals.

Several scenarios are a problem of several agents, as in multi-agent path finding.
"""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from babyrobot_levels.extensions.formats.blocks import Rows, block_map, replaced, room
from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    Conversion,
    ConversionError,
    Lost,
    Part,
    World,
    file_beside,
    shown,
)
from babyrobot_levels.extensions.formats.letters import Cell, world_of_letters
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.cells import Rewards
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import Position, SourceFile

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
        rows, lost = rows_of_map(source)
        return _world_of_map(source, rows, _with_exit(rows, lost), lost)
    first, *others = scenarios_of(source)
    name = first.map
    if folder is None:
        raise ConversionError(f"the map {shown(name)} is a file of its own, and is not read")
    there = file_beside(folder, name)
    rows, lost = rows_of_map(there)
    for each in (first, *others):
        for x, y in (each.start, each.goal):
            if y >= len(rows) or x >= len(rows[0]) or rows[y][x] in "@OTW":
                place = f"column {x}, row {y}"
                raise ConversionError(f"{place} is no free cell of the map {shown(name)}")
    if others:
        world = _world_of_team(there, rows, [first, *others], lost)
    else:
        world = _world_of_map(there, rows, [first.start, first.goal], lost)
    return replace(world, lost=tuple(replace(each, at=Position(2, 1)) for each in world.lost))


class Scenario(NamedTuple):
    """A line of a file of scenarios: an agent, its start and its goal, and the map."""

    map: str
    start: Cell
    goal: Cell
    line: int


def scenarios_of(source: SourceFile) -> list[Scenario]:
    """Return the agents of a file of scenarios, in its order.

    Raises:
        ConversionError: the text is no such file.
    """
    lines = [number for number, line in enumerate(source.lines, 1) if line.strip()]
    return [_scenario(source, number) for number in lines[1:]]


def _scenario(source: SourceFile, number: int) -> Scenario:
    fields = source.line(number).split()
    if len(fields) != 9 or not all(re.fullmatch(r"\d{1,6}", each) for each in fields[4:8]):
        raise ConversionError.at(source, Position(number, 1), "this is no line of a scenario")
    x, y, right, down = map(int, fields[4:8])
    return Scenario(fields[1].replace("\\", "/").rpartition("/")[2], (x, y), (right, down), number)


def _world_of_team(
    source: SourceFile, rows: list[str], agents: Sequence[Scenario], lost: Sequence[Lost]
) -> World:
    """Return the world of several agents, each with its own goal, where it stays."""
    starts = [agent.start for agent in agents]
    if len({*starts}) < len(starts):
        message = "two of the agents begin in one cell: these scenarios are for one at a time"
        raise ConversionError(message, "leave out --robots")
    numbered = sorted(enumerate(agents, 1), key=lambda pair: pair[1].start[::-1])
    message = "a robot that has reached its exit stays there; there, it may go on"
    world = world_of_letters(
        source,
        replaced(tuple(rows), starts, "s"),
        _TERRAIN | {"s": d.START},
        "A map of MovingAI's benchmarks.",
        names=_TOLD,
        lost=[*lost, Lost("goals", message, (0, 0))],
        written=rows,
        robots=[(f"agent-{number}", agent.goal) for number, agent in numbered],
    )
    return replace(world, fields={**world.fields, "team": {"arrived": "stay"}})


def rows_of_map(source: SourceFile) -> tuple[list[str], list[Lost]]:
    """Return the rows of a map, all of one length, and what a level does not have of it.

    Raises:
        ConversionError: the text is no map, or has another size than it says.
    """
    text = source.text.replace("\r\n", "\n")
    header = _HEADER.match(text)
    if header is None:
        help_text = "a map begins with lines for type, height, width, and `map`"
        message = f"{source.name} is not {_MOVINGAI}"
        raise ConversionError.at(source, Position(1, 1), message, help_text)
    if header[1] not in ("tile", "octile", "octile_unicost"):
        message = f"the map's type is {shown(header[1])}, not octile or tile"
        raise ConversionError.at(source, Position(1, 1), message)
    height, width = int(header[2]), int(header[3])
    rows = text[header.end() :].rstrip("\n").split("\n")
    if len(rows) != height or {*map(len, rows)} != {width}:
        sizes = f"{len(rows)} rows of {max(map(len, rows))}"
        message = f"the map has {sizes} cells, not {height} of {width} as it says"
        raise ConversionError.at(source, Position(2, 1), message)
    return rows, [_DIAGONAL] if header[1].startswith("octile") else []


def plain_cells(text: str) -> str:
    """Return the cells of a map as plain (`language.drawing.PLAIN`) and blocked ones."""
    return "".join(_TERRAIN.get(letter, d.BLOCKED) for letter in text)


def _with_exit(rows: Sequence[str], lost: list[Lost]) -> list[tuple[int, int]]:
    """Return the first free cell, and the last one that it is connected to."""
    text, width = plain_cells("".join(rows)), len(rows[0])
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
    return world_of_letters(source, marked, meanings, origin, names=_TOLD, lost=lost, written=rows)


def _marked(rows: Sequence[str], ends: Sequence[tuple[int, int]]) -> Rows:
    """Return rows with start and goal; if they are one cell, it is the start."""
    return replaced(replaced(tuple(rows), ends[1:], "e"), ends[:1], "s")


def _scenarios(source: SourceFile) -> list[Part]:
    if not source.text.lstrip().startswith("version"):
        return [Part(source.text)]
    lines = [(number, line) for number, line in enumerate(source.lines, 1) if line.strip()]
    return [Part(f"version 1\n{line}", number - 1) for number, line in lines[1:]]


def _team(source: SourceFile, robots: int) -> Part:
    """Return the first scenarios of a file as one of several agents."""
    parts = _scenarios(source)
    if not source.text.lstrip().startswith("version") or len(parts) < robots:
        raise ConversionError(f"the text has no scenarios for {robots} robots")
    lines = [part.text.partition("\n")[2] for part in parts[:robots]]
    return Part("\n".join(["version 1", *lines]), parts[0].line)


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


CODEC = Codec(read_movingai, write_movingai, draws=_is_movingai, parts=_scenarios, team=_team)
