"""The GIF painter: an episode as an animation in which the robot glides from cell to cell."""

from __future__ import annotations

import math
import struct
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image
from PIL.GifImagePlugin import getdata

from babyrobot_levels.language.looks import Theme
from babyrobot_levels.mdp.actions import DELTAS, Action
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.frames import Backdrops
from babyrobot_levels.render.raster import Progress, composite, to_rgb, translucent
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.icons import Spot
from babyrobot_levels.render.scene.layout import CELL, Layout, Overlay, layout_of, panel_width
from babyrobot_levels.render.scene.panels import compass_shapes, panel_shapes, panel_texts
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Point, Scene, Shape, scaled, toned
from babyrobot_levels.render.scene.things import held_pieces, mover_shapes, mover_spots
from babyrobot_levels.render.situation import (
    STANDING,
    GoodEnds,
    Pose,
    place_of,
    pose_of,
    situation_of,
)
from babyrobot_levels.render.svg import number

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from babyrobot_levels.render.raster import Translucent

MAX_SIDE = 800
"""The largest width and height of an animation without a given scale."""

MAX_PIXELS = 400_000_000
"""The most pixels of all frames together."""

_SMOOTH_PIXELS = 120_000_000
"""Animations with more pixels have no frames between cells."""

_LEAST_ROBOT = 32.0
"""The least width and height of the robot in a film, in pixels."""

_FRAMES_BETWEEN = 4
"""The number of frames between two cells."""

_FRAME, _ARRIVAL, _START, _END = 40, 100, 700, 1500
"""The durations of frames in milliseconds: between cells, in a cell, at the start, at the end."""

_SHORTEST = 20
"""The shortest duration; many viewers slow down shorter ones."""

_NUDGE = 0.13
"""The distance that the robot moves into a wall, as a share of a cell."""

_COLORS, _EXACT = 255, 160
"""The size of the palette, and how many of the most frequent colours it keeps exactly."""

_TRANSPARENT = 255
"""The number in an image of a pixel that stays as it was; it comes after those of colours."""


@dataclass(frozen=True, slots=True)
class Step:
    """A step of an episode.

    Attributes:
        state: the state before the step, in the numbering of `level.compile()`.
        action: the action, a `brl.Action`.
        next_state: the state after the step.
        reward: the reward.
        skidded: whether the robot skidded to another cell than the action leads to.
    """

    state: int
    action: int
    next_state: int
    reward: float
    skidded: bool = False


def to_gif(
    level: GridWorld,
    steps: Sequence[Step],
    *,
    overlay: Overlay | None = None,
    scale: float | None = None,
    progress: Progress | None = None,
) -> bytes:
    """Return an episode as a GIF file in an endless loop; the same arguments give the same bytes.

    If the level has a panel, it shows the number of steps and the return so far. Things appear and
    disappear as the robot arrives; movers glide beside it.

    Args:
        level: the level; a maze needs a seed.
        steps: the steps of the episode, at least one.
        overlay: what is shown over the cells, below the robot.
        scale: the size; 1 is 64 pixels a cell. None takes the largest up to 1 that keeps width
            and height within 800 pixels.
        progress: told how many of how many steps are painted.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: there is no step, or the frames have too many pixels.
    """
    if not steps:
        raise ValueError("the episode has no steps")
    overlay = _with_panels(level, overlay)
    layout = layout_of(level, overlay=overlay)
    if scale is None:
        scale = min(1.0, MAX_SIDE / max(layout.width, layout.height))
    width, height = round(scale * layout.width), round(scale * layout.height)
    if (len(steps) + 1) * width * height > MAX_PIXELS:
        raise ValueError(
            f"an animation of {len(steps)} steps and {width} x {height} pixels is too large"
        )
    is_smooth = (_FRAMES_BETWEEN + 1) * len(steps) * width * height <= _SMOOTH_PIXELS
    between = _FRAMES_BETWEEN if is_smooth else 0
    painter = _Painter(level, layout, overlay, scale, place_of(level, steps[0].state).configuration)
    frames = []
    for shot in _shots(level, steps, between):
        patches = (*painter.figures(shot), *painter.panels(shot.steps, shot.total, shot.start))
        frames.append(Frame(patches, shot.time))
        if progress is not None:
            progress(shot.steps, len(steps))
    return encoded(painter.ground, frames)


