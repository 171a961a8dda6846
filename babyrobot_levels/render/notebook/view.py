"""A level in a notebook, the robot moving in it, and the picture that stays in the notebook's file.

A notebook stores every MIME type of a cell's output, and a program that opens it later shows the
one it prefers. JupyterLab, Notebook and VS Code prefer widgets, even without a kernel, and then
show only an error. So the picture is displayed as an output of its own beside the widget, and a
style sheet shows the one of the two that has something to show.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.notebook.html import (
    HTML,
    MARKDOWN,
    SVG,
    TEXT,
    WIDGET,
    Bundle,
    Frontend,
    frontend,
    in_words,
    is_too_large,
    picture_mimebundle,
)
from babyrobot_levels.render.scene.build import build_layers, overlay_shapes
from babyrobot_levels.render.scene.layout import CELL, Overlay, layout_of
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene, Shape, shifted, toned
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.things import moving_pieces, pieces
from babyrobot_levels.render.situation import (
    STANDING,
    Mood,
    Pose,
    RobotPlace,
    place_of,
    pose_of,
    situation_of,
)
from babyrobot_levels.render.text import TextPainter
from babyrobot_levels.render.words.describe import describe

if TYPE_CHECKING:
    from ipycanvas import MultiCanvas  # type: ignore[import-untyped]
    from IPython.display import DisplayHandle

    from babyrobot_levels.render.notebook.canvas import LayeredCanvas

STEP_SECONDS = 0.25
"""The duration of a step at speed 1."""

_GLIDE_SHARE = 0.8
"""The part of a step in which the robot moves; the rest lets slow browsers catch up."""

_FRAME_SECONDS = 0.025

_COLAB_NOTE = (
    "This is a picture of each step. Colab shows the robot moving only after "
    "`google.colab.output.enable_custom_widget_manager()`."
)


class LevelView:
    """A level as a notebook shows it, with the robot.

    If a person watches, every `move` waits until the previous one is finished, and an overlay stays
    long enough to be read. Programs that run a notebook are not slowed down.

    Args:
        level: the level; a maze needs a seed.
        speed: the robot's speed; at 1 a step takes a quarter of a second. None for the speed that
            the level sets.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """

    def __init__(self, level: GridWorld, *, speed: float | None = None) -> None:
        self._step_seconds = STEP_SECONDS / (level.display.robot.speed if speed is None else speed)
        self._frontend = frontend()
        self._canvas: LayeredCanvas | None = None
        self._output: Output | None = None
        # The CSS class of the canvas and its picture.
        self._name = ""
        self._busy_until = self._read_until = 0.0
        x, y = level.starts[0]
        self._build(level, y * level.size[0] + x, STANDING, None)

    def _build(self, level: GridWorld, state: int, pose: Pose, overlay: Overlay | None) -> None:
        self._layers = build_layers(
            level, state=state, heading=pose.heading, pose=pose, overlay=overlay
        )
        self._layout = layout_of(level, overlay=overlay)
        self._level, self._state, self._pose = level, state, pose
        self._overlay = overlay or Overlay()
        self._slots = Slots(level, self._layout, self._overlay)

    # -- where it is shown -----------------------------------------------------------------

    @property
    def widget(self) -> MultiCanvas:
        """The canvas. Its layers are those of `babyrobot_levels.render.scene.build.LAYERS`."""
        if self._canvas is None:
            # Created on first use: a program would store widgets that nobody can see.
            from babyrobot_levels.render.notebook.canvas import LayeredCanvas

            self._canvas = LayeredCanvas(self._layers)
        return self._canvas.widget

    def show(self) -> None:
        """Show the view in the running cell, once. Outside a notebook nothing happens."""
        if self._output is not None or self._frontend is Frontend.NONE:
            return
        self._begin()
        if self._frontend is Frontend.CANVAS:
            display_bundle(self._widget_bundle())
        elif self._frontend is Frontend.PICTURES:
            display_bundle({MARKDOWN: _COLAB_NOTE, TEXT: _COLAB_NOTE})

    def mimebundle(self) -> Bundle:
        """Return what the view shows as the last line of a cell.

        The first call shows it there as `show` does. Later calls return the current picture, and
        outside a notebook the widget and the picture.
        """
        if self._frontend is Frontend.CANVAS and self._output is None:
            self._begin()
            return self._widget_bundle()
        widget = self._widget_bundle() if self._frontend is Frontend.NONE else {}
        return widget | self._picture()

    def _begin(self) -> None:
        if self._frontend is Frontend.CANVAS:
            self._name = f"babyrobot-{self.widget.model_id}"
            self.widget.add_class(self._name)
            self._output = CellOutput(self._picture, self._name)
        elif self._frontend is Frontend.PROGRAM:
            self._output = CellOutput(self._picture)
        else:
            self._output = Output(self._picture)

    def _widget_bundle(self) -> Bundle:
        # Where no widget can be shown, and in files that nbconvert makes, the picture above it is
        # all there is to see.
        return {WIDGET: self.widget._repr_mimebundle_()[WIDGET], TEXT: ""}

    def _picture(self) -> Bundle:
        if is_too_large(self._level):
            return in_words(self._level)
        shapes = tuple(shape for layer in self._layers.values() for shape in layer.shapes)
        text = TextPainter(self._level, overlay=self._overlay).lines(self._state)
        description = describe(self._level, self._state)
        scene = replace(self._layers["base"], shapes=shapes, description=description)
        bundle = picture_mimebundle(scene, "\n".join(text))
        if self._frontend is Frontend.CANVAS:
            bundle[SVG] = bundle[SVG].replace("<svg ", f'<svg class="{self._name}" ', 1)
        return bundle

    # -- what it shows ---------------------------------------------------------------------

    def move(self, state: int, pose: Pose = STANDING) -> None:
        """Show a state: the robot and movers glide to neighbouring cells and jump to others.

        Args:
            state: the configuration and the cell, `configuration * cells + y * width + x`.
            pose: the robot's pose in that cell.

        Raises:
            ValueError: the level has no such state.
        """
        place = place_of(self._level, state)
        self._wait(self._busy_until)
        frames = [*self._gliding(place, pose), self._changed(place, pose)]
        self._state, self._pose = state, pose
        self._layers |= frames[-1]
        if self._canvas is not None:
            self._canvas.animate(frames, 1000 * _FRAME_SECONDS)
        if self._output is not None:
            self._output.refresh()
        if self._is_watched:
            self._busy_until = time.monotonic() + self._step_seconds

    def set_overlay(self, overlay: Overlay | None) -> None:
        """Replace the overlay; None removes it.

        If a person watches, the previous overlay stays for the duration of a step.

        Raises:
            ValueError: the overlay has another size than the level.
        """
        self._wait(self._read_until)
        self._build(self._level, self._state, self._pose, overlay)
        self._paint()
        if self._is_watched:
            self._read_until = time.monotonic() + self._step_seconds

    def set_level(self, level: GridWorld, state: int) -> None:
        """Show another level, in one of its states. The overlay stays.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
            ValueError: the level has no such state, or another size than the overlay.
        """
        self._build(level, state, STANDING, self._overlay)
        self._paint()

    def _paint(self) -> None:
        if self._canvas is not None:
            self._canvas.paint(self._layers)
        if self._output is not None:
            self._output.refresh()

    def _changed(self, place: RobotPlace, pose: Pose) -> dict[str, Scene]:
        """Return the layers that a new state and pose change: always the robot's."""
        level, layout = self._level, self._layout
        layers: dict[str, tuple[Shape, ...]] = {}
        if level.has_things:
            still = pieces(level, layout, situation_of(level, place.configuration), self._slots)
            layers["things"] = tuple(shape for piece in still for shape in piece.shapes)
            moving = (figure for _, figure in self._movers(place))
            layers["movers"] = tuple(shape for figure in moving for shape in figure)
        if self._overlay.parts is not None:
            part = self._overlay.at(place.configuration, pose.heading)
            layers |= overlay_shapes(level, part, layout, self._slots)._asdict()
        scenes = {name: self._scene(shapes) for name, shapes in layers.items()}
        changed = {name: scene for name, scene in scenes.items() if scene != self._layers[name]}
        return {**changed, "robot": self._robot(place.y, place.x, pose)}

    def _gliding(self, place: RobotPlace, pose: Pose) -> Iterator[dict[str, Scene]]:
        """Yield the frames of a step in which the robot or movers go to neighbouring cells."""
        if not self._is_watched:
            return
        before = place_of(self._level, self._state)
        shift = _step(before.cell, place.cell)
        movers = self._movers(before)
        shifts = [
            _step(cell, to) for (cell, _), (to, _) in zip(movers, self._movers(place), strict=True)
        ]
        if not any((shift, *shifts)):
            return
        # It cheers only when it has arrived.
        mood = Mood.SLIP if pose.mood is Mood.SLIP else Mood.CALM
        width = self._level.size[0]
        here, there = (y * width + x for x, y in (before.cell, place.cell))
        facing = pose_of(here, there, Action.STAY, width).facing
        count = int(_GLIDE_SHARE * self._step_seconds / _FRAME_SECONDS)
        for share in (number / (count + 1) for number in range(1, count + 1)):
            frame = {}
            if shift is not None:
                x, y = before.x + share * shift[0], before.y + share * shift[1]
                way = Pose(facing, mood, share).turned(pose.heading)
                frame["robot"] = self._robot(y, x, way)
            if any(shifts):
                frame["movers"] = self._scene(
                    shape
                    for (_, figure), way in zip(movers, shifts, strict=True)
                    for shape in shifted(
                        figure, *(share * CELL * length for length in way or (0, 0))
                    )
                )
            yield frame

    def _movers(self, place: RobotPlace) -> list[tuple[Cell, tuple[Shape, ...]]]:
        """Return the cell and the figure of each mover."""
        situation = situation_of(self._level, place.configuration)
        crowded = self._overlay.fills_cells
        found = moving_pieces(self._level, self._layout, situation, place.cell, crowded=crowded)
        return [(cell, piece.shapes) for cell, piece in found]

    def _robot(self, y: float, x: float, pose: Pose) -> Scene:
        """Return the robot's layer with the robot in a cell, or between two."""
        corner = self._layout.corner(x, y)
        small = self._overlay.is_crowded
        return self._scene(robot_shapes(self._level.resolved_theme, *corner, pose, small=small))

    def _scene(self, shapes: Iterable[Shape]) -> Scene:
        """Return a layer with these shapes."""
        shapes = toned(shapes, self._level.resolved_theme.colors)
        return replace(self._layers["robot"], shapes=shapes)

    @property
    def _is_watched(self) -> bool:
        return self._frontend in (Frontend.CANVAS, Frontend.PICTURES)

    def _wait(self, until: float) -> None:
        """Wait until a time of the monotonic clock."""
        time.sleep(max(0.0, until - time.monotonic()))

    def close(self) -> None:
        """Stop updating the view; the last picture stays where the view was shown.

        A widget that is shown elsewhere stays. Closing twice has no effect.
        """
        if self._output is None:
            return
        self._wait(self._busy_until)
        self._output.close()
        if self._canvas is not None:
            self._canvas.close()
        self._output = self._canvas = None


