"""Levels as lines of characters: walls between cells, and the symbols of the cells."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.cells import shifts
from babyrobot_levels.language.walls import sides_of
from babyrobot_levels.mdp.drawn import drawing_of
from babyrobot_levels.render.scene.icons import default_color
from babyrobot_levels.render.scene.situation import Situation
from babyrobot_levels.render.scene.things import door_color

if TYPE_CHECKING:
    from babyrobot_levels.language.level import LevelSpec
    from babyrobot_levels.mdp.gridworld import GridWorld

ITEMS = {"key": "♀k", "coin": "¢c", "gem": "♦g", "star": "★*", "box": "■b"}
"""The character of each shape: in Unicode, and in ASCII."""

OFF, ON = "0", "1"
LOCKED = "X"
MOVER = "Ω&"

_UPRIGHT = {True: "┃/", False: "::"}
_LEVEL = {True: ("━━━", "-/-"), False: ("╴ ╶", "- -")}
"""Doors by whether they are closed: in Unicode, and in ASCII. The middle is as wide as needed."""

Position = tuple[int, int]
"""A line and a column of the text."""


class TextCells(NamedTuple):
    """Where the cells of a text are: how wide they are, and which character is their symbol."""

    width: int = 3
    symbol: int = 1

    def position(self, x: int, y: int) -> Position:
        """Return where the symbol of a cell is."""
        return 2 * y + 1, (self.width + 1) * x + 1 + self.symbol


USUAL = TextCells()


@dataclass(frozen=True, slots=True)
class TextMark:
    """A character on a picture of text.

    Attributes:
        character: the character.
        color: its colour, None for that which the character has anywhere.
        is_solid: whether the colour is that of its background.
    """

    character: str
    color: str | None = None
    is_solid: bool = True


def marks_of(
    level: GridWorld,
    situation: Situation,
    *,
    plain: bool,
    taken: frozenset[tuple[int, int]] = frozenset(),
    cells: TextCells = USUAL,
) -> dict[Position, TextMark]:
    """Return what of a picture shows the things of a level.

    The symbol of a cell is one of them: a mover before an item or a switch. The next one is
    beside it.

    Args:
        level: the level.
        situation: what is where.
        plain: whether to use ASCII characters only.
        taken: the cells whose symbol is something else: the robot, or an arrow.
        cells: where the cells are.
    """
    marks: dict[Position, TextMark] = {}
    used = set(taken)
    for x, y, mark in _in_cells(level, situation, 1 if plain else 0):
        line, column = cells.position(x, y)
        marks.setdefault((line, column + ((x, y) in used)), mark)
        used.add((x, y))
    return marks | dict(_doors(level, situation, 1 if plain else 0, cells))


def _in_cells(
    level: GridWorld, situation: Situation, kind: int
) -> Iterator[tuple[int, int, TextMark]]:
    colors = level.resolved_theme.colors
    for mover, (x, y) in zip(level.movers, situation.movers, strict=True):
        name = "guard" if mover.within is None else "wanderer"
        yield x, y, TextMark(MOVER[kind], mover.color or default_color(name, colors))
    for item, cells in zip(level.items, situation.items, strict=True):
        for x, y in cells:
            color = item.color or default_color(item.picture, colors)
            yield x, y, TextMark(ITEMS[item.picture][kind], color)
    for switch, is_on in zip(level.switches, situation.on, strict=True):
        color = switch.color or default_color("switch", colors)
        yield *switch.at, TextMark(ON if is_on else OFF, color)
    if situation.is_locked or level.exit_one_of is not None:
        for x, y in situation.exits:
            yield x, y, TextMark(LOCKED if situation.is_locked else d.EXIT)


def _doors(
    level: GridWorld, situation: Situation, kind: int, cells: TextCells
) -> Iterator[tuple[Position, TextMark]]:
    for door, closed in zip(level.doors, situation.doors, strict=True):
        color = door_color(level, door)
        for x, y in sides_of(door):
            line, left = 2 * y + 1, (cells.width + 1) * x
            if door.side in ("E", "W"):
                column = left + (cells.width + 1 if door.side == "E" else 0)
                yield (line, column), TextMark(_UPRIGHT[closed][kind], color, closed)
            else:
                line += 1 if door.side == "S" else -1
                form = _LEVEL[closed][kind]
                text = form[0] + form[1] * (cells.width - 2) + form[2]
                for column, character in enumerate(text[: cells.width], left + 1):
                    yield (line, column), TextMark(character, color, closed)


def held_line(level: GridWorld, situation: Situation) -> str:
    """Return what is held in a line, empty for a level without items."""
    if not level.items:
        return ""
    held = [item.name for item, at in zip(level.items, situation.items, strict=True) if not at]
    return f"held: {', '.join(held) or 'nothing'}"


def with_marks(lines: list[str], marks: dict[Position, TextMark]) -> list[str]:
    """Return the lines of a picture with marks on them."""
    lines = lines.copy()
    for (row, column), mark in marks.items():
        line = lines[row]
        lines[row] = line[:column] + mark.character + line[column + 1 :]
    return lines


def without_things(level: GridWorld, drawing: d.Drawing) -> d.Drawing:
    """Return a drawing without the doors, items and switches that the language's drawing shows."""
    if not level.has_things:
        return drawing
    named = {ord(letter): d.PLAIN for letter, entry in level.legend.items() if entry.kind != "area"}
    doors = {ord(d.DOOR): d.OPEN}
    return d.Drawing(
        tuple(row.translate(named) for row in drawing.cells),
        tuple(row.translate(doors) for row in drawing.east),
        tuple(row.translate(doors) for row in drawing.south),
    )


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
