"""The heat map of a picture: values as the colours of cells, values of actions as triangles.

A stronger colour is a higher number: darker on themes with dark walls, brighter on themes with
light ones. Lightness alone orders the colours of a sequential scale, and the two hues of a
diverging one, orange and blue, are told apart by people who are colour-blind. Themes of greys have
greys.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import groupby
from operator import itemgetter

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.looks import Colors
from babyrobot_levels.mdp.actions import DELTAS, MOVES
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import (
    BLACK,
    WHITE,
    contrast,
    is_gray,
    mixed,
    plate_for,
    rgba,
    rim_on,
)
from babyrobot_levels.render.scene.ground import CellGrounds, shore_shapes
from babyrobot_levels.render.scene.layout import (
    CAPTION_LEFT,
    CAPTION_LINE,
    CAPTION_SIZE,
    CELL,
    LEGEND,
    Layout,
    Overlay,
    caption_lines,
    each_cell,
)
from babyrobot_levels.render.scene.shapes import (
    Command,
    Path,
    Point,
    Rect,
    Shape,
    Text,
    polygon,
    polyline,
    rectangle,
    scaled,
)
from babyrobot_levels.render.scene.slots import Box, Slots
from babyrobot_levels.render.scene.texts import Form, form_of, number_shapes
from babyrobot_levels.render.scene.walls import casing_shapes

STEPS = 64
"""The number of steps of a scale: equal neighbours are painted as one."""

_NOISE = 1e-9
"""The share of the larger side up to which the other sign of a value is rounding."""


@dataclass(frozen=True, slots=True)
class Ramps:
    """The colours of the scales of a theme: stops from the lowest to the highest value.

    Attributes:
        sequential: for numbers of one sign.
        diverging: for numbers of both signs; zero is in the middle.
        below: for negative infinity.
        above: for positive infinity.
    """

    sequential: tuple[str, ...]
    diverging: tuple[str, ...]
    below: str
    above: str


_LIGHT = Ramps(
    ("#fffbd8", "#e3f2b8", "#b9e0b7", "#84cbbb", "#52b3c4", "#3496be"),
    ("#d9602c", "#eb9566", "#f7cbb0", "#f7f4ef", "#b7d3e9", "#73a9d4", "#3b80ba"),
    "#4d4d4d",
    "#ffffff",
)
_DARK = Ramps(
    ("#2c0f4a", "#3d2e74", "#39538b", "#2f708e", "#21918c"),
    ("#c07f16", "#8d5a10", "#573a12", "#242326", "#1c3d5c", "#24648f", "#3a8fc9"),
    "#000000",
    "#e8e8e8",
)
_LIGHT_GRAYS = Ramps(("#f4f4f4", "#8c8c8c"), ("#f4f4f4", "#8c8c8c"), "#4d4d4d", "#ffffff")
_DARK_GRAYS = Ramps(("#1f1f1f", "#868686"), ("#1f1f1f", "#868686"), "#000000", "#e8e8e8")


@dataclass(frozen=True, slots=True)
class Scale:
    """A scale of colours.

    Attributes:
        low: the lowest finite number; of counts, 0.
        high: the highest finite number.
        is_diverging: whether there are both signs: zero has the colour in the middle, and equal
            distances from it are equally strong.
        is_logarithmic: whether strength grows with the logarithm, so that the largest count does
            not make all others pale.
        stops: some of the colours from the lowest to the highest number, evenly between them.
        below: the colour of negative infinity.
        above: the colour of positive infinity.
    """

    low: float
    high: float
    is_diverging: bool
    is_logarithmic: bool
    stops: tuple[str, ...]
    below: str
    above: str

    @property
    def colors(self) -> tuple[str, ...]:
        """The colours from the lowest to the highest number, `STEPS + 1`, as `#rrggbb`."""
        return _ramp(self.stops)

    def color(self, value: float) -> str:
        """Return the colour of a number, as `#rrggbb`; one beyond an end has that end's."""
        if math.isinf(value):
            return self.above if value > 0 else self.below
        return self.colors[self.step(value)]

    def step(self, value: float) -> int:
        """Return the index of a finite number's colour."""
        return round(STEPS * min(max(self._share(value), 0.0), 1.0))

    def strip(self, count: int) -> list[str]:
        """Return the colours from the lowest to the highest number, in equal parts."""
        shares = ((index + 0.5) / count for index in range(count))
        if self.is_logarithmic:
            # Equal lengths are equal colours all the same.
            return [self.colors[round(STEPS * share)] for share in shares]
        return [self.color(self.low + share * (self.high - self.low)) for share in shares]

    def _share(self, value: float) -> float:
        """Return where a number is between the ends, 0 to 1."""
        if self.is_diverging:
            return 0.5 + 0.5 * value / max(-self.low, self.high)
        if self.is_logarithmic:
            return math.log1p(value) / (math.log1p(self.high) or 1.0)
        return (value - self.low) / (self.high - self.low) if self.high > self.low else 0.5


