"""Levels as lines of characters: walls between cells, the symbols of the cells, and colours."""

import math
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import add
from typing import NamedTuple

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.cells import shifts, sides_of
from babyrobot_levels.language.kinds import MARKED
from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.mdp.drawn import drawing_of
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import Rgb, contrast, over
from babyrobot_levels.render.scene.icons import default_color, thing_color
from babyrobot_levels.render.scene.team import robot_color
from babyrobot_levels.render.scene.things import door_color
from babyrobot_levels.render.scene.walls import GLASS
from babyrobot_levels.render.situation import Situation
from babyrobot_levels.render.terminal import ALL_COLORS, PALETTE, RESET

ITEMS = {"key": "♀k", "coin": "¢c", "gem": "♦g", "star": "★*", "box": "■b"}
"""The character of each shape: in Unicode, and in ASCII."""

OFF, ON = "0", "1"
BOX, ON_TARGET, TARGET = "▣$", "▩*", "◌."
"""A box, one on a target, and a target: in Unicode, and in ASCII."""

LOCKED = "X"
MOVER = "Ω&"

CLOSED, OPEN, GLASSY = ("┃ ━━━", "/ -/-"), ("╴ ╶", ": - -"), ("╎ ╌╌╌", ": - -")
"""Doors and glass in a legend: in Unicode, and in ASCII."""

_UPRIGHT = {True: "┃/", False: "::"}
_LEVEL = {True: ("━━━", "-/-"), False: ("╴ ╶", "- -")}
"""Doors by whether they are closed: in Unicode, and in ASCII. The middle is as wide as needed."""

Position = tuple[int, int]
"""A line and a column of the text."""


class TextCells(NamedTuple):
    """Where the cells of a text are.

    Attributes:
        width: how wide a cell is.
        symbol: which character of it is its symbol.
        beside: how far behind the symbol a second thing in the cell stands.
        filled: the cells that have more than a symbol, which the others have in their middle.
    """

    width: int = 3
    symbol: int = 1
    beside: int = 1
    filled: Container[tuple[int, int]] = ()

    def position(self, x: int, y: int) -> Position:
        """Return where the symbol of a cell is."""
        symbol = self.symbol if (x, y) in self.filled else (self.width - 1) // 2
        return 2 * y + 1, (self.width + 1) * x + 1 + symbol


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
    robot: tuple[int, int] | None = None,
    cells: TextCells = USUAL,
) -> dict[Position, TextMark]:
    """Return what of a picture shows the things of a level.

    The symbol of a cell is one of them: a mover before what lies there. The next one is
    beside it.

    Args:
        level: the level.
        situation: what is where.
        plain: whether to use ASCII characters only.
        robot: the cell in which the robot is the symbol.
        cells: where the cells are.
    """
    marks: dict[Position, TextMark] = {}
    used = {robot}
    for x, y, mark in _in_cells(level, situation, 1 if plain else 0):
        line, column = cells.position(x, y)
        marks.setdefault((line, column + cells.beside * ((x, y) in used)), mark)
        used.add((x, y))
    marks.update(_doors(level, situation, 1 if plain else 0, cells))
    return marks


def _in_cells(
    level: GridWorld, situation: Situation, kind: int
) -> Iterator[tuple[int, int, TextMark]]:
    colors = level.resolved_theme.colors
    for mover, (x, y) in zip(level.movers, situation.movers, strict=True):
        yield x, y, TextMark(MOVER[kind], thing_color(mover, colors))
    robots = [*enumerate(situation.robots, 1)]
    if situation.is_overview and robots:
        # Without a state, the picture has no other mark of the first one.
        robots.insert(0, (0, level.starts[0]))
    for number, (x, y) in robots:
        yield x, y, TextMark(level.robots[number].name[0].upper(), robot_color(level, number))
    targets = {target.at for target in level.targets}
    for x, y in situation.boxes:
        mark = ON_TARGET if (x, y) in targets else BOX
        yield x, y, TextMark(mark[kind], default_color("box", colors))
    for item, cells in zip(level.items, situation.items, strict=True):
        for x, y in cells:
            yield x, y, TextMark(ITEMS[item.picture][kind], thing_color(item, colors))
    things = level.things()
    for column, is_on in zip(things.fixed, situation.on, strict=True):
        entry = things[column].entry
        mark = ON if is_on else OFF
        if entry.at in targets:
            mark = (ON_TARGET if is_on else TARGET)[kind]
        yield *entry.at, TextMark(mark, thing_color(entry, colors))
    if situation.is_locked or level.exit_one_of is not None:
        for x, y in situation.exits:
            yield x, y, TextMark(LOCKED if situation.is_locked else d.EXIT)


