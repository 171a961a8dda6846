"""Levels of MiniHack (`.des`), as far as they are drawn: MAP, stairs, branches and lava."""

import re
from itertools import islice
from typing import Any

from babyrobot_levels.extensions.formats.blocks import LAVA_COLOR, drawn, replaced
from babyrobot_levels.extensions.formats.conversion import Codec, ConversionError, Lost, World
from babyrobot_levels.language import drawing as d
from babyrobot_levels.text.source import SourceFile

_LAVA = "L"
_CELLS = {**dict.fromkeys(".#+SCBKR\\{_L", d.PLAIN), **dict.fromkeys("-| }WFTPI", d.BLOCKED)}
_MAP = re.compile(r"(?ms)^MAP *\n(.*?)\n?^ENDMAP")
_NUMBER, _COMMA = r"(\d{1,3})", r" *, *"
_AREA = rf"\( *{_NUMBER}{_COMMA}{_NUMBER}(?:{_COMMA}{_NUMBER}{_COMMA}{_NUMBER})? *\)"
_SELECTED = re.compile(rf"(?m)^(\$\w+) *= *selection: *fillrect *{_AREA}")
_ENDS = re.compile(rf"(?m)^(BRANCH|STAIR): *(?:{_AREA}|rndcoord\((\$\w+)\))(.*)$")
_LEFT_OUT = ("OBJECT", "MONSTER", "TRAP", "DOOR", "REPLACE_TERRAIN", "TERRAIN", "IF", "LOOP")

MAX_WIDTH, MAX_HEIGHT = 80, 21
"""The size of NetHack's screen."""

MAX_ENDS = 100
"""More than levels have of stairs and branches."""

Cells = list[tuple[int, int]]


def read_minihack(source: SourceFile) -> World:
    """Return the world of a level with one map: the stair down is the exit.

    Raises:
        ConversionError: NetHack makes its rooms or its maze itself, or does not say where it ends.
    """
    text = re.sub(r"(?m)^ *#.*\n", "", source.text.replace("\r\n", "\n"))
    maps = _MAP.findall(text)
    if len(maps) != 1 or "MAZEWALK" in text:
        made = "digs its maze" if "MAZEWALK" in text else "places its rooms at random"
        raise ConversionError(f"the level is not drawn: NetHack {made}")
    lines = maps[0].split("\n")
    width = max(map(len, lines), default=0)
    rows = tuple(line.ljust(width) for line in lines)
    if width > MAX_WIDTH or len(rows) > MAX_HEIGHT:
        size = f"{width} by {len(rows)}"
        raise ConversionError(
            f"the map is {size}; NetHack's are {MAX_WIDTH} by {MAX_HEIGHT} at most"
        )
    if unknown := sorted(set("".join(rows)) - _CELLS.keys()):
        raise ConversionError(f"the map has `{unknown[0]}`, which is not known")
    ends = _ends(text, rows)
    if not ends["start"] or not ends["exit"]:
        missing = "start (BRANCH)" if not ends["start"] else "stair down"
        raise ConversionError(f"the level has no {missing} in a place that is given")
    cells = tuple("".join(map(_CELLS.__getitem__, row)) for row in rows)
    is_one = len(ends["exit"]) == 1
    cells = replaced(replaced(cells, ends["exit"] * is_one, d.EXIT), ends["start"], d.START)
    fields: dict[str, Any] = {"version": 1, **drawn(cells)}
    lost = [
        Lost(name, "left out", source.position(match.start(1)))
        for name in _LEFT_OUT
        if (match := re.search(rf"(?m)^ *({name})\b", source.text))
    ]
    if not is_one:
        fields["exit_one_of"] = [[*cell] for cell in ends["exit"]]
    if lava := d.cells_with(rows, _LAVA):
        fields["areas"] = [{"at": [*cell], "ends": True, "color": LAVA_COLOR} for cell in lava]
    return World(fields, "A level of MiniHack.", {}, tuple(lost))


def _ends(text: str, rows: tuple[str, ...]) -> dict[str, Cells]:
    """Return the free cells of starts and exits."""
    selected = islice(_SELECTED.finditer(text), MAX_ENDS)
    named = {match[1]: _cells(match.groups()[1:5], rows) for match in selected}
    found: dict[str, Cells] = {"start": [], "exit": []}
    for match in islice(_ENDS.finditer(text), MAX_ENDS):
        place = named.get(match[6], []) if match[6] else _cells(match.groups()[1:5], rows)
        is_exit = match[1] == "STAIR" and "down" in match[7]
        found["exit" if is_exit else "start"] += place
    found["exit"] = [cell for cell in found["exit"] if cell not in found["start"]]
    return found


def _cells(numbers: tuple[str | None, ...], rows: tuple[str, ...]) -> Cells:
    """Return the free cells of a rectangle of the map."""
    left, top = (int(each or 0) for each in numbers[:2])
    right, bottom = (int(numbers[2] or left), int(numbers[3] or top))
    return [
        (x, y)
        for y, row in enumerate(rows[top : bottom + 1], top)
        for x, each in enumerate(row[left : right + 1], left)
        if _CELLS[each] == d.PLAIN and each != _LAVA
    ]


CODEC = Codec(
    read_minihack,
    draws=lambda source, _: re.search(r'(?m)^(MAZE|LEVEL): *"', source.text) is not None,
)
