"""Many text pictures of one level, fast: the walls are drawn once, the robot is put on a copy."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.render.ansi import paint
from babyrobot_levels.render.numbers import WIDEST, number_lines
from babyrobot_levels.render.scene.overlays import Overlay, Rows
from babyrobot_levels.render.terminal import cut_out
from babyrobot_levels.render.text import ROBOT, policy_drawing, unicode_drawing
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

PLAIN_ROBOT = "@"


class TextPainter:
    """Draws a level as text, one picture for each state of the robot.

    Args:
        level: the level; a maze needs a seed.
        plain: whether to use ASCII characters only.
        overlay: what is shown of the level. Arrows stand in the cells; values, visits, notes and
            the lines of panels below the drawing. The rest is left to pictures.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """

    def __init__(
        self, level: GridWorld, *, plain: bool = False, overlay: Overlay | None = None
    ) -> None:
        overlay = overlay or Overlay()
        self._level, self._grid = level, level.grid()
        if overlay.actions is not None:
            # Of several actions a character shows the highest number: a move sooner than stay.
            policy = [[max(best, default=-1) for best in row] for row in overlay.actions]
            drawing = policy_drawing(level, self._grid, policy, plain=plain)
        else:
            drawing = level.draw() if plain else unicode_drawing(level, self._grid)
        self._drawing = drawing.splitlines()
        self._robot = PLAIN_ROBOT if plain else ROBOT
        self._below = [printable(line) for line in _below(overlay)]

    def lines(
        self, state: int, *, color: bool = False, room: os.terminal_size | None = None
    ) -> list[str]:
        """Return the lines of the picture.

        Args:
            state: the cell of the robot, `y * width + x`.
            color: whether to paint it in the theme's colours, with 24-bit ANSI escapes.
            room: how many columns and lines there are. Of a larger drawing, the part around the
                robot is shown.
        """
        y, x = divmod(state, self._grid.width)
        row, column = 2 * y + 1, 4 * x + 2
        lines = self._drawing.copy()
        lines[row] = lines[row][:column] + self._robot + lines[row][column + 1 :]
        if room is None:
            if color:
                lines = paint(lines, self._level, self._grid, state)
            return [*lines, *self._below]
        below = cut_out(self._below, 0, 0, room.columns, room.lines // 2)
        width = min(room.columns, len(lines[0]))
        height = min(room.lines - len(below), len(lines))
        left = min(max(0, column - width // 2), len(lines[0]) - width)
        top = min(max(0, row - height // 2), len(lines) - height)
        if color:
            # Lines that are not shown need no colours.
            shown = [line if top <= n < top + height else "" for n, line in enumerate(lines)]
            lines = paint(shown, self._level, self._grid, state)
        return [*cut_out(lines, left, top, width, height), *below]


def _below(overlay: Overlay) -> Iterator[str]:
    """Yield the lines below the drawing: each block begins with an empty one."""
    if overlay.values is not None:
        yield from _table(overlay.values, overlay.precision)
    if overlay.visits is not None:
        yield from _table(overlay.visits, 0)
    notes = [f"[{note.x:g}, {note.y:g}] {note.text}" for note in overlay.notes]
    for block in (notes, overlay.side_panel, overlay.bottom_panel):
        if block:
            yield ""
        for text in block:
            yield from text.splitlines()


def _table(rows: Rows[float | None], precision: int) -> Iterator[str]:
    if len(rows[0]) > WIDEST:
        return
    yield ""
    yield from number_lines(rows, precision)
