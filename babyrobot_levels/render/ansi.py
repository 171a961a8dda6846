"""Colours for the terminal picture: what each character is drawn in, and on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.mdp.grid import Grid
from babyrobot_levels.render.colors import Rgb, over
from babyrobot_levels.render.scene.walls import GLASS

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

Style = tuple[Rgb, Rgb]
"""The colours of a character and of its ground."""

_RESET = "\x1b[0m"
_PAPER = (255, 255, 255)
_WATER = "white"
_DARK, _LIGHT = (16, 20, 26), (255, 255, 255)


def paint(lines: list[str], level: GridWorld, grid: Grid, state: int | None) -> list[str]:
    """Return the lines of a terminal picture with ANSI escapes, reset at the end of each.

    Args:
        lines: the picture without colours: cells of three characters, walls between them.
        level: the level; its theme gives the colours.
        grid: its walls and cells.
        state: the cell of the robot, if he is in the picture.
    """
    palette = _Palette(level, grid, state)
    return ["".join(palette.line(line, row)) + _RESET for row, line in enumerate(lines)]


class _Palette:
    """Knows the colours of each place of the picture; rows and columns are those of the text."""

    def __init__(self, level: GridWorld, grid: Grid, state: int | None) -> None:
        self._colors = colors = level.resolved_theme.colors
        self._width, self._height, self._state = grid.width, grid.height, state
        self._base = over(colors.base, _PAPER)
        self._grounds = [[self._base] * grid.width for _ in range(grid.height)]
        for area in level.areas:
            if area.color is not None:
                (x, y), (columns, rows) = area.at, area.size
                for row in self._grounds[y : y + rows]:
                    row[x : x + columns] = [over(area.color, g) for g in row[x : x + columns]]
        for puddle in level.puddles:
            x, y = puddle.at
            self._grounds[y][x] = over(colors.puddle, self._grounds[y][x])
        self._texts = {}
        for cells, ground, text in (
            (level.starts, colors.start, colors.start_text),
            (level.exits, colors.exit, colors.exit_text),
        ):
            for x, y in cells:
                self._grounds[y][x] = over(ground, self._grounds[y][x])
                self._texts[x, y] = text
        self._inks = {"∘": _WATER, "◯": _WATER, "█": colors.blocked, "·": colors.lines}
        self._inks |= {"╌": GLASS, "╎": GLASS}

    def line(self, text: str, row: int) -> Iterator[str]:
        """Yield a line, with an escape wherever the style changes."""
        last: Style | None = None
        for column, character in enumerate(text):
            is_cell = row % 2 and column % 4
            style = (self._cell if is_cell else self._wall)(row, column, character)
            if style != last:
                (red, green, blue), (r, g, b) = style
                yield f"\x1b[38;2;{red};{green};{blue};48;2;{r};{g};{b}m"
                last = style
            yield character

    def _cell(self, row: int, column: int, character: str) -> Style:
        x, y = column // 4, row // 2
        ground = self._grounds[y][x]
        if y * self._width + x == self._state:
            ground = over(self._colors.robot, ground)
            return _readable_on(ground), ground
        ink = self._texts.get((x, y)) or self._inks.get(character)
        if ink is None and character.isascii():
            return _readable_on(ground), ground
        return over(ink or self._colors.arrows, ground), ground

    def _wall(self, row: int, column: int, character: str) -> Style:
        is_outer = row in (0, 2 * self._height) or column in (0, 4 * self._width)
        ground = self._base if is_outer else self._common_ground(row, column)
        plain = self._colors.border if is_outer else self._colors.walls
        return over(self._inks.get(character, plain), ground), ground

    def _common_ground(self, row: int, column: int) -> Rgb:
        """Return the ground of the cells around a place between them, if they agree."""
        rows = {(row - 1) // 2, row // 2}
        columns = {(column - 1) // 4, column // 4}
        grounds = {self._grounds[y][x] for y in rows for x in columns}
        return grounds.pop() if len(grounds) == 1 else self._base


def _readable_on(ground: Rgb) -> Rgb:
    red, green, blue = ground
    return _DARK if 0.299 * red + 0.587 * green + 0.114 * blue > 110 else _LIGHT
