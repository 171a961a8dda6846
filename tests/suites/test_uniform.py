"""Which mazes suites draw, and that those of Wilson's algorithm are equally likely among them."""

from __future__ import annotations

from collections import Counter

import pytest

from babyrobot_levels.suites.suite import load_suite

EACH = 10
"""So many levels are drawn for each maze that there can be."""


# Of the 192 mazes of 3x3 cells, 112 have a dead end in the corner of the exit.
@pytest.mark.slow
@pytest.mark.parametrize(("exit_", "mazes"), [("corner", 112), ("farthest", 192)])
def test_every_maze_that_leaves_room_for_the_exit_is_equally_likely(exit_: str, mazes: int) -> None:
    suite = load_suite(
        {
            "version": 1,
            "kind": "suite",
            "count": EACH * mazes,
            "size": [3, 3],
            "maze": {"algorithm": "wilson"},
            "exit": exit_,
        }
    )
    found = Counter(level.grid().open_bits for level in suite)
    assert len(found) == mazes
    square = sum((count - EACH) ** 2 / EACH for count in found.values())
    # It is imported when it is needed: that takes a second.
    from scipy.stats import chi2  # type: ignore[import-untyped]

    assert chi2.sf(square, mazes - 1) > 0.001
    if exit_ == "corner":
        assert {sides[8].bit_count() for sides in found} == {1}


def test_small_mazes_have_their_exit_in_a_dead_end() -> None:
    for level in load_suite("small-mazes")[:20]:
        assert level.grid().open_bits[-1].bit_count() == 1
