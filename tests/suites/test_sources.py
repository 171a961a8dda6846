"""How much the levels of a suite have at most."""

from __future__ import annotations

import babyrobot_levels as brl
from babyrobot_levels.suites.sources import Bounds


def bounds(**fields: object) -> Bounds:
    return Bounds.of(brl.Level(version=1, **fields))


def test_bounds_of_many_levels_are_the_largest_of_each() -> None:
    wide = bounds(size=(5, 2), start=[(0, 0), (1, 0)], exit=(4, 1))
    high = bounds(size=(3, 4), wind={"north": [0, 1, 0]})
    item = bounds(size=(2, 2), items=[{"name": "key", "at": (1, 0)}], exit_needs="key")
    assert Bounds.joined([wide, high, item]) == Bounds(
        size=(5, 4), radices=(2,), configurations=2, num_items=1, num_starts=2, has_wind=True
    )
    assert Bounds.joined([]) == Bounds()
