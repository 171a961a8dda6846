"""The colour of the ground in each cell: what texts, walls and arrows must stand out from."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from babyrobot_levels.render.colors import mixed

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

Cell = tuple[int, int]

_PAPER = "#ffffff"


class CellGrounds:
    """The ground of the cells, as it is painted: base, areas, blocked cells, starts and exits.

    Args:
        level: the level.

    Attributes:
        base: the colour of the base, `#rrggbb`.
        own: the colours of the cells whose ground is another one.
    """

    def __init__(self, level: GridWorld) -> None:
        colors = level.resolved_theme.colors
        self.base = mixed(colors.base, _PAPER)
        self.own: dict[Cell, str] = {}
        for area in level.areas:
            if area.color is not None:
                (left, top), (width, height) = area.at, area.size
                cells = ((left + x, top + y) for y in range(height) for x in range(width))
                self._lay(area.color, cells)
        width = level.size[0]
        blocked = (number for number, flag in enumerate(level.grid().blocked_cells) if flag)
        self._lay(colors.blocked, ((number % width, number // width) for number in blocked))
        self._lay(colors.start, level.starts)
        # A drawn exit is a tile that does not reach the edges of its cell.
        self._lay(colors.exit, level.exits if level.exit_one_of is None else ())

    def __getitem__(self, cell: Cell) -> str:
        return self.own.get(cell, self.base)

    def _lay(self, color: str, cells: Iterable[Cell]) -> None:
        for cell in cells:
            self.own[cell] = mixed(color, self[cell])
