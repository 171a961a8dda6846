"""Gymnasium-Robotics: the `maze_map` of its mazes, rows of 0, 1, "r", "g" and "c"."""

from __future__ import annotations

import json
from typing import Any

from babyrobot_levels.convert.blocks import drawn, without_ring
from babyrobot_levels.convert.checked import sequence
from babyrobot_levels.convert.conversion import Conversion, ConversionError, Lost, World, shown
from babyrobot_levels.convert.data import read_data
from babyrobot_levels.convert.marks import block_map
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.moves import Rewards
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile

PLACE = "a maze_map"
REWARDS = Rewards(step=0, exit=1)
"""The rewards of its sparse tasks."""

EITHER = "c"
_CELLS: dict[Any, str] = {0: d.PLAIN, 1: d.BLOCKED, "r": d.START, "g": d.EXIT, "c": EITHER}


def read_maze_map(source: SourceFile) -> World:
    """Return the world of a map: a list of rows, as JSON or as a Python literal."""
    rows = []
    for y, row in enumerate(sequence(plain(read_data(source)), "a maze_map")):
        cells = [_cell(value, x, y) for x, value in enumerate(sequence(row, f"row {y}"))]
        rows.append("".join(cells))
        if len(cells) != len(rows[0]) or not cells:
            raise ConversionError(f"row {y} has {len(cells)} cells, the first has {len(rows[0])}")
    if not rows:
        raise ConversionError("the map has no rows")
    lost: list[Lost] = []
    world = without_ring(_with_ends(tuple(rows), lost))
    fields = {"version": 1, **drawn(world), "rewards": {"step": 0, "exit": 1}}
    comments = {"rewards": "Those of its sparse tasks."}
    return World(fields, "A maze_map of Gymnasium-Robotics.", comments, tuple(lost))


def _cell(value: Any, x: int, y: int) -> str:
    known = isinstance(value, int | str) and not isinstance(value, bool) and value in _CELLS
    if not known:
        raise ConversionError(f'row {y}, column {x}: {shown(value)} is none of 0, 1, "r", "g", "c"')
    return _CELLS[value]


def _with_ends(rows: tuple[str, ...], lost: list[Lost]) -> tuple[str, ...]:
    """Return the rows with starts and exits; where none are named, those that may be either."""
    cells = [list(row) for row in rows]
    text = "".join(rows)
    goals = text.count(d.EXIT)
    free = EITHER if EITHER in text else d.PLAIN
    either = [(x, y) for y, row in enumerate(rows) for x, c in enumerate(row) if c == free]
    for name, mark, index in (("r", d.START, 0), ("g", d.EXIT, -1)):
        if mark not in text and either:
            x, y = either.pop(index)
            cells[y][x] = mark
            lost.append(
                Lost(name, f"none is named, so it is row {y}, column {x} of those free to be")
            )
    if goals > 1:
        lost.append(Lost("g", f"each of the {goals} ends the episode; there, one of them is drawn"))
    return tuple("".join(row).replace(EITHER, d.PLAIN) for row in cells)


def write_maze_map(level: Level) -> Conversion:
    """Return a level as a list of rows that is JSON and a Python literal alike."""
    ends = f"{PLACE} has no cells that end the episode but goals"
    rows, lost = block_map(level, PLACE, REWARDS, ends=ends, many="SE")
    values = {cell: value for value, cell in _CELLS.items()}
    lines = ",\n  ".join(json.dumps([values[cell] for cell in row]) for row in rows)
    return Conversion(f"[\n  {lines}\n]\n", tuple(lost))
