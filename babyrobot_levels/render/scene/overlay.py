"""What is written over a level's picture: answers, counts, notes. Plain data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

Content = TypeVar("Content")
Rows = Sequence[Sequence[Content]]
"""Something for each cell, `[height][width]`."""


@dataclass(frozen=True, slots=True)
class Note:
    """A text anywhere on the grid.

    Attributes:
        x: the column of the cell in whose middle the text stands; fractions lie between cells.
        y: its row.
        text: one line of text.
        color: a CSS colour, or None for the theme's `text_fg`.
    """

    x: float
    y: float
    text: str
    color: str | None = None


@dataclass(frozen=True, slots=True)
class Overlay:
    """What is written over the cells of a level and into its panels, as plain data.

    Attributes:
        values: what each cell is worth; it may be infinite. None for a cell on which nothing is
            written.
        actions: the actions that are best in each cell, as `Action`s; none where there is nothing
            to do.
        action_values: what each action is worth in each cell, in the order of `Action`: five
            numbers, each None where nothing is written; or none at all.
        visits: how often the robot was in each cell, shown as warmth and as a number. None and 0
            show nothing.
        coordinates: whether each free cell shows its coordinates.
        notes: texts anywhere on the grid.
        side_panel: lines for the panel beside the grid. A level without one is given one.
        bottom_panel: lines for the panel below the grid, likewise.
        precision: the number of decimals that numbers have at most.
    """

    values: Rows[float | None] | None = None
    actions: Rows[Sequence[int]] | None = None
    action_values: Rows[Sequence[float | None]] | None = None
    visits: Rows[float | None] | None = None
    coordinates: bool = False
    notes: Sequence[Note] = ()
    side_panel: Sequence[str] = ()
    bottom_panel: Sequence[str] = ()
    precision: int = 2
