"""When two levels have the same best policies."""

from __future__ import annotations

import babyrobot_levels as brl
from babyrobot_levels.linter.optimal_policy import Optimum


def optimum(**fields: object) -> Optimum:
    return Optimum(brl.Level(version=1, size=(4, 1), **fields))


def test_what_no_best_policy_meets_does_not_count() -> None:
    one, two = optimum(exit=(1, 0)), optimum(exit=(1, 0), areas=[{"at": (3, 0), "reward": -9}])
    assert one.equals(two)


def test_the_same_steps_in_other_cells_are_others() -> None:
    one = optimum(start=(0, 0), exit=(1, 0))
    assert one.equals(optimum(start=(0, 0), exit=(1, 0)))
    assert not one.equals(optimum(start=(1, 0), exit=(2, 0)))
