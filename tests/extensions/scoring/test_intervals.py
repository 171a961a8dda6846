"""Confidence intervals hold what they promise, of few and skewed values, too."""

from __future__ import annotations

import numpy as np
import pytest
from support.combinations import combined

from babyrobot_levels.extensions.scoring.intervals import interval


@pytest.mark.slow
@combined(1, chance=[0.011, 0.2, 0.74], episodes=[5, 30])
def test_the_interval_holds_the_mean(episodes: int, chance: float) -> None:
    random = np.random.default_rng(1)
    held = 0
    for _ in range(200):
        low, high = interval((random.random(episodes) < chance).astype(float), 0, 1)
        held += low <= chance <= high
    assert held >= 186


@pytest.mark.slow
def test_of_levels_with_few_episodes_the_interval_holds_the_mean() -> None:
    random = np.random.default_rng(2)
    chances = np.repeat(random.beta(0.2, 1.0, 40), 5)
    samples = (random.random((200, 200)) < chances).astype(float)
    found = [interval(sample, 0.0, 1.0) for sample in samples]
    assert sum(low <= chances.mean() <= high for low, high in found) >= 186
    assert max(high - low for low, high in found) < 0.14


@pytest.mark.parametrize(
    ("hits", "known"),
    [(0, (0.0, 0.1157)), (1, (0.0008, 0.1722)), (12, (0.2266, 0.594)), (30, (0.8843, 1.0))],
)
def test_two_values_have_the_interval_of_clopper_and_pearson(
    hits: int, known: tuple[float, float]
) -> None:
    found = interval(np.repeat([1.0, 0.0], [hits, 30 - hits]), 0, 1)
    assert found == pytest.approx(known, abs=0.01)


@pytest.mark.slow
def test_many_values_are_grouped() -> None:
    values = np.random.default_rng(3).exponential(size=20_000)
    low, high = interval(values, 0, 20)
    error = 1.96 * values.std() / 20_000**0.5
    assert (low, high) == pytest.approx((values.mean() - error, values.mean() + error), abs=0.003)
