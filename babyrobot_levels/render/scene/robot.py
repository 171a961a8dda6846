"""Baby Robot itself, drawn for a cell of 64 pixels; it never leaves its cell."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from babyrobot_levels.language.looks import Colors, Theme
from babyrobot_levels.mdp.actions import DELTAS, Action
from babyrobot_levels.render.colors import BLACK, WHITE
from babyrobot_levels.render.scene.shapes import (
    Command,
    Ellipse,
    Path,
    Point,
    Rect,
    Shape,
    circle,
    curve,
    mapped,
    polygon,
    polyline,
    rounded,
    scaled,
    shifted,
)
from babyrobot_levels.render.scene.slots import ROBOT_CORNER, SMALL_ROBOT
from babyrobot_levels.render.situation import STANDING, Mood, Pose

OUTLINE = "#232c38"
VISOR = "#17202b"
GLOW = "#8af3ff"
LAMP = "#ffd54a"

_TURN = {Action.EAST: 1, Action.WEST: -1}
_BOB = 1.5
"""How high a step lifts it, in pixels."""
_SWAY = 3.5
"""How far a step makes it lean, in degrees."""
_HOP = 2.0
_SLIP = 15.0


def robot_shapes(
    theme: Theme, left: float, top: float, pose: Pose = STANDING, *, small: bool = False
) -> tuple[Shape, ...]:
    """Return the robot.

    Args:
        theme: the theme; its colour `robot` is that of the body.
        left: the left edge of the robot's cell in pixels.
        top: the upper edge of the cell.
        pose: the robot's pose.
        small: whether it is in a corner of the cell, beside arrows or values of actions.
    """
    shapes = _shapes(theme.colors, left, top, pose)
    if small:
        right, down = ROBOT_CORNER
        shapes = shifted(scaled(shapes, SMALL_ROBOT, left, top), right, down)
    return tuple(shapes)


def _shapes(colors: Colors, left: float, top: float, pose: Pose) -> Iterator[Shape]:
    body = colors.robot
    ground = Figure(left, top)
    turn = _TURN.get(pose.facing, 0)
    stride = math.sin(2 * math.pi * pose.phase)
    lean, lift = _SWAY * stride, _BOB * abs(stride)
    if pose.mood is Mood.SLIP:
        lean = -_SLIP if turn > 0 else _SLIP
    elif pose.mood is Mood.CHEER:
        lean, lift = 0.0, _HOP
    figure = Figure(left, top, lean, lift)
    yield ground.disc(32, 50.5, 16 - lift, 3 - 0.2 * lift, BLACK, 0.28)
    if pose.mood is Mood.SLIP:
        yield from _splash(ground, colors.puddle)
    yield from _wheels(figure, turn)
    yield from _arms(figure, body, pose, turn)
    yield from _trunk(figure, body, pose.facing, turn)
    yield from _antenna(figure, pose, turn)
    yield from _head(figure, body, pose.facing, turn)
    if pose.facing is not Action.NORTH:
        yield from _face(figure, pose, turn)
    if pose.heading is not None:
        yield from _pointer(left, top, pose.heading, colors.arrows)


def _pointer(left: float, top: float, heading: int, color: str) -> Iterator[Shape]:
    """Yield the arrow at the edge of the cell to which a robot that turns is heading."""
    dx, dy = DELTAS[Action(heading + Action.NORTH)]
    x, y = left + 32, top + 32
    points = [
        (x + along * dx - across * dy, y + along * dy + across * dx)
        for along, across in ((29.5, 0), (21, 10), (21, -10))
    ]
    for ink, width in ((OUTLINE, 5.6), (WHITE, 3.2)):
        yield Path(polygon(points), stroke=ink, width=width)
    yield Path(polygon(points), fill=color, stroke=color, width=0.8)


def _wheels(figure: Figure, turn: int) -> Iterator[Shape]:
    """Yield two wheels: from the front they are narrow, from the side round."""
    for x in (22, 42):
        if turn:
            middle = x + (3 if x < 32 else -3)
            yield figure.disc(middle, 46, 5.6, 5.6, OUTLINE)
            yield figure.disc(middle, 46, 2.1, 2.1, WHITE, 0.55)
        else:
            yield figure.bar(x - 4.5, 41, 9, 10, 4.5, OUTLINE)
            yield figure.disc(x, 46, 1.8, 1.8, WHITE, 0.55)


def _arms(figure: Figure, body: str, pose: Pose, turn: int) -> Iterator[Shape]:
    """Yield the arms, which are seen only when the robot slips or cheers."""
    if pose.mood is Mood.CALM:
        return
    for side in (-1, 1):
        if pose.mood is Mood.CHEER:
            hand = (32 + 25.5 * side, 14.0)
            arm = curve((32 + 10 * side, 38), (32 + 25 * side, 38), hand)
        else:
            hand = (32 + 22.5 * side, 40.0 - 2 * side * turn)
            arm = curve((32 + 10 * side, 38), (32 + 17 * side, 36), hand)
        for color, width, radius in ((OUTLINE, 4.6, 3.8), (body, 2.0, 2.5)):
            yield figure.line(arm, color, width)
            yield figure.disc(*hand, radius, radius, color)


def _trunk(figure: Figure, body: str, facing: Action, turn: int) -> Iterator[Shape]:
    yield figure.bar(20.5, 32, 23, 17, 8, OUTLINE)
    yield figure.bar(22, 33, 20, 14.5, 6.5, body)
    yield figure.bar(22, 33, 20, 6, 3, BLACK, 0.18)
    if facing is Action.NORTH:
        yield figure.bar(27, 40.2, 10, 5, 2, OUTLINE)
        yield figure.bar(28.2, 41.4, 5.4, 2.6, 1, LAMP)
    else:
        yield figure.disc(32 + 5 * turn, 43, 2.4, 2.4, LAMP)


def _antenna(figure: Figure, pose: Pose, turn: int) -> Iterator[Shape]:
    """Yield the antenna, which lags behind the movement."""
    root, tip = (32.0 - 2 * turn, 14.0), (32.0 - 6 * turn, 6.2)
    yield figure.line(polyline([root, tip]), OUTLINE, 2.4)
    yield figure.disc(*tip, 3.8, 3.8, OUTLINE)
    yield figure.disc(*tip, 2.5, 2.5, LAMP)


def _head(figure: Figure, body: str, facing: Action, turn: int) -> Iterator[Shape]:
    for side in (-1, 1):
        if side != turn:
            yield figure.bar(28.5 + 20 * side, 19, 7, 11, 3.5, OUTLINE)
    yield figure.bar(11, 10.5, 42, 28, 13.5, OUTLINE)
    yield figure.bar(12.6, 12.1, 38.8, 24.8, 12, body)
    yield figure.bar(18 + turn, 13.4, 28, 4.4, 2.2, WHITE, 0.5)
    if facing is Action.NORTH:
        for y in (22.5, 26, 29.5):
            yield figure.bar(25, y, 14, 1.7, 0.85, OUTLINE, 0.75)
    if turn:
        yield figure.disc(18.5 if turn > 0 else 45.5, 25, 3.6, 5, OUTLINE)
        yield figure.disc(18.5 if turn > 0 else 45.5, 25, 1.7, 2.8, WHITE, 0.35)


def _face(figure: Figure, pose: Pose, turn: int) -> Iterator[Shape]:
    down = 1.6 if pose.facing is Action.SOUTH else 0.0
    middle = 32 + 6.5 * turn
    half = 15.5 - 2.5 * abs(turn)
    yield figure.bar(middle - half, 17 + down, 2 * half, 16.5, 8.2, VISOR)
    gaze = 2.0 * turn
    for side in (-1, 1):
        x = middle + gaze + (6.5 - 0.8 * abs(turn)) * side
        narrow = 0.8 if side == turn else 1.0
        yield from _eye(figure, pose.mood, x, 24 + 1.4 * down, narrow, turn, down)
    yield from _mouth(figure, pose.mood, middle + gaze, 28.2 + down)


def _eye(
    figure: Figure, mood: Mood, x: float, y: float, narrow: float, turn: int, down: float
) -> Iterator[Shape]:
    if mood is Mood.CHEER:
        yield figure.line(curve((x - 3.1, y + 0.2), (x, y - 6), (x + 3.1, y + 0.2)), GLOW, 2.2)
    elif mood is Mood.SLIP:
        yield figure.disc(x, y - 0.4, 4.6 * narrow, 4.8, GLOW)
        yield figure.disc(x + turn, y - 0.4, 1.7, 1.9, VISOR)
    else:
        yield figure.disc(x, y, 3.4 * narrow, 4.1, GLOW)
        yield figure.disc(x + 1.2 * narrow + 0.6 * turn, y - 1.6 + down, 1.2, 1.2, WHITE)


def _mouth(figure: Figure, mood: Mood, x: float, y: float) -> Iterator[Shape]:
    if mood is Mood.CHEER:
        grin = (("M", (x - 4.2, y - 0.9)), ("L", (x + 4.2, y - 0.9)))
        bow = ("C", (x + 3.6, y + 5, x - 3.6, y + 5, x - 4.2, y - 0.9))
        yield figure.patch((*grin, bow, ("Z", ())), GLOW)
    elif mood is Mood.SLIP:
        yield figure.disc(x, y + 2.2, 1.9, 2.1, GLOW)
    else:
        yield figure.line(curve((x - 2.5, y), (x, y + 2.8), (x + 2.5, y)), GLOW, 1.6)


def _splash(ground: Figure, water: str) -> Iterator[Shape]:
    """Yield the water that the robot slips on."""
    yield ground.disc(32, 51, 21, 4.6, water)
    yield ground.disc(32, 51, 15, 2.6, WHITE, 0.2)
    for x, y, r in ((9, 44, 2.2), (13.5, 37.5, 1.5), (55, 43, 2.4), (51.5, 36.5, 1.5)):
        yield ground.disc(x, y, r, 1.25 * r, water)


_SCALE, _LEFT, _TOP = 0.9, 3.2, 0.8
"""A figure leaves room for a text below."""


@dataclass(frozen=True, slots=True)
class Figure:
    """The position and posture of a figure: shapes in its own box of 64 by 64.

    Attributes:
        left: the left edge of its cell in the picture.
        top: the upper edge of its cell.
        lean: the angle by which it leans to the right, in degrees.
        lift: how far it is above the ground.
        pivot: the point around which it leans.
    """

    left: float
    top: float
    lean: float = 0.0
    lift: float = 0.0
    pivot: Point = (32.0, 46.0)

    def at(self, x: float, y: float) -> Point:
        """Return a point of the figure in the picture."""
        if self.lean:
            dx, dy = x - self.pivot[0], y - self.pivot[1]
            cos, sin = math.cos(math.radians(self.lean)), math.sin(math.radians(self.lean))
            x, y = self.pivot[0] + cos * dx - sin * dy, self.pivot[1] + sin * dx + cos * dy
        return self.left + _LEFT + _SCALE * x, self.top + _TOP + _SCALE * (y - self.lift)

    def bar(
        self,
        x: float,
        y: float,
        width: float,
        height: float,
        radius: float,
        fill: str,
        opacity: float = 1.0,
    ) -> Rect | Path:
        """Return a rectangle with round corners; `x`, `y` is its upper left one."""
        if self.lean:
            outline = mapped(rounded(x, y, width, height, radius), self.at)
            return Path(outline, fill=fill, opacity=opacity)
        return Rect(*self.at(x, y), _SCALE * width, _SCALE * height, fill, _SCALE * radius, opacity)

    def disc(
        self, x: float, y: float, rx: float, ry: float, fill: str, opacity: float = 1.0
    ) -> Ellipse | Path:
        """Return an ellipse; `x`, `y` is its centre."""
        if self.lean and rx != ry:
            return Path(mapped(circle(x, y, rx, ry), self.at), fill=fill, opacity=opacity)
        return Ellipse(*self.at(x, y), _SCALE * rx, _SCALE * ry, fill, opacity)

    def line(self, commands: Iterable[Command], stroke: str, width: float) -> Path:
        """Return a line with round ends."""
        return Path(mapped(commands, self.at), stroke=stroke, width=_SCALE * width, cap="round")

    def patch(self, commands: Iterable[Command], fill: str) -> Path:
        """Return a filled outline."""
        return Path(mapped(commands, self.at), fill=fill)