def _step(before: Cell, after: Cell) -> tuple[int, int] | None:
    """Return the step to a neighbouring cell; None to another one, or the same."""
    dx, dy = after[0] - before[0], after[1] - before[1]
    return (dx, dy) if abs(dx) + abs(dy) == 1 else None


# -- the output of a cell --------------------------------------------------------------------------

_STYLE = """\
<style class="{name}">
.jp-OutputArea:has(:is(canvas, div).{name}) .jp-OutputArea-child:has(style.{name})\
 + .jp-OutputArea-child,
body:has(:is(canvas, div).{name}) svg.{name},
.jp-OutputArea-child:has(style.{name}) + * + .jp-OutputArea-child:has(> .lm-Panel:last-child)\
:not(:has(> .lm-Panel > *)),
.jp-OutputArea-child:has(style.{name}) {{ display: none }}
</style>"""
"""Hides the picture if the widget's canvas or element is shown: in JupyterLab and Notebook its
whole output, elsewhere its SVG. Hides a widget's output that contains only an error, and itself."""


def display_bundle(bundle: Bundle) -> DisplayHandle:
    """Display a bundle in the running cell; return a handle to replace it."""
    from IPython.display import display

    handle: DisplayHandle = display(  # type: ignore[no-untyped-call]
        bundle, raw=True, display_id=True
    )
    return handle