def _doors(
    level: GridWorld, situation: Situation, kind: int, cells: TextCells
) -> Iterator[tuple[Position, TextMark]]:
    beside = {"N": (-1, 1), "S": (1, 1), "W": (0, 0), "E": (0, cells.width + 1)}
    for door, closed in zip(level.doors, situation.doors, strict=True):
        (down, right), text = beside[door.side], _UPRIGHT[closed][kind]
        if down:
            form = _LEVEL[closed][kind]
            text = (form[0] + form[1] * (cells.width - 2) + form[2])[: cells.width]
        marks = [TextMark(each, door_color(level, door), closed) for each in text]
        for x, y in sides_of(door):
            for column, mark in enumerate(marks, (cells.width + 1) * x + right):
                yield (2 * y + 1 + down, column), mark


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


def drawing_without_things(level: GridWorld) -> d.Drawing:
    """Return walls and cells, without the doors and things that a drawing shows."""
    drawing = drawing_of(level, level.grid())
    if not level.has_things:
        return drawing
    marks = {mark for kind in MARKED if kind.state for mark in kind.marks}
    things = [*marks.difference(level.legend)]
    things += [letter for letter, entry in level.legend.items() if entry.kind != "area"]
    named = {ord(mark): d.PLAIN for mark in things}
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


