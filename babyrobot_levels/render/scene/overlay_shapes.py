"""An overlay as shapes: numbers, arrows and texts, each in its slot of the cell."""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.actions import DELTAS, Action
from babyrobot_levels.render.colors import rim_on
from babyrobot_levels.render.scene.heat import Heat
from babyrobot_levels.render.scene.layout import CELL, Layout, each_cell
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.panels import panel_texts
from babyrobot_levels.render.scene.scale import ink_on
from babyrobot_levels.render.scene.shapes import (
    Command,
    Path,
    Point,
    Shape,
    circle,
    polygon,
    polyline,
)
from babyrobot_levels.render.scene.slots import Arrow, Box, Slots
from babyrobot_levels.render.scene.texts import (
    Anchor,
    Form,
    busy_cells,
    coordinate_texts,
    form_of,
    note_shapes,
    number_shapes,
)

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld


class OverlayShapes(NamedTuple):
    """The shapes of an overlay by layer, from the bottom up."""

    heat: tuple[Shape, ...]
    underlay: tuple[Shape, ...]
    overlay: tuple[Shape, ...]
    text: tuple[Shape, ...]


def overlay_shapes(
    level: GridWorld, overlay: Overlay, layout: Layout, slots: Slots | None = None
) -> OverlayShapes:
    """Return the shapes of an overlay: heat map, arrows, numbers, and other texts.

    Args:
        level: the level.
        overlay: what is shown.
        layout: where the cells are.
        slots: what stands where in them, if it is known.

    Raises:
        ValueError: the overlay has another size than the level.
    """
    slots = slots or Slots(level, layout, overlay)
    heat, colors = Heat(level, layout, overlay, slots), level.resolved_theme.colors
    texts: list[Shape] = []
    # On a heat map, the level's own are written in the inks of their tiles.
    if overlay.has_colors if level.display.coordinates else overlay.coordinates:
        texts += coordinate_texts(level, layout, slots, heat.colors_of)
    texts += note_shapes(level, overlay.notes, layout)
    texts += panel_texts(level, overlay, layout)
    return OverlayShapes(
        tuple(heat.shapes),
        tuple(arrow_shapes(arrow_lengths(overlay, slots, layout), slots, layout, colors.arrows)),
        tuple(number_labels(level, heat)),
        tuple(texts),
    )


# -- numbers -------------------------------------------------------------------------------------


def number_labels(level: GridWorld, heat: Heat) -> Iterator[Shape]:
    """Yield the numbers of a heat map, if they are readable on a screen."""
    overlay, slots, layout = heat.overlay, heat.slots, heat.layout
    if not overlay.has_colors:
        return
    colors = level.resolved_theme.colors
    covered = busy_cells(level, layout, slots) | {*level.starts}
    form = number_form(heat.values.values(), overlay.precision)
    if form.is_readable(layout) and slots.shown.number:
        for cell, value in heat.values.items():
            color = heat.scale.color(value)
            box = slots.plan(cell).number.moved(*layout.corner(*cell))
            ground = color if cell in covered else None
            yield from number_shapes(value, form, box, ink_on(color), ground)
    form = form_of(heat.visits.values(), 0, CELL / 2 - 7 if slots.shown.second else CELL - 8)
    if form.is_readable(layout):
        for cell, count in heat.visits.items():
            plan, tile = slots.plan(cell), heat.tiles.get(cell)
            box = (plan.second if slots.shown.second else plan.number).moved(*layout.corner(*cell))
            anchor: Anchor = "end" if slots.shown.second else "middle"
            if tile is None:
                ink, ground = colors.text_fg, colors.text_bg
            else:
                ink, ground = ink_on(tile), tile if cell in covered else None
            yield from number_shapes(count, form, box, ink, ground, anchor=anchor)
    yield from _action_labels(heat, covered)


def number_form(values: Iterable[float | None], precision: int) -> Form:
    """Return the form of values at the foot of cells."""
    return form_of(values, precision, CELL - 8)


