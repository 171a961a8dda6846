"""What of a picture stands out from what lies below it: contrasts by WCAG 2.2, from the pixels.

A scene is painted shape by shape. What is below a text is read before the text is painted; of a
figure, its outline is compared with what is beside it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy import ndimage  # type: ignore[import-untyped]

from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import GRAPHICS, TEXT, ink_on, rgba
from babyrobot_levels.render.raster import Painter
from babyrobot_levels.render.scene.build import arrow_lengths, arrow_shapes, build_scene
from babyrobot_levels.render.scene.ground import CellGrounds, flag_shapes, pad_shapes, puddle_shapes
from babyrobot_levels.render.scene.layout import CELL, COMPASS, Layout, Overlay, layout_of
from babyrobot_levels.render.scene.marks import mark_shapes, warp_shapes, wind_shapes
from babyrobot_levels.render.scene.panels import compass_shapes
from babyrobot_levels.render.scene.shapes import Rect, Scene, Shape, Text, toned
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.things import moving_pieces, pieces
from babyrobot_levels.render.scene.walls import casing_shapes, wall_shapes
from babyrobot_levels.render.situation import effects_of, situation_of

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_CHANNELS = np.array(
    [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in np.arange(256) / 255]
)
_WEIGHTS = np.array([0.2126, 0.7152, 0.0722])

_NOWHERE = "#010203"
"""A colour that no shape has."""

_ROUNDING = 0.03
"""How much a contrast may miss its bound, for colours are whole numbers."""

_CHARACTER = 0.5
"""The width of a character as a share of its size: rather too little, so that it is the text's."""

_REACH = 9
"""The pixels of a figure that count as its outline: rim and outline."""

_FAINT_PIXELS, _FAINT_SHARE = 20, 0.2
"""How much of an outline within a cell may be faint: where other figures touch it."""

_FAINT_TEXT = 0.1
"""The share of what is below a text that may be too much like it: lines that cross it."""


def faint_parts(level: Level, overlay: Overlay | None = None) -> list[tuple[str, float]]:
    """Return what of a level's picture does not stand out: what it is, and its contrast.

    Grid lines, the ground itself, robots and what is not held yet are left out.
    """
    layout = layout_of(level, overlay=overlay)
    scene = build_scene(level, overlay=overlay)
    colors = level.resolved_theme.colors
    roles: dict[Shape, str] = {
        shape: role
        for role, shapes in _figures(level, layout, overlay or Overlay())
        for shape in toned(shapes, colors)
        # The plates of texts.
        if not isinstance(shape, Rect | Text)
    }
    assert roles.keys() <= {*scene.shapes}
    return [*_faint(scene, roles, _counted(level, layout))]


def _figures(
    level: GridWorld, layout: Layout, overlay: Overlay
) -> Iterator[tuple[str, Iterable[Shape]]]:
    """Yield the shapes that tell something, by what they are."""
    slots = Slots(level, layout, overlay)
    colors, grounds = level.resolved_theme.colors, CellGrounds(level)
    yield "puddle", puddle_shapes(level, layout, slots)
    effects = effects_of(level)
    yield "wind", wind_shapes(effects.winds, slots, colors.arrows)
    yield "warp", warp_shapes(level, layout, slots, effects)
    yield "mark", mark_shapes(level, slots, effects)
    if not overlay.has_colors:
        yield "casing", casing_shapes(level, layout)
    yield "wall", wall_shapes(level, layout, slots)
    yield "compass", [*compass_shapes(level, layout)][1:]
    # An exit lies over the pad of one that begins there.
    for cell in sorted({*level.starts}.difference(level.exits)):
        # Around the pad itself is only a glow.
        yield "pad", [*pad_shapes(layout, cell, ink_on([grounds[cell]], colors.start_text))][1:]
    for cell in level.exits if level.exit_one_of is None else ():
        yield "flag", flag_shapes(layout, cell, ink_on([grounds[cell]], colors.exit_text))
    lengths = arrow_lengths(overlay.at(), slots, layout)
    yield "arrow", arrow_shapes(lengths, slots, layout, colors.arrows)
    situation = situation_of(level, None)
    crowded = overlay.fills_cells
    movers = moving_pieces(level, layout, situation, level.starts[0], crowded=crowded)
    for piece in (*pieces(level, layout, situation, slots), *(piece for _, piece in movers)):
        is_missing = piece.name[0] == "held" and not piece.name[-1]
        if not is_missing and piece.name[0] != "robot":
            yield " ".join(map(str, piece.name[:2])), piece.shapes