def ascii_lines(drawing: d.Drawing, contents: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a picture in ASCII; see `unicode_lines`."""
    lines = d.compose(drawing).splitlines()
    for y, row in enumerate(contents):
        texts = [*row]
        for x in range(drawing.width) if d.BLOCKED in drawing.cells[y] else ():
            if drawing.cells[y][x] == d.BLOCKED:
                texts[x] = "###"
        lines[2 * y + 1] = d.SOLID + "".join(map(add, texts, drawing.east[y] + d.SOLID))
    return lines


def symbols_of(level: LevelSpec, drawing: d.Drawing, *, plain: bool) -> Symbols:
    """Return the symbols of the cells. Starts and exits hide warps, warps hide puddles.

    In ASCII, they are those of the language's drawing.
    """
    if plain:
        return [[*row] for row in drawing.cells]
    south, east = shifts(level.wind, drawing.width, drawing.height)
    warps = {
        warp.at: warp.to
        if isinstance(warp.to, str)
        else max(level.leads_of(warp), key=lambda lead: lead[1])[0]
        for warp in level.warps
    }
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


def winds_to(side: str) -> str:
    """Return the arrows of winds that push to a side, such as `east`, and perhaps to another."""
    first = 2 * ("east", "south", "west", "north").index(side)
    return "".join(WINDS[(first + turn) % 8] for turn in (0, 1, -1))


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


# -- colours ---------------------------------------------------------------------------------------

Style = tuple[Rgb, Rgb]
"""The colours of a character and its background."""

_PAPER = (255, 255, 255)
_WATER = "white"
_DARK, _LIGHT = (16, 20, 26), (255, 255, 255)
_CONTRAST = 3.0
"""The least contrast of a character that stands for a thing."""

_CUBE = (0, 95, 135, 175, 215, 255)
"""The shares of red, green and blue in the colours 16 to 231 of the palette; greys follow."""

_SIXTEEN = (
    (0, 0, 0), (205, 0, 0), (0, 205, 0), (205, 205, 0),
    (0, 0, 238), (205, 0, 205), (0, 205, 205), (229, 229, 229),
    (127, 127, 127), (255, 0, 0), (0, 255, 0), (255, 255, 0),
    (92, 92, 255), (255, 0, 255), (0, 255, 255), (255, 255, 255),
)  # fmt: skip
"""The colours of a terminal that has not more, as xterm shows them."""


class TextGrounds:
    """The colours of cells without what stands in them.

    Args:
        level: the level.
    """

    def __init__(self, level: GridWorld) -> None:
        colors = level.resolved_theme.colors
        self.width, self.height = level.size
        self.base = over(colors.base, _PAPER)
        self.cells = [[self.base] * self.width for _ in range(self.height)]
        self.texts: dict[tuple[int, int], str] = {}
        for area in level.areas:
            if area.color is not None:
                (x, y), (columns, rows) = area.at, area.size
                for row in self.cells[y : y + rows]:
                    row[x : x + columns] = [over(area.color, g) for g in row[x : x + columns]]
        for puddle in level.puddles:
            x, y = puddle.at
            self.cells[y][x] = over(colors.puddle, self.cells[y][x])
        exits = level.exits if level.exit_one_of is None else ()
        for cells, ground, text in (
            (level.starts, colors.start, colors.start_text),
            (exits, colors.exit, colors.exit_text),
        ):
            for x, y in cells:
                self.cells[y][x] = over(ground, self.cells[y][x])
                self.texts[x, y] = text


class Palette:
    """The colours of each character of a picture; rows and columns are those of the text.

    Args:
        level: the level.
        grounds: the colours of its cells.
        fills: the colours that cells have instead, except below their symbols.
        robot: the cell of the robot, if it is shown.
        marks: what changes during an episode.
        cells: where the cells are.
        count: how many colours the terminal shows.
    """

    def __init__(
        self,
        level: GridWorld,
        grounds: TextGrounds,
        fills: Mapping[tuple[int, int], Rgb],
        robot: tuple[int, int] | None,
        marks: Mapping[Position, TextMark],
        cells: TextCells,
        count: int,
    ) -> None:
        self._colors = colors = level.resolved_theme.colors
        self._grounds, self._fills, self._robot = grounds, fills, robot
        self._marks, self._cells, self.count = marks, cells, count
        self._inks = {"∘": _WATER, "◯": _WATER, "█": colors.blocked, "·": colors.lines}
        self._inks |= {"╌": GLASS, "╎": GLASS}

    @property
    def base(self) -> Rgb:
        """The colour of the ground where nothing is."""
        return self._grounds.base

    def line(self, text: str, row: int) -> str:
        """Return a line with an escape where the style changes, and at its end."""
        return "".join(self._parts(text, row)) + RESET

    def _parts(self, text: str, row: int) -> Iterator[str]:
        last: Style | None = None
        for column, character in enumerate(text):
            if (style := self.style(row, column, character)) != last:
                yield escape(*style, self.count)
                last = style
            yield character

    def style(self, row: int, column: int, character: str) -> Style:
        """Return the colours of a character and of its background."""
        is_cell = row % 2 and column % (self._cells.width + 1)
        return (self._cell if is_cell else self._wall)(row, column, character)

    def _cell(self, row: int, column: int, character: str) -> Style:
        x, y = column // (self._cells.width + 1), row // 2
        is_symbol = (row, column) == self._cells.position(x, y)
        ground, own = self._grounds.cells[y][x], True
        if (x, y) in self._fills and not (is_symbol and character != " "):
            ground, own = self._fills[x, y], False
        mark = self._marks.get((row, column))
        if mark is not None and mark.color is not None:
            return _marked(mark.color, ground, is_solid=mark.is_solid)
        if (x, y) == self._robot and own:
            ground = over(self._colors.robot, ground)
            return readable_on(ground), ground
        ink = self._inks.get(character)
        if own and (x, y) in self._grounds.texts:
            ink = self._grounds.texts[x, y]
        if not own or (ink is None and character.isascii()):
            return readable_on(ground), ground
        return _seen(ink or self._colors.arrows, ground), ground

    def _wall(self, row: int, column: int, character: str) -> Style:
        step = self._cells.width + 1
        is_outer = row in (0, 2 * self._grounds.height) or column in (0, step * self._grounds.width)
        ground = self._grounds.base if is_outer else self._common_ground(row, column)
        plain = self._colors.border if is_outer else self._colors.walls
        mark = self._marks.get((row, column))
        if mark is not None and mark.color is not None:
            return _marked(mark.color, ground, is_solid=mark.is_solid)
        return over(self._inks.get(character, plain), ground), ground

    def _common_ground(self, row: int, column: int) -> Rgb:
        """Return the background of a wall: between values their mean, else what is on all sides."""
        step = self._cells.width + 1
        around = [
            (x, y)
            for y in {(row - 1) // 2, row // 2}
            for x in {(column - 1) // step, column // step}
        ]
        if all(cell in self._fills for cell in around):
            return mean([self._fills[cell] for cell in around])
        grounds = {self._fills.get((x, y), self._grounds.cells[y][x]) for x, y in around}
        return grounds.pop() if len(grounds) == 1 else self._grounds.base


def mean(colors: list[Rgb]) -> Rgb:
    """Return the colour in the middle of some."""
    red, green, blue = (sum(channel) // len(colors) for channel in zip(*colors, strict=True))
    return red, green, blue


def _marked(color: str, ground: Rgb, *, is_solid: bool) -> Style:
    """Return the colours of a thing: on a background of its colour, or in that if it is seen."""
    ink = over(color, ground)
    return (readable_on(ink), ink) if is_solid else (_seen(color, ground), ground)


def _seen(color: str, ground: Rgb) -> Rgb:
    """Return a colour if it can be seen on a background, else one that can."""
    below = "#{:02x}{:02x}{:02x}".format(*ground)
    return over(color, ground) if contrast(color, below) >= _CONTRAST else readable_on(ground)


def readable_on(ground: Rgb) -> Rgb:
    """Return a dark or a light colour, whichever can be read on a background."""
    red, green, blue = ground
    return _DARK if 0.299 * red + 0.587 * green + 0.114 * blue > 110 else _LIGHT


# -- escapes ----------------------------------------------------------------------------------


@lru_cache(maxsize=4096)
def escape(ink: Rgb, ground: Rgb | None, count: int) -> str:
    """Return the escape that sets the colours of characters and of their background.

    Args:
        ink: the colour of characters.
        ground: that of their background; None for the terminal's own.
        count: how many colours the terminal shows: 16, 256, or all.
    """
    if count >= ALL_COLORS:
        codes = ["38;2;{};{};{}".format(*ink)]
        codes += [] if ground is None else ["48;2;{};{};{}".format(*ground)]
    elif count >= PALETTE:
        codes = [f"38;5;{_in_palette(ink)}"]
        codes += [] if ground is None else [f"48;5;{_in_palette(ground)}"]
    else:
        front = _of_sixteen(ink)
        back = None if ground is None else _of_sixteen(ground)
        if ground is not None and front == back and ink != ground:
            # What differs a little must still be seen.
            front = _of_sixteen(readable_on(_SIXTEEN[back or 0]))
        codes = [str(front + (30 if front < 8 else 82))]
        codes += [] if back is None else [str(back + (40 if back < 8 else 92))]
    return f"\x1b[{';'.join(codes)}m"


def _in_palette(color: Rgb) -> int:
    """Return the number of the nearest colour of the cube, or of the greys if that is nearer."""
    levels = [min(range(6), key=lambda level: abs(_CUBE[level] - share)) for share in color]
    gray = min(23, max(0, round((sum(color) / 3 - 8) / 10)))
    red, green, blue = levels
    cube = _CUBE[red], _CUBE[green], _CUBE[blue]
    if _distance(color, (8 + 10 * gray,) * 3) < _distance(color, cube):
        return 232 + gray
    return 16 + 36 * red + 6 * green + blue


def _of_sixteen(color: Rgb) -> int:
    return min(range(16), key=lambda number: _distance(color, _SIXTEEN[number]))


def _distance(one: Rgb, other: Rgb) -> float:
    """Return how different two colours look, by the weights that eyes give to red and blue."""
    red = (one[0] + other[0]) / 2
    weights = 2 + red / 256, 4, 2 + (255 - red) / 256
    return sum(
        weight * (first - second) ** 2
        for weight, first, second in zip(weights, one, other, strict=True)
    )