def _with_panels(level: GridWorld, overlay: Overlay | None) -> Overlay:
    """Return an overlay that leaves the level's panels to the score: no rules stand there."""
    overlay = overlay or Overlay()
    side, bottom = level.display.side_panel, level.display.bottom_panel
    if panel_width(side):
        overlay = replace(overlay, side_panel=("",))
    return replace(overlay, bottom_panel=("",)) if panel_width(bottom) else overlay


@dataclass(frozen=True, slots=True)
class _Shot:
    """The content of a frame: the robot's place and pose, the score, and the duration.

    Things are as in configuration `start`, movers on their way from there to `end`.
    """

    place: Point
    pose: Pose
    steps: int
    total: float
    time: int
    start: int
    end: int
    phase: float = 0.0


def _shots(level: GridWorld, steps: Sequence[Step], between: int) -> Iterator[_Shot]:
    columns, cells = level.size[0], level.size[0] * level.size[1]
    speed, good_ends = level.display.robot.speed, GoodEnds(level)
    frame, arrival = (max(_SHORTEST, round(time / speed)) for time in (_FRAME, _ARRIVAL))
    now, x, y = place_of(level, steps[0].state)
    yield _Shot((float(x), float(y)), STANDING, 0, 0.0, _START, now, now)
    total = 0.0
    for count, step in enumerate(steps, 1):
        now, *start = place_of(level, step.state)
        then, *end = place_of(level, step.next_state)
        moved = step.state % cells, step.next_state % cells, step.action, columns
        pose = pose_of(*moved, skidded=step.skidded)
        for index in range(1, between + 1):
            phase = index / (between + 1)
            moving = pose if start == end else replace(pose, phase=phase)
            place = _between(step, (start[0], start[1]), (end[0], end[1]), phase)
            yield _Shot(place, moving, count - 1, total, frame, now, then, phase)
        total += step.reward
        ends_well = good_ends.are_reached(step.state, step.next_state)
        pose = pose_of(*moved, skidded=step.skidded, ends_well=ends_well)
        time = _END if count == len(steps) else arrival
        yield _Shot((float(end[0]), float(end[1])), pose, count, total, time, then, then)


def _between(step: Step, start: Point, end: Point, phase: float) -> Point:
    if start == end and step.action != Action.STAY and not step.skidded:
        reach = _NUDGE * math.sin(math.pi * phase)
        dx, dy = DELTAS[Action(step.action)]
        return start[0] + reach * dx, start[1] + reach * dy
    eased = _eased(phase)
    return start[0] + eased * (end[0] - start[0]), start[1] + eased * (end[1] - start[1])


def _eased(phase: float) -> float:
    return phase * phase * (3 - 2 * phase)


