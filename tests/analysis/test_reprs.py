"""What the last line of a cell shows of results with many numbers: how much there is."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import babyrobot_levels as brl

SHOWN: tuple[tuple[str, Callable[[brl.Level], object], str], ...] = (
    (
        "mdp",
        lambda level: level.compile(),
        "<Mdp: 4x4; probability, next_state, reward, terminal [16, 5, 3], ",
    ),
    ("grid", lambda level: level.grid(), "<Grid: 4x4; open [4, 4, 4], blocked [4, 4]>"),
    (
        "rollout",
        lambda level: brl.rollout(level, num_envs=2, seed=1),
        "<Rollout of 1,000 steps in 2 environments: ",
    ),
    (
        "returns",
        lambda level: brl.return_distribution(level, "random", 100),
        "<ReturnDistribution of 2 returns: mean=0.0113",
    ),
)


@pytest.mark.parametrize(
    ("make", "begins"), [row[1:] for row in SHOWN], ids=[row[0] for row in SHOWN]
)
def test_results_with_many_numbers_say_how_much_there_is(
    make: Callable[[brl.Level], object], begins: str
) -> None:
    shown = repr(make(brl.load("frozen-lake")))
    assert shown.startswith(begins)
    assert len(shown) < 120
