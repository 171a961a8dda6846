"""The raster painter: pixels by Pillow, painted larger than asked and then averaged down."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw

from babyrobot_levels.render.colors import rgba
from babyrobot_levels.render.flatten import Polyline, dashes, polylines
from babyrobot_levels.render.pen import Pen
from babyrobot_levels.render.scene.shapes import Ellipse, Path, Rect, Scene, Shape, Text

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

MAX_SIDE = 4000
"""A picture that is given no size is at most this many pixels wide and high."""

MAX_PIXELS = 64_000_000
"""The most pixels that are painted at once, before they are averaged down."""

_MAX_SAMPLES = 4
_SMALLEST_TEXT = 5.0
"""Texts of fewer pixels could not be read: they are left out."""

Box = tuple[float, float, float, float]


def to_rgb(
    scene: Scene, size: tuple[int, int] | None = None, background: str = "white"
) -> NDArray[np.uint8]:
    """Return the scene as pixels, `[height, width, 3]`.

    Args:
        scene: the scene.
        size: width and height in pixels; the scene is stretched to them. None takes the scene's
            own, or where they are over 4,000, the largest of the same proportions below.
        background: the colour on which the scene is painted.

    Raises:
        ValueError: the size is not positive, or more than 64 million pixels.
    """
    return np.array(_paint(scene, size, background))


def to_png(
    scene: Scene, size: tuple[int, int] | None = None, *, colors: int | None = None
) -> bytes:
    """Return the scene as a PNG file; see `to_rgb`. `colors` is how many it has at most."""
    buffer = io.BytesIO()
    image = _paint(scene, size, "white")
    if colors is not None:
        image = image.quantize(colors)
    image.save(buffer, "PNG", compress_level=4 if colors is None else 9)
    return buffer.getvalue()


def _paint(scene: Scene, size: tuple[int, int] | None, background: str) -> Image.Image:
    width, height = size or _default_size(scene)
    if min(width, height) < 1 or width * height > MAX_PIXELS:
        raise ValueError(f"a picture cannot be {width} x {height} pixels large")
    samples = min(_MAX_SAMPLES, math.isqrt(MAX_PIXELS // (width * height)))
    image = Image.new("RGB", (samples * width, samples * height), rgba(background)[:3])
    painter = _Painter(image, scene, samples)
    for shape in scene.shapes:
        painter.paint(shape)
    return image.reduce(samples) if samples > 1 else image


def _default_size(scene: Scene) -> tuple[int, int]:
    scale = min(1.0, MAX_SIDE / max(scene.width, scene.height))
    return max(1, round(scale * scene.width)), max(1, round(scale * scene.height))


class _Painter:
    """Paints shapes on an image that is `samples` times as large as the picture will be."""

    def __init__(self, image: Image.Image, scene: Scene, samples: int) -> None:
        self._image = image
        self._draw = ImageDraw.Draw(image)
        self._samples = samples
        self._x, self._y = image.width / scene.width, image.height / scene.height
        self._length = math.sqrt(self._x * self._y)

    def paint(self, shape: Shape) -> None:
        """Paint one shape."""
        match shape:
            case Rect():
                self._rect(shape)
            case Ellipse():
                self._ellipse(shape)
            case Path():
                self._path(shape)
            case Text():
                self._text(shape)

    def _rect(self, rect: Rect) -> None:
        left, top = rect.x * self._x, rect.y * self._y
        box = (left, top, left + rect.width * self._x, top + rect.height * self._y)
        radius = rect.radius * self._length
        self._ink(rect.fill, rect.opacity, box, lambda pen: pen.box(*box, radius))

    def _ellipse(self, ellipse: Ellipse) -> None:
        x, y = ellipse.x * self._x, ellipse.y * self._y
        rx, ry = ellipse.rx * self._x, ellipse.ry * self._y
        box = (x - rx, y - ry, x + rx, y + ry)
        self._ink(ellipse.fill, ellipse.opacity, box, lambda pen: pen.ellipse(x, y, rx, ry))

    def _path(self, path: Path) -> None:
        lines = [
            ([(x * self._x, y * self._y) for x, y in points], closed)
            for points, closed in polylines(path.commands, self._length)
        ]
        if not lines:
            return
        if path.fill is not None:

            def fill(pen: Pen) -> None:
                for points, _ in lines:
                    pen.polygon(points)

            self._ink(path.fill, path.opacity, _bounds(lines, 1), fill)
        if path.stroke is not None:
            self._stroke(path, path.stroke, lines)

    def _stroke(self, path: Path, color: str, lines: list[Polyline]) -> None:
        width, opacity = path.width * self._length, path.opacity
        if path.dash is not None:
            dash, gap = (self._length * length for length in path.dash)
            if dash < self._samples:
                # Dashes finer than the picture's pixels are seen as a fainter line.
                opacity *= dash / (dash + gap)
            else:
                lines = [part for line in lines for part in dashes(line, dash, gap)]
        # A line thinner than a pixel is a fainter one.
        width, opacity = max(width, 1.0), opacity * min(width, 1.0)

        def stroke(pen: Pen) -> None:
            for line in lines:
                pen.stroke(line, width, round_caps=path.cap == "round")

        self._ink(color, opacity, _bounds(lines, width), stroke)

    def _text(self, text: Text) -> None:
        size = text.size * min(self._x, self._y)
        if size < _SMALLEST_TEXT * self._samples:
            return
        x, y = text.x * self._x, text.y * self._y
        anchor = {"start": "ls", "middle": "ms", "end": "rs"}[text.anchor]
        reach = size * (len(text.text) + 1)
        self._ink(
            text.fill,
            text.opacity,
            (x - reach, y - 2 * size, x + reach, y + 2 * size),
            lambda pen: pen.text(x, y, text.text, size, anchor, bold=text.bold),
        )

    def _ink(self, color: str, opacity: float, box: Box, draw: Callable[[Pen], None]) -> None:
        """Draw in a colour, inside of `box`."""
        red, green, blue, alpha = rgba(color)
        alpha *= opacity
        if alpha >= 1:
            draw(Pen(self._draw, (red, green, blue)))
            return
        # Drawn into a mask first, so that what overlaps itself is not blended twice.
        left, top = max(0, math.floor(box[0]) - 1), max(0, math.floor(box[1]) - 1)
        right = min(self._image.width, math.ceil(box[2]) + 2)
        bottom = min(self._image.height, math.ceil(box[3]) + 2)
        if left < right and top < bottom and alpha > 0:
            mask = Image.new("L", (right - left, bottom - top), 0)
            draw(Pen(ImageDraw.Draw(mask), round(255 * alpha), left, top))
            self._image.paste((red, green, blue), (left, top, right, bottom), mask)


def _bounds(lines: list[Polyline], reach: float) -> Box:
    xs = [x for points, _ in lines for x, _ in points]
    ys = [y for points, _ in lines for _, y in points]
    return min(xs) - reach, min(ys) - reach, max(xs) + reach, max(ys) + reach