class _Painter:
    """Paints the ground, and the patches that are put on it."""

    def __init__(
        self, level: GridWorld, layout: Layout, overlay: Overlay, scale: float, configuration: int
    ) -> None:
        self._level, self._layout, self._scale = level, layout, scale
        self._size = round(scale * layout.width), round(scale * layout.height)
        self._small = overlay.is_crowded
        self._grounds: Backdrops | None = None
        if level.has_things:
            self._grounds = Backdrops(level, layout, self._size, overlay=overlay)
            self.ground = self._grounds.at(configuration).whole
        else:
            self.ground = to_rgb(build_scene(level, overlay=overlay, robot=False), self._size)
        self._changed: dict[Hashable, tuple[Patch, ...]] = {}
        self._robots: dict[Pose, Translucent] = {}
        self._movers: dict[Hashable, Translucent] = {}
        self._panels: tuple[tuple[int, float, int], tuple[Patch, ...]] | None = None

    def figures(self, shot: _Shot) -> Iterator[Patch]:
        """Yield the parts of the picture that differ from the ground of the film."""
        if self._grounds is None:
            yield self._laid(self.ground, self._robot(shot.pose), shot.place)
            return
        ground = self._grounds.at(shot.start)
        if ground.name not in self._changed:
            box = _box((self.ground != ground.whole).any(axis=2))
            self._changed[ground.name] = (
                (Patch(box[1].start, box[0].start, ground.whole[box]),) if box else ()
            )
        yield from self._changed[ground.name]
        # Figures may overlap: each is laid on the picture with those before.
        picture = ground.whole.copy()
        for image, place in [(self._robot(shot.pose), shot.place), *self._moving(shot)]:
            patch = self._laid(picture, image, place)
            picture[patch.place] = patch.pixels
            yield patch

    def _moving(self, shot: _Shot) -> Iterator[tuple[Translucent, Point]]:
        """Yield the pictures and places of movers."""
        level, layout = self._level, self._layout
        robot = (round(shot.place[0]), round(shot.place[1])) if shot.start == shot.end else None
        situation = situation_of(level, shot.start)
        before, after = (
            mover_spots(level, layout, each, robot)
            for each in (situation, situation_of(level, shot.end))
        )
        share = _eased(shot.phase)
        for index, (start, end) in enumerate(zip(before, after, strict=True)):
            x, y, scale = (
                first + share * (last - first)
                for first, last in ((start.x, end.x), (start.y, end.y), (start.scale, end.scale))
            )
            look = situation.ways[index]
            name = index, round(scale, 2), look, situation.arrived
            if name not in self._movers:
                spot = Spot(CELL / 2, CELL / 2, scale)
                shapes = mover_shapes(level, index, spot, look, situation.arrived)
                self._movers[name] = self._picture(tuple(shapes))
            margin = layout.margin + CELL / 2
            yield self._movers[name], ((x - margin) / CELL, (y - margin) / CELL)

    def _robot(self, pose: Pose) -> Translucent:
        if pose not in self._robots:
            # In the film of a large level, a robot as small as its cell could not be found.
            size = max(1.0, _LEAST_ROBOT / (self._scale * CELL))
            small = self._small and size == 1
            # Films of many levels have the same robot; a large one would take too much memory.
            paint = _robot if size * self._scale <= 1 else _robot.__wrapped__
            self._robots[pose] = paint(self._level.resolved_theme, pose, self._scale, size, small)
        return self._robots[pose]

    def _picture(self, shapes: tuple[Shape, ...]) -> Translucent:
        return _picture(shapes, self._level.resolved_theme, self._scale)

    def _laid(self, ground: NDArray[np.uint8], image: Translucent, place: Point) -> Patch:
        """Return the part of a picture around a place, with a figure in its middle."""
        ink, through = image
        beyond = (ink.shape[0] - max(1, round(self._scale * CELL))) // 2
        left, top = (round(self._scale * at) - beyond for at in self._layout.corner(*place))
        rows, columns = slice(max(0, -top), None), slice(max(0, -left), None)
        left, top = max(0, left), max(0, top)
        ink, through = ink[rows, columns], through[rows, columns]
        below = ground[top : top + ink.shape[0], left : left + ink.shape[1]]
        ink, through = (each[: below.shape[0], : below.shape[1]] for each in (ink, through))
        return Patch(left, top, composite((ink, through), below))

    def panels(self, steps: int, total: float, configuration: int) -> tuple[Patch, ...]:
        """Return the level's panel with the score in it, if it has one."""
        shown = steps, total, configuration
        if self._panels is None or self._panels[0] != shown:
            self._panels = shown, tuple(self._scored(*shown))
        return self._panels[1]

    def _scored(self, steps: int, total: float, configuration: int) -> Iterator[Patch]:
        # A box with the rules is below all of it.
        layout = replace(self._layout, rules=0.0)
        score = [f"Steps: {steps}", f"Return: {number(total)}"]
        # A panel is painted alone: beside a grid without columns, or below one without rows.
        if panel_width(self._level.display.side_panel):
            strip, overlay = replace(layout, columns=0), Overlay(side_panel=score)
            left, top = strip.left_width, 0.0
        elif layout.bottom:
            strip, overlay = replace(layout, rows=0), Overlay(bottom_panel=["   ".join(score)])
            left, top = 0.0, strip.top_height
        else:
            return
        shapes = (
            *panel_shapes(self._level, overlay, strip),
            *(compass_shapes(self._level, strip) if top == 0.0 else ()),
            *panel_texts(self._level, overlay, strip),
        )
        held = held_pieces(self._level, strip, situation_of(self._level, configuration))
        shapes += tuple(shape for piece in held for shape in piece.shapes)
        size = round(self._scale * strip.width), round(self._scale * strip.height)
        shapes = toned(shapes, self._level.resolved_theme.colors)
        pixels = to_rgb(Scene(strip.width, strip.height, shapes), size)
        pixels = pixels[math.ceil(self._scale * top) :, math.ceil(self._scale * left) :]
        if top == 0.0:
            # The strip is as high as the grid beside it.
            pixels = pixels[: math.floor(self._scale * layout.top_height)]
        height, width = pixels.shape[:2]
        right, foot = round(self._scale * layout.width), round(self._scale * layout.height)
        yield Patch(right - width, 0 if top == 0.0 else foot - height, pixels)


