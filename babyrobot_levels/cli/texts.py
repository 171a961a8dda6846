"""Levels and solutions as text: in colour on a terminal, in ASCII elsewhere."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from babyrobot_levels.cli.console import speaks_unicode
from babyrobot_levels.cli.pictures import shown_configuration
from babyrobot_levels.render.terminal import colors_of, room_of
from babyrobot_levels.render.text import WIDEST, TextPainter, number_lines

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.render.scene.overlay import Overlay, Rows

_ALL_LINES = 1 << 30
"""More lines than any picture has: terminals scroll."""


def text_picture(level: Level, *, plain: bool = False, configuration: int | None = None) -> str:
    """Return the level for standard output."""
    if not plain and takes_pictures():
        return _picture(level, None, configuration)
    if configuration is None:
        return level.draw()
    return _joined(
        TextPainter(level, plain=True).lines(None, configuration=configuration, held=False)
    )


def solution_text(
    level: Level,
    solution: Solution,
    *,
    values: bool,
    policy: bool,
    plain: bool = False,
    configuration: int | None = None,
) -> str:
    """Return values and policy of a solution for standard output.

    In ASCII, values are a table below the drawing, up to a width of 16 cells.

    Args:
        level: the level.
        solution: its solution.
        values: whether to show the values.
        policy: whether to show the optimal actions.
        plain: whether to use ASCII in any case.
        configuration: what is where; None is where episodes begin.
    """
    from babyrobot_levels.render.scene.overlay import Overlay

    number = shown_configuration(level, configuration)
    actions = _actions(solution, number) if policy else None
    if not plain and takes_pictures():
        shown = _values(solution, number) if values else None
        return _picture(level, Overlay(values=shown, actions=actions), number)
    if policy:
        painter = TextPainter(level, plain=True, overlay=Overlay(actions=actions))
        text = _joined(painter.lines(None, configuration=number, held=False))
    else:
        text = text_picture(level, plain=True, configuration=configuration)
    if values and level.size[0] <= WIDEST:
        text += "\n" + values_text(solution, number)
    return text


def values_text(solution: Solution, configuration: int | None) -> str:
    """Return the values in rows and columns, with two decimals."""
    return _joined(number_lines(_part(solution, solution.values, configuration).tolist(), 2))


def takes_pictures() -> bool:
    """Return whether standard output shows Unicode and colour."""
    return colors_of(sys.stdout) > 0 and speaks_unicode(sys.stdout)


def _actions(solution: Solution, configuration: int | None) -> Rows[tuple[int, ...]]:
    """Return the optimal action of each cell, the first one of several."""
    rows = _part(solution, solution.policy, configuration).tolist()
    first = solution.first_action
    return [[(action + first,) if action >= 0 else () for action in row] for row in rows]


def _values(solution: Solution, configuration: int | None) -> Rows[float | None]:
    """Return the value of each cell, None where there is none."""
    rows = _part(solution, solution.values, configuration).tolist()
    return [[None if math.isnan(value) else value for value in row] for row in rows]


def _part(solution: Solution, table: Any, configuration: int | None) -> Any:
    """Return the part of an array that belongs to a configuration: `[height, width, …]`."""
    return table[configuration or 0] if solution.values.ndim > 2 else table


def _picture(level: Level, overlay: Overlay | None, configuration: int | None) -> str:
    """Return a picture in colour: the whole level if the terminal is wide enough, else a part."""
    painter, colors = TextPainter(level, overlay=overlay), colors_of(sys.stdout)
    room = None
    if sys.stdout.isatty():
        columns, lines = room_of(sys.stdout)
        width = level.size[0]
        has_arrows = overlay is not None and overlay.actions is not None
        if 4 * width + 1 > columns and 2 * width + 1 <= columns and not has_arrows:
            return _joined(painter.blocks(configuration=configuration, colors=colors))
        is_cut = 4 * width + 1 > columns
        room = os.terminal_size((columns, max(1, lines - 2) if is_cut else _ALL_LINES))
    shown = painter.lines(None, configuration=configuration, colors=colors, held=False, room=room)
    return _joined(shown)


def _joined(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)
