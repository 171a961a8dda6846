"""Walls: those of the maze and of the level, glass walls, and the border of the grid."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from babyrobot_levels.language.cells import sides_of
from babyrobot_levels.language.drawing import consecutive
from babyrobot_levels.mdp.grid import BIT, Grid
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import GRAPHICS, contrast, rim_on
from babyrobot_levels.render.scene.ground import CellGrounds
from babyrobot_levels.render.scene.icons import INK, RIM
from babyrobot_levels.render.scene.layout import CHARACTER_WIDTH, Layout
from babyrobot_levels.render.scene.shapes import Command, Path, Rect, Shape, Text, polyline
from babyrobot_levels.render.scene.slots import Slots

GLASS = "#8fd0f5"
_GLASS_CORE = "#f4fbff"
_GLASS_EXTRA = 4.0
"""How much wider than others a glass wall is, in pixels."""

_GLASS_DASHES = (None, (13.0, 3.0), (5.0, 6.0))
"""The dashes of glass that lets the robot through seldom, as often as not, and mostly."""

_NUMBER_SIZE, _NUMBER_HEIGHT = 8.5, 11.0
"""The font size of the number on a glass wall, and the height of its ground."""

_CASING = 1.5
"""How far the casing of a wall is seen on both of its sides, in pixels."""

Edge = tuple[bool, int, int]
"""A side of a cell: whether it is vertical, and the corner `(x, y)` of the grid where it begins."""


@dataclass(frozen=True, slots=True)
class _Style:
    """The look of a wall; `fit` ends it at its corners instead of rounding it off beyond them."""

    color: str
    width: float
    fit: bool = False
    rim: str = ""
    """The colour of the two edges of a glass wall; empty for a solid one."""
    dash: tuple[float, float] | None = None

    @property
    def outline(self) -> str:
        """The colour at its sides."""
        return self.rim or self.color

    @property
    def cap(self) -> Literal["butt", "round"]:
        """How its ends look."""
        return "butt" if self.fit or self.rim else "round"


Beside = Callable[[tuple[int, int], str], str]
"""Returns the colour of the ground in a cell, at one of its sides `N`, `E`, `S` and `W`."""


def wall_shapes(level: GridWorld, layout: Layout, slots: Slots) -> Iterator[Shape]:
    """Yield the walls, those of one style together: glass below, solid walls, then the border.

    Walls with a colour or width of their own are painted on top of the others. Glass has the more
    gaps, the more often it lets the robot through, and says how often; the number gives way to
    values of actions.

    Args:
        level: the level.
        layout: where its cells are.
        slots: what stands in them.
    """
    inner, outer = _styles(level, layout)
    for styles, lowest in zip((inner, outer), _lowest(level), strict=True):
        drawn: dict[_Style, list[Edge]] = {style: [] for style in lowest}
        for edge, style in styles.items():
            drawn.setdefault(style, []).append(edge)
        for style, edges in drawn.items():
            if style.width > 0:
                yield from _strokes(layout, style, edges)
    if not slots.shown.actions:
        shown = {edge for edge, style in inner.items() if style.width > 0}
        chances = _inner_edges(level.grid())
        yield from _numbers(layout, {edge: chance for edge, chance in chances if edge in shown})


def casing_shapes(
    level: GridWorld, layout: Layout, beside: Beside | None = None
) -> Iterator[Shape]:
    """Yield the rims, black or white, of walls between cells that are like the ground there.

    They lie on the ground, below all walls: a heat map covers them, and has its own. The border has
    none, as the picture ends there.

    Args:
        level: the level.
        layout: where its cells are.
        beside: returns the colours beside walls; by default, those of the level's ground.
    """
    blocked, grounds = level.grid().blocked_cells, CellGrounds(level)
    drawn: dict[_Style, list[Edge]] = {}
    for edge, style in _styles(level, layout)[0].items():
        down, x, y = edge
        is_faint = any(
            contrast(style.outline, beside(cell, name) if beside else grounds[cell]) < GRAPHICS
            for cell, name in (
                ((x - down, y - (not down)), "E" if down else "S"),
                ((x, y), "W" if down else "N"),
            )
            if not blocked[cell[1] * layout.columns + cell[0]]
        )
        if is_faint and style.width > 0:
            drawn.setdefault(style, []).append(edge)
    for style, edges in drawn.items():
        commands, width = tuple(_within_border(layout, edges)), style.width + 2 * _CASING
        rim = rim_on([style.outline])
        yield Path(commands, stroke=rim, width=width, dash=style.dash, cap=style.cap)


def _within_border(layout: Layout, edges: list[Edge]) -> Iterator[Command]:
    """Yield the lines of edges, whose rims are not seen outside of the border."""
    least = layout.margin + _CASING
    right, foot = (least + side - 2 * _CASING for side in (layout.grid_width, layout.grid_height))
    for name, (x, y) in _commands(layout, edges):
        yield name, (min(max(x, least), right), min(max(y, least), foot))


def _lowest(level: GridWorld) -> tuple[tuple[_Style, ...], tuple[_Style]]:
    """Return the styles of walls without looks of their own: inside, from the bottom, and outer."""
    colors, widths = level.resolved_theme.colors, level.resolved_theme.widths
    glass = (
        _Style(GLASS, widths.walls + _GLASS_EXTRA, rim=colors.walls, dash=dash)
        for dash in _GLASS_DASHES
    )
    return (*glass, _Style(colors.walls, widths.walls)), (_Style(colors.border, widths.border),)


def _styles(level: GridWorld, layout: Layout) -> tuple[dict[Edge, _Style], dict[Edge, _Style]]:
    """Return the styles of the walls between cells, and of those around them."""
    (*glass, solid), (border,) = _lowest(level)
    inner = {
        edge: glass[min(int(3 * chance), 2)] if chance else solid
        for edge, chance in _inner_edges(level.grid())
    }
    outer = dict.fromkeys(_outer_edges(layout), border)
    for edge, style in _own_styles(level, inner | outer).items():
        (inner if edge in inner else outer)[edge] = style
    return inner, outer


def _inner_edges(grid: Grid) -> Iterator[tuple[Edge, float]]:
    """Yield the walls between two cells, and the chance to get through; above 0 it is glass."""
    for cell, walls in enumerate(grid.wall_bits):
        y, x = divmod(cell, grid.width)
        if walls & BIT["E"] and x < grid.width - 1:
            yield (True, x + 1, y), grid.glass.get((cell, "E"), 0.0)
        if walls & BIT["S"] and y < grid.height - 1:
            yield (False, x, y + 1), grid.glass.get((cell, "S"), 0.0)


def _outer_edges(layout: Layout) -> Iterator[Edge]:
    for x in range(layout.columns):
        yield False, x, 0
        yield False, x, layout.rows
    for y in range(layout.rows):
        yield True, 0, y
        yield True, layout.columns, y


def _own_styles(level: GridWorld, place: dict[Edge, _Style]) -> dict[Edge, _Style]:
    """Return the styles of those walls that the level gives looks of their own."""
    own: dict[Edge, _Style] = {}
    for wall in level.walls:
        if wall.color is None and wall.width is None and not wall.fit:
            continue
        for x, y in sides_of(wall):
            edge = wall.side in ("E", "W"), x + (wall.side == "E"), y + (wall.side == "S")
            # An opening may have removed the wall.
            if edge in place:
                style = own.get(edge, place[edge])
                own[edge] = replace(
                    style,
                    color=style.color if wall.color is None else wall.color,
                    width=style.width if wall.width is None else wall.width,
                    fit=style.fit or wall.fit,
                )
    return own


def _strokes(layout: Layout, style: _Style, edges: list[Edge]) -> Iterator[Shape]:
    commands = tuple(_commands(layout, edges))
    if not commands:
        return
    if style.rim:
        # Two edges with light between them, like windows on floor plans.
        for color, width in ((style.rim, 1.0), (style.color, 0.7), (_GLASS_CORE, 0.25)):
            yield Path(commands, stroke=color, width=width * style.width, dash=style.dash)
    else:
        yield Path(commands, stroke=style.color, width=style.width, cap=style.cap)


def _numbers(layout: Layout, chances: dict[Edge, float]) -> Iterator[Shape]:
    """Yield the chance to get through glass, once in the middle of each stretch of one chance."""
    stretches: dict[float, list[Edge]] = {}
    for edge, chance in chances.items():
        if chance:
            stretches.setdefault(chance, []).append(edge)
    for chance, edges in stretches.items():
        text = _percent(chance)
        width = (len(text) + 1.2) * _NUMBER_SIZE * CHARACTER_WIDTH
        for line in _lines(edges):
            is_upright, x, y = line[(len(line) - 1) // 2]
            middle, centre = layout.corner(x + 0.5 * (not is_upright), y + 0.5 * is_upright)
            for fill, rim in ((INK, 1.2), (RIM, 0.0)):
                left, height = middle - width / 2 - rim, _NUMBER_HEIGHT + 2 * rim
                top = centre - height / 2
                yield Rect(left, top, width + 2 * rim, height, fill, radius=height / 2)
            yield Text(middle, centre + 0.36 * _NUMBER_SIZE, text, _NUMBER_SIZE, INK, bold=True)


def _percent(chance: float) -> str:
    text = f"{100 * chance:.0f}%"
    if text == "0%":
        return "<1%"
    return ">99%" if text == "100%" and chance < 1 else text


def _commands(layout: Layout, edges: list[Edge]) -> Iterator[Command]:
    """Yield one line for all edges that follow each other."""
    for line in _lines(edges):
        (down, first_x, first_y), (_, last_x, last_y) = line[0], line[-1]
        end = (last_x, last_y + 1) if down else (last_x + 1, last_y)
        yield from polyline([layout.corner(first_x, first_y), layout.corner(*end)])


def _lines(edges: list[Edge]) -> Iterator[Sequence[Edge]]:
    """Yield the edges that follow each other."""

    def position(edge: Edge) -> tuple[tuple[bool, int], int]:
        is_upright, x, y = edge
        return ((True, x), y) if is_upright else ((False, y), x)

    yield from consecutive(sorted(edges, key=position), position)
