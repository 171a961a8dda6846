"""The ipycanvas painter: a picture in layers on a widget, each change sent in one message."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from ipycanvas import Canvas, MultiCanvas, hold_canvas  # type: ignore[import-untyped]

from babyrobot_levels.render.colors import rgba
from babyrobot_levels.render.scene.shapes import (
    Commands,
    Ellipse,
    Path,
    Rect,
    Scene,
    Shape,
    Text,
    rounded,
    screen_scale,
)
from babyrobot_levels.render.svg import FONT

_ALIGN = {"start": "left", "middle": "center", "end": "right"}
_SPACES = re.compile("[ \t\r\n]+")
"""Characters that SVG shows as one space."""


@contextmanager
def one_message(widget: MultiCanvas) -> Iterator[None]:
    """Send everything that the block draws on a widget's layers in one message.

    After an exception, what was drawn so far is sent, and ipycanvas keeps working: its own
    `hold_canvas` would hold back everything that any canvas draws afterwards.
    """
    hold = hold_canvas()
    hold.__enter__()
    try:
        # ipycanvas names a canvas in a message only if another canvas was drawn on last. A page
        # that was loaded since would not know which, and never draw again. So every message ends
        # on another canvas than it begins with, and therefore begins with a name.
        widget[0].begin_path()
        yield
    finally:
        widget[-1].begin_path()
        hold.__exit__(None, None, None)


def paint(canvas: Canvas, shapes: Iterable[Shape], scale: float = 1.0) -> None:
    """Replace what a canvas shows by shapes.

    Args:
        canvas: the canvas.
        shapes: the shapes, in painting order.
        scale: canvas pixels for each pixel of the shapes.
    """
    # Not `save` and `restore`: an interrupted batch leaves them unbalanced.
    canvas.reset_transform()
    canvas.clear()
    canvas.set_transform(scale, 0, 0, scale, 0, 0)
    brush = _Brush(canvas)
    for shape in shapes:
        match shape:
            case Rect():
                brush.rect(shape)
            case Ellipse():
                brush.ellipse(shape)
            case Path():
                brush.path(shape)
            case Text():
                brush.text(shape)


class _Brush:
    """Draws shapes one by one; a style is sent only when it changes."""

    def __init__(self, canvas: Canvas) -> None:
        self._canvas = canvas
        self._style: dict[str, Any] = {}
        self._dash: tuple[float, ...] | None = None
        self._use(line_join="round")

    def _use(self, **style: Any) -> None:
        for name, value in style.items():
            if self._style.get(name) != value:
                setattr(self._canvas, name, value)
                self._style[name] = value

    def _ink(self, style: str, color: str, opacity: float) -> bool:
        """Set a colour; return whether it is visible at all."""
        red, green, blue, alpha = rgba(color)
        alpha = round(alpha * opacity, 4)
        if alpha > 0:
            # As numbers: ipycanvas does not accept all of the names that browsers know.
            self._use(global_alpha=alpha, **{style: f"#{red:02x}{green:02x}{blue:02x}"})
        return alpha > 0

    def rect(self, rect: Rect) -> None:
        if not self._ink("fill_style", rect.fill, rect.opacity):
            return
        box = rect.x, rect.y, rect.width, rect.height
        if min(rect.radius, rect.width, rect.height) <= 0:
            self._canvas.fill_rect(*_rounded(*box))
            return
        self._trace(rounded(*box, rect.radius))
        self._canvas.fill()

    def ellipse(self, ellipse: Ellipse) -> None:
        if self._ink("fill_style", ellipse.fill, ellipse.opacity):
            place = _rounded(ellipse.x, ellipse.y, ellipse.rx, ellipse.ry)
            self._canvas.begin_path()
            self._canvas.ellipse(*place, 0, 0, round(2 * math.pi, 5))
            self._canvas.fill()

    def path(self, path: Path) -> None:
        filled = path.fill is not None and self._ink("fill_style", path.fill, path.opacity)
        if filled:
            self._trace(path.commands)
            self._canvas.fill()
        if path.stroke is None or not self._ink("stroke_style", path.stroke, path.opacity):
            return
        if not filled:
            self._trace(path.commands)
        self._use(line_width=round(path.width, 2), line_cap=path.cap)
        if (dash := path.dash or ()) != self._dash:
            self._canvas.set_line_dash(_rounded(*dash))
            self._dash = dash
        self._canvas.stroke()

    def _trace(self, commands: Commands) -> None:
        canvas = self._canvas
        canvas.begin_path()
        for letter, numbers in commands:
            match letter:
                case "M":
                    canvas.move_to(*_rounded(*numbers))
                case "L":
                    canvas.line_to(*_rounded(*numbers))
                case "C":
                    canvas.bezier_curve_to(*_rounded(*numbers))
                case _:
                    canvas.close_path()

    def text(self, text: Text) -> None:
        if not self._ink("fill_style", text.fill, text.opacity):
            return
        weight = "bold " if text.bold else ""
        self._use(font=f"{weight}{text.size:g}px {FONT}", text_align=_ALIGN[text.anchor])
        # Lone surrogates cannot be sent.
        line = _SPACES.sub(" ", text.text).strip().encode("utf-8", "replace").decode()
        self._canvas.fill_text(line, *_rounded(text.x, text.y))


def _rounded(*numbers: float) -> list[float]:
    """Return numbers with at most two decimals, as in SVG: they are sent as text."""
    return [round(number, 2) for number in numbers]


class LayeredCanvas:
    """Layers of a picture, one canvas each.

    Drawing is messages, not state: a front end that connects later has missed them. It gets the
    whole picture as soon as it reports that it is ready.

    Args:
        layers: the layers by their names, from the bottom up, all of one size.

    Attributes:
        widget: the widget that shows them.
    """

    def __init__(self, layers: Mapping[str, Scene]) -> None:
        self._wanted = dict(layers)
        self._painted: dict[str, tuple[Shape, ...]] = {}
        width, height = _size(self._wanted)
        self.widget = MultiCanvas(
            len(layers), width=width, height=height, layout={"max_width": "100%", "height": "auto"}
        )
        self.widget.on_client_ready(self.repaint)
        self.paint(layers)

    def paint(self, layers: Mapping[str, Scene]) -> None:
        """Paint the layers that have changed. The size may change, too.

        Args:
            layers: all layers, by their original names.
        """
        self._wanted = dict(layers)
        if (size := _size(self._wanted)) != (self.widget.width, self.widget.height):
            self._painted.clear()
            self.widget.width, self.widget.height = size
        stale = {
            name: scene for name, scene in layers.items() if self._painted.get(name) != scene.shapes
        }
        if stale:
            self._draw([stale])

    def repaint(self) -> None:
        """Paint everything again."""
        self._painted.clear()
        self.paint(self._wanted)

    def animate(self, frames: Sequence[Mapping[str, Scene]], milliseconds: float) -> None:
        """Play frames; what the last one that has a layer shows on it stays.

        The browser plays them asynchronously.

        Args:
            frames: the frames in order, each with the layers that it changes.
            milliseconds: the duration of each frame.
        """
        # Finish first what an exception interrupted.
        self.paint(self._wanted)
        for frame in frames:
            self._wanted |= frame
        self._draw(frames, milliseconds)

    def _draw(self, frames: Sequence[Mapping[str, Scene]], milliseconds: float = 0.0) -> None:
        # These layers count as unknown until everything is sent: after an exception they are
        # painted again.
        changed = {name: scene for frame in frames for name, scene in frame.items()}
        for name in changed:
            self._painted.pop(name, None)
        names = list(self._wanted)
        with one_message(self.widget):
            for number, frame in enumerate(frames):
                # One pause for all layers of a frame.
                pause = milliseconds if number else 0.0
                for name, scene in frame.items():
                    canvas = self.widget[names.index(name)]
                    if pause:
                        canvas.sleep(pause)
                        pause = 0.0
                    paint(canvas, scene.shapes, screen_scale(scene))
        self._painted |= {name: scene.shapes for name, scene in changed.items()}

    def close(self) -> None:
        """Remove the widget from the screen, and free its memory."""
        self.widget.on_client_ready(self.repaint, remove=True)
        self.widget.close()
        # The layers themselves stay: a front end that still plays their last frames and did not
        # find them would stop drawing on all canvases of the page.
        for layer in range(len(self._wanted)):
            self.widget[layer].width = self.widget[layer].height = 1


def _size(layers: Mapping[str, Scene]) -> tuple[int, int]:
    scene = next(iter(layers.values()))
    scale = screen_scale(scene)
    return math.ceil(scale * scene.width), math.ceil(scale * scene.height)