def _action_labels(heat: Heat, covered: Container[Cell]) -> Iterator[Shape]:
    """Yield the values of moves in their triangles, the best in bold; `stay` has none."""
    slots, layout = heat.slots, heat.layout
    # Beside an arrow there is less room.
    room = CELL / 2 - _SIDE - (_MIDDLE if slots.shown.arrows else 2.0)
    numbers = [value for values in heat.action_values.values() for value in values[1:]]
    form = form_of(numbers, heat.overlay.precision, room)
    if not form.is_readable(layout):
        return
    for cell, values in heat.action_values.items():
        best = max(value for value in values if value is not None)
        plan = slots.plan(cell)
        top, foot, y = plan.free.top, plan.free.bottom, plan.arrow.centre[1]
        height = 1.4 * form.size
        boxes: dict[Action, tuple[Box, Anchor]] = {
            Action.NORTH: (Box(0, top, CELL, top + height), "middle"),
            Action.EAST: (Box(0, y, CELL - _SIDE, y), "end"),
            Action.SOUTH: (Box(0, foot - height, CELL, foot), "middle"),
            Action.WEST: (Box(_SIDE, y, CELL, y), "start"),
        }
        for action, (box, anchor) in boxes.items():
            value = values[action]
            if value is not None:
                box = box.moved(*layout.corner(*cell))
                color = heat.scale.color(value)
                # Away from the edges of a cell, its triangles are narrow.
                ground = color if cell in covered or top > _NARROW else None
                is_best = value >= best - _TIE * abs(best) if math.isfinite(best) else value == best
                yield from number_shapes(
                    value, form, box, ink_on(color), ground, anchor=anchor, bold=is_best
                )


# -- arrows --------------------------------------------------------------------------------------

_SIDE, _MIDDLE, _NARROW = 6.0, 9.5, 8.0
"""The distance of values of actions from the sides of their cell, from arrows' centres, and from
its upper edge before they need a ground."""

_TIE = 1e-9
"""The relative difference up to which two values count as equal."""

_WIDTH, _RIM = 3.2, 2.0
"""The width of arrows, and of the rim that makes them visible on every background."""
_THIN = 2.0, 1.5
"""The same of the short arrows beside values of actions."""
_RING = 0.25
"""The radius of the ring that means `stay`, as a share of the arrows' length."""
_SHORTEST = 0.4
"""The length of the arrow of an improbable action, as a share of that of the most likely one."""
_LEAST = 0.005
"""The probability below which an action has no arrow."""
_MOST_RIMMED = 100
"""The most columns and rows with rims: in larger pictures they would be finer than a pixel."""

Lengths = Mapping[int, float]
"""The length of the arrow of each action, as a share of the longest."""


def arrow_lengths(overlay: Overlay, slots: Slots, layout: Layout) -> Iterator[tuple[Cell, Lengths]]:
    """Yield the arrows of the cells in which the robot can act."""
    if overlay.probabilities is not None:
        for cell, chances in each_cell(overlay.probabilities, layout):
            most = max(chances.values(), default=0.0)
            lengths = {
                action: _SHORTEST + (1 - _SHORTEST) * chance / most
                for action, chance in chances.items()
                if chance >= _LEAST * most > 0
            }
            if cell in slots.acting:
                yield cell, lengths
        return
    for cell, actions in each_cell(overlay.actions, layout):
        if cell in slots.acting:
            yield cell, dict.fromkeys(actions, 1.0)


def arrow_shapes(
    cells: Iterable[tuple[Cell, Lengths]], slots: Slots, layout: Layout, color: str
) -> Iterator[Shape]:
    """Yield the arrows of a policy, with a rim that makes them visible on every background.

    Args:
        cells: the lengths of the arrows of each cell.
        slots: what stands where in the cells.
        layout: where the cells are.
        color: the colour of the arrows.
    """
    shafts: list[Command] = []
    heads: list[Command] = []
    for cell, lengths in cells:
        box = slots.plan(cell).arrow.moved(*layout.corner(*cell))
        middle, reach, start = box.centre, box.width / 2, 0.0
        if Action.STAY in lengths:
            start = _RING * reach * lengths[Action.STAY]
            shafts += circle(*middle, start)
        for action, length in lengths.items():
            if action != Action.STAY:
                shaft, head = _arrow(middle, DELTAS[Action(action)], start, length * reach)
                shafts += shaft
                heads += head
    lines, tips = tuple(shafts), tuple(heads)
    width, around = _THIN if slots.shown.actions else (_WIDTH, _RIM)
    if max(layout.columns, layout.rows) <= _MOST_RIMMED:
        rim = rim_on([color])
        if lines:
            yield Path(lines, stroke=rim, width=width + 2 * around, cap="round")
        if tips:
            yield Path(tips, stroke=rim, width=2 * around)
    if lines:
        yield Path(lines, stroke=color, width=width, cap="round")
    if tips:
        yield Path(tips, fill=color)


def _arrow(start: Point, towards: tuple[int, int], gap: float, reach: float) -> Arrow:
    """Return shaft and head of an arrow that begins and ends `gap` and `reach` from `start`."""
    length = 0.5 * reach

    def at(along: float, across: float) -> Point:
        return (
            start[0] + along * towards[0] - across * towards[1],
            start[1] + along * towards[1] + across * towards[0],
        )

    neck = reach - length
    half = 0.6 * length
    shaft = polyline([at(min(gap, neck), 0), at(neck, 0)])
    return shaft, polygon([at(reach, 0), at(neck, half), at(neck, -half)])
