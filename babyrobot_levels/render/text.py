"""Levels as text: the language's own drawing, and one in Unicode for terminals."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.moves import shifts
from babyrobot_levels.mdp.drawn import drawing_of
from babyrobot_levels.mdp.grid import Grid

if TYPE_CHECKING:
    from babyrobot_levels.language.level import LevelSpec
    from babyrobot_levels.mdp.gridworld import GridWorld

ROBOT = "☻"
TO_START = "↻"
HELD = "◉"
BLOCK = "█"

_SHOWN = {d.SMALL: "∘", d.LARGE: "◯"}
_WARPS = "⇒⇘⇓⇙⇐⇖⇑⇗"
_WINDS = "→↘↓↙←↖↑↗"
"""Arrows from east on, by the clock."""

_JOINTS = "·╵╶└╷│┌├╴┘─┴┐┤┬┼"
"""By the walls that meet: 1 north, 2 east, 4 south, 8 west."""

_ACROSS = {d.SOLID: "───", d.GLASS: "╌╌╌", d.OPEN: "   "}
_DOWN = {d.SOLID: "│", d.GLASS: "╎", d.OPEN: " "}


def unicode_drawing(
    level: GridWorld, grid: Grid, *, state: int | None = None, color: bool = False
) -> str:
    """Return a picture for terminals; each line ends with a newline.

    Starts, exits and a legend's characters are shown as in the drawing; puddles are rings, warps
    double arrows (`↻` to the start), wind single ones. Every character takes one column, and
    every cell as many as in the language's drawing.

    Args:
        level: the level.
        grid: its walls and cells.
        state: the cell, `y * width + x`, of the robot.
        color: whether to paint it in the theme's colours, with 24-bit ANSI escapes.
    """
    drawing = drawing_of(level, grid)
    cells = [list(row) for row in _symbols(level, drawing)]
    if state is not None:
        cells[state // grid.width][state % grid.width] = ROBOT
    lines = ["".join(line) for line in _lines(drawing, cells)]
    if color:
        from babyrobot_levels.render.ansi import paint

        lines = paint(lines, level, grid, state)
    return "\n".join([*lines, ""])


def policy_drawing(
    level: LevelSpec, grid: Grid, policy: Sequence[Sequence[int]], *, plain: bool
) -> str:
    """Return a picture of where a policy leads; each line ends with a newline.

    Args:
        level: the level.
        grid: its walls and cells.
        policy: the action of each cell, `[height][width]`, as `Action`s; -1 where there is none.
        plain: whether to use ASCII characters only.
    """
    drawing = drawing_of(level, grid)
    arrows = ".^>v<" if plain else "·↑→↓←"
    cells = [
        [
            arrows[action] if action >= 0 else character
            for action, character in zip(actions, row, strict=True)
        ]
        for actions, row in zip(policy, drawing.cells, strict=True)
    ]
    if plain:
        return d.compose(replace(drawing, cells=tuple("".join(row) for row in cells)))
    return "\n".join([*("".join(line) for line in _lines(drawing, cells)), ""])


def _symbols(level: LevelSpec, drawing: d.Drawing) -> Iterator[list[str]]:
    """Yield rows of what the cells show. Starts and exits hide warps, and warps hide puddles."""
    south, east = shifts(level.wind, drawing.width, drawing.height)
    warps = {warp.at: warp.to for warp in level.warps}
    for y, row in enumerate(drawing.cells):
        shown = []
        for x, character in enumerate(row):
            symbol = _SHOWN.get(character, character)
            if character in (d.START, d.EXIT, d.BLOCKED):
                pass
            elif (x, y) in warps:
                symbol = _warp((x, y), warps[x, y])
            elif character == d.PLAIN and (east[y] or south[x]):
                symbol = _arrow(_WINDS, east[y], south[x])
            shown.append(symbol)
        yield shown


def _warp(at: tuple[int, int], to: tuple[int, int] | str) -> str:
    if isinstance(to, str):
        return TO_START
    return HELD if to == at else _arrow(_WARPS, to[0] - at[0], to[1] - at[1])


def _arrow(arrows: str, east: int, south: int) -> str:
    return arrows[round(math.atan2(south, east) / (math.pi / 4)) % 8]


def _lines(drawing: d.Drawing, cells: list[list[str]]) -> Iterator[Iterator[str]]:
    """Yield the lines as their parts; lines of walls and lines of cells by turns."""
    width, height = drawing.width, drawing.height
    border = d.SOLID * width
    across = [border, *drawing.south, border]
    down = [d.SOLID + row + d.SOLID for row in drawing.east]
    # Beyond the grid no walls meet the outer one, and nothing is blocked.
    blocked = [[False] * (width + 2) for _ in range(height + 2)]
    for x, y in drawing.find(d.BLOCKED):
        blocked[y + 1][x + 1] = True

    def joint(x: int, y: int) -> str:
        if all(blocked[y + dy][x + dx] for dy in (0, 1) for dx in (0, 1)):
            return BLOCK
        north = down[y - 1][x] if y else d.OPEN
        east = across[y][x] if x < width else d.OPEN
        south = down[y][x] if y < height else d.OPEN
        west = across[y][x - 1] if x else d.OPEN
        met = [north, east, south, west]
        if met in ([d.OPEN, d.GLASS] * 2, [d.GLASS, d.OPEN] * 2):
            return "╌" if east == d.GLASS else "╎"
        return _JOINTS[sum((mark != d.OPEN) << bit for bit, mark in enumerate(met))]

    def wall_line(y: int) -> Iterator[str]:
        for x in range(width):
            yield joint(x, y)
            is_inside = blocked[y][x + 1] and blocked[y + 1][x + 1]
            yield 3 * BLOCK if is_inside else _ACROSS[across[y][x]]
        yield joint(width, y)

    def cell_line(y: int) -> Iterator[str]:
        for x, symbol in enumerate(cells[y]):
            is_inside = blocked[y + 1][x] and blocked[y + 1][x + 1]
            yield BLOCK if is_inside else _DOWN[down[y][x]]
            yield 3 * BLOCK if symbol == d.BLOCKED else f" {symbol} "
        yield _DOWN[d.SOLID]

    for y in range(height):
        yield wall_line(y)
        yield cell_line(y)
    yield wall_line(height)
