"""Levels as lines of characters: walls between cells, and the symbols of the cells."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.moves import shifts
from babyrobot_levels.mdp.drawn import drawing_of
from babyrobot_levels.render.text_marks import without_things

if TYPE_CHECKING:
    from babyrobot_levels.language.level import LevelSpec
    from babyrobot_levels.mdp.gridworld import GridWorld

TO_START = "↻"
HELD = "◉"
BLOCK = "█"

PUDDLES = {d.SMALL: "∘", d.LARGE: "◯"}
_WARPS = "⇒⇘⇓⇙⇐⇖⇑⇗"
WINDS = "→↘↓↙←↖↑↗"
"""Arrows from east, clockwise."""

_JOINTS = "·╵╶└╷│┌├╴┘─┴┐┤┬┼"
"""The characters of corners by the bit set of walls: 1 north, 2 east, 4 south, 8 west."""

_ACROSS = {d.SOLID: "─", d.GLASS: "╌", d.OPEN: " "}
_DOWN = {d.SOLID: "│", d.GLASS: "╎", d.OPEN: " "}

Symbols = list[list[str]]
"""A character for each cell, `[height][width]`."""


def drawing_without_things(level: GridWorld) -> d.Drawing:
    """Return walls and cells, without what changes during an episode."""
    return without_things(level, drawing_of(level, level.grid()))


def ascii_lines(drawing: d.Drawing, symbols: Symbols) -> list[str]:
    """Return the lines of a picture in ASCII, with these symbols in the cells."""
    return d.compose(replace(drawing, cells=tuple(map("".join, symbols)))).splitlines()


def symbols_of(level: LevelSpec, drawing: d.Drawing) -> Symbols:
    """Return the symbols of the cells. Starts and exits hide warps, warps hide puddles."""
    south, east = shifts(level.wind, drawing.width, drawing.height)
    warps = {warp.at: warp.to for warp in level.warps}
    symbols = []
    for y, row in enumerate(drawing.cells):
        shown = []
        for x, character in enumerate(row):
            symbol = PUDDLES.get(character, character)
            if character in (d.START, d.EXIT, d.BLOCKED):
                pass
            elif (x, y) in warps:
                symbol = _warp((x, y), warps[x, y])
            elif character == d.PLAIN and (east[y] or south[x]):
                symbol = _arrow(WINDS, east[y], south[x])
            shown.append(symbol)
        symbols.append(shown)
    return symbols


def _warp(at: tuple[int, int], to: tuple[int, int] | str) -> str:
    if isinstance(to, str):
        return TO_START
    return HELD if to == at else _arrow(_WARPS, to[0] - at[0], to[1] - at[1])


def _arrow(arrows: str, east: int, south: int) -> str:
    return arrows[round(math.atan2(south, east) / (math.pi / 4)) % 8]


def unicode_lines(drawing: d.Drawing, contents: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a picture; lines of walls and lines of cells alternate.

    Args:
        drawing: walls and cells.
        contents: the texts of the cells, `[height][width]`, all of the same length. Those of
            blocked cells are not shown.
    """
    return ["".join(line) for line in _lines(drawing, contents)]


def _lines(drawing: d.Drawing, contents: Sequence[Sequence[str]]) -> Iterator[Iterator[str]]:
    """Yield the lines as their parts."""
    length = len(contents[0][0])
    width, height = drawing.width, drawing.height
    border = d.SOLID * width
    across = [border, *drawing.south, border]
    down = [d.SOLID + row + d.SOLID for row in drawing.east]
    # Outside the grid there are no walls and no blocked cells.
    blocked = [[False] * (width + 2) for _ in range(height + 2)]
    for x, y in drawing.find(d.BLOCKED):
        blocked[y + 1][x + 1] = True

    def joint(x: int, y: int) -> str:
        if all(blocked[y + dy][x + dx] for dy in (0, 1) for dx in (0, 1)):
            return BLOCK
        north = down[y - 1][x] if y else d.OPEN
        east = across[y][x] if x < width else d.OPEN
        south = down[y][x] if y < height else d.OPEN
        west = across[y][x - 1] if x else d.OPEN
        met = [north, east, south, west]
        if met in ([d.OPEN, d.GLASS] * 2, [d.GLASS, d.OPEN] * 2):
            return "╌" if east == d.GLASS else "╎"
        return _JOINTS[sum((mark != d.OPEN) << bit for bit, mark in enumerate(met))]

    def wall_line(y: int) -> Iterator[str]:
        for x in range(width):
            yield joint(x, y)
            is_inside = blocked[y][x + 1] and blocked[y + 1][x + 1]
            yield length * (BLOCK if is_inside else _ACROSS[across[y][x]])
        yield joint(width, y)

    def cell_line(y: int) -> Iterator[str]:
        for x, text in enumerate(contents[y]):
            is_inside = blocked[y + 1][x] and blocked[y + 1][x + 1]
            yield BLOCK if is_inside else _DOWN[down[y][x]]
            yield length * BLOCK if blocked[y + 1][x + 1] else text
        yield _DOWN[d.SOLID]

    for y in range(height):
        yield wall_line(y)
        yield cell_line(y)
    yield wall_line(height)
