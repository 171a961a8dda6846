"""Scores of all levels, and of several runs, in a few numbers, with intervals that hold."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from babyrobot_levels.extensions.scoring.intervals import interval, trimmed_interval, with_runs
from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.text.words import Telling

SOLVED = 0.95
"""From this share of the optimum on, a level counts as solved."""

WORST = 0.1
"""The share of the levels that the worst tenth is made of."""

_NAMES = ("mean", "median", "iqm", "worst_tenth", "solved", "regret", "success")
"""The statistics that have intervals."""

_EQUAL = 1e-9
"""Shares that differ by less are equal."""


@dataclass(frozen=True, slots=True)
class Summary(Telling, public=True):
    """The scores of all levels, in one run or several, in a few numbers.

    Levels without a share are left out.

    Attributes:
        levels: the number of levels.
        mean: the mean of the shares.
        median: the median of the shares; of several runs, of their means in each level.
        iqm: the interquartile mean: that of the middle half of the shares.
        worst_tenth: the mean of the lowest tenth of the shares (CVaR), at least one.
        solved: how many of the levels are solved, 0 to 1: those with a share of 0.95 or more.
        regret: the mean of the regrets of all levels.
        success: the mean of the chances to reach an exit of all levels.
        low: the lower end of the 95 % confidence interval of `mean`, in these levels and runs;
            equal to it if all scores are exact.
        high: the upper end.
        runs: the number of runs.
        intervals: the 95 % intervals of `mean`, `median`, `iqm`, `worst_tenth`, `solved`, `regret`
            and `success`, `(low, high)`, for other levels of the same kind and other runs. An end
            is nan if so few levels tell nothing of it: the lower one of `worst_tenth` with fewer
            than about 35 levels, and both of a single level in a single run; those of
            what is not finite, too, such as of an agent that never terminates.
    """

    levels: int
    mean: float
    median: float
    iqm: float
    worst_tenth: float
    solved: float
    regret: float
    success: float
    low: float
    high: float
    runs: int = 1
    intervals: dict[str, tuple[float, float]] = field(default_factory=dict, hash=False)


@dataclass(frozen=True, slots=True)
class Improvement(Telling, public=True):
    """How often one agent is better than another.

    Attributes:
        probability: the chance that a run of the one has a higher share of the optimum than a run
            of the other, in the same level, where equal shares count half; the mean over levels.
        low: the lower end of its 95 % interval, for other levels of the same kind and other runs;
            nan of a single level in single runs.
        high: the upper end.
    """

    probability: float
    low: float
    high: float


def statistics_of(
    shares: Floats, means: Floats, most_regret: float, *, stratified: bool
) -> tuple[dict[str, float], dict[str, tuple[float, float]]]:
    """Return statistics of runs, and their intervals, by their names.

    Args:
        shares: `[runs, levels]`, of the levels that have shares.
        means: regrets and successes, `[runs, levels, 2]`.
        most_regret: the most that a regret can be in levels of the same kind.
        stratified: see `brl.summary`.
    """
    groups = (
        (shares, _of_shares, _share_ends),
        (means, _of_means, lambda found: _mean_ends(found, most_regret)),
    )
    ends = [_ends(*group, stratified=stratified) for group in groups]
    found = [*_of_shares(shares).tolist(), *_of_means(means).tolist()]
    # Regrets and shares of success and of what is solved are not below 0, nor are shares above 1.
    floor, ceiling = [-math.inf] * 4 + [0.0] * 3, [1.0] * 5 + [math.inf, 1.0]
    # One nan for all, so that summaries of the same runs are equal.
    within = np.clip(np.concatenate(ends, axis=1), floor, ceiling)
    lows, highs = ([math.nan if math.isnan(end) else end for end in row] for row in within.tolist())
    intervals = zip(lows, highs, strict=True)
    return dict(zip(_NAMES, found, strict=True)), dict(zip(_NAMES, intervals, strict=True))


def improvement_of(ones: Floats, others: Floats) -> Improvement:
    """Return the probability of improvement, of shares `[runs, levels]` and `[others, levels]`."""
    one, other = ones[:, None], others[None]
    wins = np.where(np.isclose(one, other, rtol=0.0, atol=_EQUAL), 0.5, one > other)
    by_level, samples = wins.mean(axis=(0, 1)), (wins.mean(axis=(1, 2)), wins.mean(axis=(0, 2)))
    known = by_level.mean(keepdims=True)
    ends = np.array(interval(by_level, 0.0, 1.0) if len(by_level) > 1 else (*known, *known))
    ends = with_runs(known, ends[:, None], *(each[:, None] for each in samples))
    low, high = np.clip(ends.ravel(), 0.0, 1.0).tolist() if wins.size > 1 else [math.nan] * 2
    return Improvement(float(known[0]), low, high)


def _ends(
    values: Floats,
    statistics: Callable[[Floats], Floats],
    of_levels: Callable[[Floats], Floats],
    *,
    stratified: bool,
) -> Floats:
    """Return the ends of intervals for other levels and other runs, `[2, statistics]`.

    Args:
        values: `[runs, levels, …]`.
        statistics: returns the statistics of such values.
        of_levels: returns the ends of their intervals for other levels.
        stratified: whether they are for other runs alone.
    """
    known, (runs, levels) = statistics(values), values.shape[:2]
    if runs * levels == 1:
        # A single value cannot tell how much others differ.
        return np.full((2, len(known)), math.nan)
    ends = np.stack([known, known]) if stratified or levels == 1 else of_levels(values)
    with np.errstate(invalid="ignore"):
        # What is not finite has ends that are nan.
        return with_runs(known, ends, statistics(values[:, None]))


def _share_ends(shares: Floats) -> Floats:
    """Return the ends of the intervals of `_of_shares` for other levels, `[2, 5]`.

    Shares are at most 1. How low they may be, nobody knows: as far below chance as the optimum is
    above it, and twice as far from the optimum as the worst that there is.
    """
    lowest = 2.0 * min(0.0, float(shares.min())) - 1.0
    by_level, solved = shares.mean(axis=0), (shares >= SOLVED).mean(axis=0)
    ends = np.array(
        [
            interval(by_level, lowest, 1.0),
            trimmed_interval(by_level[None], lowest, 1.0, 0.5, 0.5),
            trimmed_interval(shares, lowest, 1.0, 0.25, 0.75),
            trimmed_interval(shares, lowest, 1.0, 0.0, WORST),
            interval(solved, 0.0, 1.0),
        ]
    ).T
    # What is only as that bound is told by no level.
    ends[0, ends[0] <= lowest + _EQUAL] = math.nan
    known = _of_shares(shares)
    return np.stack([np.minimum(ends[0], known), np.maximum(ends[1], known)])


def _mean_ends(means: Floats, most_regret: float) -> Floats:
    """Return the ends of the intervals of `_of_means` for other levels, `[2, 2]`."""
    regrets, successes = means.mean(axis=0).T
    return np.array([interval(regrets, 0.0, most_regret), interval(successes, 0.0, 1.0)]).T


def _of_shares(shares: Floats) -> Floats:
    """Return mean, median, IQM, worst tenth and solved of shares `[…, runs, levels]`: `[…, 5]`."""
    ordered = np.sort(shares.reshape(*shares.shape[:-2], -1))
    count = ordered.shape[-1]
    found = (
        ordered.mean(axis=-1),
        np.median(shares.mean(axis=-2), axis=-1),
        ordered[..., count // 4 : count - count // 4].mean(axis=-1),
        ordered[..., : max(1, math.ceil(WORST * count))].mean(axis=-1),
        np.where(np.isnan(ordered[..., 0]), math.nan, (ordered >= SOLVED).mean(axis=-1)),
    )
    return np.stack(found, axis=-1)


def _of_means(values: Floats) -> Floats:
    """Return the means of values `[…, runs, levels, n]`: `[…, n]`."""
    found: Floats = values.mean(axis=(-3, -2))
    return found
