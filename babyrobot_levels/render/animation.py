"""The GIF painter: an episode as a small film in which the robot glides from cell to cell."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.film import film_of, laid
from babyrobot_levels.render.gif import Frame, Patch, encoded
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_base
from babyrobot_levels.render.scene.layout import CELL, Layout, layout_of, panel_width
from babyrobot_levels.render.scene.overlays import Overlay
from babyrobot_levels.render.scene.overlays.notes import panel_texts
from babyrobot_levels.render.scene.panels import compass_shapes, panel_shapes
from babyrobot_levels.render.scene.pose import STANDING, Pose, pose_of
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene
from babyrobot_levels.render.svg import number

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.film import Film

MAX_SIDE = 800
"""A film that is given no scale is at most this many pixels wide and high."""

MAX_PIXELS = 400_000_000
"""The most pixels of all frames together."""

_SMOOTH_PIXELS = 120_000_000
"""Films of more pixels do without the frames between cells."""

_BETWEEN = 4
"""The number of frames between two cells."""

_FRAME, _ARRIVAL, _START, _END = 40, 100, 700, 1500
"""How long frames are shown, in milliseconds: between cells, in a cell, at the start, at the end.
"""

_SHORTEST = 20
"""Frames that are shown for less time are slowed down by many viewers."""

_NUDGE = 0.13
"""How far into a wall the robot bumps, as a share of a cell."""

Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Step:
    """A step of an episode, as a film shows it.

    Attributes:
        state: the cell that the robot leaves, `y * width + x`.
        action: what he was told to do, a `brl.Action`.
        next_state: the cell in which he arrives.
        reward: what that gives.
        skidded: whether chance led him elsewhere.
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
) -> bytes:
    """Return an episode as a GIF file that plays for ever; the same arguments give the same bytes.

    A level that has a panel shows in it the number of steps and the return up to then.

    Args:
        level: the level; a maze needs a seed.
        steps: the steps of the episode, at least one.
        overlay: what is written over the cells, below the robot.
        scale: the size, where 1 is 64 pixels a cell. None takes the largest up to 1 that keeps
            width and height within 800 pixels.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: there is no step, or so many pixels would be too many.
    """
    if not steps:
        raise ValueError("an episode has at least one step")
    layout = layout_of(level, overlay=overlay)
    if scale is None:
        scale = min(1.0, MAX_SIDE / max(layout.width, layout.height))
    width, height = round(scale * layout.width), round(scale * layout.height)
    if (len(steps) + 1) * width * height > MAX_PIXELS:
        raise ValueError(f"a film of {len(steps)} steps and {width} x {height} pixels is too large")
    between = _BETWEEN if (_BETWEEN + 1) * len(steps) * width * height <= _SMOOTH_PIXELS else 0
    stage = _Stage(level, layout, overlay, scale)
    frames = []
    for shot in _shots(level, steps, between):
        patches = (stage.robot(shot.place, shot.pose), *stage.panels(shot.steps, shot.total))
        frames.append(Frame(patches, shot.time))
    return encoded(stage.ground, frames)


@dataclass(frozen=True, slots=True)
class _Shot:
    """What a frame shows: the robot's place and pose, the score, and for how long."""

    place: Place
    pose: Pose
    steps: int
    total: float
    time: int


def _shots(level: GridWorld, steps: Sequence[Step], between: int) -> Iterator[_Shot]:
    columns = level.size[0]
    exits = {y * columns + x for x, y in level.exits}
    speed = level.display.robot.speed
    frame, arrival = (max(_SHORTEST, round(time / speed)) for time in (_FRAME, _ARRIVAL))

    def place(state: int) -> Place:
        y, x = divmod(state, columns)
        return float(x), float(y)

    yield _Shot(place(steps[0].state), STANDING, 0, 0.0, _START)
    total = 0.0
    for count, step in enumerate(steps, 1):
        start, end = place(step.state), place(step.next_state)
        way = step.state, step.next_state, step.action, columns
        pose = pose_of(*way, skidded=step.skidded)
        for index in range(1, between + 1):
            phase = index / (between + 1)
            walking = pose if start == end else replace(pose, phase=phase)
            yield _Shot(_on_the_way(step, start, end, phase), walking, count - 1, total, frame)
        total += step.reward
        pose = pose_of(*way, skidded=step.skidded, at_exit=step.next_state in exits)
        yield _Shot(end, pose, count, total, _END if count == len(steps) else arrival)


def _on_the_way(step: Step, start: Place, end: Place, phase: float) -> Place:
    if step.state == step.next_state and step.action != Action.STAY and not step.skidded:
        reach = _NUDGE * math.sin(math.pi * phase)
        dx, dy = _SHIFTS[Action(step.action)]
        return start[0] + reach * dx, start[1] + reach * dy
    eased = phase * phase * (3 - 2 * phase)
    return start[0] + eased * (end[0] - start[0]), start[1] + eased * (end[1] - start[1])


_SHIFTS = {
    Action.NORTH: (0, -1),
    Action.EAST: (1, 0),
    Action.SOUTH: (0, 1),
    Action.WEST: (-1, 0),
}


class _Stage:
    """The ground, and the patches that are laid on it."""

    def __init__(
        self, level: GridWorld, layout: Layout, overlay: Overlay | None, scale: float
    ) -> None:
        self._level, self._layout, self._scale = level, layout, scale
        self._size = round(scale * layout.width), round(scale * layout.height)
        self.ground = to_rgb(build_base(level, overlay=overlay), self._size)
        self._robots: dict[Pose, Film] = {}
        self._panels: tuple[tuple[int, float], tuple[Patch, ...]] | None = None

    def robot(self, place: Place, pose: Pose) -> Patch:
        """Return the robot's surroundings with him in it."""
        left, top = (round(self._scale * at) for at in self._layout.corner(*place))
        side = max(1, round(self._scale * CELL))
        if pose not in self._robots:
            scene = Scene(CELL, CELL, robot_shapes(self._level.resolved_theme, 0.0, 0.0, pose))
            self._robots[pose] = film_of(lambda ground: to_rgb(scene, (side, side), ground))
        ground = self.ground[top : top + side, left : left + side]
        return Patch(left, top, laid(self._robots[pose], ground))

    def panels(self, steps: int, total: float) -> tuple[Patch, ...]:
        """Return the level's panel with the score in it, if it has one."""
        if self._panels is None or self._panels[0] != (steps, total):
            self._panels = (steps, total), tuple(self._scored(steps, total))
        return self._panels[1]

    def _scored(self, steps: int, total: float) -> Iterator[Patch]:
        layout, score = self._layout, [f"Steps: {steps}", f"Return: {number(total)}"]
        # A panel is painted by itself: beside a grid without columns, or below one without rows.
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
            *compass_shapes(self._level, strip),
            *panel_texts(self._level, overlay, strip),
        )
        size = round(self._scale * strip.width), round(self._scale * strip.height)
        pixels = to_rgb(Scene(strip.width, strip.height, shapes), size)
        pixels = pixels[math.ceil(self._scale * top) :, math.ceil(self._scale * left) :]
        if top == 0.0:
            # The strip reaches down as far as the grid, beside which it stands.
            pixels = pixels[: math.floor(self._scale * layout.top_height)]
        height, width = pixels.shape[:2]
        yield Patch(self._size[0] - width, 0 if top == 0.0 else self._size[1] - height, pixels)
