"""What books and programs print about levels of the gallery, beside what is computed.

A figure belongs to a digest: a level that is the same MDP has it too, whatever its name.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from babyrobot_levels.analysis.solver.evaluation import evaluate
from babyrobot_levels.analysis.solver.optimum import solve

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level

SUTTON_BARTO = "Sutton and Barto, Reinforcement Learning: An Introduction (2nd edition, 2018)"
RUSSELL_NORVIG = (
    "Russell and Norvig, Artificial Intelligence: A Modern Approach (3rd edition, 2010)"
)
GYMNASIUM = "Gymnasium 1.4 (gymnasium/envs/__init__.py)"

Table = Sequence[Sequence[float | None]]
"""A number for each cell, by rows; None where nothing is printed."""

_: None = None


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
        compute: computes the same for the level.
    """

    level: str
    digest: str
    what: str
    source: str
    decimals: int
    printed: Table
    compute: Callable[[Level], Table]


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
        for row, printed in zip(figure.compute(level), figure.printed, strict=True)
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


def _uniform(level: Level) -> Table:
    return _table(evaluate(level, "uniform", actions="moves").values.tolist())


def _utilities(level: Level) -> Table:
    """Return values that count the reward of being in a cell, which here is that of a step."""
    return [[None if v is None else v + level.rewards.step for v in row] for row in _optimal(level)]


def _table(values: list[list[float]]) -> Table:
    return [[None if math.isnan(value) else value for value in row] for row in values]


def _best(level: Level) -> Table:
    return [[solve(level, actions="moves").expected_return]]


def _best_in_time(level: Level) -> Table:
    return [[solve(level, actions="moves", within=level.max_steps).expected_return]]


def _best_steps(level: Level) -> Table:
    return [[solve(level, actions="moves").expected_steps]]


FIGURES: tuple[Figure, ...] = (
    Figure(
        "gridworld-3-5",
        "sha256:57c194a945859a3a0749dc735a363f121d250056e80f5095f350e1095a826fd3",
        "Values of the equiprobable random policy",
        f"{SUTTON_BARTO}, Figure 3.2",
        1,
        (
            (3.3, 8.8, 4.4, 5.3, 1.5),
            (1.5, 3.0, 2.3, 1.9, 0.5),
            (0.1, 0.7, 0.7, 0.4, -0.4),
            (-1.0, -0.4, -0.4, -0.6, -1.2),
            (-1.9, -1.3, -1.2, -1.4, -2.0),
        ),
        _uniform,
    ),
    Figure(
        "gridworld-3-5",
        "sha256:57c194a945859a3a0749dc735a363f121d250056e80f5095f350e1095a826fd3",
        "Optimal values",
        f"{SUTTON_BARTO}, Figure 3.5",
        1,
        (
            (22.0, 24.4, 22.0, 19.4, 17.5),
            (19.8, 22.0, 19.8, 17.8, 16.0),
            (17.8, 19.8, 17.8, 16.0, 14.4),
            (16.0, 17.8, 16.0, 14.4, 13.0),
            (14.4, 16.0, 14.4, 13.0, 11.7),
        ),
        _optimal,
    ),
    Figure(
        "gridworld-4-1",
        "sha256:4d7cc696bf1db701f21394ca5cbf304feb8d4d84461bfa00cf5ac3d6bc74877e",
        "Values of the equiprobable random policy",
        f"{SUTTON_BARTO}, Figure 4.1",
        0,
        ((_, -14, -20, -22), (-14, -18, -20, -20), (-20, -20, -18, -14), (-22, -20, -14, _)),
        _uniform,
    ),
    Figure(
        "windy-gridworld",
        "sha256:306c6f29d5bc370983dc3587ab461f0272df2e87d22b0c7b5e8b935e6fc9e8a5",
        "Fewest steps",
        f"{SUTTON_BARTO}, Example 6.5",
        0,
        ((15,),),
        _best_steps,
    ),
    Figure(
        "cliff-walking",
        "sha256:090afeb66d17e438031c58063f69e1dfc7391012dc3efec9fce1fead20a5824c",
        "Return of the optimal path, 13 steps along the edge",
        f"{SUTTON_BARTO}, Example 6.6",
        0,
        ((-13,),),
        _best,
    ),
    Figure(
        "dyna-maze",
        "sha256:4b2b5fb8a76978fed122a59d885c0b75914d316ba9bd9c51eab74122d81ef466",
        "Steps of an optimal episode",
        f"{SUTTON_BARTO}, Figure 8.2",
        0,
        ((14,),),
        _best_steps,
    ),
    Figure(
        "russell-norvig-4x3",
        "sha256:b21f634922e74b7489bd65102de6cc513b338fe20b251dd91a0fa4cbd161b13c",
        "Utilities, which count the reward of being in the cell itself",
        f"{RUSSELL_NORVIG}, Figure 17.3",
        3,
        (
            (0.812, 0.868, 0.918, _),
            (0.762, _, 0.660, _),
            (0.705, 0.655, 0.611, 0.388),
        ),
        _utilities,
    ),
    Figure(
        "frozen-lake",
        "sha256:0585587d0fd8aedc8ce7a7bb884a0fc8637a8cfee66096b4dd1b04628700525a",
        "Optimal return within 100 steps",
        f"{GYMNASIUM}, FrozenLake-v1",
        2,
        ((0.74,),),
        _best_in_time,
    ),
    Figure(
        "frozen-lake-8x8",
        "sha256:d51b333312fe3aba9b81abf157788fea0310e60979ad0e826e0d4f3a2cd07d04",
        "Optimal return within 200 steps",
        f"{GYMNASIUM}, FrozenLake8x8-v1",
        2,
        ((0.91,),),
        _best_in_time,
    ),
)
"""What is known, in the order of the gallery's sources."""
