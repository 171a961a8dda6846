"""When the same can happen in two levels, under all policies and under the best ones."""

from __future__ import annotations

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.linter.optimal_policy import Facts, best_episodes, episodes


def level(**fields: object) -> brl.Level:
    return brl.Level(version=1, size=(4, 1), **fields)


def same(one: Facts, two: Facts) -> bool:
    return all(map(np.array_equal, one, two))


def test_what_no_best_policy_meets_does_not_count_for_the_best() -> None:
    one, two = (
        level(exit=(3, 0), start=(1, 0)),
        level(exit=(3, 0), start=(1, 0), areas=[{"at": (0, 0), "reward": -9}]),
    )
    assert same(best_episodes(one), best_episodes(two))
    assert not same(episodes(one), episodes(two))


def test_what_no_policy_comes_to_does_not_count() -> None:
    one, two = level(exit=(1, 0)), level(exit=(1, 0), areas=[{"at": (3, 0), "reward": -9}])
    assert same(episodes(one), episodes(two))
    assert one.digest != two.digest


@pytest.mark.parametrize("facts", [episodes, best_episodes])
def test_the_same_steps_in_other_cells_are_others(facts: object) -> None:
    assert callable(facts)
    one = facts(level(start=(0, 0), exit=(1, 0)))
    assert same(one, facts(level(start=(0, 0), exit=(1, 0))))
    assert not same(one, facts(level(start=(1, 0), exit=(2, 0))))
