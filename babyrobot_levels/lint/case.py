"""What rules look at: one level, its text, and what is worked out from it once for all rules."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from babyrobot_levels.library.level import Level
from babyrobot_levels.lint.drawn import Mark, cell_mark
from babyrobot_levels.lint.rule import Route, Rule
from babyrobot_levels.lint.silence import MARK, Silence, silences
from babyrobot_levels.mdp.grid import Grid, build_grid
from babyrobot_levels.text.comments import Comment, comments
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.source import SourceFile

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.lint.barriers import Barriers
    from babyrobot_levels.lint.effects import AreaEffect
    from babyrobot_levels.lint.ground import Ground
    from babyrobot_levels.mdp.reachability import Reach
    from babyrobot_levels.mdp.tables import Mdp


class Case:
    """A valid level and the text that it is from.

    Attributes:
        level: the level.
        document: its text as YAML, with the place of each part.
        path: the file, if it is from one.
        rules: the rules that look at it.
    """

    def __init__(
        self,
        level: Level,
        document: Document,
        path: Path | None = None,
        rules: Sequence[Rule] = (),
    ) -> None:
        self.level, self.document, self.path, self.rules = level, document, path, rules

    @property
    def source(self) -> SourceFile:
        """The text."""
        return self.document.source

    @property
    def data(self) -> dict[str, Any]:
        """What the file says, as plain data."""
        data: dict[str, Any] = self.document.data
        return data

    @cached_property
    def comments(self) -> list[Comment]:
        """The comments of the text."""
        return comments(self.document)

    @cached_property
    def silences(self) -> list[Silence]:
        """The comments that silence rules."""
        if MARK not in self.source.text:
            return []
        return silences(self.document, self.comments)

    @cached_property
    def starts(self) -> list[int]:
        """The states in which an episode can begin."""
        return [self.state(cell) for cell in self.level.starts]

    @property
    def grid(self) -> Grid:
        """Walls and cells after the maze."""
        return self.level.grid()

    @property
    def mdp(self) -> Mdp:
        """The exact tables."""
        return self.level.compile()

    @cached_property
    def reach(self) -> Reach:
        """Which cells can be reached, and from which cells the end can be."""
        from babyrobot_levels.mdp.reachability import reach_of

        return reach_of(self.level, self.mdp)

    @cached_property
    def best(self) -> Solution | None:
        """The best that can be done, None where it has no value or takes too long to find."""
        from babyrobot_levels.lint.best import best_of

        return best_of(self.level)

    @cached_property
    def bare_grid(self) -> Grid:
        """The grid without the level's own walls and openings: the maze, or nothing at all."""
        if not self.level.walls and not self.level.openings:
            return self.grid
        return build_grid(self.level.model_copy(update={"walls": (), "openings": ()}))

    @cached_property
    def barriers(self) -> Barriers:
        """What walls and openings do."""
        from babyrobot_levels.lint.barriers import Barriers

        return Barriers(self.level, self.bare_grid)

    @cached_property
    def ground(self) -> Ground:
        """What areas, puddles and skidding do."""
        from babyrobot_levels.lint.ground import Ground

        return Ground(self)

    @cached_property
    def rewarded(self) -> NDArray[np.bool_]:
        """The cells whose own reward some outcome has, `[height, width]`."""
        from babyrobot_levels.lint.variants import rewarded_cells

        return rewarded_cells(self.level)

    def listed_areas(self) -> Iterator[tuple[Route, AreaEffect]]:
        """Yield what each area does that the file lists, with the way to it."""
        if "areas" in self.data:
            for number, area in enumerate(self.ground.areas):
                yield ("areas", number), area

    def state(self, cell: tuple[int, int]) -> int:
        """Return the state of a cell `(x, y)`."""
        return cell[1] * self.level.size[0] + cell[0]

    def cell(self, state: int) -> tuple[int, int]:
        """Return the cell `(x, y)` of a state."""
        y, x = divmod(state, self.level.size[0])
        return x, y

    def place(self, state: int) -> tuple[Route, Mark | None]:
        """Return where a file speaks of a cell: in its drawing if it has one, else at its size."""
        if self.level.map is not None:
            return ("map",), cell_mark(self.level, *self.cell(state))
        return ("maze" if self.level.maze is not None else "size",), None

    def place_of_end(self, field: str, number: int) -> tuple[Route, Mark | None]:
        """Return where a file speaks of one of its starts or exits (`field`), by its number."""
        cells = self.level.starts if field == "start" else self.level.exits
        if self.level.map is not None or field not in self.data:
            return self.place(self.state(cells[number]))
        is_list = isinstance(getattr(self.level, field)[0], tuple)
        return ((field, number) if is_list else (field,)), None
