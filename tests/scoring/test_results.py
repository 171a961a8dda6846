"""Confidence intervals hold what they promise, of few and skewed returns, too."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from support.combinations import combined

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.scoring import results


@combined(1, chance=[0.011, 0.2, 0.74], episodes=[5, 30])
def test_the_interval_holds_the_mean(episodes: int, chance: float) -> None:
    random = np.random.default_rng(1)
    held = 0
    for _ in range(200):
        low, high = results.interval((random.random(episodes) < chance).astype(float), 0, 1)
        held += low <= chance <= high
    assert held >= 186


def test_of_levels_with_few_episodes_the_interval_holds_the_mean() -> None:
    random = np.random.default_rng(2)
    chances = np.repeat(random.beta(0.2, 1.0, 40), 5)
    samples = (random.random((200, 200)) < chances).astype(float)
    found = [results.interval(sample, 0.0, 1.0) for sample in samples]
    assert sum(low <= chances.mean() <= high for low, high in found) >= 186
    assert max(high - low for low, high in found) < 0.14


@pytest.mark.parametrize(
    ("hits", "known"),
    [(0, (0.0, 0.1157)), (1, (0.0008, 0.1722)), (12, (0.2266, 0.594)), (30, (0.8843, 1.0))],
)
def test_two_values_have_the_interval_of_clopper_and_pearson(
    hits: int, known: tuple[float, float]
) -> None:
    found = results.interval(np.repeat([1.0, 0.0], [hits, 30 - hits]), 0, 1)
    assert found == pytest.approx(known, abs=0.01)


def test_many_values_are_grouped() -> None:
    values = np.random.default_rng(3).exponential(size=20_000)
    low, high = results.interval(values, 0, 20)
    error = 1.96 * values.std() / 20_000**0.5
    assert (low, high) == pytest.approx((values.mean() - error, values.mean() + error), abs=0.003)


def returns_of(level: brl.Level, steps: int, discount: float) -> list[float]:
    """Return the returns of all episodes there can be."""
    mdp, found = level.compile(), list[float]()

    def go(state: int, step: int, total: float) -> None:
        if step == steps or mdp.is_terminal[state]:
            found.append(total)
            return
        for action in range(mdp.num_actions):
            for _, after, reward, terminal in mdp.outcomes(state, action):
                now = total + discount**step * reward
                go(after, steps if terminal else step + 1, now)

    go(int(np.argmax(mdp.start)), 0, 0.0)
    return found


@pytest.mark.parametrize("rewards", [{"step": -1}, {"step": 1, "exit": -9}, {"step": 0, "bump": 2}])
@pytest.mark.parametrize("discount", [1.0, 0.9])
def test_extremes_are_those_of_all_episodes(
    rewards: Any, discount: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    puddle = {"at": [1, 0], "size": "large"}
    level = brl.load({"version": 1, "size": [3, 1], "puddles": [puddle], "rewards": rewards})
    space, every = space_of(level, "all"), returns_of(level, 5, discount)
    found = results.extremes(space, 5, discount)
    assert found == pytest.approx((min(every), max(every)))
    # Where it would take long, the extremes are outside of these.
    monkeypatch.setattr(results, "_MOST_SWEEPS", 2)
    low, high = results.extremes(space, 5, discount)
    assert low <= min(every) + 1e-9
    assert high >= max(every) - 1e-9
