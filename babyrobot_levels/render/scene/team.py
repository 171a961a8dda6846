"""Several robots as they are drawn: each in its colour, small where it has arrived."""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.language.looks import Theme
from babyrobot_levels.render.colors import GRAPHICS, ink_on, is_gray
from babyrobot_levels.render.scene.icons import Spot
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Path, Shape, rounded, scaled, shifted
from babyrobot_levels.render.situation import STANDING, Mood, Pose

_COLORS = ("#0072b2", "#cc79a7", "#009e73")
"""The colours of the second robot and the next, which those who are colour-blind tell apart.

They are from Okabe and Ito, https://jfly.uni-koeln.de/color/.
"""

_GRAYS = ("#8a8a8a", "#1f1f1f", "#d0d0d0")
"""The same for a theme of greys, the first of them far from the dark grey of its robot."""

_ARRIVED = Pose(STANDING.facing, Mood.CHEER)


def robot_color(level: LevelSpec, number: int) -> str:
    """Return the colour of one of several robots."""
    robot, theme = level.robots[number], level.resolved_theme
    if robot.color is not None:
        return robot.color
    if number == 0:
        return theme.colors.robot
    return (_GRAYS if is_gray(theme.colors) else _COLORS)[number - 1]


def robot_theme(level: LevelSpec, number: int) -> Theme:
    """Return the theme in which one of several robots is drawn."""
    return level.resolved_theme.with_robot(robot_color(level, number))


def teammate_shapes(level: LevelSpec, number: int, spot: Spot, *, arrived: bool) -> Iterator[Shape]:
    """Yield the figure of one of several robots.

    Args:
        level: the level.
        number: its number in the list.
        spot: where it is drawn.
        arrived: whether it has arrived at its exit.
    """
    shapes = robot_shapes(robot_theme(level, number), 0.0, 0.0, _ARRIVED if arrived else STANDING)
    half = CELL / 2 * spot.scale
    yield from shifted(scaled(shapes, spot.scale, 0.0, 0.0), spot.x - half, spot.y - half)


def own_exit_shapes(level: LevelSpec, layout: Layout) -> Iterator[Shape]:
    """Yield a frame in the colour of each robot that has an exit of its own, one in another."""
    insets: dict[Cell, float] = {}
    for number, robot in enumerate(level.robots):
        if robot.exit is not None:
            left, top = layout.corner(*robot.exit)
            inset = insets.setdefault(robot.exit, 5.0)
            side, color = CELL - 2 * inset, robot_color(level, number)
            frame = rounded(left + inset, top + inset, side, side, 7.0)
            rim = ink_on([level.resolved_theme.colors.exit], color, GRAPHICS)
            yield Path(frame, stroke=rim, width=6.4)
            yield Path(frame, stroke=color, width=4.0)
            insets[robot.exit] += 6.5