@lru_cache(maxsize=256)
def _robot(theme: Theme, pose: Pose, scale: float, size: float, small: bool) -> Translucent:
    """Return a picture of the robot that is `size` cells wide and high."""
    shapes = robot_shapes(theme, 0.0, 0.0, pose, small=small)
    return _picture(tuple(scaled(shapes, size)), theme, scale, size)


def _picture(
    shapes: tuple[Shape, ...], theme: Theme, scale: float, cells: float = 1.0
) -> Translucent:
    """Return shapes as a picture that is so many cells wide and high."""
    side = max(1, round(cells * scale * CELL))
    scene = Scene(cells * CELL, cells * CELL, toned(shapes, theme.colors))
    return translucent(lambda ground: to_rgb(scene, (side, side), ground))


def _box(changed: NDArray[np.bool_]) -> tuple[slice, slice] | None:
    """Return the rows and columns in which something has changed; None for none."""
    rows, columns = (np.flatnonzero(changed.any(axis=axis)).tolist() for axis in (1, 0))
    return (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)) if rows else None


# -- the file -------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Patch:
    """A part of a frame that differs: its top-left corner, and uint8 `[height, width, 3]`."""

    left: int
    top: int
    pixels: NDArray[np.uint8]

    @property
    def place(self) -> tuple[slice, slice]:
        """Its rows and columns."""
        height, width = self.pixels.shape[:2]
        return slice(self.top, self.top + height), slice(self.left, self.left + width)


@dataclass(frozen=True, slots=True)
class Frame:
    """A frame: the patches on the ground, and the duration in milliseconds."""

    patches: tuple[Patch, ...]
    time: int


