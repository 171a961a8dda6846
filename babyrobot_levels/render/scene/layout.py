"""The layout of a picture: grid, margin, panels, compass, lines of text, and rules."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, TypeVar

from babyrobot_levels.language.looks import Panel
from babyrobot_levels.mdp.gridworld import GridWorld

Content = TypeVar("Content")
Rows = Sequence[Sequence[Content]]
"""Something for each cell, `[height][width]`."""


AtHand = tuple[int | None, int | None]
"""The configuration and heading of what depends on them; None for none at hand."""


@dataclass(frozen=True, slots=True)
class Note:
    """A text anywhere on the grid.

    Attributes:
        x: the column of the cell on whose centre the text is; fractions are between cells.
        y: its row.
        text: one line of text.
        color: a CSS colour, or None for the theme's `text_fg`.
    """

    x: float
    y: float
    text: str
    color: str | None = None


LOST = "from here, a box can reach no target"
"""What crosses mean."""


@dataclass(frozen=True, slots=True)
class Overlay:
    """What is shown over the cells of a level and in its panels.

    Attributes:
        values: the value of each cell; it may be infinite. None for a cell that shows nothing.
        actions: the actions of a policy in each cell, as `Action`s; it may be none.
        probabilities: the probability of each action in each cell, where arrows are to tell it
            by their length; `actions` are the most likely ones.
        action_values: the value of each action in each cell, in the order of `Action`: five
            numbers, each None if it is not shown; or none at all.
        visits: the number of visits to each cell. None and 0 show nothing.
        coordinates: whether each free cell shows its coordinates.
        notes: texts anywhere on the grid.
        side_panel: lines for the panel beside the grid. A level without one gets one.
        bottom_panel: lines for the panel below the grid, likewise.
        precision: the largest number of decimals.
        extent: the lowest and highest value of all configurations, where they differ: these have
            the same colours in all of them.
        rules: whether the rules of the level are shown: in a panel of the level in which they have
            room, else in a box of their own below the picture. Without it, only panels show them
            that have nothing else to show.
        never: the cells in which no robot can be in the configuration that is shown: hatched.
        lost: the cells from which a box can be pushed to no target: crossed.
        caption: which configuration that is, and what is hatched, in words; below the grid.
        parts: the overlay of a configuration and heading (each None if none is at hand), where
            they differ; it takes the place of this one.
    """

    values: Rows[float | None] | None = None
    actions: Rows[Sequence[int]] | None = None
    probabilities: Rows[Mapping[int, float]] | None = None
    action_values: Rows[Sequence[float | None]] | None = None
    visits: Rows[float | None] | None = None
    coordinates: bool = False
    notes: Sequence[Note] = ()
    side_panel: Sequence[str] = ()
    bottom_panel: Sequence[str] = ()
    precision: int = 2
    extent: tuple[float, float] | None = None
    rules: bool = False
    never: frozenset[tuple[int, int]] = frozenset()
    lost: frozenset[tuple[int, int]] = frozenset()
    caption: str = ""
    parts: Callable[[int | None, int | None], Overlay] | None = None

    @property
    def fills_cells(self) -> bool:
        """Whether it shows something in the middle of cells."""
        shown = self.values, self.actions, self.action_values, self.visits
        return any(rows is not None for rows in shown)

    @property
    def is_crowded(self) -> bool:
        """Whether arrows or values of actions take the middle of cells: the robot is small."""
        return self.actions is not None or self.action_values is not None

    @property
    def has_colors(self) -> bool:
        """Whether numbers are shown as colours, which need a legend."""
        return any(rows is not None for rows in (self.values, self.action_values, self.visits))

    @property
    def words(self) -> str:
        """The caption, and what crosses mean."""
        return "; ".join(filter(None, (self.caption, f"crossed: {LOST}" if self.lost else "")))

    def at(self, configuration: int | None = None, heading: int | None = None) -> Overlay:
        """Return what is shown in a configuration, with a heading; None for none at hand."""
        return self if self.parts is None else self.parts(configuration, heading)


# -- layout ----------------------------------------------------------------------------------------

CELL = 64.0
"""The side of a cell in pixels."""

_SLOT = 36.0
"""The largest side of the square in which a panel shows something that is held."""

COMPASS = 72.0
"""The side of the compass's square in pixels."""


