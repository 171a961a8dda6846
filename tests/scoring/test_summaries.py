"""Bootstrap intervals of several runs, and the probability of improvement."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

import babyrobot_levels as brl


def scores_of(shares: Sequence[float]) -> brl.Scores:
    """Return exact scores in levels with the optimum 1, in which chance has 0."""
    return brl.Scores(
        [
            brl.LevelScore(
                level=str(number), digest=str(number), expected_return=share, optimum=1.0,
                random=0.0, share=share, regret=1 - share, success=share, steps=1.0, within=9,
                discount=1.0, episodes=0, low=share, high=share,
            )
            for number, share in enumerate(shares)
        ]
    )  # fmt: skip


def drawn(seed: int, runs: int, levels: int, of_runs: float, of_levels: float) -> list[brl.Scores]:
    """Return runs whose shares differ by run, by level, and by chance."""
    random = np.random.default_rng(seed)
    found = 0.5 + of_runs * random.standard_normal((runs, 1))
    found = found + of_levels * random.standard_normal(levels)
    return [scores_of(each) for each in found + 0.01 * random.standard_normal((runs, levels))]


@pytest.mark.parametrize(
    ("runs", "levels", "of_runs", "of_levels"), [(1, 40, 0, 0.2), (12, 40, 0.1, 0.2)]
)
def test_intervals_hold_for_other_runs_and_levels(
    runs: int, levels: int, of_runs: float, of_levels: float
) -> None:
    found = [
        brl.summary(drawn(seed, runs, levels, of_runs, of_levels)).intervals for seed in range(40)
    ]
    for name in ("mean", "median", "iqm"):
        held = sum(each[name][0] <= 0.5 <= each[name][1] for each in found)
        assert held >= 34, name
    assert sum(each["mean"][1] - each["mean"][0] for each in found) / 40 < 0.2


def test_strata_are_the_runs_of_each_level() -> None:
    shares = np.array([[0.1, 0.4], [0.3, 0.8]])
    summary = brl.summary([scores_of(run) for run in shares], stratified=True)
    # Of 16 samples, one has the lower share of each level twice, and one the higher.
    assert summary.intervals["mean"] == pytest.approx((0.25, 0.55))
    assert summary.intervals["regret"] == pytest.approx((0.45, 0.75))
    assert summary.runs == 2
    assert (summary.mean, summary.median) == pytest.approx((0.4, 0.4))
    with pytest.raises(ValueError, match="give two or more"):
        brl.summary([scores_of([0.5, 0.6])], stratified=True)


def test_a_summary_is_the_same_each_time_and_leaves_random_numbers_alone() -> None:
    runs = drawn(3, 3, 10, 0.1, 0.1)
    np.random.seed(0)
    assert brl.summary(runs) == brl.summary(runs)
    assert np.random.random() == np.random.RandomState(0).random_sample()
    assert runs[0].summary.intervals == brl.summary(runs[0]).intervals


def test_samples_that_are_drawn_in_parts_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    run = scores_of(np.linspace(0, 1, 9).tolist())
    ends = brl.summary([run]).intervals["mean"]
    monkeypatch.setattr("babyrobot_levels.scoring.summaries._AT_ONCE", 100)
    assert brl.summary([run]).intervals["mean"] == pytest.approx(ends, abs=0.02)


def test_a_single_level_has_no_interval() -> None:
    summary = scores_of([0.7]).summary
    assert summary.mean == 0.7
    assert all(math.isnan(end) for ends in summary.intervals.values() for end in ends)
    assert scores_of([0.7]).to_dict()["summary"]["intervals"]["mean"] == [None, None]


def test_improvement_is_the_statistic_of_mann_and_whitney() -> None:
    better = [scores_of([0.5, 0.9]), scores_of([0.7, 0.2])]
    worse = [scores_of([0.5, 0.3])]
    found = brl.improvement(better, worse)
    # In the first level 1 and a half, in the second 1, of two.
    assert found.probability == pytest.approx((0.75 + 0.5) / 2)
    assert found.low <= found.probability <= found.high
    assert brl.improvement(worse, better).probability == pytest.approx(1 - found.probability)
    assert brl.improvement(worse[0], worse[0]) == brl.Improvement(0.5, 0.5, 0.5)


def test_runs_are_in_the_same_levels() -> None:
    with pytest.raises(ValueError, match="not in the same levels"):
        brl.summary([scores_of([0.5, 0.6]), scores_of([0.5])])
    with pytest.raises(ValueError, match="there are no runs"):
        brl.summary([])
