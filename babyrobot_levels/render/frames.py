"""Frames of one level, fast: what stays is painted once, and the rest composited on a copy."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from babyrobot_levels.render.raster import composite, to_rgb, translucent
from babyrobot_levels.render.scene.build import build_layers
from babyrobot_levels.render.scene.layout import CELL, Layout, layout_of
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.overlay_shapes import overlay_shapes
from babyrobot_levels.render.scene.pose import STANDING, Pose
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene, shifted
from babyrobot_levels.render.scene.situation import Cell, Situation, place_of, situation_of
from babyrobot_levels.render.scene.things import Piece, moving_pieces, pieces

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.raster import Translucent

    _Patch = tuple[slice, slice, NDArray[np.uint8]]
    _Sprite = tuple[slice, slice, Translucent]

MAX_FRAME_SIDE = 2048
"""The largest width and height of a frame without a given size."""

IMAGE_CELL = 16
"""The default side of a cell in image observations, in pixels."""

MIN_IMAGE_SIDE = 36
"""The smallest picture that common convolutional networks accept."""

MAX_IMAGE_SIDE = 1024

_GRAY = (0.299, 0.587, 0.114)
"""The brightness of red, green and blue (ITU-R BT.601)."""

_POSES = 64
"""The number of poses that are cached."""

_PATCH_BYTES = 8 * 1024 * 1024
"""The memory for cached cells."""

_PIECES = 1024
"""The number of pieces that are cached: each a thing in one of its places or values."""

_GROUND_BYTES = 32 * 1024 * 1024
"""The memory for cached configurations."""

_AtHand = tuple[int | None, int | None]
"""The configuration and heading of an overlay that depends on them."""

_Key = TypeVar("_Key", bound=Hashable)
_Value = TypeVar("_Value")


@dataclass(frozen=True, slots=True)
class _Ground:
    """A configuration without the robot and movers: with and without what is above them."""

    below: NDArray[np.uint8]
    whole: NDArray[np.uint8]
    above: Translucent | None


class FramePainter:
    """Paints frames of a level, one for each state and pose of the robot.

    The level is painted once. What lies, stands open or is held is laid on it, once for each
    configuration in which these differ. A frame is a copy of that with patches on it: the cells of
    the robot and of movers. The most recent of all these are cached.

    Args:
        level: the level; a maze needs a seed.
        size: width and height in pixels, to which the cells alone are stretched, without panels
            and margin: what an agent should see. In a level with items, a row below the cells shows
            what is held. None gives the whole picture at 64 pixels a cell; fewer for large levels,
            so that no side exceeds 2,048 pixels.
        grayscale: whether frames have one channel instead of three.
        overlay: values, arrows and texts shown over the cells and in the panels.

    Attributes:
        width: the width of a frame in pixels.
        height: its height in pixels.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: the size is not positive or too large, or the overlay has another size than
            the level.
    """

    def __init__(
        self,
        level: GridWorld,
        size: tuple[int, int] | None = None,
        grayscale: bool = False,
        overlay: Overlay | None = None,
    ) -> None:
        cells_only = size is not None
        layout = layout_of(level, cells_only=cells_only, overlay=overlay)
        self.width, self.height = size or _whole_size(layout)
        self._level, self._layout, self._grayscale = level, layout, grayscale
        self._overlay = overlay
        layers = build_layers(level, robot=False, cells_only=cells_only, overlay=overlay)
        self._still = [layers["base"], layers["grid"]]
        self._bare: NDArray[np.uint8] | None = None
        self._scale = self.width / layout.width, self.height / layout.height
        self._left = _offsets(layout.margin, layout.columns, self._scale[0])
        self._top = _offsets(layout.margin, layout.rows, self._scale[1])
        self._cell = max(1, round(self._scale[0] * CELL)), max(1, round(self._scale[1] * CELL))
        self._robots: dict[Pose, Translucent] = {}
        self._pieces: dict[Hashable, _Sprite] = {}
        self._overlays: dict[_AtHand, tuple[Scene, Translucent]] = {}
        self._grounds: dict[Hashable, _Ground] = {}
        self._patches: dict[tuple[int, Pose], tuple[Hashable, list[_Patch]]] = {}
        self._limit = max(16, _PATCH_BYTES // (3 * self._cell[0] * self._cell[1]))
        self._most_grounds = max(4, _GROUND_BYTES // (6 * self.width * self.height))

    def frame(
        self, state: int, pose: Pose = STANDING, heading: int | None = None
    ) -> NDArray[np.uint8]:
        """Return the picture with the robot in a state: a fresh array, `[height, width, channels]`.

        Args:
            state: the configuration and the cell, `configuration * cells + y * width + x`, as in
                `level.compile()`.
            pose: the robot's pose.
            heading: where a robot that turns looks, 0 N, 1 E, 2 S, 3 W.

        Raises:
            ValueError: the level has no such state.
        """
        pose = pose if heading is None else pose.turned(heading)
        name, patches = self._patches.get((state, pose)) or self._patched(state, pose)
        ground = self._grounds.get(name)
        if ground is None:
            ground = self._ground(place_of(self._level, state).configuration, pose.heading)[1]
        frame = ground.whole.copy()
        for rows, columns, pixels in patches:
            frame[rows, columns] = pixels
        return frame

    def _patched(self, state: int, pose: Pose) -> tuple[Hashable, list[_Patch]]:
        """Paint the cells of the robot and of movers, and cache them."""
        level, place = self._level, place_of(self._level, state)
        name, ground = self._ground(place.configuration, pose.heading)
        situation = situation_of(level, place.configuration)
        figures: dict[Cell, list[_Sprite]] = {place.cell: [self._robot(place.cell, pose)]}
        for cell, piece in moving_pieces(level, self._layout, situation, place.cell):
            figures.setdefault(cell, []).append(self._sprite(piece))
        patches = [_patch(ground, sprites) for sprites in figures.values()]
        _remember(self._patches, (state, pose), (name, patches), self._limit)
        return name, patches

    def _robot(self, cell: Cell, pose: Pose) -> _Sprite:
        image = self._robots.get(pose)
        if image is None:
            shapes = robot_shapes(self._level.resolved_theme, 0.0, 0.0, pose)
            image = self._translucent([Scene(CELL, CELL, shapes)], self._cell)
            _remember(self._robots, pose, image, _POSES)
        left, top = self._left[cell[0]], self._top[cell[1]]
        return slice(top, top + self._cell[1]), slice(left, left + self._cell[0]), image

    # -- configurations --------------------------------------------------------------------------

    def _ground(self, configuration: int, heading: int | None) -> tuple[Hashable, _Ground]:
        """Return the picture of a configuration without the robot and movers, and its name."""
        situation, overlay = situation_of(self._level, configuration), self._overlay
        at_hand: _AtHand = (None, None)
        if overlay is not None and overlay.parts is not None:
            at_hand = configuration, heading
        name = situation.standing, at_hand
        ground = self._grounds.get(name)
        if ground is not None:
            return name, ground
        under, above = (None, None) if overlay is None else self._painted_overlay(overlay, at_hand)
        if self._level.has_things:
            below = self._with_things(situation)
            if under is not None:
                image = self._translucent([under], (self.width, self.height))
                below = composite(image, below)
        else:
            below = self._painted([*self._still, *([] if under is None else [under])])
        ground = _Ground(below, below if above is None else composite(above, below), above)
        _remember(self._grounds, name, ground, self._most_grounds)
        return name, ground

    def _with_things(self, situation: Situation) -> NDArray[np.uint8]:
        if self._bare is None:
            self._bare = self._painted(self._still)
        picture = self._bare.copy()
        for piece in pieces(self._level, self._layout, situation):
            rows, columns, image = self._sprite(piece)
            picture[rows, columns] = composite(image, picture[rows, columns])
        return picture

    def _painted_overlay(self, overlay: Overlay, at_hand: _AtHand) -> tuple[Scene, Translucent]:
        """Return what of the overlay is below the robot, and what is above it."""
        found = self._overlays.get(at_hand)
        if found is None:
            layers = overlay_shapes(self._level, overlay.at(*at_hand), self._layout)
            whole = self._layout.width, self._layout.height
            texts = Scene(*whole, (*layers.overlay, *layers.text))
            above = self._translucent([texts], (self.width, self.height))
            found = Scene(*whole, layers.underlay), above
            _remember(self._overlays, at_hand, found, self._most_grounds)
        return found

    def _sprite(self, piece: Piece) -> _Sprite:
        """Return the pixels in which a piece is, and its picture there."""
        found = self._pieces.get(piece.name)
        if found is None:
            (scale_x, scale_y), (left, top, right, bottom) = self._scale, piece.box
            x, y = max(0, math.floor(left * scale_x)), max(0, math.floor(top * scale_y))
            width = min(self.width, math.ceil(right * scale_x)) - x
            height = min(self.height, math.ceil(bottom * scale_y)) - y
            shapes = tuple(shifted(piece.shapes, -x / scale_x, -y / scale_y))
            scene = Scene(width / scale_x, height / scale_y, shapes)
            image = self._translucent([scene], (width, height))
            found = slice(y, y + height), slice(x, x + width), image
            _remember(self._pieces, piece.name, found, _PIECES)
        return found

    # -- pixels ----------------------------------------------------------------------------------

    def _painted(
        self, scenes: list[Scene], size: tuple[int, int] | None = None, ground: str = "white"
    ) -> NDArray[np.uint8]:
        shapes = tuple(shape for scene in scenes for shape in scene.shapes)
        pixels = to_rgb(
            replace(scenes[0], shapes=shapes), size or (self.width, self.height), ground
        )
        return _gray(pixels) if self._grayscale else pixels

    def _translucent(self, scenes: list[Scene], size: tuple[int, int]) -> Translucent:
        return translucent(lambda ground: self._painted(scenes, size, ground))


def _patch(ground: _Ground, sprites: Sequence[_Sprite]) -> _Patch:
    """Lay pictures on a part of a ground, one over the other, below what is above them."""
    top, bottom = min(y.start for y, _, _ in sprites), max(y.stop for y, _, _ in sprites)
    left, right = min(x.start for _, x, _ in sprites), max(x.stop for _, x, _ in sprites)
    rows, columns = slice(top, bottom), slice(left, right)
    pixels = ground.below[rows, columns].copy()
    for y, x, image in sprites:
        part = slice(y.start - top, y.stop - top), slice(x.start - left, x.stop - left)
        pixels[part] = composite(image, pixels[part])
    if ground.above is not None:
        ink, through = ground.above
        pixels = composite((ink[rows, columns], through[rows, columns]), pixels)
    return rows, columns, pixels


def _remember(cache: dict[_Key, _Value], key: _Key, value: _Value, limit: int) -> None:
    """Add an entry to a cache; a full cache drops its oldest entry."""
    if len(cache) >= limit:
        del cache[next(iter(cache))]
    cache[key] = value


def default_image_size(width: int, height: int) -> tuple[int, int]:
    """Return height and width in pixels of image observations of a level.

    Cells are squares of 16 pixels: more if a side would be below 36 pixels, fewer if one would
    exceed 1,024. Where a level is too narrow for both, the cells are stretched.

    Args:
        width: the number of columns of cells.
        height: the number of rows of cells.
    """
    cell = max(IMAGE_CELL, math.ceil(MIN_IMAGE_SIDE / min(width, height)))
    cell = min(cell, MAX_IMAGE_SIDE // max(width, height))
    return max(MIN_IMAGE_SIDE, height * cell), max(MIN_IMAGE_SIDE, width * cell)


def _whole_size(layout: Layout) -> tuple[int, int]:
    scale = min(1.0, (MAX_FRAME_SIDE + 0.5) / max(layout.width, layout.height))
    if scale < 1:
        # Cells of whole pixels, at least one.
        scale = max(1, math.floor(scale * CELL)) / CELL
    return round(scale * layout.width), round(scale * layout.height)


def _offsets(margin: float, count: int, scale: float) -> list[int]:
    """Return the pixel at which each column (or row) of cells begins."""
    return [round((margin + index * CELL) * scale) for index in range(count)]


def _gray(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    brightness: NDArray[np.float64] = np.rint(pixels @ np.array(_GRAY))
    return brightness[..., np.newaxis].astype(np.uint8)