STRIP = 42.0
"""The height of the strip below the grid that shows what is held, where there is no panel."""

LEGEND = 28.0
"""The height of the legend of a heat map below the grid."""

CAPTION_SIZE, CAPTION_LINE, CAPTION_FOOT, CAPTION_LEFT = 9.5, 12.0, 6.0, 24.0
"""The font size of a caption, the height of its lines, the space below, and its indent."""

_LEGEND_CELLS = 16
"""The columns and rows from which on the legend is larger."""


class HeldSlots(NamedTuple):
    """Where what is held is shown: squares in rows.

    Attributes:
        left: the left edge of all squares.
        top: their upper edge.
        side: the side of a square.
        columns: the number of squares in a row.
        rows: the number of rows.
    """

    left: float
    top: float
    side: float
    columns: int
    rows: int

    def centre(self, number: int) -> tuple[float, float]:
        """Return the centre of a square."""
        row, column = divmod(number, self.columns)
        return self.left + (column + 0.5) * self.side, self.top + (row + 0.5) * self.side


class TextRoom(NamedTuple):
    """A rectangle with room for text: in the panel beside the grid or below it, or a box below."""

    left: float
    top: float
    width: float
    height: float
    where: Literal["side", "bottom", "box"]


@dataclass(frozen=True, slots=True)
class Layout:
    """The parts of a picture, in pixels.

    Attributes:
        columns: the number of columns of cells.
        rows: the number of rows of cells.
        margin: the width of the margin around the grid.
        side: the width of the strip to the right of the grid, 0 for none.
        bottom: the height of the panel below the grid, 0 for none.
        items: the number of items that can be held.
        held_in: where what is held is shown: in a panel, or in a strip below the grid.
        strip: the height of that strip, 0 for none.
        legend: the height of the legend of a heat map below the grid, 0 for none.
        caption: the height of the caption of an overlay below that, 0 for none.
        rules: the height of the box with the rules below everything, 0 for none.
    """

    columns: int
    rows: int
    margin: float
    side: float
    bottom: float
    items: int = 0
    held_in: Literal["side", "bottom", "strip"] = "strip"
    strip: float = 0.0
    legend: float = 0.0
    caption: float = 0.0
    rules: float = 0.0

    @property
    def grid_width(self) -> float:
        """The width of all cells."""
        return self.columns * CELL

    @property
    def grid_height(self) -> float:
        """The height of all cells."""
        return self.rows * CELL

    @property
    def left_width(self) -> float:
        """The width of the grid with its margins."""
        return self.grid_width + 2 * self.margin

    @property
    def top_height(self) -> float:
        """The height of the grid with its margins, and of legend and caption below it."""
        return self.legend_top + self.legend + self.caption

    @property
    def legend_top(self) -> float:
        """Where the legend begins."""
        return self.grid_height + 2 * self.margin

    @property
    def times(self) -> float:
        """How much larger legend and caption are: large pictures are made smaller."""
        return max(1.0, max(self.columns, self.rows) / _LEGEND_CELLS)

    @property
    def width(self) -> float:
        """The width of the picture."""
        width = self.left_width + self.side
        return max(width, NARROWEST) if self.rules else width

    @property
    def height(self) -> float:
        """The height of the picture."""
        return self.top_height + self.bottom + self.strip + self.rules

    @property
    def slots(self) -> HeldSlots | None:
        """Where what is held is shown; None for a level without items."""
        if not self.items:
            return None
        if self.held_in == "side":
            room = max(8.0, self.side - 2 * PANEL_EDGE), self.top_height / 2
            side, columns, rows = _squares(self.items, *room, _SLOT)
            left = self.left_width + (self.side - columns * side) / 2
            return HeldSlots(left, self.top_height - rows * side - 4, side, columns, rows)
        if self.held_in == "bottom":
            room = self.width / 2, max(8.0, self.bottom - 4)
            side, columns, rows = _squares(self.items, *room, _SLOT)
            left = self.width - columns * side - 4
            top = self.top_height + (self.bottom - rows * side) / 2
            return HeldSlots(left, top, side, columns, rows)
        side, columns, rows = _squares(self.items, self.grid_width, self.strip, self.strip)
        top = self.top_height + (self.strip - rows * side) / 2
        return HeldSlots(self.margin, top, side, columns, rows)

    def corner(self, x: float, y: float) -> tuple[float, float]:
        """Return the top-left corner of a cell; halves give its centre."""
        return self.margin + x * CELL, self.margin + y * CELL

    def cell(self, point: tuple[float, float]) -> tuple[int, int]:
        """Return the cell in which a point of the picture lies."""
        x, y = (int((place - self.margin) // CELL) for place in point)
        return x, y

    def cells(self) -> Iterator[tuple[int, int]]:
        """Yield all cells, row by row."""
        return ((x, y) for y in range(self.rows) for x in range(self.columns))


def layout_of(
    level: GridWorld, *, cells_only: bool = False, overlay: Overlay | None = None
) -> Layout:
    """Return the layout of a level's picture.

    Args:
        level: the level.
        cells_only: whether to leave out the margin, the panels and the compass.
        overlay: what is shown over it; its lines get a panel if the level has none.
    """
    overlay = overlay or Overlay()
    columns, rows = level.size
    items = len(level.items)
    if cells_only:
        # As high as a cell: an agent sees what is held as large as what lies.
        return Layout(columns, rows, 0.0, 0.0, 0.0, items, strip=CELL if items else 0.0)
    widths = level.resolved_theme.widths
    # Half of the border is outside of the cells and must not be cut off.
    margin = float(math.ceil(max(widths.padding, widths.border / 2)))
    side, bottom = panel_width(level.display.side_panel), panel_width(level.display.bottom_panel)
    if overlay.side_panel and not side:
        side = Panel().width
    held_in: Literal["side", "bottom", "strip"] = "side" if side else "strip"
    if level.display.compass:
        side = max(side, COMPASS)
    if held_in == "strip" and (bottom or overlay.bottom_panel):
        held_in = "bottom"
    if overlay.bottom_panel and not bottom:
        # With items, first as high as their pictures, which leave less room for the text.
        layout = Layout(columns, rows, margin, side, _SLOT + 4, items, held_in)
        bottom = height_of(wrapped(overlay.bottom_panel, bottom_room(layout)))
        bottom = max(bottom, layout.bottom) if items and held_in == "bottom" else bottom
    strip = STRIP if items and held_in == "strip" else 0.0
    layout = Layout(columns, rows, margin, side, bottom, items, held_in, strip)
    legend = LEGEND * layout.times if overlay.has_colors else 0.0
    is_told = overlay.fills_cells or overlay.lost
    lines = caption_lines(overlay.words, layout) if is_told else []
    caption = layout.times * (CAPTION_LINE * len(lines) + CAPTION_FOOT) if lines else 0.0
    layout = replace(layout, legend=legend, caption=caption)
    return with_rules(level, overlay, layout) if overlay.rules else layout


def with_rules(level: GridWorld, overlay: Overlay, layout: Layout) -> Layout:
    """Return a layout with a box for the rules below the picture, if no panel has room for all."""
    from babyrobot_levels.render.words.rules import rules_of

    texts = [rule.text for rule in rules_of(level)]
    room = rules_room(level, overlay, layout)
    if room is not None and height_for(texts, room.width) <= room.height:
        return layout
    return replace(layout, rules=height_for(texts, max(layout.width, NARROWEST)))


def caption_lines(caption: str, layout: Layout) -> list[str]:
    """Return a caption in lines, at most as many as the layout has room for if it has any."""
    room = layout.left_width / layout.times - 2 * CAPTION_LEFT
    most = round((layout.caption / layout.times - CAPTION_FOOT) / CAPTION_LINE)
    return textwrap.wrap(
        caption,
        max(9, int(room / (CAPTION_SIZE * CHARACTER_WIDTH))),
        max_lines=most if layout.caption else 4,
        placeholder=" …",
    )


def rules_room(level: GridWorld, overlay: Overlay, layout: Layout) -> TextRoom | None:
    """Return where a picture shows the rules: in their box, or in a panel that is not used."""
    if layout.rules:
        top = layout.height - layout.rules
        return TextRoom(0.0, top, layout.width, layout.rules, "box")
    side, bottom = (
        panel_width(panel) for panel in (level.display.side_panel, level.display.bottom_panel)
    )
    if side >= NARROWEST and not overlay.side_panel:
        top = COMPASS if level.display.compass else 0.0
        return TextRoom(layout.left_width, top, layout.side, side_foot(layout) - top, "side")
    if bottom >= LINE and bottom_room(layout) >= NARROWEST and not overlay.bottom_panel:
        return TextRoom(0.0, layout.top_height, bottom_room(layout), layout.bottom, "bottom")
    return None


def side_foot(layout: Layout) -> float:
    """Return where the room for text in the panel beside the grid ends."""
    slots = layout.slots if layout.held_in == "side" else None
    return layout.top_height if slots is None else slots.top


def each_cell(
    rows: Rows[Content] | None, layout: Layout
) -> Iterator[tuple[tuple[int, int], Content]]:
    """Yield each cell with its content; nothing if there are no rows.

    Raises:
        ValueError: there are more or fewer rows or columns than in the layout.
    """
    if rows is None:
        return
    if len(rows) != layout.rows or any(len(row) != layout.columns for row in rows):
        raise ValueError(f"an overlay must have {layout.rows} rows of {layout.columns} cells")
    for y, row in enumerate(rows):
        for x, content in enumerate(row):
            yield (x, y), content


def bottom_room(layout: Layout) -> float:
    """Return the width that the panel below the grid has for text."""
    slots = layout.slots
    return layout.width if slots is None or layout.held_in != "bottom" else slots.left


def _squares(count: int, width: float, height: float, largest: float) -> tuple[float, int, int]:
    """Return the side of the largest squares of which `count` fit in, and columns and rows."""

    def fitting(rows: int) -> tuple[float, int, int]:
        columns = math.ceil(count / rows)
        return min(largest, width / columns, height / rows), columns, rows

    return max((fitting(rows) for rows in range(1, count + 1)), key=lambda found: found[0])


def panel_width(panel: str | float | Panel) -> float:
    """Return a panel's width (of a bottom panel, its height) in pixels, 0 for `none`."""
    if isinstance(panel, Panel):
        return panel.width
    return 0.0 if isinstance(panel, str) else panel


CHARACTER_WIDTH = 0.58
"""The average width of a character, as a share of the font size."""

LINE = 18.0
"""The height of a panel's line in pixels."""

LINE_SIZE = 13.0
"""The font size of a panel's text."""

PANEL_EDGE = 10.0
"""The padding of a panel."""


def wrapped(texts: Sequence[str], width: float) -> list[str]:
    """Return texts wrapped into lines that fit into a panel of the given width in pixels."""
    columns = max(1, int((width - 2 * PANEL_EDGE) / (LINE_SIZE * CHARACTER_WIDTH)))
    return [
        line
        for text in texts
        for part in text.splitlines() or [""]
        for line in textwrap.wrap(part, columns) or [""]
    ]


def height_of(lines: Sequence[str]) -> float:
    """Return the height of a panel for the lines."""
    return 2 * PANEL_EDGE + LINE * len(lines)


_FIT_SIZES = (12.0, 10.5, 9.0)


def fit(text: str, room: float) -> tuple[float, str]:
    """Return the largest font size at which a text fits; a text that never fits is shortened."""
    for size in _FIT_SIZES:
        if len(text) * size * CHARACTER_WIDTH <= room:
            return size, text
    count = max(1, int(room / (_FIT_SIZES[-1] * CHARACTER_WIDTH)) - 1)
    return _FIT_SIZES[-1], text[:count].rstrip() + "…"


# -- where rules stand in a box --------------------------------------------------------------------

SAMPLE = 18.0
"""The side of a sample in pixels."""

RULE_SIZE = 11.5
"""The font size."""

RULE_LINE = 14.0
"""The height of a line."""

NARROWEST = 130.0
"""The least width of a box for rules."""

_RULE_EDGE, _GAP, _BETWEEN = 10.0, 8.0, 5.0
"""The padding of a box, and the distances between a sample and its text, and between two rows."""

TEXT_LEFT = SAMPLE + _GAP
"""The distance of a text from the left edge of its row."""

_RULE_COLUMN = 230.0
"""The least width of one of several columns."""

_ROUNDING = 1e-6
"""A box as high as its rules may be lower by rounding."""

_RULE_CHARACTER = 0.54
"""The average width of a character, as a share of the font size."""

_SCALES = (1.0, 0.9, 0.8, 0.7)
"""The scales of rules in a box that is given, from the largest: smaller letters are not read."""


class RuleRow(NamedTuple):
    """A rule in a box.

    Attributes:
        rule: its number.
        left: its left edge, counted from that of the box.
        top: its upper edge, likewise.
        lines: the lines of its text.
    """

    rule: int
    left: float
    top: float
    lines: Sequence[str]


def height_for(texts: Sequence[str], width: float) -> float:
    """Return the height of a box in which all rules have room."""
    heights = list(map(_rule_height, _rule_lines(texts, width)))
    room = max(heights, default=0.0)
    while not _rules_fit(heights, room, _rule_columns(width)):
        room += 1.0
    return room - _BETWEEN + 2 * _RULE_EDGE


def scale_for(texts: Sequence[str], width: float, height: float) -> float | None:
    """Return the largest scale at which all rules have room in a box; None if there is none."""
    fits = (each for each in _SCALES if each * height_for(texts, width / each) <= height)
    return next(fits, None)


def rows_in(texts: Sequence[str], width: float, height: float) -> list[RuleRow]:
    """Return the rows in a box that has room for all."""
    rows: list[RuleRow] = []
    column, down = 0, 0.0
    room, columns = height - 2 * _RULE_EDGE + _BETWEEN, _rule_columns(width)
    for number, lines in enumerate(_rule_lines(texts, width)):
        tall = _rule_height(lines)
        if down + tall > room + _ROUNDING and rows and column + 1 < columns:
            column, down = column + 1, 0.0
        rows.append(
            RuleRow(number, _RULE_EDGE + column * width / columns, _RULE_EDGE + down, lines)
        )
        down += tall
    return rows


def _rule_columns(width: float) -> int:
    return max(1, int(width / _RULE_COLUMN))


def _rule_lines(texts: Sequence[str], width: float) -> list[list[str]]:
    room = width / _rule_columns(width) - 2 * _RULE_EDGE - TEXT_LEFT
    characters = max(1, int(room / (RULE_SIZE * _RULE_CHARACTER)))
    return [textwrap.wrap(text, characters) for text in texts]


def _rule_height(lines: Sequence[str]) -> float:
    """Return the height of a row, with the distance to the next one."""
    return max(SAMPLE, RULE_LINE * len(lines)) + _BETWEEN


def _rules_fit(heights: Sequence[float], room: float, columns: int) -> bool:
    down = 0.0
    for height in heights:
        if down + height > room:
            columns, down = columns - 1, 0.0
        down += height
    return columns > 0
