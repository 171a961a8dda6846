"""What the last line of a cell shows of results with many numbers: how much there is."""

from __future__ import annotations

from typing import Any

import pytest

import babyrobot_levels as brl

LEVEL = brl.load("frozen-lake")
SHOWN = (
    (LEVEL.compile(), "<Mdp: 4x4; probability, next_state, reward, terminal [16, 5, 3], "),
    (LEVEL.grid(), "<Grid: 4x4; open [4, 4, 4], blocked [4, 4]>"),
    (brl.rollout(LEVEL, num_envs=2, seed=1), "<Rollout of 1,000 steps in 2 environments: "),
    (
        brl.return_distribution(LEVEL, "random", 100),
        "<ReturnDistribution of 2 returns: mean=0.0113",
    ),
)


@pytest.mark.parametrize(("result", "begins"), SHOWN, ids=lambda value: type(value).__name__)
def test_results_with_many_numbers_say_how_much_there_is(result: Any, begins: str) -> None:
    assert repr(result).startswith(begins)
    assert len(repr(result)) < 120