def scale_of(values: Iterable[float | None], colors: Colors) -> Scale:
    """Return the scale of values.

    Args:
        values: all values of a picture; None and infinite ones have no part in it.
        colors: the colours of the theme.
    """
    finite = [value for value in values if value is not None and math.isfinite(value)]
    low, high = min(finite, default=0.0), max(finite, default=0.0)
    ramps = ramps_of(colors)
    is_diverging = min(-low, high) > _NOISE * max(-low, high)
    stops = ramps.diverging if is_diverging else ramps.sequential
    return Scale(low, high, is_diverging, False, stops, ramps.below, ramps.above)


def count_scale(counts: Iterable[float | None], colors: Colors) -> Scale:
    """Return the logarithmic scale of counts, from 0; see `scale_of`."""
    most = max((count for count in counts if count is not None), default=0.0)
    ramps = ramps_of(colors)
    return Scale(0.0, most, False, True, ramps.sequential, ramps.below, ramps.above)


def ramps_of(colors: Colors) -> Ramps:
    """Return the colours of a theme's scales: light ones where walls are dark, and else dark."""
    is_light = contrast(colors.walls, WHITE) > contrast(colors.walls, BLACK)
    if is_gray(colors):
        return _LIGHT_GRAYS if is_light else _DARK_GRAYS
    return _LIGHT if is_light else _DARK


@lru_cache(maxsize=16)
def _ramp(stops: Sequence[str]) -> tuple[str, ...]:
    """Return the colours of a scale, evenly between its stops."""
    parts = len(stops) - 1
    channels = [rgba(stop)[:3] for stop in stops]
    ramp = []
    for step in range(STEPS + 1):
        index = min(int(step * parts / STEPS), parts - 1)
        share = step * parts / STEPS - index
        pairs = zip(channels[index], channels[index + 1], strict=True)
        mixed = (round(low + share * (high - low)) for low, high in pairs)
        ramp.append("#" + "".join(f"{channel:02x}" for channel in mixed))
    return tuple(ramp)


# -- the heat map ---------------------------------------------------------------------------------

_FRAME = 5.5
"""The width of the frame in the colour of the ground below a heat map, in pixels."""

_MOVES = {action.name[0]: action for action in MOVES}

_OVERLAP = 0.5
"""How far tiles reach under their neighbours: nothing shines through between them."""

BAR_STEPS = 24
"""The number of colours of the legend's bar."""

_BAR, _BAR_TOP = 9.0, 4.0
_HATCHES, _HATCH_OPACITY = 8, 0.32
_CROSS = 12.0
"""How many lines of hatching begin at a side of a cell, and how strong they are."""

_LONGEST_BAR, _LEGEND_MARGIN = 260.0, 11.0
_LEGEND_SIZE = 9.5


