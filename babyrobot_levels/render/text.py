"""Levels as text: the language's drawing, and one in Unicode, in colour, for terminals."""

import math
import os
import textwrap
from collections.abc import Iterator, Mapping, Sequence, Set
from functools import cached_property
from typing import NamedTuple

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import Rgb, rgba
from babyrobot_levels.render.scene.heat import Heat, Scale
from babyrobot_levels.render.scene.layout import LOST, AtHand, Overlay, Rows, layout_of
from babyrobot_levels.render.scene.slots import Slots, standing_cells
from babyrobot_levels.render.scene.texts import Form, form_of
from babyrobot_levels.render.situation import Situation, place_of, situation_of
from babyrobot_levels.render.terminal import RESET, cut_out
from babyrobot_levels.render.text_legend import Entry, legend_of, marked_symbols
from babyrobot_levels.render.text_plan import (
    USUAL,
    WINDS,
    Palette,
    Position,
    Symbols,
    TextCells,
    TextGrounds,
    TextMark,
    ascii_lines,
    drawing_without_things,
    escape,
    held_line,
    marks_of,
    unicode_lines,
    with_marks,
)
from babyrobot_levels.render.words.rules import MOST, Rule, rules_of
from babyrobot_levels.text.source import printable

ROBOT = "☻"
PLAIN_ROBOT = "@"
ROBOTS, PLAIN_ROBOTS = f"▲►▼◄{ROBOT}", f"^>v<{PLAIN_ROBOT}"
"""A robot that looks north, east, south, west; and one that does not turn."""

WIDEST = 16
"""The widest level whose table of numbers fits on a screen."""

_ARROWS, _PLAIN_ARROWS = "·↑→↓←↗↘↙↖", ".^>v<9317"
"""The characters of the actions, from `stay` on."""

_NEVER, _PLAIN_NEVER = "╱", "-"
"""The characters of a cell in which no robot can be in the configuration that is shown."""

_LOST, _PLAIN_LOST = "×", "x"
"""The characters of a cell from which a box can reach no target."""

_BLACK = (0, 0, 0)
_BAR = 24
"""The columns of the bar in the legend of a scale."""


_Asked = tuple[Situation, TextCells, Cell | None]


class _Drawn(NamedTuple):
    """A picture without the robot and things.

    Attributes:
        lines: its lines.
        cells: where its cells are.
        fills: the colours of cells that have a value.
        below: the lines below it.
    """

    lines: list[str]
    cells: TextCells
    fills: Mapping[Cell, Rgb]
    below: list[str]


