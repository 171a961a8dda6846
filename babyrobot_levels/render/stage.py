"""A picture in layers on an ipycanvas widget. What changes is painted, in one message."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ipycanvas import Canvas, MultiCanvas  # type: ignore[import-untyped]

from babyrobot_levels.render.canvas import one_message, paint
from babyrobot_levels.render.scene.shapes import Scene, Shape, screen_scale


class Stage:
    """Layers of a picture, one canvas each.

    Drawing is messages, not state: a front end that connects later has seen none of them. It is
    given the whole picture as soon as it says that it is there.

    Args:
        layers: the layers by their names, from the bottom up, all of one size.

    Attributes:
        widget: what shows them.
    """

    def __init__(self, layers: Mapping[str, Scene]) -> None:
        self._wanted = dict(layers)
        self._painted: dict[str, tuple[Shape, ...]] = {}
        width, height = _size(self._wanted)
        self.widget = MultiCanvas(
            len(layers),
            width=width,
            height=height,
            layout={"max_width": "100%", "height": "auto"},
        )
        self.widget.on_client_ready(self.repaint)
        self.paint(layers)

    def paint(self, layers: Mapping[str, Scene]) -> None:
        """Paint what differs from what is seen. The size may be another one.

        Args:
            layers: all layers, by the names that they had at first.
        """
        self._wanted = dict(layers)
        size = _size(self._wanted)
        if size != (self.widget.width, self.widget.height):
            self._painted.clear()
            self.widget.width, self.widget.height = size
        stale = {
            name: [scene]
            for name, scene in layers.items()
            if self._painted.get(name) != scene.shapes
        }
        if stale:
            self._draw(stale)

    def repaint(self) -> None:
        """Paint everything again."""
        self._painted.clear()
        self.paint(self._wanted)

    def animate(self, name: str, frames: Sequence[Scene], milliseconds: float) -> None:
        """Play frames on a layer; the last one stays.

        The browser plays them, while Python goes on.

        Args:
            name: the layer.
            frames: what it shows, one after the other.
            milliseconds: how long each of them is seen.
        """
        # What an exception left unfinished comes first.
        self.paint(self._wanted)
        self._wanted[name] = frames[-1]
        self._draw({name: frames}, milliseconds)

    def _draw(self, films: Mapping[str, Sequence[Scene]], milliseconds: float = 0.0) -> None:
        # Until all of it is sent, nothing is known of these layers: what an exception leaves
        # unfinished is painted the next time.
        for name in films:
            self._painted.pop(name, None)
        names = list(self._wanted)
        with one_message(self.widget):
            for name, frames in films.items():
                self._animate(self.widget[names.index(name)], frames, milliseconds)
        self._painted |= {name: frames[-1].shapes for name, frames in films.items()}

    def _animate(self, canvas: Canvas, frames: Sequence[Scene], milliseconds: float) -> None:
        for number, frame in enumerate(frames):
            if number:
                canvas.sleep(milliseconds)
            paint(canvas, frame.shapes, screen_scale(frame))

    def close(self) -> None:
        """Take the widget off the screen, and let go of its memory."""
        self.widget.on_client_ready(self.repaint, remove=True)
        self.widget.close()
        # The layers themselves stay: a front end that still plays their last frames and did not
        # find them would draw nothing any more, on no canvas of the page.
        for layer in range(len(self._wanted)):
            self.widget[layer].width = self.widget[layer].height = 1


def _size(layers: Mapping[str, Scene]) -> tuple[int, int]:
    scene = next(iter(layers.values()))
    scale = screen_scale(scene)
    return math.ceil(scale * scene.width), math.ceil(scale * scene.height)