@dataclass(frozen=True)
class Heat:
    """The numbers of a picture as colours.

    Args:
        level: the level.
        layout: where its cells are.
        overlay: the numbers.
        slots: what stands where in its cells.
    """

    level: GridWorld
    layout: Layout
    overlay: Overlay
    slots: Slots

    @cached_property
    def values(self) -> dict[Cell, float]:
        """The values that are shown: of cells in which the robot can stand, and not 0 in ends."""
        slots, standing = self.slots, self.slots.acting | self.slots.ends
        return {
            cell: value
            for cell, value in each_cell(self.overlay.values, self.layout)
            if value is not None and (value or cell in slots.acting) and cell in standing
        }

    @cached_property
    def visits(self) -> dict[Cell, float]:
        """The counts that are shown."""
        return {cell: count for cell, count in each_cell(self.overlay.visits, self.layout) if count}

    @cached_property
    def action_values(self) -> dict[Cell, Sequence[float | None]]:
        """The values of actions that are shown."""
        return {
            cell: values
            for cell, values in each_cell(self.overlay.action_values, self.layout)
            if cell in self.slots.acting and any(value is not None for value in values)
        }

    @cached_property
    def scale(self) -> Scale:
        """The scale: of values, or of counts where no values are shown."""
        colors, overlay = self.level.resolved_theme.colors, self.overlay
        if overlay.values is None and overlay.action_values is None:
            return count_scale(self.visits.values(), colors)
        numbers: list[float | None] = [*(overlay.extent or ()), *self.values.values()]
        numbers += (value for values in self.action_values.values() for value in values[1:])
        return scale_of(numbers, colors)

    @cached_property
    def tiles(self) -> Mapping[Cell, str]:
        """The colours of the cells that have one."""
        numbers: Mapping[Cell, float] = {}
        if self.overlay.values is not None:
            numbers = self.values
        elif self.overlay.action_values is None:
            numbers = self.visits
        return {
            cell: self.scale.color(number)
            for cell, number in numbers.items()
            if cell not in self.action_values
        }

    def beside(self, cell: Cell, side: str) -> str:
        """Return the colour at a side `N`, `E`, `S` or `W` of a cell."""
        value = self.action_values[cell][_MOVES[side]] if cell in self.action_values else None
        if value is not None:
            return self.scale.color(value)
        return self.tiles.get(cell) or self._grounds[cell]

    def colors_of(self, cell: Cell) -> tuple[str, ...]:
        """Return the colours that a cell shows: one, or those from the north clockwise."""
        sides = _MOVES if cell in self.action_values else "N"
        return tuple(self.beside(cell, side) for side in sides)

    def _at_edge(self, cell: Cell, side: str) -> str:
        """Return the colour at an edge of a cell: that of its hatching or frame, if it has one."""
        own, (dx, dy) = self._grounds.own, DELTAS[_MOVES[side]]
        color = own.get(cell)
        if cell in self.overlay.never:
            ink = rim_on([self.level.resolved_theme.colors.base])
            return mixed(ink, self._grounds[cell], _HATCH_OPACITY)
        is_framed = color != own.get((cell[0] + dx, cell[1] + dy))
        return color if color is not None and is_framed else self.beside(cell, side)

    @cached_property
    def _grounds(self) -> CellGrounds:
        return CellGrounds(self.level)

    @property
    def shapes(self) -> Iterator[Shape]:
        """The tiles and triangles, what sets the level off from them, and the legend."""
        if not self.overlay.has_colors:
            if self.overlay.never:
                # Those of the ground lie below the hatching.
                yield from casing_shapes(self.level, self.layout, self._at_edge)
            return
        yield from _tiles(self.tiles, self.layout)
        yield from self._triangles()
        yield from self.edges
        if self.layout.legend:
            form = form_of((self.scale.low, self.scale.high), self.overlay.precision)
            yield from legend_shapes(self.level, self.layout, self.scale, form)

    @property
    def edges(self) -> Iterator[Shape]:
        """Frames in the colours of the grounds below, and what is below walls and puddles."""
        if self.tiles or self.action_values:
            yield from frame_shapes(self.level, {*self.tiles, *self.action_values}, self.layout)
        yield from casing_shapes(self.level, self.layout, self._at_edge)
        yield from shore_shapes(self.level, self.layout, self.slots, self.colors_of)

    def _triangles(self) -> Iterator[Shape]:
        parts: dict[str, list[Command]] = defaultdict(list)
        for cell, values in self.action_values.items():
            corners = [
                self.layout.corner(cell[0] + dx, cell[1] + dy)
                for dx, dy in ((0, 0), (1, 0), (1, 1), (0, 1))
            ]
            middle = self.layout.corner(cell[0] + 0.5, cell[1] + 0.5)
            for index, action in enumerate(MOVES):
                if (value := values[action]) is not None:
                    outer = corners[index], corners[(index + 1) % 4]
                    parts[self.scale.color(value)] += polygon([*outer, middle])
        for color, commands in parts.items():
            yield Path(tuple(commands), fill=color)
        diagonals: list[Command] = []
        for x, y in self.action_values:
            diagonals += polyline([self.layout.corner(x, y), self.layout.corner(x + 1, y + 1)])
            diagonals += polyline([self.layout.corner(x + 1, y), self.layout.corner(x, y + 1)])
        if diagonals:
            yield Path(tuple(diagonals), stroke=self.level.resolved_theme.colors.lines, width=0.8)


