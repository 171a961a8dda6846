"""Maps of Sokoban, as many small programs have them: `#` and blanks, alone or in collections."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby, islice, pairwise
from typing import Any
from xml.etree.ElementTree import Element

from babyrobot_levels.extensions.formats.block_maps import PATH, is_maze
from babyrobot_levels.extensions.formats.blocks import (
    block_map,
    drawn,
    has_walls,
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
    Part,
    World,
)
from babyrobot_levels.extensions.formats.xml import read_xml
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.cells import Rewards
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import START, Position, SourceFile
from babyrobot_levels.text.words import listed

_SOKOBAN = "a Sokoban map"
_BOX, _BOX_ON_GOAL, _ON_GOAL, _DOT = "$*+."
_CELLS = {"#": d.BLOCKED, " ": d.PLAIN, "-": d.PLAIN, "_": d.PLAIN, _BOX: d.PLAIN}
_CELLS |= {"@": d.START, "S": d.START, _ON_GOAL: d.START}
_CELLS |= {_DOT: d.EXIT, "E": d.EXIT, "X": d.EXIT, _BOX_ON_GOAL: d.EXIT}
_STARTS = {mark for mark, cell in _CELLS.items() if cell == d.START}
_BOXED = {_BOX: d.BOX, _DOT: d.TARGET, _BOX_ON_GOAL: d.COVERED}
"""What marks mean in a map with boxes."""

_PATHS = {_DOT: "EX", _BOX_ON_GOAL: "EX", _ON_GOAL: "@SEX"}
"""What other programs draw ways with, and the marks of start and exit that show it is one."""

_BOTH = {("@", _DOT): _ON_GOAL, (_DOT, _BOX): _BOX_ON_GOAL}
"""The marks of two things in a cell."""

_COMMENT = ";"
_KEYWORD = re.compile(r"([A-Za-z][A-Za-z ]*):(.*)")
_RUNS = re.compile(r"(?=.*\d)(?=.*#)(\d*[#@+$*. _|-])+\Z")
_DIGITS = 7
_RUN = re.compile(r"(\d+)(\D)")
_HELP = "`#` wall, a blank (or `-`) free, @ or S start, `.` E or X exit, $ and * boxes"


def read_sokoban(source: SourceFile) -> World:
    """Return the world of a map: its walls are blocked cells, and so is everything around them.

    Titles, comments, and lines like `Author:`, as files of Sokoban levels have them, may surround
    the map, and are its title, its author and its description. In a map with boxes `.` is a
    target, in others an exit. Where `E` or `X` marks the exits, `.`, `*` and `+` are free cells.
    """
    given, source = source, _expanded(source)
    map_only, texts = _without_texts(source)
    if (count := sum(1 for _ in _maps(map_only.lines))) > 1:
        raise ConversionError(f"the text has {count} maps", "keep the one that is to be the level")
    lost: list[Lost] = []
    lines = text_rows(map_only, blanks=True)
    text = "".join(lines)
    meanings = _meanings(text, lost)
    rows = translated(map_only, lines, meanings, _HELP, blanks=True)
    world, _ = without_margin(without_surroundings(rows), rows)
    # Files of levels are often indented.
    indent = min(len(row) - len(row.lstrip(d.PLAIN)) for row in rows)
    if all(set(row[:indent]) <= {d.BLOCKED} for row in world):
        world = tuple(row[indent:] for row in world)
    cells = without_ring(world)
    fields = {"version": 1, **texts, **drawn(cells)}
    if _ON_GOAL in text and meanings[_DOT] == d.TARGET:
        fields["targets"] = [{"at": [*d.cells_with(cells, d.START)[0]]}]
    elif _ON_GOAL in text and meanings[_ON_GOAL] == d.START:
        message = "a start cannot be an exit; it is only the start"
        lost.append(Lost(_ON_GOAL, message, _place(given, _ON_GOAL)))
    second = _place(given, "".join(_STARTS), 1)
    lost += (replace(each, at=second) for each in told_starts(rows))
    lost = [replace(each, at=each.at or _place(given, each.field.strip("`"))) for each in lost]
    return World(fields, "A map of `#` and blanks.", {}, tuple(lost))


def _place(source: SourceFile, marks: str, number: int = 0) -> Position:
    """Return the place of one of some marks in the rows of a map, also if these have runs."""
    found = (
        Position(line, column)
        for line, row in enumerate(source.lines, 1)
        if _is_row(row) or _RUNS.match(row)
        for column, mark in enumerate(row, 1)
        if mark in marks
    )
    return next(islice(found, number, None), START)


def _meanings(text: str, lost: list[Lost]) -> dict[str, str]:
    """Return what the marks of a map mean, by those that are there."""
    meanings = dict(_CELLS)
    if _BOX in text or (_BOX_ON_GOAL in text and not {"E", "X"} & {*text}):
        meanings |= _BOXED
    for mark, ends in _PATHS.items():
        if (others := [end for end in ends if end in text]) and mark in text:
            meanings[mark] = d.PLAIN
            names = {each: "the start" if each in _STARTS else "the exit" for each in others}
            known = listed([f"`{each}` is {name}" for each, name in names.items()])
            lost.append(Lost(f"`{mark}`", f"read as free, because {known}"))
    return meanings


def _expanded(source: SourceFile) -> SourceFile:
    """Return a text with its runs written out: `4#|#@.#|4#` are three rows."""
    if not any(map(_RUNS.match, source.lines)):
        return source
    lines: list[str] = []
    room = (MAX_SIZE + 2) ** 2
    for number, line in enumerate(source.lines, 1):
        is_runs = _RUNS.match(line) is not None
        counts = re.findall(r"\d+", line) if is_runs else []
        # Numbers with more digits would take long to be read.
        room -= sum(int(count) if len(count) <= _DIGITS else room + 1 for count in counts)
        if room < 0:
            message = "the runs come to more cells than a level has"
            raise ConversionError.at(source, Position(number, 1), message)
        lines += _RUN.sub(lambda run: int(run[1]) * run[2], line).split("|") if is_runs else [line]
    return SourceFile(source.name, "\n".join(lines))


def _without_texts(source: SourceFile) -> tuple[SourceFile, dict[str, Any]]:
    """Return a text with blank lines in place of all that is no map, and what these lines say."""
    lines, texts, above, others = [*source.lines], dict[str, Any](), "", []
    walls = [number for number, line in enumerate(lines) if "#" in line and _is_row(line)]
    for number, line in enumerate(source.lines):
        keyword = _KEYWORD.match(line)
        if keyword is not None and keyword[1].lower() in ("title", "author") and keyword[2].strip():
            texts[keyword[1].lower()] = keyword[2].strip()
        elif keyword is not None or line.startswith(_COMMENT):
            others.append(line.lstrip(f"{_COMMENT} "))
        elif _is_row(line) or "#" in line or not walls or {number - 1, number + 1} <= {*walls}:
            # What is between walls is a row with an unknown character.
            continue
        elif number < walls[0] and re.search("[A-Za-z]", line):
            others.append(above)
            above = line.strip()
        else:
            others.append(line.strip())
        lines[number] = ""
    if above and texts.setdefault("title", above) != above:
        others.append(above)
    # What is only a number is that of the map in its collection.
    told = "\n".join(line for line in others if line and not line.isdecimal())
    if told:
        texts["description"] = told
    return SourceFile(source.name, "\n".join(lines)), texts


def _is_row(line: str) -> bool:
    return _CELLS.keys() >= set(line)


def _is_row_or_faulty(line: str) -> bool:
    """Return whether a line is a row of a map, or one between walls with an unknown character."""
    row = line.strip()
    is_known = _is_row(line) or _RUNS.match(line) is not None
    return row != "" and (is_known or row[0] == row[-1] == "#")


def _maps(lines: Sequence[str]) -> Iterator[tuple[int, int]]:
    """Yield the first line of each map and the one behind it, counted from 0."""
    number = 0
    for is_map, group in groupby(lines, _is_row_or_faulty):
        rows = [*group]
        if is_map and any(set(row) & _STARTS for row in rows):
            yield number, number + len(rows)
        number += len(rows)


def sokoban_parts(source: SourceFile) -> list[Part]:
    """Return the maps of a collection, each with what is written about it."""
    if source.text.lstrip().startswith("<"):
        return [*_parts_of_slc(source)]
    # It raises an error if the runs of all maps come to too much.
    _expanded(source)
    lines, maps = source.lines, [*_maps(source.lines)]
    cuts = [_cut(lines, end, begin) for (_, end), (begin, _) in pairwise(maps)]
    first = _cut(lines, 0, maps[0][0]) if len(maps) > 1 else 0
    above = {match[1].lower(): line for line in lines[:first] if (match := _KEYWORD.match(line))}
    parts = []
    for begin, end in zip([first, *cuts], [*cuts, len(lines)], strict=True):
        text = "\n".join(lines[begin:end])
        if "author" in above and not re.search("(?im)^author:", text):
            text += f"\n{above['author']}"
        parts.append(Part(text, begin + 1))
    return parts


def _cut(lines: Sequence[str], end: int, begin: int) -> int:
    """Return the line, between the end of a map and the next one, where what is told changes.

    A title stands above its map, but keywords below it, unless they touch the next one.
    """
    last = begin
    while last > end and not lines[last - 1].strip():
        last -= 1
    at = last
    while at > end and lines[at - 1].strip():
        at -= 1
    touches = last == begin and at > end
    return at if touches or not any(map(_KEYWORD.match, lines[at:last])) else last


def _parts_of_slc(source: SourceFile) -> Iterator[Part]:
    """Yield the maps of a collection in XML."""
    places: dict[Element, Position] = {}
    root = read_xml(source, places)
    title = (root.findtext("Title") or "").strip()
    for collection in root.iter("LevelCollection"):
        for level in collection.iter("Level"):
            lines = [*level.iter("L")]
            rows = [line.text or "" for line in lines]
            begins = (
                Position(at.line, at.column + len("<L>")) for at in map(places.__getitem__, lines)
            )
            author = level.get("Copyright") or collection.get("Copyright")
            about = {"Title": level.get("Id"), "Author": author, "Collection": title}
            told = (f"{key}: {' '.join(each.split())}" for key, each in about.items() if each)
            yield Part("\n".join([*rows, *told]), rows=tuple(begins) or (places[level],))


def write_sokoban(level: Level) -> Conversion:
    """Return a level as a map with a ring of walls, `@` for the start and `.` for exits.

    Boxes and targets are kept where they alone end the episode, and no wall stands between cells.
    """
    ends = f"{_SOKOBAN} has no cells that end the episode but exits"
    is_kept = level.ends_covered and not has_walls(level.grid())
    carried = frozenset({"boxes", "targets"} if is_kept else ())
    rows, lost = block_map(level, _SOKOBAN, Rewards(), ends=ends, many="E", carried=carried)
    marks = str.maketrans({d.BLOCKED: "#", d.START: "@", d.EXIT: _DOT})
    lines = [[*row.translate(marks)] for row in rows]
    for marked, mark in ((level.targets, _DOT), (level.boxes, _BOX)) if is_kept else ():
        for x, y in (each.at for each in marked):
            # The map has a ring.
            lines[y + 1][x + 1] = _BOTH.get((lines[y + 1][x + 1], mark), mark)
    return Conversion("\n".join(map("".join, lines)) + "\n", tuple(lost))


def _is_sokoban(source: SourceFile, letters: set[str]) -> bool:
    if source.text.lstrip().startswith("<"):
        return "<SokobanLevels" in source.text
    map_only, _ = _without_texts(_expanded(source))
    found = {*"".join(map_only.lines)}
    # A path from S to E is in mazes only, and letters of a start alone are a lake.
    is_one = found >= {"S", "E"} and found & PATH and is_maze(map_only, found)
    is_map = letters - {"\n"} == found or bool(found & _STARTS)
    return is_map and found <= _CELLS.keys() and found - {"S", " "} != set() and not is_one


CODEC = Codec(read_sokoban, write_sokoban, draws=_is_sokoban, parts=sokoban_parts)