class TextPainter:
    """Draws a level as text, one picture for each state of the robot.

    Starts, exits and a legend's characters are shown as in the language's drawing; puddles are
    rings, warps double arrows (`↻` to the start), wind single ones, and other cells with effects of
    their own are letters. Every character takes one column, and every cell as many as in that
    drawing. `explained` says what they mean, and what is not drawn.

    Arrows are beside the symbols of cells. In colour, values and visits are the backgrounds of
    cells, with numbers where they fit; without colour, numbers are below the drawing. Notes and the
    lines of panels are always below. The rest of an overlay is shown by pictures only.

    Args:
        level: the level; a maze needs a seed.
        plain: whether to use ASCII characters only.
        overlay: what is shown about the level.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """

    def __init__(
        self, level: GridWorld, *, plain: bool = False, overlay: Overlay | None = None
    ) -> None:
        self._level, self._plain = level, plain
        self._overlay = overlay or Overlay()
        self._robots = PLAIN_ROBOTS if plain else ROBOTS
        self._arrows = _PLAIN_ARROWS if plain else _ARROWS
        self._drawing = drawing_without_things(level)
        self._grounds: TextGrounds | None = None
        self._drawn: tuple[tuple[AtHand, int, int | None], _Drawn] | None = None
        self._marked: tuple[_Asked, dict[Position, TextMark]] | None = None

    def lines(
        self,
        state: int | None,
        *,
        configuration: int | None = None,
        heading: int | None = None,
        colors: int = 0,
        held: bool = True,
        room: os.terminal_size | None = None,
    ) -> list[str]:
        """Return the lines of the picture.

        Args:
            state: the configuration and the cell of the robot, as in `level.compile()`; None for
                no robot.
            configuration: what is where, if no state is given; None is the level as a whole.
            heading: where a robot that turns looks, 0 N, 1 E, 2 S, 3 W.
            colors: how many colours the terminal shows, 16, 256 or all; 0 for no escapes.
            held: whether a line below the drawing says what is held, in a level with items.
            room: the available columns and lines. Of a larger drawing, the part around the robot,
                or else the start, is returned, and a line that says which part it is.
        """
        robot: Cell | None = None
        if state is not None:
            configuration, *place = place_of(self._level, state)
            robot = place[0], place[1]
        drawn = self._at(configuration, heading, colors, room and room.columns)
        situation = situation_of(self._level, configuration)
        marks = self._marks_of(situation, drawn.cells, robot)
        shown = marks
        if robot is not None:
            mark = TextMark(self._robots[-1 if heading is None else heading])
            shown = {**marks, drawn.cells.position(*robot): mark}
        lines, below = with_marks(drawn.lines, shown), drawn.below
        if held and (line := held_line(self._level, situation)):
            below = ["", line, *below]
        window = _Window(0, 0, len(lines[0]), len(lines))
        if room is not None:
            below = cut_out(below, 0, 0, room.columns, room.lines // 2)
            at = robot or self._level.starts[0]
            room = os.terminal_size((room.columns, room.lines - len(below)))
            window, words = _window(self._level.size, drawn.cells, at, room)
            below = [*words, *below]
        rows = range(window.top, window.top + window.height)
        if colors:
            # Only visible lines need colours.
            palette = self._palette(drawn, robot, marks, colors)
            lines = [palette.line(line, n) if n in rows else "" for n, line in enumerate(lines)]
        return [*cut_out(lines, *window), *below] if room else [*lines, *below]

    def blocks(self, *, configuration: int | None = None, colors: int) -> list[str]:
        """Return the lines of a small picture: a cell has two columns and one line.

        TextCells and walls are blocks of colour, two in each character. Arrows and numbers are not
        shown, nor is what has no colour.

        Args:
            configuration: what is where; None is the level as a whole.
            colors: how many colours the terminal shows, 16, 256 or all.
        """
        cells, drawn = TextCells(1, 0), self._at(configuration, None, colors, 1)
        situation = situation_of(self._level, configuration)
        marks = marks_of(self._level, situation, plain=False, cells=cells)
        ends = {*self._level.starts, *situation.exits}
        fills = {cell: color for cell, color in drawn.fills.items() if cell not in ends}
        palette = self._palette(drawn._replace(cells=cells, fills=fills), None, marks, colors)
        lines = unicode_lines(self._drawing, [[" "] * len(row) for row in self._drawing.cells])
        pixels: list[list[Rgb | None]] = [
            [palette.style(row, column, each)[each in " ·"] for column, each in enumerate(line)]
            for row, line in enumerate(lines)
        ]
        pixels.append([None] * len(lines[0]))
        pairs = zip(pixels[::2], pixels[1::2], strict=True)
        return [*(_half_blocks(*pair, colors) for pair in pairs), *drawn.below]

    def _palette(
        self,
        drawn: _Drawn,
        robot: Cell | None,
        marks: Mapping[tuple[int, int], TextMark],
        colors: int,
    ) -> Palette:
        if self._grounds is None:
            self._grounds = TextGrounds(self._level)
        return Palette(self._level, self._grounds, drawn.fills, robot, marks, drawn.cells, colors)

    def _at(
        self, configuration: int | None, heading: int | None, colors: int, columns: int | None
    ) -> _Drawn:
        """Return what does not depend on the robot's cell."""
        at_hand = (None, None) if self._overlay.parts is None else (configuration, heading)
        key = at_hand, colors, columns
        if self._drawn is None or self._drawn[0] != key:
            overlay = self._overlay.at(*at_hand)
            if colors and not self._plain:
                drawn = self._painted(overlay, colors, columns)
            else:
                drawn = self._lined(overlay)
            self._drawn = key, drawn
        return self._drawn[1]

    def _marks_of(self, *asked: *_Asked) -> dict[Position, TextMark]:
        """Return what shows the things; the picture and its legend ask for the same."""
        if self._marked is None or self._marked[0] != asked:
            situation, cells, robot = asked
            marks = marks_of(self._level, situation, plain=self._plain, robot=robot, cells=cells)
            self._marked = asked, marks
        return self._marked[1]

    def _lined(self, overlay: Overlay) -> _Drawn:
        """Return the picture without colours: arrows in the cells, numbers below."""
        arrows = self._arrows_of(overlay)
        cells = TextCells(3, 0, 2, arrows) if arrows else USUAL
        symbols = self._symbols_of(overlay)
        for x, y in overlay.never:
            symbols[y][x] = self.never if symbols[y][x] == " " else symbols[y][x]
        contents = [
            [
                _content(symbol, arrows[x, y], "", cells) if (x, y) in arrows else f" {symbol} "
                for x, symbol in enumerate(row)
            ]
            for y, row in enumerate(symbols)
        ]
        self._cross(overlay, contents)
        lines = (ascii_lines if self._plain else unicode_lines)(self._drawing, contents)
        below = [
            *_table(overlay.values, overlay.precision),
            *_table(overlay.visits, _decimals(overlay)),
        ]
        below += _texts_below(overlay, self.never)
        return _Drawn(lines, cells, {}, below)

    def _painted(self, overlay: Overlay, colors: int, columns: int | None) -> _Drawn:
        """Return the picture in colours: values are backgrounds, with numbers where they fit."""
        layout = layout_of(self._level, overlay=overlay)
        heat = Heat(self._level, layout, overlay, Slots(self._level, layout, overlay))
        values = heat.visits if overlay.values is None else heat.values
        arrows = self._arrows_of(overlay)
        form = form_of(values.values(), overlay.precision)
        numbers = {cell: _value_text(value, form) for cell, value in values.items()}
        longest = max(map(len, numbers.values()), default=0)
        # A blank between arrow and number is left out where that lets the numbers fit.
        fitting = (
            TextCells(longest + more, 0, more - 1)
            for more in ((3, 2) if arrows else (2,))
            if columns is None or (longest + more + 1) * self._level.size[0] < columns
        )
        cells = next(fitting, None) if numbers else None
        if cells is None:
            numbers, cells = {}, TextCells(3, 0, 2) if arrows or values else USUAL
        cells = cells._replace(filled={**arrows, **values})
        contents = [
            [
                _content(symbol, arrows.get((x, y), ""), numbers.get((x, y), ""), cells)
                if (x, y) in values or (x, y) in arrows
                else symbol.center(cells.width)
                for x, symbol in enumerate(row)
            ]
            for y, row in enumerate(self._symbols_of(overlay))
        ]
        for x, y in overlay.never:
            if contents[y][x].isspace():
                contents[y][x] = self.never * cells.width
        self._cross(overlay, contents)
        fills = {cell: rgba(color)[:3] for cell, color in heat.tiles.items()}
        below = [*_legend(heat.scale, form, colors)] if fills else []
        if overlay.values is not None:
            below += _table(overlay.visits, _decimals(overlay))
        below += _texts_below(overlay, self.never)
        return _Drawn(unicode_lines(self._drawing, contents), cells, fills, below)

    def _cross(self, overlay: Overlay, contents: list[list[str]]) -> None:
        """Mark lost cells beside their symbols, or before numbers that leave no room there."""
        for x, y in overlay.lost:
            content = contents[y][x]
            if content.endswith(" "):
                contents[y][x] = content[:-1] + self.lost
            elif content.startswith(" "):
                contents[y][x] = self.lost + content[1:]

    @cached_property
    def _rules(self) -> tuple[Rule, ...]:
        return rules_of(self._level, drawn=False)

    @cached_property
    def symbols(self) -> Symbols:
        """The symbols of the cells."""
        return marked_symbols(self._level, self._drawing, self._rules, plain=self._plain)

    def _symbols_of(self, overlay: Overlay) -> Symbols:
        """Return the symbols in a picture: arrows of wind would be read as those of a policy."""
        hidden = "" if overlay.actions is None else WINDS
        return [[" " if each in hidden else each for each in row] for row in self.symbols]

    @property
    def never(self) -> str:
        """The character of a cell in which no robot can be."""
        return _PLAIN_NEVER if self._plain else _NEVER

    @property
    def lost(self) -> str:
        """The character of a cell from which a box can reach no target."""
        return _PLAIN_LOST if self._plain else _LOST

    def explained(
        self,
        *,
        caption: str = "",
        configuration: int | None = None,
        colors: int = 0,
        columns: int = 100,
        most: int | None = MOST,
        by_color: bool = False,
    ) -> list[str]:
        """Return what the marks of the picture mean, and what it does not show.

        Args:
            caption: what the values and the policy are of.
            configuration: what is where; None is the level as a whole.
            colors: how many colours the terminal shows.
            columns: how long lines may be, at least 40.
            most: how many lines, and how many parts that are not drawn, are told; None for all.
            by_color: whether the picture is that of `blocks`, which has only colours.
        """
        drawn = self._at(configuration, None, colors, None)
        situation = situation_of(self._level, configuration)
        marks = self._marks_of(situation, drawn.cells, None)
        symbols = self._symbols_of(self._overlay)
        found = legend_of(
            self._level, situation, self._rules, symbols, marks, drawn.cells,
            plain=self._plain,
        )  # fmt: skip
        palette = self._palette(drawn, None, marks, colors) if colors else None
        if by_color and palette is not None:
            found = found.by_color(palette)
        entries, not_drawn = found.entries[:most], found.not_drawn[:most]
        if more := len(found.entries) - len(entries) + len(found.not_drawn) - len(not_drawn):
            not_drawn.append(f"and {more:,} further rules, which `babyrobot preview --rules` tells")
        lines: list[str] = []
        for entry in (*self._of_policy(caption), *entries):
            lines += _legend_lines(entry, palette, max(columns, 40))
        if not_drawn:
            text = f"not drawn: {'; '.join(not_drawn)}"
            lines += textwrap.wrap(text, max(columns, 40), subsequent_indent=" " * 11)
        return lines

    def _of_policy(self, caption: str) -> Iterator[Entry]:
        """Yield what the marks of a policy mean, as far as there are any."""
        overlay, blocked = self._overlay, self._level.grid().blocked_cells
        arrows, width = self._arrows_of(overlay), self._level.size[0]
        stay, moves = self._arrows[0], self._arrows[1 : 1 + self._level.moves]
        if arrows:
            keypad = "; digits as on a keypad" if moves[-1].isdigit() else ""
            words = f"an optimal action, also where there are several{keypad}"
            yield Entry(((" ".join(moves), None),), words)
        if stay in arrows.values():
            yield Entry(((stay, None),), "stay")
        if caption:
            mark, _, meaning = caption.replace("hatched:", self.never).partition(" ")
            yield Entry(((mark, None),), meaning)
        if overlay.lost:
            yield Entry(((self.lost, None),), LOST)
        taken = {*arrows, *overlay.never}
        free = (divmod(cell, width)[::-1] for cell, is_wall in enumerate(blocked) if not is_wall)
        if arrows and not taken.issuperset(free):
            yield Entry((("others", None),), "the episode is over, or no robot can be there")

    def _arrows_of(self, overlay: Overlay) -> dict[Cell, str]:
        """Return the arrow of each cell that has one.

        A cell in which robots act shows one action, the one with the highest number: moves before
        `stay`.
        """
        return {
            (x, y): self._arrows[max(actions)]
            for y, row in enumerate(overlay.actions or ())
            for x, actions in enumerate(row)
            if actions and (x, y) in self._acting
        }

    @cached_property
    def _acting(self) -> frozenset[Cell]:
        return standing_cells(self._level)[0]


def _legend_lines(entry: Entry, palette: Palette | None, columns: int) -> Iterator[str]:
    """Yield the lines of an entry, its marks in the colours that they have in the picture."""
    length, shown = -1, []
    for mark, place in entry.marks:
        code = ""
        if palette is not None and place is not None:
            code = escape(*palette.style(*place, mark), palette.count)
            mark = f" {mark} "
        length += len(mark) + 1
        shown.append(f"{code}{mark}{RESET if code else ''}")
    first, *rest = textwrap.wrap(entry.words, columns - 9) or [""]
    yield f"{' '.join(shown)}{' ' * (7 - length)}  {first}"
    yield from (f"{'':9}{line}" for line in rest)


def _content(symbol: str, arrow: str, number: str, cells: TextCells) -> str:
    """Return the text of a cell: its symbol, its arrow and its number."""
    if arrow:
        return f"{symbol}{arrow}{number:>{cells.width - 2}}"
    return f"{symbol}{number:>{cells.width - 2}} "


def _value_text(value: float, form: Form) -> str:
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    return form.text(value)


def _half_blocks(above: Sequence[Rgb | None], below: Sequence[Rgb | None], colors: int) -> str:
    """Return a line whose characters show two blocks of colour each."""
    parts, last = [], ""
    for top, foot in zip(above, below, strict=True):
        code = escape(top or _BLACK, foot, colors)
        parts.append(("" if code == last else code) + "▀")
        last = code
    return "".join(parts) + RESET


# -- parts of a picture -----------------------------------------------------------------------


class _Window(NamedTuple):
    """A part of a drawing, in columns and lines."""

    left: int
    top: int
    width: int
    height: int


def _window(
    size: tuple[int, int], cells: TextCells, at: Cell, room: os.terminal_size
) -> tuple[_Window, list[str]]:
    """Return the part of a drawing that fits, around a cell, and a line that says which it is."""
    steps = cells.width + 1, 2
    if all(step * count < free for step, count, free in zip(steps, size, room, strict=True)):
        return _Window(0, 0, steps[0] * size[0] + 1, 2 * size[1] + 1), []
    free = room.columns, room.lines - 1
    shown = [min(count, max(1, (free[axis] - 1) // steps[axis])) for axis, count in enumerate(size)]
    first = [min(max(0, at[axis] - shown[axis] // 2), size[axis] - shown[axis]) for axis in (0, 1)]
    last = [first[axis] + shown[axis] - 1 for axis in (0, 1)]
    width, height = (min(steps[axis] * shown[axis] + 1, free[axis]) for axis in (0, 1))
    words = f"cells {first} to {last} of {size[0]} x {size[1]}"
    part = _Window(steps[0] * first[0], 2 * first[1], width, height)
    return part, cut_out([words], 0, 0, room.columns, 1)


# -- what is below it -------------------------------------------------------------------------


def _texts_below(overlay: Overlay, never: str) -> Iterator[str]:
    """Yield notes, the caption and the lines of panels; each block begins with an empty line."""
    notes = [f"[{note.x:g}, {note.y:g}] {note.text}" for note in overlay.notes]
    caption = [overlay.caption.replace("hatched:", never)] if overlay.caption else []
    for block in (notes, caption, overlay.side_panel, overlay.bottom_panel):
        if block:
            yield ""
        for text in block:
            yield from map(printable, text.splitlines())


def _decimals(overlay: Overlay) -> int:
    """Return the decimals of counts, which expected ones have."""
    counts = [count for row in overlay.visits or () for count in row]
    return form_of(counts, overlay.precision).decimals


def _table(rows: Rows[float | None] | None, precision: int) -> Iterator[str]:
    if rows is None or len(rows[0]) > WIDEST:
        return
    yield ""
    yield from number_lines(rows, precision)


def number_lines(
    rows: Sequence[Sequence[float | None]], precision: int, never: Set[Cell] = frozenset()
) -> Iterator[str]:
    """Yield a line for each row. None and nan give empty cells, or say that they never occur."""
    shown = [
        [
            f"{value:.{precision}f}"
            if value is not None and not math.isnan(value)
            else _PLAIN_NEVER * ((x, y) in never)
            for x, value in enumerate(row)
        ]
        for y, row in enumerate(rows)
    ]
    width = max(len(text) for row in shown for text in row)
    for row in shown:
        yield "  ".join(text.rjust(width) for text in row).rstrip()


def _legend(scale: Scale, form: Form, colors: int) -> Iterator[str]:
    """Yield the lines of a legend: the lowest number, the colours up to the highest, and that."""
    ends = [form.text(scale.low), form.text(scale.high)]
    strip = scale.strip(_BAR)
    if scale.low == scale.high:
        ends, strip = ["", ends[1]], strip[:2]
    grounds = (rgba(color)[:3] for color in strip)
    bar = "".join(f"{escape(ground, ground, colors)} " for ground in grounds)
    yield ""
    yield f"{ends[0]} {bar}{RESET} {ends[1]}".lstrip(" ")
