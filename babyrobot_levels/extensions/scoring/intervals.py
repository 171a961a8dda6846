"""95 % intervals that hold for few values as well, of means and of what is left of trimmed ones.

What a few values did not show can still happen: an agent that reaches the exit in one episode of a
hundred mostly fails thirty times in a row. So these intervals have to know between which bounds
values lie. Values in rising order cut the distribution that they are from into parts, whose shares
are as likely as the weights of a flat Dirichlet distribution, whatever that distribution is. For
the lower end of an interval, each part counts as its lowest value, and for the upper end as its
highest; the first one, or the last, is the bound. Of a mean, that is the interval of Gaffke (2005);
see Learned-Miller and Thomas, A new confidence interval for the mean of a bounded random variable
(2019), who conjecture that it always holds. Of zeros and ones it is the interval of Clopper and
Pearson (1934), of quantiles that of order statistics (Thompson, 1936).
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.tables import Floats

TAIL = 0.025
"""The chance that an interval of 95 % lies below what it is of, and that it lies above."""

_DRAWS = 4000
"""How often weights are drawn: the ends vary by about 2 % of the width of the interval."""

_APART = 500
"""So many of the lowest and of the highest values are weighted alone; if there are more, those
between them are in twice as many groups."""

_AT_ONCE, _MANY = 1_000_000, 10_000_000
"""So many values are drawn at once, which bounds the memory, and altogether, which bounds the time:
weights of parts are drawn a quarter as often at the least."""


def interval(values: Floats, low: float, high: float) -> tuple[float, float]:
    """Return a 95 % confidence interval of the mean that values are drawn from.

    It is nan if a bound is not finite.

    Args:
        values: `[n]`, independent of each other.
        low: the lowest value that there can be.
        high: the highest.
    """
    if not math.isfinite(high - low):
        return math.nan, math.nan
    distinct, counts = _grouped(*np.unique(values, return_counts=True))
    random = np.random.default_rng(0)
    weights = random.standard_gamma([*counts, 1.0], (_DRAWS, len(counts) + 1))
    weights /= weights.sum(axis=1, keepdims=True)
    known, unknown, mean = weights[:, :-1] @ distinct, weights[:, -1], float(values.mean())
    least = float(np.quantile(known + unknown * low, TAIL))
    most = float(np.quantile(known + unknown * high, 1 - TAIL))
    return min(least, mean), max(most, mean)


def _grouped(values: Floats, counts: NDArray[Any]) -> tuple[Floats, NDArray[Any]]:
    """Return sorted values and how often they are there, with their means if they are many."""
    if len(values) <= 4 * _APART:
        return values, counts
    inner = np.linspace(_APART, len(values) - _APART, 2 * _APART, endpoint=False).astype(int)
    starts = np.concatenate([np.arange(_APART), inner, np.arange(-_APART, 0) + len(values)])
    sizes = np.add.reduceat(counts, starts)
    return np.add.reduceat(values * counts, starts) / sizes, sizes


def trimmed_interval(
    values: Floats, low: float, high: float, first: float, last: float
) -> tuple[float, float]:
    """Return a 95 % confidence interval of a part of the distribution that values are drawn from.

    It is nan if a bound is not finite.

    Args:
        values: `[runs, levels]`: levels are independent of each other, runs in a level are not.
        low: the lowest value that there can be.
        high: the highest.
        first: which share of the lowest values is left out.
        last: the interval is that of the mean from there to this share, or of the quantile `first`.
    """
    if not math.isfinite(high - low):
        return math.nan, math.nan
    runs, levels = values.shape
    order = np.argsort(values, axis=None, kind="stable")
    known, level = values.ravel()[order], order % levels
    random = np.random.default_rng(0)
    lows, highs, step = list[Floats](), list[Floats](), max(1, _AT_ONCE // order.size)
    draws = min(_DRAWS, max(_DRAWS // 4, _MANY // order.size))
    for begin in range(0, draws, step):
        weights = random.standard_exponential((min(step, draws - begin), levels + 1))
        weights /= weights.sum(axis=1, keepdims=True)
        each, unknown = weights[:, level] / runs, weights[:, -1:]
        lows.append(_trimmed(np.array([low, *known]), np.hstack([unknown, each]), first, last))
        highs.append(_trimmed(np.array([*known, high]), np.hstack([each, unknown]), first, last))
    return (
        float(np.quantile(np.concatenate(lows), TAIL, method="lower")),
        float(np.quantile(np.concatenate(highs), 1 - TAIL, method="higher")),
    )


def _trimmed(values: Floats, weights: Floats, first: float, last: float) -> Floats:
    """Return the part of a distribution from one share to another, `[draws]`; see above.

    Args:
        values: in rising order, `[n]`.
        weights: their shares, `[draws, n]`.
        first: where the part begins.
        last: where it ends.
    """
    reached = np.cumsum(weights, axis=1)
    if first == last:
        quantiles: Floats = values[(reached < first).sum(axis=1)]
        return quantiles
    shares = np.diff(np.clip(reached, first, last), axis=1, prepend=first)
    means: Floats = shares @ values / (last - first)
    return means


def with_runs(known: Floats, ends: Floats, *samples: Floats) -> Floats:
    """Return the ends of intervals for other runs as well, `[2, n]`.

    Of runs it is the interval of Student's t. How far both are from the statistic is put together
    as errors that do not depend on each other: Zou and Donner, Construction of confidence limits
    about effect measures (2008).

    Args:
        known: the statistics, `[n]`.
        ends: their intervals for other levels, `[2, n]`, or the statistics themselves.
        samples: the statistics of each run alone, `[runs, n]`, for one sample of runs or several.
    """
    # SciPy is imported when it is needed.
    from scipy.special import stdtrit  # type: ignore[import-untyped]

    reach = abs(ends - known)
    for each in samples:
        if len(each) > 1:
            error = each.std(axis=0, ddof=1) / len(each) ** 0.5
            reach = np.hypot(reach, stdtrit(len(each) - 1, 1 - TAIL) * error)
    return known + [[-1], [1]] * reach
