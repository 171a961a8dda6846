"""The overlay of a picture: values, policies, counts, notes. Plain data."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

Content = TypeVar("Content")
Rows = Sequence[Sequence[Content]]
"""Something for each cell, `[height][width]`."""


AtHand = tuple[int | None, int | None]
"""The configuration and heading of what depends on them; None for none at hand."""


@dataclass(frozen=True, slots=True)
class Note:
    """A text anywhere on the grid.

    Attributes:
        x: the column of the cell on whose centre the text is; fractions are between cells.
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
    """What is shown over the cells of a level and in its panels.

    Attributes:
        values: the value of each cell; it may be infinite. None for a cell that shows nothing.
        actions: the actions of a policy in each cell, as `Action`s; it may be none.
        probabilities: the probability of each action in each cell, where arrows are to tell it
            by their length; `actions` are the most likely ones.
        action_values: the value of each action in each cell, in the order of `Action`: five
            numbers, each None if it is not shown; or none at all.
        visits: the number of visits to each cell. None and 0 show nothing.
        coordinates: whether each free cell shows its coordinates.
        notes: texts anywhere on the grid.
        side_panel: lines for the panel beside the grid. A level without one gets one.
        bottom_panel: lines for the panel below the grid, likewise.
        precision: the largest number of decimals.
        extent: the lowest and highest value of all configurations, where they differ: these have
            the same colours in all of them.
        rules: whether the rules of the level are shown: in a panel of the level in which they have
            room, else in a box of their own below the picture. Without it, only panels show them
            that have nothing else to show.
        parts: the overlay of a configuration and heading (each None if none is at hand), where
            they differ; it takes the place of this one.
    """

    values: Rows[float | None] | None = None
    actions: Rows[Sequence[int]] | None = None
    probabilities: Rows[Mapping[int, float]] | None = None
    action_values: Rows[Sequence[float | None]] | None = None
    visits: Rows[float | None] | None = None
    coordinates: bool = False
    notes: Sequence[Note] = ()
    side_panel: Sequence[str] = ()
    bottom_panel: Sequence[str] = ()
    precision: int = 2
    extent: tuple[float, float] | None = None
    rules: bool = False
    parts: Callable[[int | None, int | None], Overlay] | None = None

    @property
    def fills_cells(self) -> bool:
        """Whether it shows something in the middle of cells."""
        shown = self.values, self.actions, self.action_values, self.visits
        return any(rows is not None for rows in shown)

    @property
    def is_crowded(self) -> bool:
        """Whether arrows or values of actions take the middle of cells: the robot is small."""
        return self.actions is not None or self.action_values is not None

    @property
    def has_colors(self) -> bool:
        """Whether numbers are shown as colours, which need a legend."""
        shown = self.values, self.action_values, self.visits
        return any(rows is not None for rows in shown)

    def at(self, configuration: int | None = None, heading: int | None = None) -> Overlay:
        """Return what is shown in a configuration, with a heading; None for none at hand."""
        return self if self.parts is None else self.parts(configuration, heading)
