"""The raster painter: pixels by Pillow, painted larger than asked and then averaged down."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import chain, islice, pairwise
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from babyrobot_levels.render.colors import Rgb, rgba
from babyrobot_levels.render.scene.shapes import (
    Commands,
    Ellipse,
    Path,
    Point,
    Rect,
    Scene,
    Shape,
    Text,
    cubic,
    told_as_shapes,
)
from babyrobot_levels.text import budget
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from PIL.PngImagePlugin import PngInfo

    Translucent = tuple[NDArray[np.uint8], NDArray[np.uint8]]
    """The ink, and the visible share of the ground of 255; each `[height, width, channels]`."""


_MINUS, _BAR = "\N{MINUS SIGN}", 0.58
"""A sign that the font lacks, and its width as a share of the size."""

MAX_SIDE = 4000
"""The largest width and height of a picture without a given size."""

MAX_PIXELS = 64_000_000
"""The most pixels that are painted at once, before averaging."""

_MAX_SAMPLES = 4
_SMALLEST_TEXT = 5.0
"""Texts with fewer pixels are left out: they would not be readable."""

_REPORTED = 256
"""The number of shapes from one report of progress to the next."""

_FINEST_DASH = 1.5
"""The shortest dashes that are painted one by one, in pixels."""

_STEP = 500
"""The work that a step of a path counts as, which takes longer than to write it down."""

_MASK_COST, _MASK_MARGIN = 4000, 4
"""What a mask costs besides its pixels, in pixels, and how far apart two of them must be."""

_MANY = 10_000
"""The number of translucent lines from which on they have one mask: to part them takes longer."""

_MAX_PARTS = 64
"""The most lines that a curve becomes."""

Box = tuple[float, float, float, float]
Ink = int | tuple[int, ...]
Progress = Callable[[int, int], None]
"""Is told, now and then, how much of how much is done."""

Polyline = tuple[list[Point], bool]
"""Points, and whether the last is joined to the first."""


def to_rgb(
    scene: Scene, size: tuple[int, int] | None = None, background: str = "white"
) -> NDArray[np.uint8]:
    """Return the scene as pixels, `[height, width, 3]`.

    Args:
        scene: the scene.
        size: width and height in pixels, to which the scene is stretched. None takes the scene's
            own, scaled down to at most 4,000 pixels a side.
        background: the background colour.

    Raises:
        ValueError: the size is not positive, or exceeds 64 million pixels.
    """
    return np.array(_paint(scene, size, background))


def to_png(
    scene: Scene,
    size: tuple[int, int] | None = None,
    *,
    colors: int | None = None,
    progress: Progress | None = None,
) -> bytes:
    """Return the scene as a PNG file; see `to_rgb`.

    Args:
        scene: the scene.
        size: width and height in pixels.
        colors: the largest number of colours.
        progress: told, now and then, how many of how many shapes are painted.
    """
    buffer = io.BytesIO()
    image = _paint(scene, size, "white", progress)
    if colors is not None:
        image = image.quantize(colors)
    image.save(buffer, "PNG", compress_level=4 if colors is None else 9, pnginfo=_texts(scene))
    return buffer.getvalue()


def pixels_to_png(pixels: NDArray[np.uint8]) -> bytes:
    """Return pixels, uint8 `[height, width, 3]`, as a PNG file."""
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG")
    return buffer.getvalue()


def reduced(png: bytes, side: int, colors: int = 64) -> bytes:
    """Return a picture with fewer pixels and colours as a PNG file.

    Args:
        png: the picture, a PNG file.
        side: the largest width and height in pixels.
        colors: the largest number of colours.
    """
    buffer = io.BytesIO()
    with Image.open(io.BytesIO(png)) as image:
        image.thumbnail((side, side), Image.Resampling.BOX)
        image.quantize(colors, dither=Image.Dither.NONE).save(buffer, "PNG", compress_level=9)
    return buffer.getvalue()


def _texts(scene: Scene) -> PngInfo:
    """Return the scene's title and description as texts of a PNG file."""
    # Arrays of pixels do without the plugin.
    from PIL.PngImagePlugin import PngInfo

    texts = PngInfo()
    for key, text in (("Title", scene.title), ("Description", scene.description)):
        if text:
            texts.add_text(key, one_line(text))
    return texts


