"""Intervals for other levels and runs, and the probability of improvement."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl


def scores_of(shares: Any) -> brl.Scores:
    """Return exact scores in levels with the optimum 1, in which chance has 0."""
    return brl.Scores(
        [
            brl.LevelScore(
                level=str(number), digest=str(number), expected_return=share, optimum=1.0,
                random=0.0, share=share, regret=1 - share, success=max(share, 0.0),
                steps=1.0, within=9, discount=1.0, episodes=0, low=share, high=share,
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


def held(found: Sequence[tuple[float, float]], true: float) -> float:
    """Return how many of some intervals hold a value; an end that is not told holds all."""
    return sum(not true < low - 1e-9 and not true > high + 1e-9 for low, high in found) / len(found)


POPULATIONS: dict[str, Callable[[np.random.Generator, int], Any]] = {
    "one in a hundred": lambda random, count: 1.0 * (random.random(count) < 0.01),
    "nine in ten": lambda random, count: 1.0 * (random.random(count) < 0.9),
    "near the optimum": lambda random, count: random.beta(8, 1, count),
    "a tenth below chance": lambda random, count: np.where(
        random.random(count) < 0.1, random.uniform(-1, 0, count), 1.0
    ),
    "far below chance": lambda random, count: 1 - random.exponential(0.5, count),
}


@pytest.mark.sweep
@pytest.mark.parametrize("name", POPULATIONS)
@pytest.mark.parametrize(("levels", "times"), [(5, 80), (30, 25)])
def test_intervals_hold_for_other_levels_of_skewed_populations(
    name: str, levels: int, times: int
) -> None:
    draw, random = POPULATIONS[name], np.random.default_rng(0)
    whole = np.sort(draw(random, 200_000))
    true = {
        "mean": whole.mean(),
        "median": whole[100_000],
        "iqm": whole[50_000:150_000].mean(),
        "worst_tenth": whole[:20_000].mean(),
        "solved": (whole >= 0.95).mean(),
        "regret": 1 - whole.mean(),
    }
    found = [brl.summary(scores_of(draw(random, levels))).intervals for _ in range(times)]
    for statistic, value in true.items():
        # In a hundred, three may lie at either side, and a few more by chance.
        assert held([each[statistic] for each in found], value) >= 0.9, statistic


@pytest.mark.slow
def test_improvement_holds_for_other_levels() -> None:
    # Better in every other level, by chance, or in nearly none.
    for chance in (0.5, 0.02):
        random, found = np.random.default_rng(0), list[tuple[float, float]]()
        for _ in range(100):
            wins = 1.0 * (random.random(5) < chance)
            one = brl.improvement(scores_of(wins), scores_of(np.full(5, 0.5)))
            found.append((one.low, one.high))
        assert held(found, chance) >= 0.9


@pytest.mark.slow
@pytest.mark.parametrize("stratified", [False, True])
def test_intervals_hold_for_other_runs(stratified: bool) -> None:
    summaries = [
        brl.summary(drawn(seed, 4, 10, 0.1, 0.0 if stratified else 0.05), stratified=stratified)
        for seed in range(40)
    ]
    for name in ("mean", "median", "iqm"):
        assert held([each.intervals[name] for each in summaries], 0.5) >= 0.85, name
    widths = [each.intervals["mean"][1] - each.intervals["mean"][0] for each in summaries]
    assert 0.2 < np.mean(widths) < (0.35 if stratified else 0.8)


def test_few_levels_tell_how_bad_the_worst_tenth_can_be_at_most() -> None:
    shares = np.linspace(0.2, 0.9, 45)
    assert math.isnan(scores_of(shares[:30]).summary.intervals["worst_tenth"][0])
    assert scores_of(shares).summary.intervals["worst_tenth"][0] < 0.2
    # Of five levels, all may be in the better half.
    assert math.isnan(scores_of(shares[:5]).summary.intervals["median"][0])


def test_intervals_of_shares_of_levels_are_those_of_clopper_and_pearson() -> None:
    # Of 30 levels, none is solved: 1 - 0.025 ** (1 / 30).
    low, high = scores_of(np.zeros(30)).summary.intervals["solved"]
    assert low == 0
    assert high == pytest.approx(0.1157, abs=0.01)


def test_strata_keep_the_levels() -> None:
    shares = np.array([[0.1, 0.4], [0.3, 0.8], [0.2, 0.3]])
    summary = brl.summary([scores_of(run) for run in shares], stratified=True)
    # Student's t with two degrees of freedom, over the means of the runs: 0.25, 0.55, 0.25.
    error = 4.3027 * np.std([0.25, 0.55, 0.25], ddof=1) / 3**0.5
    assert summary.intervals["mean"] == pytest.approx((0.35 - error, 0.35 + error), rel=1e-4)
    assert summary.intervals["regret"] == pytest.approx((0.65 - error, 0.65 + error), rel=1e-4)
    assert summary.runs == 3
    assert (summary.mean, summary.median) == pytest.approx((0.35, 0.35))
    with pytest.raises(ValueError, match="give two or more"):
        brl.summary([scores_of([0.5, 0.6])], stratified=True)


def test_a_summary_is_the_same_each_time_and_leaves_random_numbers_alone() -> None:
    runs = drawn(3, 3, 10, 0.1, 0.1)
    np.random.seed(0)
    assert brl.summary(runs) == brl.summary(runs)
    assert np.random.random() == np.random.RandomState(0).random_sample()
    assert runs[0].summary.intervals == brl.summary(runs[0]).intervals


@pytest.mark.slow
def test_weights_that_are_drawn_in_parts_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    run = scores_of(np.linspace(0, 1, 9).tolist())
    ends = brl.summary([run]).intervals
    monkeypatch.setattr("babyrobot_levels.extensions.scoring.intervals._AT_ONCE", 100)
    assert brl.summary([run]).intervals == ends


def test_a_single_level_has_no_interval() -> None:
    summary = scores_of([0.7]).summary
    assert summary.mean == 0.7
    assert all(math.isnan(end) for ends in summary.intervals.values() for end in ends)
    assert scores_of([0.7]).to_dict()["summary"]["intervals"]["mean"] == [None, None]
    alone = brl.improvement(scores_of([0.7]), scores_of([0.6]))
    assert (alone.probability, math.isnan(alone.low), math.isnan(alone.high)) == (1, True, True)
    # Several runs tell of others in this level.
    runs = [scores_of([share]) for share in (0.7, 0.6, 0.65)]
    assert brl.summary(runs).intervals == brl.summary(runs, stratified=True).intervals


def test_what_is_not_finite_has_no_interval() -> None:
    # In the second level, the agent never ends.
    endless = scores_of([0.7, -math.inf, 0.8])
    for runs in ([endless], [endless, endless]):
        intervals = brl.summary(runs).intervals
        assert all(math.isnan(end) for name in ("mean", "iqm", "regret") for end in intervals[name])
        assert intervals["solved"] == brl.summary([scores_of([0.7, 0, 0.8])]).intervals["solved"]


def test_improvement_is_the_statistic_of_mann_and_whitney() -> None:
    better = [scores_of([0.5, 0.9]), scores_of([0.7, 0.2])]
    worse = [scores_of([0.5, 0.3])]
    found = brl.improvement(better, worse)
    # In the first level 1 and a half, in the second 1, of two.
    assert found.probability == pytest.approx((0.75 + 0.5) / 2)
    assert found.low <= found.probability <= found.high
    assert brl.improvement(worse, better).probability == pytest.approx(1 - found.probability)
    same = brl.improvement(worse[0], worse[0])
    assert same.probability == 0.5
    assert same.low + same.high == pytest.approx(1, abs=0.02)


def test_agents_that_never_terminate_are_equally_good() -> None:
    endless = scores_of([0.7, -math.inf])
    assert brl.improvement(endless, endless).probability == 0.5


def test_runs_are_in_the_same_levels() -> None:
    with pytest.raises(ValueError, match="not in the same levels"):
        brl.summary([scores_of([0.5, 0.6]), scores_of([0.5])])
    with pytest.raises(ValueError, match="there are no runs"):
        brl.summary([])
