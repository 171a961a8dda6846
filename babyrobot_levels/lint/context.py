"""What a rule checks: one level, its text, and results that several rules share."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from babyrobot_levels.library.level import Level
from babyrobot_levels.lint.finding import cell_mark
from babyrobot_levels.lint.suppressions import MARK, Suppression, suppressions
from babyrobot_levels.mdp.grid import BIT, Grid, build_grid
from babyrobot_levels.text.comments import Comment, comments
from babyrobot_levels.text.diagnostics import Location, Route
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.source import SourceFile

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.lint.barriers import Barriers
    from babyrobot_levels.lint.terrain import AreaEffect, TerrainEffects
    from babyrobot_levels.mdp.reachability import Reach
    from babyrobot_levels.mdp.tables import Mdp


class LintContext:
    """A valid level and its text. Everything that takes time is computed once, on first use.

    Attributes:
        level: the level.
        document: its text as YAML, with the position of each value.
        path: the file, if there is one.
        active: codes and names, in lower case, of the rules that check this level.
    """

    def __init__(
        self,
        level: Level,
        document: Document,
        path: Path | None = None,
        active: frozenset[str] = frozenset(),
    ) -> None:
        self.level, self.document, self.path, self.active = level, document, path, active

    @property
    def source(self) -> SourceFile:
        """The text."""
        return self.document.source

    @property
    def data(self) -> dict[str, Any]:
        """The contents of the file as plain data."""
        data: dict[str, Any] = self.document.data
        return data

    @cached_property
    def comments(self) -> list[Comment]:
        """The comments of the text."""
        return comments(self.document)

    @cached_property
    def suppressions(self) -> list[Suppression]:
        """The comments that suppress rules."""
        if MARK not in self.source.text:
            return []
        return suppressions(self.document, self.comments)

    @cached_property
    def starts(self) -> list[int]:
        """The start states."""
        return [self.state(cell) for cell in self.level.starts]

    @property
    def grid(self) -> Grid:
        """Walls and cells, including those of the maze."""
        return self.level.grid()

    @property
    def mdp(self) -> Mdp:
        """The exact tables."""
        return self.level.compile()

    @cached_property
    def reach(self) -> Reach:
        """Which states are reachable, and from which states an end of the episode is."""
        from babyrobot_levels.mdp.reachability import reach_of

        return reach_of(self.level, self.mdp)

    @cached_property
    def solution(self) -> Solution | None:
        """The optimal values and policy; None if they do not exist or take too long to compute."""
        from babyrobot_levels.lint.optimal_policy import solution_of

        return solution_of(self.level)

    @cached_property
    def bare_grid(self) -> Grid:
        """The grid without the level's own walls and openings: the maze, or an empty rectangle."""
        if not self.level.walls and not self.level.openings:
            return self.grid
        return build_grid(self.level.model_copy(update={"walls": (), "openings": ()}))

    @cached_property
    def barriers(self) -> Barriers:
        """The effects of walls and openings."""
        from babyrobot_levels.lint.barriers import Barriers

        return Barriers(self.level, self.bare_grid)

    @cached_property
    def terrain(self) -> TerrainEffects:
        """The effects of areas, puddles and skidding."""
        from babyrobot_levels.lint.terrain import TerrainEffects

        return TerrainEffects(self.level)

    def listed_areas(self) -> Iterator[tuple[Route, AreaEffect]]:
        """Yield the route and the effect of each area that the file lists."""
        if "areas" in self.data:
            for number, area in enumerate(self.terrain.areas):
                yield ("areas", number), area

    def state(self, cell: tuple[int, int]) -> int:
        """Return the state of a cell `(x, y)`."""
        return cell[1] * self.level.size[0] + cell[0]

    def cell(self, state: int) -> tuple[int, int]:
        """Return the cell `(x, y)` of a state."""
        y, x = divmod(state, self.level.size[0])
        return x, y

    def neighbours(self, state: int) -> Iterator[int]:
        """Yield the adjacent cells that no wall separates from a cell."""
        for side, bit in BIT.items():
            other = self.grid.neighbour(state, side) if self.grid.open_bits[state] & bit else None
            if other is not None:
                yield other

    def place(self, state: int) -> Location:
        """Return where the file shows a cell: in the drawing if there is one, else at its size."""
        if self.level.map is not None:
            return cell_mark(self.level, *self.cell(state))
        return ("maze" if self.level.maze is not None else "size",)

    def place_of_end(self, field: str, number: int) -> Location:
        """Return where the file gives a start or an exit (`field`), by its index."""
        cells = self.level.starts if field == "start" else self.level.exits
        if self.level.map is not None or field not in self.data:
            return self.place(self.state(cells[number]))
        is_list = isinstance(getattr(self.level, field)[0], tuple)
        return (field, number) if is_list else (field,)
