"""Scores of all levels, and of several runs, in a few numbers, with bootstrap intervals."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.text.words import Telling

SOLVED = 0.95
"""From this share of the optimum on, a level counts as solved."""

WORST = 0.1
"""The share of the levels that the worst tenth is made of."""

TAIL = 0.025
"""The chance that an interval of 95 % lies below what it is of, and that it lies above."""

_NAMES = ("mean", "median", "iqm", "worst_tenth", "solved", "regret", "success")
"""The statistics that have intervals."""

_DRAWS = 2000
"""How many samples are drawn for an interval: its ends vary by about 3 % of its width."""

_EQUAL = 1e-9
"""Shares that differ by less are equal."""

_AT_ONCE = 1_000_000
"""So many values are drawn at once, which bounds the memory."""


@dataclass(frozen=True, slots=True)
class Summary(Telling):
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
        intervals: the 95 % bootstrap intervals of `mean`, `median`, `iqm`, `worst_tenth`,
            `solved`, `regret` and `success`, `(low, high)`, for other levels of the same kind and
            other runs; nan of a single level in a single run.
    """

    __module__ = "babyrobot_levels"

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
class Improvement(Telling):
    """How often one agent is better than another.

    Attributes:
        probability: the chance that a run of the one has a higher share of the optimum than a run
            of the other, in the same level, where equal shares count half; the mean over levels.
        low: the lower end of its 95 % bootstrap interval.
        high: the upper end.
    """

    __module__ = "babyrobot_levels"

    probability: float
    low: float
    high: float


def statistics_of(
    shares: Floats, means: Floats, *, stratified: bool
) -> tuple[dict[str, float], dict[str, tuple[float, float]]]:
    """Return statistics of runs, and their intervals, by their names.

    Args:
        shares: `[runs, levels]`, of the levels that have shares.
        means: regrets and successes, `[runs, levels, 2]`.
        stratified: see `brl.summary`.
    """
    size, other = shares.shape, means.shape[:2]
    ends = np.concatenate(
        [
            _ends(size, lambda *drawn: _of_shares(shares[drawn]), stratified=stratified),
            _ends(other, lambda *drawn: _of_means(means[drawn]), stratified=stratified),
        ],
        axis=1,
    )
    known = [*_of_shares(shares).tolist(), *_of_means(means).tolist()]
    return (
        dict(zip(_NAMES, known, strict=True)),
        dict(zip(_NAMES, map(tuple, ends.T.tolist()), strict=True)),
    )


def improvement_of(ones: Floats, others: Floats) -> Improvement:
    """Return the probability of improvement, of shares `[runs, levels]` and `[others, levels]`."""
    difference = ones[:, None] - others[None]
    wins = np.where(abs(difference) < _EQUAL, 0.5, difference > 0)
    random = np.random.default_rng(0)
    # How often each is drawn: of the runs, and of the levels.
    counts = [random.multinomial(size, np.full(size, 1 / size), _DRAWS) for size in wins.shape]
    drawn = np.einsum("di,dj,dij->d", *counts[:2], np.tensordot(counts[2], wins, (1, 2)))
    low, high = np.quantile(drawn / wins.size, [TAIL, 1 - TAIL]).tolist()
    return Improvement(float(wins.mean()), low, high)


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


def _ends(size: tuple[int, int], of_drawn: Callable[..., Any], *, stratified: bool) -> Floats:
    """Return the ends of the bootstrap intervals of several statistics, `[2, statistics]`.

    Args:
        size: the numbers of runs and levels.
        of_drawn: returns statistics for the numbers of runs and levels in samples.
        stratified: see `brl.summary`.
    """
    runs, levels = size
    random = np.random.default_rng(0)
    found: list[Any] = []
    step = max(1, _AT_ONCE // (runs * levels))
    for first in range(0, _DRAWS, step):
        count = min(step, _DRAWS - first)
        if stratified:
            drawn = random.integers(runs, size=(count, runs, levels)), np.arange(levels)
        else:
            drawn = (
                random.integers(runs, size=(count, runs, 1)),
                random.integers(levels, size=(count, 1, levels)),
            )
        found.append(of_drawn(*drawn))
    ends = np.quantile(np.concatenate(found), [TAIL, 1 - TAIL], axis=0)
    # A single value cannot tell how much others differ.
    return ends if runs * levels > 1 else np.full_like(ends, math.nan)
