"""An overlay as shapes, kept clear of each other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.looks import Colors
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.overlays import Content, Overlay, Rows
from babyrobot_levels.render.scene.overlays.heat import heat_shapes
from babyrobot_levels.render.scene.overlays.notes import note_shapes, panel_texts
from babyrobot_levels.render.scene.overlays.numbers import HEIGHT, SMALL, action_pills, pill
from babyrobot_levels.render.scene.overlays.policy import SHORTEST, arrow_shapes
from babyrobot_levels.render.scene.overlays.rooms import BESIDE_COORDINATES, Cell, Rooms
from babyrobot_levels.render.scene.shapes import Shape
from babyrobot_levels.render.scene.texts import coordinate_texts

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_COUNT_ROOM = 30.0
"""Coordinates stand beside the count."""


class OverlayShapes(NamedTuple):
    """The shapes of an overlay by layer, from the bottom up."""

    underlay: tuple[Shape, ...]
    overlay: tuple[Shape, ...]
    text: tuple[Shape, ...]


def overlay_shapes(level: GridWorld, overlay: Overlay, layout: Layout) -> OverlayShapes:
    """Return what an overlay says: heat and arrows on the ground, numbers, and other texts.

    They keep clear of each other, and of the texts that the picture has already.

    Raises:
        ValueError: the overlay is not as large as the level.
    """
    colors, rooms = level.resolved_theme.colors, Rooms(level, layout)
    visits = [(cell, count) for cell, count in _cells(overlay.visits, layout) if count]
    ground: list[Shape] = [*heat_shapes(visits, rooms, layout, colors.arrows)]
    tops = _corners(level, overlay, visits, rooms, layout)
    numbers = [*_counts(visits, tops, colors, layout)]
    numbers += _values(level, overlay, rooms, layout)
    crowded = {
        cell: values
        for cell, values in _cells(overlay.action_values, layout)
        if any(value is not None for value in values)
    }
    numbers += _action_values(crowded, overlay, rooms, colors, layout)
    actions = _cells(overlay.actions, layout)
    ground += arrow_shapes(actions, rooms, layout, colors.arrows, crowded)
    texts: list[Shape] = []
    if overlay.coordinates and not level.display.coordinates:
        texts += coordinate_texts(level, layout, tops)
    texts += note_shapes(level, overlay.notes, layout)
    texts += panel_texts(level, overlay, layout)
    return OverlayShapes(tuple(ground), tuple(numbers), tuple(texts))


def _corners(
    level: GridWorld,
    overlay: Overlay,
    visits: list[tuple[Cell, float]],
    rooms: Rooms,
    layout: Layout,
) -> dict[Cell, float]:
    """Return where coordinates and counts begin: they share the upper edge of their cell."""
    if level.display.coordinates:
        return dict.fromkeys(layout.cells(), BESIDE_COORDINATES)
    cells = layout.cells() if overlay.coordinates else (cell for cell, _ in visits)
    return {cell: rooms.take_top(cell, HEIGHT) for cell in cells}


def _counts(
    visits: list[tuple[Cell, float]], tops: dict[Cell, float], colors: Colors, layout: Layout
) -> Iterator[Shape]:
    for cell, count in visits:
        right, upper = layout.corner(cell[0] + 1, cell[1])
        under = upper + tops[cell] + HEIGHT
        yield from pill(count, right - 4, under, _COUNT_ROOM, 0, colors, "end")


def _values(level: GridWorld, overlay: Overlay, rooms: Rooms, layout: Layout) -> Iterator[Shape]:
    """Yield values, at the feet of the cells; an exit, where all is over, needs no 0."""
    colors = level.resolved_theme.colors
    for cell, value in _cells(overlay.values, layout):
        if value is not None and not (value == 0 and cell in level.exits):
            middle, upper = layout.corner(cell[0] + 0.5, cell[1])
            under = upper + rooms.take_foot(cell, HEIGHT)
            yield from pill(value, middle, under, CELL - 4, overlay.precision, colors)


def _action_values(
    crowded: Mapping[Cell, Sequence[float | None]],
    overlay: Overlay,
    rooms: Rooms,
    colors: Colors,
    layout: Layout,
) -> Iterator[Shape]:
    """Yield values of actions, at the sides of the cells; arrows are left the middle."""
    gap = 2 * SHORTEST if overlay.actions is not None else 0.0
    for cell, values in crowded.items():
        height = min(SMALL, rooms.height(cell) / 3)
        box = rooms.take_top(cell, height), rooms.take_foot(cell, height)
        corner = layout.corner(*cell)
        yield from action_pills(values, corner, box, height, gap, overlay.precision, colors)


def _cells(rows: Rows[Content] | None, layout: Layout) -> Iterator[tuple[Cell, Content]]:
    if rows is None:
        return
    if len(rows) != layout.rows or any(len(row) != layout.columns for row in rows):
        raise ValueError(f"an overlay must have {layout.rows} rows of {layout.columns} cells")
    for y, row in enumerate(rows):
        for x, content in enumerate(row):
            yield (x, y), content
