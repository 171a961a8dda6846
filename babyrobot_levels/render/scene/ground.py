"""The ground of the cells: base, areas, blocked cells, the lines between cells, starts, exits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.paths import polygon, polyline
from babyrobot_levels.render.scene.runs import rectangles, runs
from babyrobot_levels.render.scene.shapes import Command, Ellipse, Path, Rect, Shape

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_DASH = 4.0
_LINE_WIDTH = 1.0
_EDGE = 3.0
"""How high blocked cells seem to stand above the ground."""


def ground_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the ground, from the bottom up."""
    colors = level.resolved_theme.colors
    blocked = level.grid().blocked_cells
    yield Rect(layout.margin, layout.margin, layout.grid_width, layout.grid_height, colors.base)
    for area in level.areas:
        if area.color is not None:
            yield _cells(layout, area.at, area.size, area.color)
    yield from _blocked(layout, blocked, colors.blocked)
    if lines := tuple(_line_commands(layout, blocked)):
        yield Path(lines, stroke=colors.lines, width=_LINE_WIDTH, dash=(_DASH, _DASH))
    for cell in level.starts:
        yield _cells(layout, cell, (1, 1), colors.start)
        yield from _pad(layout, cell, colors.start_text)
    for cell in level.exits:
        yield _cells(layout, cell, (1, 1), colors.exit)
        yield from _flag(layout, cell, colors.exit_text)


def _cells(layout: Layout, at: tuple[int, int], size: tuple[int, int], fill: str) -> Rect:
    return Rect(*layout.corner(*at), size[0] * CELL, size[1] * CELL, fill)


def _pad(layout: Layout, cell: tuple[int, int], color: str) -> Iterator[Shape]:
    """Yield the pad that the robot starts from."""
    x, y = layout.corner(cell[0] + 0.5, cell[1] + 0.5)
    for radius, opacity in ((20, 0.25), (12, 0.35)):
        yield Ellipse(x, y + 11, radius, 0.3 * radius, color, opacity)


def _flag(layout: Layout, cell: tuple[int, int], color: str) -> Iterator[Shape]:
    """Yield the flag that marks an exit."""
    x, y = layout.corner(cell[0] + 0.5, cell[1] + 0.5)
    yield Ellipse(x - 8, y + 13, 9, 2.4, "#000000", 0.25)
    yield Path(polyline([(x - 8, y - 22), (x - 8, y + 13)]), stroke=color, width=3, cap="round")
    cloth: tuple[Command, ...] = (
        ("M", (x - 7, y - 21)),
        ("C", (x - 1, y - 25, x + 5, y - 16, x + 13, y - 19)),
        ("L", (x + 13, y - 4)),
        ("C", (x + 5, y - 1, x - 1, y - 10, x - 7, y - 6)),
        ("Z", ()),
    )
    yield Path(cloth, fill=color)


def _blocked(layout: Layout, blocked: bytes, fill: str) -> Iterator[Shape]:
    """Yield the blocked cells as blocks that stand a little above the ground."""
    columns = layout.columns
    blocks = [
        _cells(layout, (x, y), (width, height), fill)
        for x, y, width, height in rectangles(blocked, columns)
    ]
    if len(blocks) > 1:
        # As one shape: where two meet within a pixel, the ground would shine through.
        yield Path(tuple(step for block in blocks for step in _outline(block)), fill=fill)
    else:
        yield from blocks
    for y in range(layout.rows):
        row = blocked[y * columns : (y + 1) * columns]
        above = blocked[(y - 1) * columns : y * columns] if y else b"\1" * columns
        below = blocked[(y + 1) * columns : (y + 2) * columns] or b"\1" * columns
        for x, length in runs(here and not there for here, there in zip(row, above, strict=True)):
            left, top = layout.corner(x, y)
            yield Rect(left, top, length * CELL, _EDGE, "#ffffff", opacity=0.22)
        for x, length in runs(here and not there for here, there in zip(row, below, strict=True)):
            left, bottom = layout.corner(x, y + 1)
            yield Rect(left, bottom - _EDGE, length * CELL, _EDGE, "#000000", opacity=0.3)


def _outline(rect: Rect) -> tuple[Command, ...]:
    right, bottom = rect.x + rect.width, rect.y + rect.height
    return polygon([(rect.x, rect.y), (right, rect.y), (right, bottom), (rect.x, bottom)])


def _line_commands(layout: Layout, blocked: bytes) -> Iterator[Command]:
    """Yield the lines between free cells, inset so that their dashes meet evenly at corners."""
    inset = _DASH / 2 / CELL
    columns, rows = layout.columns, layout.rows
    for y in range(1, rows):
        above = blocked[(y - 1) * columns : y * columns]
        below = blocked[y * columns : (y + 1) * columns]
        for x, length in runs(not (a or b) for a, b in zip(above, below, strict=True)):
            yield from _line(layout, (x + inset, y), (x + length - inset, y))
    for x in range(1, columns):
        left, right = blocked[x - 1 :: columns], blocked[x::columns]
        for y, length in runs(not (a or b) for a, b in zip(left, right, strict=True)):
            yield from _line(layout, (x, y + inset), (x, y + length - inset))


def _line(
    layout: Layout, start: tuple[float, float], end: tuple[float, float]
) -> tuple[Command, ...]:
    return polyline([layout.corner(*start), layout.corner(*end)])
