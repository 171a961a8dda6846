"""What a rule checks: one level, its text, and results that several rules share.

Comments suppress findings: `# babyrobot: ignore[BR503] reason`.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.finding import cell_mark, cells_text, count_drawn
from babyrobot_levels.mdp.grid import BIT, Grid, build_grid
from babyrobot_levels.text.budget import OverBudgetError
from babyrobot_levels.text.diagnostics import Location, Route
from babyrobot_levels.text.document import Comment, Document, comments
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.source import SourceFile, Span

if TYPE_CHECKING:
    from babyrobot_levels.analysis.metrics import Metrics
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.linter.optimal_policy import Necessity
    from babyrobot_levels.linter.terrain import AreaEffect, Barriers, TerrainEffects
    from babyrobot_levels.linter.things import ThingEffects
    from babyrobot_levels.mdp.states import Reach
    from babyrobot_levels.mdp.tables import Mdp


MARK = "babyrobot:"
"""A text that every suppression comment contains."""

_COMMENT = re.compile(r"#\s*babyrobot:\s*ignore(?:\[(?P<words>[^\]]*)\])?(?P<reason>.*)")


@dataclass(slots=True)
class Suppression:
    """One comment that suppresses rules.

    Attributes:
        comment: the comment.
        words: the codes and names of rules in it, as written.
        lines: the lines (from 1) that it covers, None for the whole file.
        used: the words that suppressed a finding.
    """

    comment: Comment
    words: tuple[str, ...]
    lines: range | None
    used: set[str] = field(default_factory=set)

    def covers(self, names: Collection[str], span: Span) -> bool:
        """Return whether a finding at a position is suppressed, and record the words that did it.

        Args:
            names: the rule's code and names, in lower case.
            span: the position.
        """
        if self.lines is not None and span.start.line not in self.lines:
            return False
        hits = [word for word in self.words if word.lower() in names]
        self.used.update(hits)
        return bool(hits)


def suppressions(document: Document, comments: Iterable[Comment]) -> Iterator[Suppression]:
    """Yield the suppression comments of a file.

    A comment above the first field covers the whole file. At the end of a line, it covers what
    begins on that line, including everything nested in it. On a line of its own, it covers what
    begins below it.
    """
    for comment in comments:
        if (match := _COMMENT.match(comment.text)) is not None:
            words = tuple(filter(None, re.split(r"[,\s]+", match["words"] or "")))
            yield Suppression(comment, words, _lines(document, comment))


def _lines(document: Document, comment: Comment) -> range | None:
    line = comment.span.start.line
    if comment.is_alone:
        if line < document.root.span.start.line:
            return None
        lines = document.source.lines
        while line < len(lines) and lines[line].lstrip()[:1] in ("", "#"):
            line += 1
        line += 1
    return range(line, _last_line(document, line) + 1)


def _last_line(document: Document, line: int) -> int:
    """Return the last line of the fields, entries and values that begin on a line."""
    waiting, last = [document.root], line
    while waiting:
        node = waiting.pop()
        for key, child in node.children.items():
            begin = node.keys.get(key, child).span.start.line
            end = child.span.end.line - (child.span.end.column == 1)
            if begin == line:
                last = max(last, end)
            elif begin < line <= end:
                waiting.append(child)
    return last


class LintContext:
    """A valid level and its text. Everything that takes time is computed once, on first use.

    Attributes:
        level: the level.
        document: its text as YAML, with the position of each value.
        path: the file, if there is one.
        active: codes and names, in lower case, of the rules that check this level.
        given_up: why some rules of play were not applied to the end; None if all were.
    """

    given_up: str | None = None
    _compared = 0

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
    def comments(self) -> Sequence[Comment]:
        """The comments of the text."""
        return comments(self.document)

    @cached_property
    def suppressions(self) -> list[Suppression]:
        """The comments that suppress rules."""
        if MARK not in self.source.text:
            return []
        return [*suppressions(self.document, self.comments)]

    @cached_property
    def starts(self) -> list[int]:
        """The start states, in the order of the start cells, then of what is drawn at reset."""
        cells = [self.state(cell) for cell in self.level.starts]
        if not self.level.has_things:
            return cells
        states: list[int] = self.mdp.start.nonzero()[0].tolist()
        return sorted(states, key=lambda state: (cells.index(state % self.mdp.cells), state))

    @property
    def grid(self) -> Grid:
        """Walls and cells, including those of the maze."""
        return self.level.grid()

    @property
    def mdp(self) -> Mdp:
        """The exact tables."""
        return self.level.compile()

    @cached_property
    def too_large(self) -> str | None:
        """Why the tables are too large for rules to read; None if they are not."""
        try:
            self.level.compile()
        except OverBudgetError as error:
            return str(error)
        return None

    @cached_property
    def reach(self) -> Reach:
        """Which states are reachable, and from which states an end of the episode is."""
        from babyrobot_levels.mdp.states import reach_of

        return reach_of(self.level, self.mdp)

    def starts_on(self, cell: tuple[int, int]) -> Iterator[int]:
        """Yield the start states on a start cell: with things, one for all that may be drawn."""
        return (state for state in self.starts if self.cell(state) == cell)

    def starts_text(self, states: list[int]) -> tuple[int, str]:
        """Return the number of the first start cell of some start states, and words for them.

        If what is drawn at reset decides which of the states of a cell are among them, the words
        say what is drawn: `start [0, 0] with `gem` on [3, 1]`.
        """
        cells, some = self.level.starts, {*states}
        others = {self.cell(state) for state in self.starts if state not in some}
        if whole := [number for number, cell in enumerate(cells) if cell not in others]:
            text = cells_text([cells[number] for number in whole])
            return whole[0], f"start{'s' * (len(whole) > 1)} {text}"
        cell = self.cell(states[0])
        told = self.things.told(states[0], states, self.starts)
        more = len(states) - 1
        rest = f" (and {more} more draw{'s' * (more > 1)})" if more else ""
        return cells.index(cell), f"start {cells_text([cell])} with {told}{rest}"

    @cached_property
    def reached_cells(self) -> bytes:
        """For each cell, 1 where a robot can be, in whatever configuration."""
        return self._any_configuration(bytes(steps >= 0 for steps in self.reach.steps))

    @cached_property
    def occupied_cells(self) -> bytes:
        """For each cell, 1 where a robot can be while the episode goes on, in any configuration."""
        return self._any_configuration(self.reach.on)

    @cached_property
    def ended_exits(self) -> set[int]:
        """The numbers of the cells in which episodes end at an exit."""
        steps, size = self.reach.steps, self.mdp.cells
        return {
            state % size
            for state, left in enumerate(self.reach.to_exit)
            if left == 0 and steps[state] >= 0
        }

    def _any_configuration(self, flags: bytes) -> bytes:
        size = self.mdp.cells
        if len(flags) == size:
            return flags
        found = bytearray(1 in flags[cell::size] for cell in range(size))
        # Where several robots but the first are, configurations tell.
        robots = self.level.things().of_kind("robot")
        for place in set((self.mdp.configurations[:, robots][:, 1:] % size).ravel().tolist()):
            found[place] = 1
        return bytes(found)

    @cached_property
    def solution(self) -> Solution | None:
        """The optimal values and policy; None if they do not exist or take too long to compute."""
        from babyrobot_levels.linter.optimal_policy import solution_of

        return solution_of(self.level)

    @cached_property
    def metrics(self) -> Metrics:
        """The metrics, which have the solution that other rules read."""
        from babyrobot_levels.analysis.metrics import Metrics
        from babyrobot_levels.language.metric_names import MAX_SOLVED

        found = Metrics(self.level)
        if self.mdp.num_states <= MAX_SOLVED:
            vars(found)["solution"] = self.solution
        return found

    @cached_property
    def necessity(self) -> Necessity:
        """Which doors, and which needs of them and of the exits, make no difference."""
        from babyrobot_levels.linter.optimal_policy import Necessity

        check_needs = "need-without-effect" in self.active
        return Necessity(self.level, self.things.working_doors, check_needs=check_needs)

    def has_same_digest(self, **fields: Any) -> bool:
        """Return whether the level with other values for some fields has the same digest.

        False where that is not found out: only so many levels are compared.
        """
        from babyrobot_levels.linter.variants import max_variants
        from babyrobot_levels.mdp.gridworld import changed

        self._compared += 1
        if self._compared > max_variants(self.level):
            return False
        try:
            return changed(self.level, **fields).digest == self.level.digest
        except LevelError:
            return False

    @cached_property
    def bare_grid(self) -> Grid:
        """The grid without the level's own walls and openings: the maze, or an empty rectangle."""
        if not self.level.walls and not self.level.openings:
            return self.grid
        return build_grid(self.level.model_copy(update={"walls": (), "openings": ()}))

    @cached_property
    def barriers(self) -> Barriers:
        """The effects of walls and openings."""
        from babyrobot_levels.linter.terrain import Barriers

        return Barriers(self.level, self.bare_grid)

    @cached_property
    def terrain(self) -> TerrainEffects:
        """The effects of areas, puddles and skidding."""
        from babyrobot_levels.linter.terrain import TerrainEffects

        return TerrainEffects(self.level)

    @cached_property
    def things(self) -> ThingEffects:
        """What becomes of the things of the level in the configurations that occur."""
        from babyrobot_levels.linter.things import ThingEffects

        return ThingEffects(self.level, self.mdp)

    def listed_areas(self) -> Iterator[tuple[Route, AreaEffect]]:
        """Yield the route and the effect of each area that the file lists."""
        if "areas" in self.data:
            for number, area in enumerate(self.terrain.areas):
                yield ("areas", number), area

    def state(self, cell: tuple[int, int]) -> int:
        """Return the number of a cell `(x, y)`, which is its state in a level without things."""
        return cell[1] * self.level.size[0] + cell[0]

    def cell(self, state: int) -> tuple[int, int]:
        """Return the cell `(x, y)` of a state, or of the number of a cell."""
        width, height = self.level.size
        y, x = divmod(state % (width * height), width)
        return x, y

    def neighbours(self, cell: int) -> Iterator[int]:
        """Yield the numbers of the adjacent cells that no wall separates from a cell."""
        for side, bit in BIT.items():
            other = self.grid.neighbour(cell, side) if self.grid.open_bits[cell] & bit else None
            if other is not None:
                yield other

    def place(self, state: int) -> Location:
        """Return where the file shows the cell of a state: in the drawing, or by the size."""
        if self.level.map is not None:
            return cell_mark(self.level, *self.cell(state))
        return ("maze" if self.level.maze is not None else "size",)

    def place_of_end(self, field: str, number: int) -> Location:
        """Return where the file gives a start or an exit (`field`), by its index."""
        cells = self.level.starts if field == "start" else self.level.exits
        if field == "exit" and "exit_one_of" in self.data:
            return ("exit_one_of", number)
        if self.level.map is not None or field not in self.data:
            return self.place(self.state(cells[number]))
        is_list = isinstance(getattr(self.level, field)[0], tuple)
        return (field, number) if is_list else (field,)

    def place_of_entry(self, field: str, number: int) -> Location:
        """Return where the file gives a thing, by the field of its kind and its index."""
        if number >= (drawn := count_drawn(self.level, field)):
            return (field, number - drawn)
        return self.place(self.state(getattr(self.level, field)[number].places[0]))