def legend_shapes(level: GridWorld, layout: Layout, scale: Scale, form: Form) -> Iterator[Shape]:
    """Yield the legend: a bar with the colours, the lowest and highest number, and zero between."""
    bar = legend_bar(layout)
    yield legend_plate(level, layout)
    for index, color in enumerate(scale.strip(BAR_STEPS)):
        x = index * bar.width / BAR_STEPS
        yield Rect(bar.left + x, bar.top, bar.width - x, bar.height, color)
    yield from legend_texts(level, layout, scale, form)


def legend_plate(level: GridWorld, layout: Layout) -> Rect:
    """Return the ground of the legend."""
    colors = level.resolved_theme.colors
    plate = plate_for(colors.text_fg, colors.text_bg)
    return Rect(0, layout.legend_top, layout.left_width, layout.legend, plate)


def legend_bar(layout: Layout) -> Box:
    """Return where the legend's bar is."""
    times = layout.times
    length = min(layout.left_width - 2 * _LEGEND_MARGIN * times, _LONGEST_BAR * times)
    left = (layout.left_width - length) / 2
    top = layout.legend_top + _BAR_TOP * times
    return Box(left, top, left + length, top + _BAR * times)


def legend_texts(level: GridWorld, layout: Layout, scale: Scale, form: Form) -> Iterator[Shape]:
    """Yield what is at the legend's bar: the ends, and zero between them."""
    top, times = layout.legend_top, layout.times
    form, ink = replace(form, size=_LEGEND_SIZE), level.resolved_theme.colors.text_fg
    yield from scaled(_legend(layout.left_width / times, top, scale, form, ink), times, 0, top)


def _legend(width: float, top: float, scale: Scale, form: Form, ink: str) -> Iterator[Shape]:
    length = min(width - 2 * _LEGEND_MARGIN, _LONGEST_BAR)
    left, bar, foot = (width - length) / 2, top + _BAR_TOP, top + LEGEND
    texts = Box(left, bar + _BAR, left + length, foot)
    if scale.low == scale.high:
        yield from number_shapes(scale.low, form, texts, ink, bold=False)
        return
    yield from number_shapes(scale.low, form, texts, ink, anchor="start", bold=False)
    yield from number_shapes(scale.high, form, texts, ink, anchor="end", bold=False)
    if scale.is_diverging:
        x = left - length * scale.low / (scale.high - scale.low)
        yield Rect(x - 0.5, bar - 1, 1, _BAR + 2, ink)
        low, high = (0.6 * form.size * len(form.text(end)) for end in (scale.low, scale.high))
        if left + low < x - 10 and x + 10 < left + length - high:
            zero = texts._replace(left=x - 10, right=x + 10)
            yield from number_shapes(0.0, Form(0, form.size), zero, ink, bold=False)


# -- what cannot occur -----------------------------------------------------------------------------


