"""Wilson's and the Aldous-Broder mazes: every possible maze with the same probability."""

from __future__ import annotations

from collections import Counter

import pytest
from support.mazes import Board, empty, grow

from babyrobot_levels.mdp.mazes import ALGORITHMS

UNIFORM = ("wilson", "aldous-broder")
EACH = 60
"""So many mazes are grown for each that is possible."""


def deviation(board: Board, mazes: int, algorithm: str) -> float:
    """Return how likely even mazes would deviate at least as much, by the chi-square test."""
    found = Counter(grow(board, seed, algorithm) for seed in range(EACH * mazes))
    assert len(found) <= mazes
    square = sum((count - EACH) ** 2 / EACH for count in found.values())
    square += EACH * (mazes - len(found))
    # It is imported when it is needed: that takes a second.
    from scipy.stats import chi2  # type: ignore[import-untyped]

    return float(chi2.sf(square, mazes - 1))


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", UNIFORM)
@pytest.mark.parametrize(
    ("board", "mazes"),
    [
        # Kirchhoff's theorem counts the spanning trees.
        (empty(2, 3, 3), 15),
        (empty(3, 3, 4), 192),
        ((3, 3, bytes([0, 0, 0, 0, 1, 0, 0, 0, 0]), 1), 8),
    ],
)
def test_every_maze_is_equally_likely(algorithm: str, board: Board, mazes: int) -> None:
    assert deviation(board, mazes, algorithm) > 0.001


@pytest.mark.sweep
@pytest.mark.parametrize("algorithm", sorted(set(ALGORITHMS) - set(UNIFORM)))
def test_the_other_algorithms_prefer_some_mazes(algorithm: str) -> None:
    assert deviation(empty(3, 3), 192, algorithm) < 1e-9