def encoded(ground: NDArray[np.uint8], frames: Sequence[Frame]) -> bytes:
    """Return frames as a GIF file in an endless loop, without dithering.

    Args:
        ground: the picture below all frames, uint8 `[height, width, 3]`.
        frames: at least one frame.
    """
    patches = {id(patch): patch for frame in frames for patch in frame.patches}
    packed = {key: _packed(patch.pixels) for key, patch in patches.items()}
    everything = [_packed(ground).ravel(), *(pixels.ravel() for pixels in packed.values())]
    colors, counts = np.unique(np.concatenate(everything), return_counts=True)
    palette = _palette(colors, counts)
    number = _nearest(colors, palette)

    def indexed(pixels: NDArray[np.int32]) -> NDArray[np.uint8]:
        return number[np.searchsorted(colors, pixels)]

    base = indexed(_packed(ground))
    parts = {key: indexed(pixels) for key, pixels in packed.items()}

    def pictures() -> Iterator[tuple[NDArray[np.uint8], int]]:
        for frame in frames:
            pixels = base.copy()
            for patch in frame.patches:
                pixels[patch.place] = parts[id(patch)]
            yield pixels, frame.time

    return b"".join(_file(base.shape, _unpacked(palette).astype(np.uint8), pictures()))


def _file(
    shape: tuple[int, ...],
    palette: NDArray[np.uint8],
    pictures: Iterator[tuple[NDArray[np.uint8], int]],
) -> Iterator[bytes]:
    """Yield the parts of a GIF file: of each picture only what differs from the one before."""
    height, width = shape
    table = palette.tobytes().ljust(3 * 256, b"\0")
    yield b"GIF89a" + struct.pack("<HHBBB", width, height, 0xF7, 0, 0) + table
    yield b"!\xff\x0bNETSCAPE2.0\x03\x01\0\0\0"
    last, time = next(pictures)
    left, top, image = 0, 0, last
    for pixels, next_time in pictures:
        changed = pixels != last
        box = _box(changed)
        if box is None:
            time += next_time
            continue
        yield _image(image, left, top, time)
        image = np.where(changed[box], pixels[box], np.uint8(_TRANSPARENT))
        left, top, last, time = box[1].start, box[0].start, pixels, next_time
    yield _image(image, left, top, time)
    yield b";"


def _image(pixels: NDArray[np.uint8], left: int, top: int, time: int) -> bytes:
    """Return an image of a GIF file, which is laid on those before."""
    parts = getdata(
        Image.fromarray(pixels),
        (left, top),
        duration=time,
        disposal=1,
        transparency=_TRANSPARENT,
        interlace=0,
    )
    return b"".join(parts)


def _packed(pixels: NDArray[np.uint8]) -> NDArray[np.int32]:
    """Return pixels as one number each."""
    numbers = pixels.astype(np.int32)
    return numbers[..., 0] << 16 | numbers[..., 1] << 8 | numbers[..., 2]


def _unpacked(colors: NDArray[np.int32]) -> NDArray[np.int32]:
    return np.stack([colors >> 16, colors >> 8 & 255, colors & 255], axis=-1)


def _palette(colors: NDArray[np.int32], counts: NDArray[np.intp]) -> NDArray[np.int32]:
    """Return at most 256 colours: the most frequent ones, and a reduction of the others."""
    if colors.size <= _COLORS:
        return colors
    order = np.argsort(-counts, kind="stable")
    rest = np.sort(colors[order[_EXACT:]])
    image = Image.fromarray(_unpacked(rest).astype(np.uint8)[np.newaxis])
    reduced = image.quantize(_COLORS - _EXACT, Image.Quantize.MEDIANCUT)
    others = np.array(reduced.getpalette("RGB"), np.uint8).reshape(-1, 3)
    return np.concatenate([colors[order[:_EXACT]], _packed(others)])


def _nearest(colors: NDArray[np.int32], palette: NDArray[np.int32]) -> NDArray[np.uint8]:
    """Return the index of the nearest colour of the palette, for each colour."""
    wanted, there = _unpacked(colors), _unpacked(palette)
    distance = np.zeros((colors.size, palette.size), np.int32)
    for channel in range(3):
        distance += (wanted[:, channel, None] - there[:, channel]) ** 2
    nearest: NDArray[np.intp] = distance.argmin(axis=1)
    return nearest.astype(np.uint8)
