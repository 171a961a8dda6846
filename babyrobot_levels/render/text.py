"""Levels as text: the language's drawing, and one in Unicode, in colour, for terminals."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.moves import shifts
from babyrobot_levels.mdp.drawn import drawing_of
from babyrobot_levels.mdp.grid import Grid
from babyrobot_levels.render.colors import Rgb, contrast, over
from babyrobot_levels.render.scene.overlay import Overlay, Rows
from babyrobot_levels.render.scene.situation import place_of, situation_of
from babyrobot_levels.render.scene.walls import GLASS
from babyrobot_levels.render.terminal import cut_out
from babyrobot_levels.render.text_marks import (
    Mark,
    Position,
    cell_position,
    held_line,
    marks_of,
    with_marks,
    without_things,
)
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    from babyrobot_levels.language.level import LevelSpec
    from babyrobot_levels.mdp.gridworld import GridWorld

ROBOT = "☻"
PLAIN_ROBOT = "@"
ROBOTS, PLAIN_ROBOTS = f"▲►▼◄{ROBOT}", f"^>v<{PLAIN_ROBOT}"
"""A robot that looks north, east, south, west; and one that does not turn."""

TO_START = "↻"
HELD = "◉"
BLOCK = "█"

_SHOWN = {d.SMALL: "∘", d.LARGE: "◯"}
_WARPS = "⇒⇘⇓⇙⇐⇖⇑⇗"
_WINDS = "→↘↓↙←↖↑↗"
"""Arrows from east, clockwise."""

_JOINTS = "·╵╶└╷│┌├╴┘─┴┐┤┬┼"
"""The characters of corners by the bit set of walls: 1 north, 2 east, 4 south, 8 west."""

_ACROSS = {d.SOLID: "───", d.GLASS: "╌╌╌", d.OPEN: "   "}
_DOWN = {d.SOLID: "│", d.GLASS: "╎", d.OPEN: " "}

Style = tuple[Rgb, Rgb]
"""The colours of a character and its background."""

WIDEST = 16
"""The widest level whose table of numbers fits on a screen."""

_RESET = "\x1b[0m"
_PAPER = (255, 255, 255)
_WATER = "white"
_DARK, _LIGHT = (16, 20, 26), (255, 255, 255)
_CONTRAST = 3.0
"""The least contrast of a character that stands for a thing."""

_AtHand = tuple[int | None, int | None]
"""The configuration and heading of an overlay that depends on them."""


class _Drawn(NamedTuple):
    """A picture without the robot and things; the cells whose middle is taken; what is below."""

    lines: list[str]
    taken: frozenset[tuple[int, int]]
    below: list[str]


def unicode_drawing(
    level: GridWorld,
    grid: Grid,
    *,
    state: int | None = None,
    configuration: int | None = None,
    color: bool = False,
) -> str:
    """Return a picture for terminals; each line ends with a newline.

    Starts, exits and a legend's characters are shown as in the drawing; puddles are rings, warps
    double arrows (`↻` to the start), wind single ones. Every character takes one column, and
    every cell as many as in the language's drawing.

    Args:
        level: the level.
        grid: its walls and cells.
        state: the configuration and the cell of the robot, as in `level.compile()`.
        configuration: what is where, if no state is given; None is the level as a whole.
        color: whether to use the theme's colours, as 24-bit ANSI escapes.
    """
    lines, robot = _plan(level, grid, None, plain=False), None
    if state is not None:
        configuration, *cell = place_of(level, state)
        robot = cell[0], cell[1]
        lines = with_marks(lines, {cell_position(*robot): Mark(ROBOT)})
    situation = situation_of(level, configuration)
    taken = frozenset() if robot is None else frozenset({robot})
    marks = marks_of(level, situation, plain=False, taken=taken)
    lines = with_marks(lines, marks)
    if color:
        lines = _colored(lines, _Palette(level, grid, robot, marks))
    return "\n".join([*lines, ""])


def policy_drawing(
    level: GridWorld,
    grid: Grid,
    policy: Sequence[Sequence[int]] | None,
    *,
    configuration: int | None = None,
    plain: bool,
) -> str:
    """Return a picture of a policy; each line ends with a newline.

    Args:
        level: the level.
        grid: its walls and cells.
        policy: the action of each cell, `[height][width]`, as `Action`s; -1 where there is none.
            None shows the cells.
        configuration: what is where; None is the level as a whole.
        plain: whether to use ASCII characters only.
    """
    lines = _plan(level, grid, policy, plain=plain)
    situation = situation_of(level, configuration)
    marks = marks_of(level, situation, plain=plain, taken=_with_arrows(policy))
    return "\n".join([*with_marks(lines, marks), ""])


def _with_arrows(policy: Sequence[Sequence[int]] | None) -> frozenset[tuple[int, int]]:
    return frozenset(
        (x, y) for y, row in enumerate(policy or ()) for x, action in enumerate(row) if action >= 0
    )


def _plan(
    level: GridWorld, grid: Grid, policy: Sequence[Sequence[int]] | None, *, plain: bool
) -> list[str]:
    """Return the lines of a picture of everything but things."""
    drawing = without_things(level, drawing_of(level, grid))
    cells: list[list[str]] = [list(row) for row in drawing.cells]
    if policy is not None:
        arrows = ".^>v<" if plain else "·↑→↓←"
        cells = [
            [
                arrows[action] if action >= 0 else character
                for action, character in zip(actions, row, strict=True)
            ]
            for actions, row in zip(policy, cells, strict=True)
        ]
    elif not plain:
        cells = list(_symbols(level, drawing))
    if plain:
        return d.compose(replace(drawing, cells=tuple(map("".join, cells)))).splitlines()
    return ["".join(line) for line in _lines(drawing, cells)]


def _symbols(level: LevelSpec, drawing: d.Drawing) -> Iterator[list[str]]:
    """Yield the symbols of the cells by rows. Starts and exits hide warps, warps hide puddles."""
    south, east = shifts(level.wind, drawing.width, drawing.height)
    warps = {warp.at: warp.to for warp in level.warps}
    for y, row in enumerate(drawing.cells):
        shown = []
        for x, character in enumerate(row):
            symbol = _SHOWN.get(character, character)
            if character in (d.START, d.EXIT, d.BLOCKED):
                pass
            elif (x, y) in warps:
                symbol = _warp((x, y), warps[x, y])
            elif character == d.PLAIN and (east[y] or south[x]):
                symbol = _arrow(_WINDS, east[y], south[x])
            shown.append(symbol)
        yield shown


def _warp(at: tuple[int, int], to: tuple[int, int] | str) -> str:
    if isinstance(to, str):
        return TO_START
    return HELD if to == at else _arrow(_WARPS, to[0] - at[0], to[1] - at[1])


def _arrow(arrows: str, east: int, south: int) -> str:
    return arrows[round(math.atan2(south, east) / (math.pi / 4)) % 8]


def _lines(drawing: d.Drawing, cells: list[list[str]]) -> Iterator[Iterator[str]]:
    """Yield the lines as their parts; lines of walls and lines of cells alternate."""
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
            yield 3 * BLOCK if is_inside else _ACROSS[across[y][x]]
        yield joint(width, y)

    def cell_line(y: int) -> Iterator[str]:
        for x, symbol in enumerate(cells[y]):
            is_inside = blocked[y + 1][x] and blocked[y + 1][x + 1]
            yield BLOCK if is_inside else _DOWN[down[y][x]]
            yield 3 * BLOCK if symbol == d.BLOCKED else f" {symbol} "
        yield _DOWN[d.SOLID]

    for y in range(height):
        yield wall_line(y)
        yield cell_line(y)
    yield wall_line(height)


# -- pictures of one level, one for each state ------------------------------------------------


class TextPainter:
    """Draws a level as text, one picture for each state of the robot.

    Args:
        level: the level; a maze needs a seed.
        plain: whether to use ASCII characters only.
        overlay: what is shown about the level. Arrows are in the cells; values, visits, notes and
            the lines of panels are below the drawing. The rest is shown by pictures only.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """

    def __init__(
        self, level: GridWorld, *, plain: bool = False, overlay: Overlay | None = None
    ) -> None:
        self._level, self._grid, self._plain = level, level.grid(), plain
        self._overlay = overlay or Overlay()
        self._robots = PLAIN_ROBOTS if plain else ROBOTS
        self._drawn: tuple[_AtHand, _Drawn] | None = None
        if self._overlay.parts is None:
            self._at(None, None)

    def _at(self, configuration: int | None, heading: int | None) -> _Drawn:
        """Return what does not depend on the robot's cell."""
        at_hand = (None, None) if self._overlay.parts is None else (configuration, heading)
        if self._drawn is None or self._drawn[0] != at_hand:
            overlay, policy = self._overlay.at(*at_hand), None
            if overlay.actions is not None:
                # A character shows one action, the one with the highest number: moves before stay.
                policy = [[max(best, default=-1) for best in row] for row in overlay.actions]
            drawn = _Drawn(
                _plan(self._level, self._grid, policy, plain=self._plain),
                _with_arrows(policy),
                [printable(line) for line in _below(overlay)],
            )
            self._drawn = at_hand, drawn
        return self._drawn[1]

    def lines(
        self,
        state: int,
        *,
        heading: int | None = None,
        color: bool = False,
        held: bool = True,
        room: os.terminal_size | None = None,
    ) -> list[str]:
        """Return the lines of the picture.

        Args:
            state: the configuration and the cell of the robot, as in `level.compile()`.
            heading: where a robot that turns looks, 0 N, 1 E, 2 S, 3 W.
            color: whether to use the theme's colours, as 24-bit ANSI escapes.
            held: whether a line below the drawing says what is held, in a level with items.
            room: the available columns and lines. Of a larger drawing, the part around the robot
                is returned.
        """
        configuration, x, y = place_of(self._level, state)
        situation = situation_of(self._level, configuration)
        drawn = self._at(configuration, heading)
        row, column = cell_position(x, y)
        taken = drawn.taken | {(x, y)}
        marks = marks_of(self._level, situation, plain=self._plain, taken=taken)
        robot = self._robots[-1 if heading is None else heading]
        lines = with_marks(drawn.lines, {**marks, (row, column): Mark(robot)})
        below = drawn.below
        if held and (line := held_line(self._level, situation)):
            below = ["", line, *below]
        palette = _Palette(self._level, self._grid, (x, y), marks)
        if room is None:
            return [*(_colored(lines, palette) if color else lines), *below]
        below = cut_out(below, 0, 0, room.columns, room.lines // 2)
        width = min(room.columns, len(lines[0]))
        height = min(room.lines - len(below), len(lines))
        left = min(max(0, column - width // 2), len(lines[0]) - width)
        top = min(max(0, row - height // 2), len(lines) - height)
        if color:
            # Only visible lines need colours.
            shown = [line if top <= n < top + height else "" for n, line in enumerate(lines)]
            lines = _colored(shown, palette)
        return [*cut_out(lines, left, top, width, height), *below]


def _below(overlay: Overlay) -> Iterator[str]:
    """Yield the lines below the drawing; each block begins with an empty line."""
    if overlay.values is not None:
        yield from _table(overlay.values, overlay.precision)
    if overlay.visits is not None:
        yield from _table(overlay.visits, 0)
    notes = [f"[{note.x:g}, {note.y:g}] {note.text}" for note in overlay.notes]
    for block in (notes, overlay.side_panel, overlay.bottom_panel):
        if block:
            yield ""
        for text in block:
            yield from text.splitlines()


def _table(rows: Rows[float | None], precision: int) -> Iterator[str]:
    if len(rows[0]) > WIDEST:
        return
    yield ""
    yield from number_lines(rows, precision)


# -- tables of numbers ------------------------------------------------------------------------


def number_lines(rows: Sequence[Sequence[float | None]], precision: int) -> Iterator[str]:
    """Yield a line for each row. None and nan give empty cells."""
    shown = [
        ["" if value is None or math.isnan(value) else f"{value:.{precision}f}" for value in row]
        for row in rows
    ]
    width = max(len(text) for row in shown for text in row)
    for row in shown:
        yield "  ".join(text.rjust(width) for text in row).rstrip()


# -- colours ----------------------------------------------------------------------------------


def _colored(lines: list[str], palette: _Palette) -> list[str]:
    """Return the lines of a terminal picture with ANSI escapes, reset at the end of each.

    Args:
        lines: the picture without colours: cells of three characters, walls between them.
        palette: the colours of its characters.
    """
    return ["".join(palette.line(line, row)) + _RESET for row, line in enumerate(lines)]


class _Palette:
    """The colours of each character of the picture; rows and columns are those of the text."""

    def __init__(
        self,
        level: GridWorld,
        grid: Grid,
        robot: tuple[int, int] | None,
        marks: Mapping[Position, Mark],
    ) -> None:
        self._colors = colors = level.resolved_theme.colors
        self._width, self._height, self._robot = grid.width, grid.height, robot
        self._marks = marks
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
        exits = level.exits if level.exit_one_of is None else ()
        for cells, ground, text in (
            (level.starts, colors.start, colors.start_text),
            (exits, colors.exit, colors.exit_text),
        ):
            for x, y in cells:
                self._grounds[y][x] = over(ground, self._grounds[y][x])
                self._texts[x, y] = text
        self._inks = {"∘": _WATER, "◯": _WATER, "█": colors.blocked, "·": colors.lines}
        self._inks |= {"╌": GLASS, "╎": GLASS}

    def line(self, text: str, row: int) -> Iterator[str]:
        """Yield the parts of a line, with an escape where the style changes."""
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
        mark = self._marks.get((row, column))
        if mark is not None and mark.color is not None:
            return _marked(mark.color, ground, is_solid=mark.is_solid)
        if (x, y) == self._robot:
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
        mark = self._marks.get((row, column))
        if mark is not None and mark.color is not None:
            return _marked(mark.color, ground, is_solid=mark.is_solid)
        return over(self._inks.get(character, plain), ground), ground

    def _common_ground(self, row: int, column: int) -> Rgb:
        """Return the background that the cells around a wall share, or the base colour."""
        rows = {(row - 1) // 2, row // 2}
        columns = {(column - 1) // 4, column // 4}
        grounds = {self._grounds[y][x] for y in rows for x in columns}
        return grounds.pop() if len(grounds) == 1 else self._base


def _marked(color: str, ground: Rgb, *, is_solid: bool) -> Style:
    """Return the colours of a thing: on a background of its colour, or in that if it is seen."""
    ink = over(color, ground)
    if is_solid:
        return _readable_on(ink), ink
    below = "#{:02x}{:02x}{:02x}".format(*ground)
    return ink if contrast(color, below) >= _CONTRAST else _readable_on(ground), ground


def _readable_on(ground: Rgb) -> Rgb:
    red, green, blue = ground
    return _DARK if 0.299 * red + 0.587 * green + 0.114 * blue > 110 else _LIGHT
