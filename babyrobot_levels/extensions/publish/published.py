"""What books and programs print about levels of the gallery, beside what is computed.

A figure belongs to a digest: a level that is the same MDP has it too, whatever its name.
"""

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from babyrobot_levels.analysis.solver.evaluation import evaluate
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import Solution
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.templates import static

Table = Sequence[Sequence[float | None]]
"""A number for each cell, by rows; None where nothing is printed."""


@dataclass(frozen=True, slots=True)
class Figure:
    """What is printed about a level.

    Attributes:
        level: the name of the level in the gallery.
        digest: its digest.
        what: what the numbers are.
        source: where they are printed.
        decimals: the number of decimals in print.
        printed: a number for each cell; a single number is a table of one.
        compute: the name of what computes the same for the level.
    """

    level: str
    digest: str
    what: str
    source: str
    decimals: int
    printed: Table
    compute: str


@dataclass(frozen=True, slots=True)
class Comparison:
    """A figure beside what is computed.

    Attributes:
        figure: the figure.
        computed: the numbers of the level, in the places of those in print.
        difference: the largest difference, computed minus printed, by its size.
    """

    figure: Figure
    computed: Table
    difference: float

    @property
    def agrees(self) -> bool:
        """Whether the numbers are the same within half a unit of the last decimal in print."""
        return abs(self.difference) <= 0.5 * 10.0**-self.figure.decimals + 1e-9


def comparisons(level: Level) -> list[Comparison]:
    """Return what is printed about a level, each beside what is computed.

    Args:
        level: the level; a maze needs a seed.
    """
    digest = level.digest
    return [_compared(figure, level) for figure in FIGURES if figure.digest == digest]


def _compared(figure: Figure, level: Level) -> Comparison:
    computed = [
        [None if other is None else value for value, other in zip(row, printed, strict=True)]
        for row, printed in zip(_COMPUTED[figure.compute](level), figure.printed, strict=True)
    ]
    differences = [
        value - other
        for row, printed in zip(computed, figure.printed, strict=True)
        for value, other in zip(row, printed, strict=True)
        if value is not None and other is not None
    ]
    return Comparison(figure, computed, max(differences, key=abs))


def _optimal(level: Level) -> Table:
    return _table(solve(level, actions="moves").values.tolist())


def _utilities(level: Level) -> Table:
    """Return values that count the reward of being in a cell, which here is that of a step."""
    return [[None if v is None else v + level.rewards.step for v in row] for row in _optimal(level)]


def _table(values: list[list[float]]) -> Table:
    return [[None if math.isnan(value) else value for value in row] for row in values]


def _best(level: Level, within: int | None = None) -> Solution:
    return solve(level, actions="moves", within=within)


_COMPUTED: dict[str, Callable[[Level], Table]] = {
    "uniform": lambda level: _table(evaluate(level, "uniform", actions="moves").values.tolist()),
    "optimal": _optimal,
    "utilities": _utilities,
    "return": lambda level: [[_best(level).expected_return]],
    "return-in-time": lambda level: [[_best(level, level.max_steps).expected_return]],
    "steps": lambda level: [[_best(level).expected_steps]],
}
"""What computes a figure, by the name that it has in the list of figures."""

FIGURES = tuple(Figure(**each) for each in json.loads(static("extensions/publish/published.json")))
"""All figures, in the order in which the pages of their levels show them."""
