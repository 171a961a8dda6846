"""Frames of one level, fast: what stays is painted once, and the rest composited on a copy."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.raster import composite, to_rgb, translucent
from babyrobot_levels.render.scene.build import build_layers, overlay_shapes
from babyrobot_levels.render.scene.layout import CELL, STRIP, AtHand, Layout, Overlay, layout_of
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene, shifted, toned
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.things import Piece, moving_pieces, pieces
from babyrobot_levels.render.situation import STANDING, Pose, Situation, place_of, situation_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from babyrobot_levels.render.raster import Translucent

    Patch = tuple[slice, slice, NDArray[np.uint8]]
    """Rows, columns, and the pixels that are there."""

    Sprite = tuple[slice, slice, Translucent]
    """Rows, columns, and the picture that is laid there."""

_GRAY = (0.299, 0.587, 0.114)
"""The brightness of red, green and blue (ITU-R BT.601)."""

_SPRITES = 1024
"""The number of sprites that are cached: each a thing in one of its places or values."""

_BYTES = 32 * 1024 * 1024
"""The memory for cached grounds."""

_Key = TypeVar("_Key", bound=Hashable)
_Value = TypeVar("_Value")


@dataclass(frozen=True, slots=True)
class Backdrop:
    """A configuration without the robot and movers.

    Attributes:
        name: configurations whose grounds look the same have the same.
        below: what is below the robot.
        above: what of the overlay is above it.
        whole: the two of them.
    """

    name: Hashable
    below: NDArray[np.uint8]
    above: Translucent | None
    whole: NDArray[np.uint8]

    def patch(self, sprites: Sequence[Sprite]) -> Patch:
        """Lay sprites on a part of the ground, one over the other, below what is above them."""
        top, bottom = min(y.start for y, _, _ in sprites), max(y.stop for y, _, _ in sprites)
        left, right = min(x.start for _, x, _ in sprites), max(x.stop for _, x, _ in sprites)
        rows, columns = slice(top, bottom), slice(left, right)
        pixels = self.below[rows, columns].copy()
        for y, x, image in sprites:
            part = slice(y.start - top, y.stop - top), slice(x.start - left, x.stop - left)
            pixels[part] = composite(image, pixels[part])
        if self.above is not None:
            ink, through = self.above
            pixels = composite((ink[rows, columns], through[rows, columns]), pixels)
        return rows, columns, pixels


class Backdrops:
    """Paints the configurations of a level, and sprites to lay on them.

    The level is painted once, and what lies, stands open or is held laid on copies of it. The most
    recent grounds and sprites are cached.

    Args:
        level: the level; a maze needs a seed.
        layout: the parts of the picture.
        size: its width and height in pixels.
        cells_only: whether the margin, the panels and the compass are left out.
        grayscale: whether there is one channel instead of three.
        overlay: values, arrows and texts shown over the cells and in the panels.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: the size is not positive or too large, or the overlay has another size than
            the level.
    """

    def __init__(
        self,
        level: GridWorld,
        layout: Layout,
        size: tuple[int, int],
        *,
        cells_only: bool = False,
        grayscale: bool = False,
        overlay: Overlay | None = None,
    ) -> None:
        self._level, self._layout, self._grayscale = level, layout, grayscale
        self._overlay, self.size = overlay, size
        self.scale = size[0] / layout.width, size[1] / layout.height
        layers = build_layers(
            level, robot=False, cells_only=cells_only, overlay=overlay, layout=layout
        )
        self._slots = Slots(level, layout, overlay or Overlay())
        self._base, self._grid = layers["base"], layers["grid"]
        self._bare: dict[AtHand | None, NDArray[np.uint8]] = {}
        self._sprites: dict[Hashable, Sprite] = {}
        self._overlays: dict[AtHand, tuple[Scene, Scene, Translucent]] = {}
        self._grounds: dict[Hashable, Backdrop] = {}
        self._limit = max(4, _BYTES // (6 * size[0] * size[1]))

    def named(self, name: Hashable) -> Backdrop | None:
        """Return a ground by its name, None if it is not cached any more."""
        return self._grounds.get(name)

    def at(self, configuration: int, heading: int | None = None) -> Backdrop:
        """Return the ground of a configuration, by its number.

        Args:
            configuration: the number of the configuration.
            heading: that of a robot that turns, for an overlay that depends on it.
        """
        situation, overlay = situation_of(self._level, configuration), self._overlay
        at_hand: AtHand = (None, None)
        if overlay is not None and overlay.parts is not None:
            at_hand = configuration, heading
        name = situation.standing, at_hand
        ground = self._grounds.get(name)
        if ground is None:
            ground = self._painted_ground(name, situation, at_hand)
            remember(self._grounds, name, ground, self._limit)
        return ground

    def _painted_ground(self, name: Hashable, situation: Situation, at_hand: AtHand) -> Backdrop:
        heat, under, above = self._painted_overlay(at_hand)
        if self._level.has_things:
            below = self._with_things(situation, heat, at_hand)
            if under.shapes:
                below = composite(self.translucent(under, self.size), below)
        else:
            below = self._painted(_joined(self._base, heat, self._grid, under), self.size)
        return Backdrop(name, below, above, below if above is None else composite(above, below))

    def _with_things(self, situation: Situation, heat: Scene, at_hand: AtHand) -> NDArray[np.uint8]:
        key = at_hand if heat.shapes else None
        bare = self._bare.get(key)
        if bare is None:
            bare = self._painted(_joined(self._base, heat, self._grid), self.size)
            remember(self._bare, key, bare, self._limit)
        picture = bare.copy()
        for piece in pieces(self._level, self._layout, situation, self._slots):
            rows, columns, image = self.sprite(piece)
            picture[rows, columns] = composite(image, picture[rows, columns])
        return picture

    def _painted_overlay(self, at_hand: AtHand) -> tuple[Scene, Scene, Translucent | None]:
        """Return the heat map, what else of the overlay is below the robot, and what is above."""
        whole = self._layout.width, self._layout.height
        if self._overlay is None:
            return Scene(*whole, ()), Scene(*whole, ()), None
        found = self._overlays.get(at_hand)
        if found is None:
            part = self._overlay.at(*at_hand)
            layers = overlay_shapes(self._level, part, self._layout, self._slots)
            texts = Scene(*whole, (*layers.overlay, *layers.text))
            heat, under = Scene(*whole, layers.heat), Scene(*whole, layers.underlay)
            found = heat, under, self.translucent(texts, self.size)
            remember(self._overlays, at_hand, found, self._limit)
        return found

    def sprite(self, piece: Piece) -> Sprite:
        """Return the picture of a piece, and the pixels in which it is."""
        found = self._sprites.get(piece.name)
        if found is None:
            (scale_x, scale_y), (left, top, right, bottom) = self.scale, piece.box
            x, y = max(0, math.floor(left * scale_x)), max(0, math.floor(top * scale_y))
            width = min(self.size[0], math.ceil(right * scale_x)) - x
            height = min(self.size[1], math.ceil(bottom * scale_y)) - y
            shapes = tuple(shifted(piece.shapes, -x / scale_x, -y / scale_y))
            scene = Scene(width / scale_x, height / scale_y, shapes)
            image = self.translucent(scene, (width, height))
            found = slice(y, y + height), slice(x, x + width), image
            remember(self._sprites, piece.name, found, _SPRITES)
        return found

    def translucent(self, scene: Scene, size: tuple[int, int]) -> Translucent:
        """Return a scene as a picture that can be laid on a ground."""
        return translucent(lambda ground: self._painted(scene, size, ground))

    def _painted(
        self, scene: Scene, size: tuple[int, int], ground: str = "white"
    ) -> NDArray[np.uint8]:
        shapes = toned(scene.shapes, self._level.resolved_theme.colors)
        pixels = to_rgb(replace(scene, shapes=shapes), size, ground)
        if not self._grayscale:
            return pixels
        brightness: NDArray[np.float64] = np.rint(pixels @ np.array(_GRAY))
        return brightness[..., np.newaxis].astype(np.uint8)


def _joined(scene: Scene, *others: Scene) -> Scene:
    """Return scenes as one."""
    shapes = (shape for other in others for shape in other.shapes)
    return replace(scene, shapes=(*scene.shapes, *shapes))


def remember(cache: dict[_Key, _Value], key: _Key, value: _Value, limit: int) -> None:
    """Add an entry to a cache; a full cache drops its oldest entry."""
    if len(cache) >= limit:
        del cache[next(iter(cache))]
    cache[key] = value


MAX_FRAME_SIDE = 2048
"""The largest width and height of a frame without a given size."""

IMAGE_CELL = 16
"""The default side of a cell in image observations, in pixels."""

MIN_IMAGE_SIDE = 36
"""The smallest picture that common convolutional networks accept."""

MAX_IMAGE_SIDE = 1024

_ROOM = MAX_FRAME_SIDE, MAX_FRAME_SIDE

_POSES = 64
"""The number of poses that are cached."""

_PATCH_BYTES = 8 * 1024 * 1024
"""The memory for cached cells."""


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
        room: the largest width and height of the whole picture, whose cells are made smaller until
            it fits; by default, 2,048 pixels each.

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
        room: tuple[int, int] | None = None,
    ) -> None:
        cells_only = size is not None
        # Without what is below the grid: a film's frames are equally large, whatever they show.
        layout = layout_of(level, cells_only=cells_only, overlay=overlay)
        layout = replace(layout, legend=0.0, caption=0.0)
        self.width, self.height = size or _whole_size(layout, room or _ROOM)
        self._level, self._layout = level, layout
        self._crowded = overlay is not None and overlay.fills_cells
        self._small = overlay is not None and overlay.is_crowded
        self._grounds = Backdrops(
            level,
            layout,
            (self.width, self.height),
            cells_only=cells_only,
            grayscale=grayscale,
            overlay=overlay,
        )
        scale_x, scale_y = self._grounds.scale
        self._left = _offsets(layout.margin, layout.columns, scale_x)
        self._top = _offsets(layout.margin, layout.rows, scale_y)
        self._cell = max(1, round(scale_x * CELL)), max(1, round(scale_y * CELL))
        self._robots: dict[Pose, Translucent] = {}
        self._patches: dict[tuple[int, Pose], tuple[Hashable, list[Patch]]] = {}
        self._limit = max(16, _PATCH_BYTES // (3 * self._cell[0] * self._cell[1]))

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
        ground = self._grounds.named(name)
        if ground is None:
            ground = self._grounds.at(place_of(self._level, state).configuration, pose.heading)
        frame = ground.whole.copy()
        for rows, columns, pixels in patches:
            frame[rows, columns] = pixels
        return frame

    def _patched(self, state: int, pose: Pose) -> tuple[Hashable, list[Patch]]:
        """Paint the cells of the robot and of movers, and cache them."""
        level, place = self._level, place_of(self._level, state)
        ground = self._grounds.at(place.configuration, pose.heading)
        situation = situation_of(level, place.configuration)
        figures: dict[Cell, list[Sprite]] = {place.cell: [self._robot(place.cell, pose)]}
        movers = moving_pieces(level, self._layout, situation, place.cell, crowded=self._crowded)
        for cell, piece in movers:
            figures.setdefault(cell, []).append(self._grounds.sprite(piece))
        patches = [ground.patch(sprites) for sprites in figures.values()]
        remember(self._patches, (state, pose), (ground.name, patches), self._limit)
        return ground.name, patches

    def _robot(self, cell: Cell, pose: Pose) -> Sprite:
        image = self._robots.get(pose)
        if image is None:
            shapes = robot_shapes(self._level.resolved_theme, 0.0, 0.0, pose, small=self._small)
            image = self._grounds.translucent(Scene(CELL, CELL, shapes), self._cell)
            remember(self._robots, pose, image, _POSES)
        left, top = self._left[cell[0]], self._top[cell[1]]
        return slice(top, top + self._cell[1]), slice(left, left + self._cell[0]), image


def image_cells(level: GridWorld) -> tuple[int, int]:
    """Return the columns and rows of a picture of the cells alone, as agents see it.

    These are those of the level; in a level with items, a further row shows what is held.
    """
    width, height = level.size
    return width, height + bool(level.items)


def default_image_size(width: int, height: int) -> tuple[int, int]:
    """Return height and width in pixels of image observations of a level.

    Cells are squares of 16 pixels: more if a side would be below 36 pixels, fewer if one would
    exceed 1,024. Where a level is too narrow for both, the cells are stretched.

    Args:
        width: the number of columns of cells; see `image_cells`.
        height: the number of rows.
    """
    cell = max(IMAGE_CELL, math.ceil(MIN_IMAGE_SIDE / min(width, height)))
    cell = min(cell, MAX_IMAGE_SIDE // max(width, height))
    return max(MIN_IMAGE_SIDE, height * cell), max(MIN_IMAGE_SIDE, width * cell)


def largest_frame(level: GridWorld, size: tuple[int, int], num_items: int) -> tuple[int, int]:
    """Return width and height in pixels of the frames of a level of another size.

    Args:
        level: a level with the same theme and panels.
        size: the width and height of the other one in cells.
        num_items: how many items that has.
    """
    like = layout_of(level)
    strip = STRIP if num_items and like.held_in == "strip" else 0.0
    layout = replace(like, columns=size[0], rows=size[1], items=num_items, strip=strip)
    return _whole_size(layout, _ROOM)


def _whole_size(layout: Layout, room: tuple[int, int]) -> tuple[int, int]:
    scale = min(1.0, (room[0] + 0.5) / layout.width, (room[1] + 0.5) / layout.height)
    if scale < 1:
        # Cells of whole pixels, at least one.
        scale = max(1, math.floor(scale * CELL)) / CELL
    return round(scale * layout.width), round(scale * layout.height)


def _offsets(margin: float, count: int, scale: float) -> list[int]:
    """Return the pixel at which each column (or row) of cells begins."""
    return [round((margin + index * CELL) * scale) for index in range(count)]