def _counted(level: GridWorld, layout: Layout) -> Bools:
    """Return the pixels beside which figures are seen: free cells, and the compass."""
    counted = np.zeros((round(layout.height), round(layout.width)), np.bool_)
    blocked, side = level.grid().blocked_cells, int(CELL)
    edge = int(layout.margin + level.resolved_theme.widths.border / 2) + 2
    for x, y in layout.cells():
        if not blocked[y * layout.columns + x]:
            left, top = map(int, layout.corner(x, y))
            counted[top : top + side, left : left + side] = True
    # The border needs no contrast: the picture ends there.
    inner = np.zeros_like(counted)
    inner[
        edge : int(layout.grid_height + 2 * layout.margin) - edge,
        edge : int(layout.left_width) - edge,
    ] = True
    counted &= inner
    counted[8 : int(COMPASS) - 8, int(layout.left_width) + 8 :] = True
    return counted


def _faint(scene: Scene, roles: Mapping[Shape, str], counted: Bools) -> Iterator[tuple[str, float]]:
    """Yield what does not stand out; consecutive shapes of one role are one figure."""
    image = _sheet(scene, "#ffffff")
    painter = Painter(image, scene, 1)
    for role, shapes in groupby(scene.shapes, lambda shape: roles.get(shape, "")):
        figure, before = tuple(shapes), image.copy() if role else None
        for shape in figure:
            if isinstance(shape, Text):
                yield from _faint_text(image, shape)
            painter.paint(shape)
        # A wall has to stand out from its casing, where it has one.
        if before is not None and role != "casing":
            yield from _faint_outline(role, _outline(scene, figure), before, image, counted)


def _sheet(scene: Scene, color: str) -> Image.Image:
    return Image.new("RGB", (round(scene.width), round(scene.height)), rgba(color)[:3])


def _outline(scene: Scene, figure: Iterable[Shape]) -> Bools:
    """Return the pixels of a figure, whatever is below it."""
    sheet = _sheet(scene, _NOWHERE)
    bare, painter = np.asarray(sheet).copy(), Painter(sheet, scene, 1)
    for shape in figure:
        painter.paint(shape)
    inside: Bools = (np.asarray(sheet) != bare).any(axis=2)
    return inside


def _faint_text(image: Image.Image, text: Text) -> Iterator[tuple[str, float]]:
    width = _CHARACTER * text.size * len(text.text)
    left = text.x - {"start": 0, "middle": width / 2, "end": width}[text.anchor]
    below = np.asarray(image)[
        max(0, round(text.y - 0.72 * text.size)) : round(text.y),
        max(0, round(left)) : round(left + width),
    ]
    *front, alpha = rgba(text.fill)
    alpha *= text.opacity
    ink = np.rint(alpha * np.array(front) + (1 - alpha) * below).astype(np.uint8)
    ratios = _ratios(_of(ink), _of(below))
    worst = float(np.quantile(ratios, _FAINT_TEXT))
    if worst < TEXT - _ROUNDING:
        yield f"text {text.text!r}", worst


def _faint_outline(
    role: str, inside: Bools, before: Image.Image, after: Image.Image, counted: Bools
) -> Iterator[tuple[str, float]]:
    """Yield the cells in which too much of a figure's outline is like what is beside it."""
    rows, columns = (
        slice(max(0, int(places.min(initial=0)) - _REACH), int(places.max(initial=0)) + _REACH)
        for places in np.nonzero(inside)
    )
    inside, counted = inside[rows, columns], counted[rows, columns]
    below, above = (_of(np.asarray(image)[rows, columns]) for image in (before, after))
    outside = ndimage.binary_dilation(inside) & ~inside & counted
    light = ndimage.maximum_filter(np.where(inside, above, -1.0), _REACH)
    dark = ndimage.minimum_filter(np.where(inside, above, 2.0), _REACH)
    ratios = np.maximum(_ratios(light, below), _ratios(dark, below))
    ys, xs = np.nonzero(outside)
    cells = np.stack([(xs + columns.start) // int(CELL), (ys + rows.start) // int(CELL)])
    for x, y in sorted({*zip(*cells.tolist(), strict=True)}):
        here = ratios[ys, xs][(cells[0] == x) & (cells[1] == y)]
        faint = here[here < GRAPHICS - _ROUNDING]
        if len(faint) >= _FAINT_PIXELS and len(faint) > _FAINT_SHARE * len(here):
            yield f"{role} at {x}, {y}", float(np.median(faint))


def _of(pixels: NDArray[np.uint8]) -> Floats:
    luminance: Floats = _CHANNELS[pixels] @ _WEIGHTS
    return luminance


def _ratios(one: Floats, other: Floats) -> Floats:
    return (np.maximum(one, other) + 0.05) / (np.minimum(one, other) + 0.05)
