"""Texts on the grid: start, exit, labels of areas, notes, coordinates, and numbers."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from babyrobot_levels.language.cells import sides_of
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.actions import DELTAS
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import ink_on, plate_for
from babyrobot_levels.render.scene.ground import CellGrounds
from babyrobot_levels.render.scene.layout import CHARACTER_WIDTH, Layout, Note, fit
from babyrobot_levels.render.scene.marks import crossed_cells
from babyrobot_levels.render.scene.shapes import (
    MAX_SIDE,
    Commands,
    Path,
    Rect,
    Shape,
    Text,
    polyline,
)
from babyrobot_levels.render.scene.slots import Box, Slots

_END_SIZE, _SMALL_END_SIZE = 11.0, 8.5
_COORDINATE_SIZE = 9.5


def end_texts(level: GridWorld, layout: Layout, slots: Slots) -> Iterator[Shape]:
    """Yield START and EXIT: at the foot of their cells, or beside answers at the top."""
    colors, display, grounds = level.resolved_theme.colors, level.display, CellGrounds(level)
    exits = level.exits if level.exit_one_of is None else ()
    # Where one of several robots begins, another may leave; a frame tells whose exit it is.
    ends = frozenset(exits)
    starts = [cell for cell in level.starts if cell not in ends]
    own = {robot.exit for robot in level.robots}
    exits = tuple(cell for cell in exits if cell not in own)
    for word, cells, shown, fill in (
        ("START", starts, display.start_text, colors.start_text),
        ("EXIT", exits, display.exit_text, colors.exit_text),
    ):
        for cell in cells if shown else ():
            ink, ground = ink_on([grounds[cell]], fill), grounds[cell]
            box = slots.plan(cell).word
            if box is None:
                continue
            box = box.moved(*layout.corner(*cell))
            if slots.is_small(cell):
                yield Rect(box.left, box.top, box.width, box.height, ground, radius=3.0)
                yield Text(box.centre[0], box.bottom - 2.2, word, _SMALL_END_SIZE, ink, bold=True)
            else:
                if slots.shown.fills_cells:
                    # Its cell may have another colour.
                    left, width = box.centre[0] - 19, 38
                    yield Rect(left, box.top - 1, width, box.height + 2, ground, radius=3.0)
                yield Text(box.centre[0], box.bottom, word, _END_SIZE, ink, bold=True)


def end_text(word: str, layout: Layout, cell: Cell, fill: str) -> Text:
    """Return a word at the foot of a cell."""
    centre, foot = layout.corner(cell[0] + 0.5, cell[1] + 1)
    return Text(centre, foot - 5, word, _END_SIZE, fill, bold=True)


def label_shapes(level: GridWorld, slots: Slots) -> Iterator[Shape]:
    """Yield the labels of areas, on a background that keeps them readable."""
    colors = level.resolved_theme.colors
    plate = plate_for(colors.text_fg, colors.text_bg)
    for box, size, text, _ in slots.labels:
        yield Rect(*box[:2], box.width, box.height, plate, radius=box.height / 2)
        yield Text(box.centre[0], box.top + 1.02 * size, text, size, colors.text_fg)


def note_shapes(level: GridWorld, notes: Sequence[Note], layout: Layout) -> Iterator[Shape]:
    """Yield notes on the grid, each on a background that keeps it readable."""
    colors = level.resolved_theme.colors
    left_edge, right_edge = layout.margin + 2, layout.margin + layout.grid_width - 2
    for note in notes:
        line = " ".join(note.text.split())
        if not line:
            continue
        size, text = fit(line, layout.grid_width - 16)
        width, height = len(text) * size * CHARACTER_WIDTH + size, 1.4 * size
        x, y = layout.corner(note.x + 0.5, note.y + 0.5)
        # A note that would stick out of the grid is moved inwards.
        left = min(max(x - width / 2, left_edge), right_edge - width)
        fill = colors.text_fg if note.color is None else note.color
        plate = plate_for(fill, colors.text_bg)
        yield Rect(left, y - height / 2, width, height, plate, radius=height / 2)
        yield Text(left + width / 2, y + 0.342 * size, text, size, fill, bold=True)


def coordinate_texts(
    level: GridWorld,
    layout: Layout,
    slots: Slots,
    colors_of: Callable[[Cell], Sequence[str]] | None = None,
    *,
    on_plates: bool = False,
    crossed: Iterable[Cell] = (),
) -> Iterator[Shape]:
    """Yield the coordinates of each free cell, at its left, where nothing crosses them.

    Args:
        level: the level.
        layout: where its cells are.
        slots: what stands where in them.
        colors_of: returns the colours of a cell: one, or those from the north clockwise; by
            default, that of its ground.
        on_plates: whether all of them are on plates of that colour, and not only those that
            something crosses.
        crossed: further cells in which something does.
    """
    colors, blocked = level.resolved_theme.colors, level.grid().blocked_cells
    busy, grounds = busy_cells(level, layout, slots).union(crossed), CellGrounds(level)
    fills, exits = dict.fromkeys(level.starts, colors.start_text), frozenset(level.exits)
    if level.exit_one_of is None:
        fills |= dict.fromkeys(level.exits, colors.exit_text)
    for x, y in layout.cells():
        place = slots.plan((x, y)).coordinates
        if place is not None and not blocked[y * layout.columns + x]:
            box = place.moved(*layout.corner(x, y))
            text = f"{x},{y}"
            is_end = slots.is_small((x, y)) and (x, y) in fills
            on_flag = (x, y) in exits and len(text) > 3
            below = colors_of((x, y)) if colors_of and not is_end else (grounds[x, y],)
            if on_plates or is_end or on_flag or (x, y) in busy or len(below) > 1:
                width = len(text) * _COORDINATE_SIZE * CHARACTER_WIDTH
                yield Rect(box.left - 3, box.top, width + 6, box.height + 2, below[0], radius=3.0)
            fill = ink_on(below[:1], fills.get((x, y), colors.arrows))
            yield Text(box.left, box.bottom, text, _COORDINATE_SIZE, fill, "start")


def busy_cells(level: GridWorld, layout: Layout, slots: Slots) -> set[Cell]:
    """Return the cells in which texts may lie on puddles, arrows of warps, things or tracks."""
    cells = crossed_cells(level, layout, slots)
    cells |= {puddle.at for puddle in level.puddles} | {warp.at for warp in level.warps}
    still = (thing.cells for thing in level.things() if not thing.moves)
    cells |= {cell for places in still for cell in places if cell is not None}
    for door in level.doors:
        dx, dy = DELTAS[next(action for action in DELTAS if action.name[0] == door.side)]
        cells |= {cell for x, y in sides_of(door) for cell in ((x, y), (x + dx, y + dy))}
    for mover in level.movers:
        cells.update(mover.path or ())
        if mover.within is not None:
            (left, top), (width, height) = mover.within.at, mover.within.size
            cells |= {(left + x, top + y) for x in range(width) for y in range(height)}
    return cells


# -- numbers ---------------------------------------------------------------------------------------

Anchor = Literal["start", "middle", "end"]

_SIZE = 10.5
"""The largest font size."""

_SMALLEST = 7.5
"""The font size below which decimals are dropped instead."""

_READABLE = 7.0
"""The font size on a screen below which numbers are left out."""

_UNITS = (("T", 1e12), ("G", 1e9), ("M", 1e6), ("k", 1e3))
_WHOLE = 1e-9
"""The relative difference from a whole number up to which a number is one."""

_LARGE = 99_999.5
"""The number from which on thousands, millions and so on are counted."""


@dataclass(frozen=True, slots=True)
class Form:
    """The form of the numbers of a picture.

    Attributes:
        decimals: how many decimals each of them has.
        size: the font size.
    """

    decimals: int
    size: float = _SIZE

    def text(self, value: float) -> str:
        """Return a finite number as it is written: 923k from a hundred thousand on."""
        if abs(value) >= _LARGE:
            for unit, worth in _UNITS:
                # What is rounded to a thousand of a unit is one of the next.
                if 0.9995 * worth <= abs(value) < 999.5e12:
                    return f"{value / worth:.3g}{unit}"
            return f"{value:.0e}".replace("e+", "e")
        text = f"{value:.{self.decimals}f}"
        return text.removeprefix("-") if float(text) == 0 else text

    def drawn(self, value: float) -> str:
        """Return a finite number as pictures show it: decimals only where it is not whole."""
        is_whole = math.isclose(value, round(value), rel_tol=_WHOLE, abs_tol=_WHOLE)
        return (Form(0) if is_whole else self).text(value).replace("-", "\N{MINUS SIGN}")

    def is_readable(self, layout: Layout) -> bool:
        """Whether numbers can be read on a screen."""
        return self.size * min(1.0, MAX_SIDE / max(layout.width, layout.height)) >= _READABLE


def form_of(values: Iterable[float | None], precision: int, room: float = math.inf) -> Form:
    """Return the form of numbers: as many decimals as any of them needs, fewer where room is short.

    Args:
        values: the numbers; None and infinite ones have no part in it.
        precision: the largest number of decimals.
        room: the largest width of a number in pixels.
    """
    finite = [value for value in values if value is not None and math.isfinite(value)]
    needed = (len(f"{value:.{precision}f}".rstrip("0").partition(".")[2]) for value in finite)
    decimals = max(needed, default=0) if precision else 0

    def width(form: Form) -> float:
        longest = max((len(form.text(value)) for value in finite), default=1)
        return max(longest, 3) * CHARACTER_WIDTH

    while decimals > 0 and width(Form(decimals)) * _SMALLEST > room:
        # Fewer decimals are readable, smaller ones are not.
        decimals -= 1
    return Form(decimals, min(_SIZE, room / width(Form(decimals))))


def short(value: float, precision: int = 2) -> str:
    """Return a finite number in few characters, with no more decimals than it needs.

    Args:
        value: the number.
        precision: the largest number of decimals.
    """
    return form_of([value], precision).text(value)


def number_shapes(
    value: float,
    form: Form,
    box: Box,
    ink: str,
    ground: str | None = None,
    *,
    anchor: Anchor = "middle",
    bold: bool = True,
) -> Iterator[Shape]:
    """Yield a number in a box.

    Args:
        value: the number; it may be infinite.
        form: how it is written.
        box: where, in pixels of the picture.
        ink: its colour.
        ground: the colour of a ground that hides what lies below; None for no ground.
        anchor: at which edge of the box it is.
        bold: whether it is in bold.
    """
    text = "" if math.isinf(value) else form.drawn(value)
    width = max(len(text), 3) * form.size * CHARACTER_WIDTH
    across = {"start": box.left, "middle": box.centre[0], "end": box.right}[anchor]
    left = across - {"start": 0.0, "middle": width / 2, "end": width}[anchor]
    y = box.centre[1]
    if ground is not None:
        height = form.size
        yield Rect(left - 2, y - height / 2, width + 4, height, ground, radius=height / 2)
    if text:
        yield Text(across, y + 0.342 * form.size, text, form.size, ink, anchor, bold=bold)
        return
    # Not every font has this character.
    x = left + width / 2 + (0 if value > 0 else 3.5)
    yield Path(_infinity(x, y), stroke=ink, width=1.3)
    if value < 0:
        yield Path(polyline([(x - 11, y), (x - 8, y)]), stroke=ink, width=1.3)


def _infinity(x: float, y: float) -> Commands:
    return (
        ("M", (x, y)),
        ("C", (x + 2.5, y - 4, x + 6, y - 3.5, x + 6, y)),
        ("C", (x + 6, y + 3.5, x + 2.5, y + 4, x, y)),
        ("C", (x - 2.5, y - 4, x - 6, y - 3.5, x - 6, y)),
        ("C", (x - 6, y + 3.5, x - 2.5, y + 4, x, y)),
        ("Z", ()),
    )
