"""The colours of text pictures: those of the theme, of things and of values, as escapes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING

from babyrobot_levels.render.colors import Rgb, contrast, over
from babyrobot_levels.render.scene.walls import GLASS
from babyrobot_levels.render.terminal import ALL_COLORS, PALETTE
from babyrobot_levels.render.text_plan import Position, TextCells, TextMark

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

Style = tuple[Rgb, Rgb]
"""The colours of a character and its background."""

RESET = "\x1b[0m"

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
        self._marks, self._cells, self._count = marks, cells, count
        self._inks = {"∘": _WATER, "◯": _WATER, "█": colors.blocked, "·": colors.lines}
        self._inks |= {"╌": GLASS, "╎": GLASS}

    def line(self, text: str, row: int) -> str:
        """Return a line with an escape where the style changes, and at its end."""
        return "".join(self._parts(text, row)) + RESET

    def _parts(self, text: str, row: int) -> Iterator[str]:
        last: Style | None = None
        for column, character in enumerate(text):
            style = self.style(row, column, character)
            if style != last:
                yield escape(*style, self._count)
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