def _paint(
    scene: Scene, size: tuple[int, int] | None, background: str, progress: Progress | None = None
) -> Image.Image:
    if size is None:
        scale = min(1.0, MAX_SIDE / max(scene.width, scene.height))
        size = max(1, round(scale * scene.width)), max(1, round(scale * scene.height))
    width, height = size
    if min(width, height) < 1:
        raise ValueError(f"invalid picture size: {width} x {height} pixels")
    if width * height > MAX_PIXELS:
        raise ValueError(
            f"a picture of {width} x {height} pixels is too large; "
            f"the limit is {MAX_PIXELS:,} pixels"
        )
    steps = sum(len(shape.commands) if isinstance(shape, Path) else 1 for shape in scene.shapes)
    with told_as_shapes():
        budget.spend(_STEP * steps)
    samples = min(_MAX_SAMPLES, math.isqrt(MAX_PIXELS // (width * height)))
    image = Image.new("RGB", (samples * width, samples * height), rgba(background)[:3])
    painter = Painter(image, scene, samples)
    for count, shape in enumerate(scene.shapes, 1):
        painter.paint(shape)
        if progress is not None and count % _REPORTED == 0:
            progress(count, len(scene.shapes))
    return image.reduce(samples) if samples > 1 else image


class Painter:
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
        red, green, blue, alpha = rgba(rect.fill)
        if radius < 1 and 0 < (alpha := alpha * rect.opacity) < 1:
            self._tint((red, green, blue), round(255 * alpha), box)
            return
        self._ink(rect.fill, rect.opacity, box, lambda pen: pen.box(*box, radius))

    def _tint(self, color: Rgb, strength: int, box: Box) -> None:
        """Lay a translucent colour on a rectangle, faster than through a mask."""
        left, top, right, bottom = _pixels(*box)
        left, top = max(0, left), max(0, top)
        right, bottom = min(self._image.width, right + 1), min(self._image.height, bottom + 1)
        if left < right and top < bottom:
            part = self._image.crop((left, top, right, bottom))
            self._image.paste(part.point(_mixing(color, strength)), (left, top))

    def _ellipse(self, ellipse: Ellipse) -> None:
        x, y = ellipse.x * self._x, ellipse.y * self._y
        rx, ry = ellipse.rx * self._x, ellipse.ry * self._y
        box = (x - rx, y - ry, x + rx, y + ry)
        self._ink(ellipse.fill, ellipse.opacity, box, lambda pen: pen.ellipse(x, y, rx, ry))

    def _path(self, path: Path) -> None:
        if path.fill is not None:

            def fill(lines: Iterable[Polyline], pen: Pen) -> None:
                for points, _ in lines:
                    pen.polygon(points)

            self._ink_lines(path.fill, path.opacity, self._lines(path), 1, fill)
        if path.stroke is not None:
            self._stroke(path, path.stroke, self._lines(path))

    def _lines(self, path: Path) -> Iterator[Polyline]:
        """Yield the pieces of a path, in pixels."""
        for points, closed in polylines(path.commands, self._length):
            yield [(x * self._x, y * self._y) for x, y in points], closed

    def _stroke(self, path: Path, color: str, lines: Iterator[Polyline]) -> None:
        width, opacity = path.width * self._length, path.opacity
        if path.dash is not None:
            dash, gap = (self._length * length for length in path.dash)
            if dash < _FINEST_DASH * self._samples:
                # Fine dashes look like a fainter line, and a large level has hundreds of thousands.
                opacity *= dash / (dash + gap)
            else:
                lines = (part for line in lines for part in dashes(line, dash, gap))
        # A line thinner than a pixel is a fainter line of one pixel.
        opacity, width = opacity * min(width, 1.0), max(width, 1.0)

        def stroke(lines: Iterable[Polyline], pen: Pen) -> None:
            for line in lines:
                pen.stroke(line, width, round_caps=path.cap == "round")

        self._ink_lines(color, opacity, lines, width, stroke)

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

    def _ink_lines(
        self,
        color: str,
        opacity: float,
        lines: Iterator[Polyline],
        reach: float,
        draw: Callable[[Iterable[Polyline], Pen], None],
    ) -> None:
        """Draw lines in a colour; a few translucent ones that are far apart in several masks."""
        first = [*islice(lines, _MANY)]
        if rgba(color)[3] * opacity >= 1 or len(first) == _MANY:
            self._ink(color, opacity, (0, 0, *self._image.size), partial(draw, chain(first, lines)))
            return
        for group in _apart(first, reach) if first else ():
            self._ink(color, opacity, _bounds(group, reach), partial(draw, group))

    def _ink(self, color: str, opacity: float, box: Box, draw: Callable[[Pen], None]) -> None:
        """Draw in a colour inside `box`."""
        red, green, blue, alpha = rgba(color)
        alpha *= opacity
        if alpha >= 1:
            draw(Pen(self._draw, (red, green, blue)))
            return
        # Drawn into a mask first, so that overlapping parts are not blended twice.
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


def _apart(lines: list[Polyline], reach: float) -> list[list[Polyline]]:
    """Return lines in the groups whose boxes are painted fastest; no two groups overlap."""
    rows = _split(lines, 1, reach)
    cells = [group for row in rows for group in _split(row, 0, reach)]
    return min(([lines], rows, cells), key=lambda groups: _cost(groups, reach))


def _split(lines: list[Polyline], axis: int, reach: float) -> list[list[Polyline]]:
    """Return lines in groups that are apart on an axis."""
    places = sorted(
        ((min(ends), max(ends), line) for line in lines if (ends := [p[axis] for p in line[0]])),
        key=itemgetter(0),
    )
    groups: list[list[Polyline]] = []
    end = -math.inf
    for first, last, line in places:
        if first - reach > end + reach + _MASK_MARGIN:
            groups.append([])
        groups[-1].append(line)
        end = max(end, last)
    return groups


def _cost(groups: list[list[Polyline]], reach: float) -> float:
    boxes = (_bounds(group, reach) for group in groups)
    return sum(_MASK_COST + (right - left) * (bottom - top) for left, top, right, bottom in boxes)


# -- pixels of one colour ---------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Pen:
    """Draws in `ink` on an image whose top-left pixel is (`left`, `top`) of the picture."""

    draw: ImageDraw.ImageDraw
    ink: Ink
    left: int = 0
    top: int = 0

    def box(self, x0: float, y0: float, x1: float, y1: float, radius: float = 0.0) -> None:
        """Fill a rectangle, at least a pixel wide and high."""
        left, top, right, bottom = _pixels(x0, y0, x1, y1)
        corners = (left - self.left, top - self.top, right - self.left, bottom - self.top)
        if radius >= 1:
            self.draw.rounded_rectangle(corners, radius, self.ink)
        else:
            self.draw.rectangle(corners, self.ink)

    def ellipse(self, x: float, y: float, rx: float, ry: float) -> None:
        """Fill an ellipse around (`x`, `y`)."""
        left, top = round(x - rx) - self.left, round(y - ry) - self.top
        right = max(left, round(x + rx) - self.left - 1)
        bottom = max(top, round(y + ry) - self.top - 1)
        self.draw.ellipse((left, top, right, bottom), self.ink)

    def polygon(self, points: list[Point]) -> None:
        """Fill a polygon."""
        # Pillow's coordinates are the centres of pixels.
        corners = [(round(x - 0.5) - self.left, round(y - 0.5) - self.top) for x, y in points]
        self.draw.polygon(corners, self.ink)

    def stroke(self, line: Polyline, width: float, *, round_caps: bool) -> None:
        """Draw a line with round joins."""
        points, closed = line
        half = width / 2
        for start, end in pairwise([*points, points[0]] if closed else points):
            self._segment(start, end, half)
        if half >= 1:
            for x, y in points if round_caps or closed else points[1:-1]:
                self.ellipse(x, y, half, half)

    def _segment(self, start: Point, end: Point, half: float) -> None:
        (x0, y0), (x1, y1) = start, end
        if x0 == x1:
            self.box(x0 - half, min(y0, y1), x0 + half, max(y0, y1))
        elif y0 == y1:
            self.box(min(x0, x1), y0 - half, max(x0, x1), y0 + half)
        else:
            length = math.hypot(x1 - x0, y1 - y0)
            dx, dy = half * (y1 - y0) / length, half * (x0 - x1) / length
            self.polygon(
                [(x0 + dx, y0 + dy), (x1 + dx, y1 + dy), (x1 - dx, y1 - dy), (x0 - dx, y0 - dy)]
            )

    def text(self, x: float, y: float, text: str, size: float, anchor: str, *, bold: bool) -> None:
        """Write a line in Pillow's own font; it has no bold, so bold text is thickened."""
        left, foot, font = x - self.left, y - self.top, _font(size)
        weight = size / 32 if bold else 0
        if text.startswith(_MINUS):
            # The font has no minus sign: a bar that is as wide as a figure.
            bar, text = _BAR * size, text.removeprefix(_MINUS)
            left -= {"l": 0.0, "m": 0.5, "r": 1.0}[anchor[0]] * (bar + font.getlength(text))
            top, height = foot - 0.36 * size, max(1.0, 0.08 * size + weight)
            self.draw.rectangle((left, top, left + 0.8 * bar, top + height - 1), self.ink)
            left, anchor = left + bar, "ls"
        text = text.replace(_MINUS, "-")
        self.draw.text((left, foot), text, self.ink, font, anchor, stroke_width=weight)


def _pixels(x0: float, y0: float, x1: float, y1: float) -> tuple[int, int, int, int]:
    """Return the first and last columns and rows of a rectangle; it has at least one of each."""
    left, top = round(x0), round(y0)
    return left, top, max(left, round(x1) - 1), max(top, round(y1) - 1)


@lru_cache(maxsize=64)
def _mixing(color: Rgb, strength: int) -> list[int]:
    """Return what each value of the channels becomes below a colour, of a strength up to 255.

    It is rounded as Pillow does where it pastes through a mask.
    """
    sums = (
        value * (255 - strength) + part * strength + 128 for part in color for value in range(256)
    )
    return [(each + (each >> 8)) >> 8 for each in sums]


@lru_cache(maxsize=64)
def _font(size: float) -> ImageFont.FreeTypeFont:
    font = ImageFont.load_default(size)
    assert isinstance(font, ImageFont.FreeTypeFont)
    return font


# -- paths as straight lines ------------------------------------------------------------------


def polylines(commands: Commands, scale: float = 1.0) -> Iterator[Polyline]:
    """Yield the pieces of a path as polylines; curves look smooth at `scale`."""
    points: list[Point] = []
    closed = False
    for letter, numbers in commands:
        if letter == "M":
            if points:
                yield points, closed
            points, closed = [(numbers[0], numbers[1])], False
        elif letter == "Z":
            closed = True
        elif letter == "L":
            points.append((numbers[0], numbers[1]))
        else:
            points += _cubic(points[-1], numbers, scale)
    if points:
        yield points, closed


def _cubic(start: Point, numbers: tuple[float, ...], scale: float) -> Iterator[Point]:
    places = start, numbers[:2], numbers[2:4], numbers[4:]
    length = sum(math.dist(one, next_one) for one, next_one in pairwise(places))
    parts = min(_MAX_PARTS, 3 + int(math.sqrt(length * scale)))
    return (cubic(start, numbers, part / parts) for part in range(1, parts + 1))


def dashes(line: Polyline, dash: float, gap: float) -> Iterator[Polyline]:
    """Yield the dashes of a line, which begins with a dash."""
    points, closed = line
    points = [*points, points[0]] if closed else points
    drawing, left = True, dash
    current = [points[0]]
    for start, end in pairwise(points):
        length, done = math.dist(start, end), 0.0
        while length - done > left:
            done += left
            share = done / length
            cut = (start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1]))
            if drawing:
                yield [*current, cut], False
            current = [cut]
            drawing, left = not drawing, gap if drawing else dash
        left -= length - done
        current.append(end)
    if drawing and len(current) > 1:
        yield current, False


# -- translucent pictures ---------------------------------------------------------------------


def translucent(paint: Callable[[str], NDArray[np.uint8]]) -> Translucent:
    """Return a picture that lets the ground show through: painted on black and on white.

    Args:
        paint: returns the picture on a ground of the given colour.
    """
    ink = paint("black")
    return ink, paint("white") - ink


def composite(image: Translucent, ground: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a translucent picture laid on a ground, as far as the ground reaches."""
    height, width = ground.shape[:2]
    ink, through = (part[:height, :width] for part in image)
    seen = (ground.astype(np.uint16) * through + 127) // 255
    return ink + seen.astype(np.uint8)