def never_shapes(level: GridWorld, overlay: Overlay, layout: Layout) -> Iterator[Shape]:
    """Yield the hatching of cells in which no robot can be, and the caption that tells it."""
    colors = level.resolved_theme.colors
    # A drawn exit is a tile on the ground, and would not stand out from lines around it.
    tiles = level.exits if level.exit_one_of is not None else ()
    cells = [layout.corner(*cell) for cell in sorted(overlay.never.difference(tiles))]
    if cells:
        step = CELL / max(2, round(_HATCHES / layout.times))
        yield _hatched(cells, CELL, step, colors.base)
    if not layout.caption:
        return
    top, times = layout.legend_top + layout.legend, layout.times
    plate = plate_for(colors.text_fg, colors.text_bg)
    yield Rect(0, top, layout.left_width, layout.caption, plate)
    if cells:
        yield _hatched([(9 * times, top + times)], 10 * times, 3 * times, plate, 0.9)
    left = (CAPTION_LEFT if cells else 9) * times
    for number, line in enumerate(caption_lines(overlay.words, layout), 1):
        y = top + times * (CAPTION_LINE * number - 2.5)
        yield Text(left, y, line, times * CAPTION_SIZE, colors.text_fg, "start")


def lost_shapes(heat: Heat) -> Iterator[Shape]:
    """Yield crosses on the cells from which a box can reach no target."""
    lines: dict[str, list[Command]] = defaultdict(list)
    near, far = _CROSS, CELL - _CROSS
    for cell in sorted(heat.overlay.lost):
        left, top = heat.layout.corner(*cell)
        for first, last in ((near, far), (far, near)):
            ends = [(left + first, top + near), (left + last, top + far)]
            lines[rim_on(heat.colors_of(cell))] += polyline(ends)
    for ink, commands in lines.items():
        yield Path(tuple(commands), stroke=ink, width=3.0, opacity=_HATCH_OPACITY, cap="round")


def _hatched(
    corners: Iterable[Point], side: float, step: float, ground: str, opacity: float = _HATCH_OPACITY
) -> Path:
    """Return diagonal lines in squares, which go on in neighbours."""
    lines: list[Command] = []
    for left, top in corners:
        for along in (step * count for count in range(1, round(2 * side / step))):
            near, far = max(0.0, along - side), min(along, side)
            lines += polyline([(left + near, top + far), (left + far, top + near)])
    return Path(tuple(lines), stroke=rim_on([ground]), width=step / 8, opacity=opacity)


def _tiles(tiles: Mapping[Cell, str], layout: Layout) -> Iterator[Shape]:
    """Yield tiles, equal neighbours as one: for each colour a shape."""
    growing: dict[tuple[int, int, str], int] = {}
    parts: dict[str, list[Command]] = defaultdict(list)

    def end(run: tuple[int, int, str], first: int, last: int) -> None:
        x, length, color = run
        (left, top), (right, foot) = layout.corner(x, first), layout.corner(x + length, last)
        right = right if x + length == layout.columns else right + _OVERLAP
        foot = foot if last == layout.rows else foot + _OVERLAP
        parts[color] += rectangle(left, top, right, foot)

    for y in range(layout.rows + 1):
        row = [(tiles.get((x, y)), x) for x in range(layout.columns)]
        found = set()
        for color, equal in groupby(row, itemgetter(0)):
            cells = [x for _, x in equal]
            if color is not None:
                found.add((cells[0], len(cells), color))
        for run in [run for run in growing if run not in found]:
            end(run, growing.pop(run), y)
        for run in sorted(found):
            growing.setdefault(run, y)
    for color, commands in parts.items():
        yield Path(tuple(commands), fill=color)


def frame_shapes(level: GridWorld, cells: AbstractSet[Cell], layout: Layout) -> Iterator[Shape]:
    """Yield frames inside the cells whose ground has a colour of its own."""
    grounds = CellGrounds(level).own
    parts: dict[str, list[Command]] = defaultdict(list)
    for x, y in sorted(cells & grounds.keys()):
        color, (left, top) = grounds[x, y], layout.corner(x, y)
        right, foot = left + CELL, top + CELL
        for dx, dy, corners in (
            (0, -1, (left, top, right, top + _FRAME)),
            (1, 0, (right - _FRAME, top, right, foot)),
            (0, 1, (left, foot - _FRAME, right, foot)),
            (-1, 0, (left, top, left + _FRAME, foot)),
        ):
            if grounds.get((x + dx, y + dy)) != color:
                parts[color] += rectangle(*corners)
    for color, commands in parts.items():
        yield Path(tuple(commands), fill=color)