class Output:
    """A picture in the running cell.

    Args:
        still: returns the picture as it is now.
        beside: the CSS class of the picture, and of the widget that is displayed after it: it is
            shown only if that is not. Empty for no widget.
    """

    def __init__(self, still: Callable[[], Bundle], beside: str = "") -> None:
        if beside:
            display_bundle({HTML: _STYLE.format(name=beside), TEXT: ""})
        self._still = still
        self._handle = display_bundle(still())

    def refresh(self) -> None:
        """Show the changed picture."""
        self._handle.update(self._still(), raw=True)  # type: ignore[no-untyped-call]

    def close(self) -> None:
        """Stop updating the picture."""


class CellOutput(Output):
    """A picture that is updated once, when a cell has finished."""

    def __init__(self, still: Callable[[], Bundle], beside: str = "") -> None:
        from IPython.core.getipython import get_ipython

        super().__init__(still, beside)
        self._is_stale = False
        shell = get_ipython()
        assert shell is not None
        self._events = shell.events
        self._events.register("post_run_cell", self._update)

    def refresh(self) -> None:
        """Note that the picture has changed; it is updated when the cell has finished."""
        self._is_stale = True

    def _update(self, _: object = None) -> None:
        if self._is_stale:
            super().refresh()
        self._is_stale = False

    def close(self) -> None:
        """Stop updating the picture."""
        self._update()
        self._events.unregister("post_run_cell", self._update)
