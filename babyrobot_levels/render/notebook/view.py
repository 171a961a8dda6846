"""A level in a notebook, and the robot as he walks in it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.notebook.bundle import (
    MARKDOWN,
    SVG,
    TEXT,
    WIDGET,
    Bundle,
    in_words,
    is_too_large,
    picture_mimebundle,
)
from babyrobot_levels.render.notebook.frontend import Frontend, frontend
from babyrobot_levels.render.scene.build import build_layers
from babyrobot_levels.render.scene.layout import layout_of
from babyrobot_levels.render.scene.pose import STANDING, Mood, Pose, pose_of
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene
from babyrobot_levels.render.textframes import TextPainter

if TYPE_CHECKING:
    from ipycanvas import MultiCanvas  # type: ignore[import-untyped]

    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.notebook.output import Output
    from babyrobot_levels.render.scene.overlays import Overlay
    from babyrobot_levels.render.stage import Stage

STEP_SECONDS = 0.25
"""How long a step takes at speed 1."""

_GLIDE_SHARE = 0.8
"""The part of a step in which the robot moves. In the rest, browsers that are late catch up."""

_FRAME_SECONDS = 0.025

_NOTE = "Above is a picture. Where ipycanvas is installed and the kernel runs, the robot walks."
_COLAB_NOTE = (
    "This is a picture of each step. Colab shows the robot walking only after "
    "`google.colab.output.enable_custom_widget_manager()`."
)


class LevelView:
    """A level as a notebook shows it, with the robot.

    Where a person watches, the robot takes his time: every `move` waits until the one before is
    over, and what is written over the picture can be read. A program that runs a notebook is not
    held up.

    Args:
        level: the level; a maze needs a seed.
        speed: how fast the robot is; at 1 a step takes a quarter of a second. None for the speed
            that the level asks for.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """

    def __init__(self, level: GridWorld, *, speed: float | None = None) -> None:
        self._step_seconds = STEP_SECONDS / (level.display.robot.speed if speed is None else speed)
        self._frontend = frontend()
        self._stage: Stage | None = None
        self._output: Output | None = None
        # The CSS class by which the canvas and its picture are known.
        self._name = ""
        self._busy_until = self._read_until = 0.0
        x, y = level.starts[0]
        self._build(level, y * level.size[0] + x, STANDING, None)

    def _build(self, level: GridWorld, state: int, pose: Pose, overlay: Overlay | None) -> None:
        self._layers = build_layers(level, state=state, pose=pose, overlay=overlay)
        self._layout = layout_of(level, overlay=overlay)
        self._level, self._state, self._pose, self._overlay = level, state, pose, overlay

    # -- where it is shown -----------------------------------------------------------------

    @property
    def widget(self) -> MultiCanvas:
        """The canvas. Its layers are those of `babyrobot_levels.render.scene.build.LAYERS`."""
        if self._stage is None:
            # Not before somebody asks: a program would store widgets that nobody can see.
            from babyrobot_levels.render.stage import Stage

            self._stage = Stage(self._layers)
        return self._stage.widget

    def show(self) -> None:
        """Show the view in the running cell, once. Outside of a notebook nothing happens."""
        if self._output is not None or self._frontend is Frontend.NONE:
            return
        from babyrobot_levels.render.notebook.output import put_out

        self._begin()
        if self._frontend is Frontend.CANVAS:
            put_out(self._widget_bundle())
        elif self._frontend is Frontend.PICTURES:
            put_out({MARKDOWN: _COLAB_NOTE, TEXT: _COLAB_NOTE})

    def mimebundle(self) -> Bundle:
        """Return what the view shows as the last line of a cell.

        The first time, it is shown there as `show` does. Later it is the picture of the moment; and
        outside of a notebook both, widget and picture.
        """
        if self._frontend is Frontend.CANVAS and self._output is None:
            self._begin()
            return self._widget_bundle()
        widget = self._widget_bundle() if self._frontend is Frontend.NONE else {}
        return widget | self._picture()

    def _begin(self) -> None:
        from babyrobot_levels.render.notebook.output import CellOutput, HiddenOutput, Output

        if self._frontend is Frontend.CANVAS:
            self._name = f"babyrobot-{self.widget.model_id}"
            self.widget.add_class(self._name)
            self._output = HiddenOutput(self._picture, self._name)
        elif self._frontend is Frontend.PROGRAM:
            self._output = CellOutput(self._picture)
        else:
            self._output = Output(self._picture)

    def _widget_bundle(self) -> Bundle:
        return {WIDGET: self.widget._repr_mimebundle_()[WIDGET], TEXT: _NOTE}

    def _picture(self) -> Bundle:
        if is_too_large(self._level):
            return in_words(self._level)
        shapes = tuple(shape for layer in self._layers.values() for shape in layer.shapes)
        text = TextPainter(self._level, overlay=self._overlay).lines(self._state)
        bundle = picture_mimebundle(replace(self._layers["base"], shapes=shapes), "\n".join(text))
        if self._frontend is Frontend.CANVAS:
            bundle[SVG] = bundle[SVG].replace("<svg ", f'<svg class="{self._name}" ', 1)
        return bundle

    # -- what it shows ---------------------------------------------------------------------

    def move(self, state: int, pose: Pose = STANDING) -> None:
        """Have the robot glide to a cell; to one that is not beside his own he jumps.

        Args:
            state: the cell, `y * width + x`.
            pose: how he holds himself when he is there.

        Raises:
            ValueError: the level has no such state.
        """
        columns, rows = self._level.size
        if not 0 <= state < columns * rows:
            raise ValueError(f"state {state} is not on the level")
        self._wait(self._busy_until)
        frames = [*self._on_the_way(state, pose), self._robot(*divmod(state, columns), pose)]
        self._state, self._pose, self._layers["robot"] = state, pose, frames[-1]
        if self._stage is not None:
            self._stage.animate("robot", frames, 1000 * _FRAME_SECONDS)
        if self._output is not None:
            self._output.refresh()
        if self._is_watched:
            self._busy_until = time.monotonic() + self._step_seconds

    def set_overlay(self, overlay: Overlay | None) -> None:
        """Write something over the picture, in the place of what was there; None for nothing.

        Where a person watches, what was written before stays as long as a step takes.

        Raises:
            ValueError: the overlay is not as large as the level.
        """
        self._wait(self._read_until)
        self._build(self._level, self._state, self._pose, overlay)
        self._paint()
        if self._is_watched:
            self._read_until = time.monotonic() + self._step_seconds

    def set_level(self, level: GridWorld, state: int) -> None:
        """Show another level, with the robot in a state. What is written over it stays.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
            ValueError: the level has no such state, or another size than what is written over it.
        """
        self._build(level, state, STANDING, self._overlay)
        self._paint()

    def _paint(self) -> None:
        if self._stage is not None:
            self._stage.paint(self._layers)
        if self._output is not None:
            self._output.refresh()

    def _on_the_way(self, state: int, pose: Pose) -> Iterator[Scene]:
        """Yield the robot's layer between his cell and one beside it."""
        columns, _ = self._level.size
        (y, x), (to_y, to_x) = divmod(self._state, columns), divmod(state, columns)
        if abs(to_x - x) + abs(to_y - y) != 1 or not self._is_watched:
            return
        # Before he cheers, he walks.
        mood = Mood.SLIP if pose.mood is Mood.SLIP else Mood.CALM
        facing = pose_of(self._state, state, Action.STAY, columns).facing
        count = int(_GLIDE_SHARE * self._step_seconds / _FRAME_SECONDS)
        for share in (number / (count + 1) for number in range(1, count + 1)):
            place = y + share * (to_y - y), x + share * (to_x - x)
            yield self._robot(*place, Pose(facing, mood, share))

    def _robot(self, y: float, x: float, pose: Pose) -> Scene:
        """Return the robot's layer with him in a cell, or between two."""
        corner = self._layout.corner(x, y)
        shapes = robot_shapes(self._level.resolved_theme, *corner, pose)
        return replace(self._layers["robot"], shapes=shapes)

    @property
    def _is_watched(self) -> bool:
        return self._frontend in (Frontend.CANVAS, Frontend.PICTURES)

    def _wait(self, until: float) -> None:
        """Wait until a moment of the monotonic clock: until the last step is over, say."""
        time.sleep(max(0.0, until - time.monotonic()))

    def close(self) -> None:
        """Leave the last picture where the view was shown; nothing moves there any more.

        A widget that somebody else shows stays. Closing twice is fine.
        """
        if self._output is None:
            return
        self._wait(self._busy_until)
        self._output.close()
        if self._stage is not None:
            self._stage.close()
        self._output = self._stage = None
