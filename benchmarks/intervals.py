"""How often the 95 % intervals of summaries and of improvement hold what they are intervals of.

    python benchmarks/intervals.py [--times 400]

prints the tables of docs/scoring.md. Shares of levels are drawn from populations, most of them
skewed; of several runs, each has an effect of its own in all levels. An end that an interval does
not tell holds everything. It measures no time, and takes half an hour.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.extensions.scoring.summaries import (
    SOLVED,
    WORST,
    improvement_of,
    statistics_of,
)

Floats = NDArray[np.float64]
Random = np.random.Generator
Draw = Callable[[Random, int], Any]

POPULATIONS: dict[str, Draw] = {
    "1 % at the optimum, others like chance": lambda rng, n: 1.0 * (rng.random(n) < 0.01),
    "90 % at the optimum, others like chance": lambda rng, n: 1.0 * (rng.random(n) < 0.9),
    "near the optimum: beta(8, 1)": lambda rng, n: rng.beta(8, 1, n),
    "near chance: beta(0.5, 5)": lambda rng, n: rng.beta(0.5, 5, n),
    "normal(0.5, 0.2)": lambda rng, n: np.minimum(1, rng.normal(0.5, 0.2, n)),
    "90 % at the optimum, others −1 to 0": lambda rng, n: np.where(
        rng.random(n) < 0.9, 1.0, rng.uniform(-1, 0, n)
    ),
    "90 % beta(8, 1), others −3 to −2": lambda rng, n: np.where(
        rng.random(n) < 0.9, rng.beta(8, 1, n), rng.uniform(-3, -2, n)
    ),
    "1 − exponential(0.5)": lambda rng, n: 1 - rng.exponential(0.5, n),
    "1 − exponential(2)": lambda rng, n: 1 - rng.exponential(2, n),
    "1 − log-normal(−1, 1)": lambda rng, n: 1 - rng.lognormal(-1, 1, n),
}
EFFECTS: dict[str, Draw] = {
    "normal(0, 0.1)": lambda rng, n: rng.normal(0, 0.1, n),
    "0.1 − exponential(0.1)": lambda rng, n: 0.1 - rng.exponential(0.1, n),
    "a tenth of the runs 0.6 lower": lambda rng, n: np.where(rng.random(n) < 0.9, 0.0, -0.6),
}
LEVELS, RUNS = (5, 10, 30, 100), (3, 5, 10)
STATISTICS = ("mean", "median", "iqm", "worst_tenth", "solved")
WHOLE = 1_000_000


def single_run(draw: Draw, rng: Random, _: int, levels: int) -> Floats:
    """Return shares of one run, `[1, levels]`."""
    shares: Floats = draw(rng, levels)[None]
    return shares


def several_runs(effect: Draw, rng: Random, runs: int, levels: int) -> Floats:
    """Return shares of runs with effects, `[runs, levels]`."""
    shares = rng.beta(5, 1, levels) + effect(rng, runs)[:, None]
    found: Floats = np.minimum(1, shares + rng.normal(0, 0.05, (runs, levels)))
    return found


def true_statistics(shares: Floats) -> list[float]:
    """Return the statistics of a whole population, `[runs, levels]`."""
    ordered = np.sort(shares.ravel())
    count = ordered.size
    return [
        float(ordered.mean()),
        float(np.median(shares.mean(axis=0))),
        float(ordered[count // 4 : 3 * count // 4].mean()),
        float(ordered[: round(WORST * count)].mean()),
        float((ordered >= SOLVED).mean()),
    ]


def held(draw: Callable[[int, int], Floats], runs: int, levels: int, times: int) -> Floats:
    """Return how often each interval holds, `[statistics]`, of shares `[runs, levels]`."""
    true = true_statistics(draw(4000, 500) if runs > 1 else draw(1, WHOLE))
    found = np.zeros(len(true))
    for _ in range(times):
        shares = draw(runs, levels)
        means = np.stack([1 - shares, shares], axis=-1)
        ends = statistics_of(shares, means, 2.0, stratified=False)[1]
        low, high = np.array([ends[name] for name in STATISTICS]).T
        found += ~(low > np.array(true) + 1e-9) & ~(high < np.array(true) - 1e-9)
    return found / times


def improvement_held(chance: float, levels: int, times: int, rng: Random) -> float:
    """Return how often the interval of improvement holds, of levels that one wins or ties."""
    found = 0
    for _ in range(times):
        wins = np.where(rng.random((1, levels)) < chance, 1.0, 0.5)
        result = improvement_of(wins, np.full((1, levels), 0.5))
        found += result.low - 1e-9 <= 0.5 + chance / 2 <= result.high + 1e-9
    return found / times


def row(*cells: str) -> None:
    """Print a row of a table."""
    print(f"| {' | '.join(cells)} |", flush=True)


def told(values: Sequence[float]) -> str:
    """Return shares as percents, one after the other."""
    return ", ".join(f"{100 * value:.0f}" for value in values)


def main() -> None:
    """Simulate, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", type=int, default=400, help="samples for each figure")
    times = parser.parse_args().times
    rng = np.random.default_rng(0)
    row("shares of levels", *STATISTICS)
    row(*["---"] * (len(STATISTICS) + 1))
    for name, population in POPULATIONS.items():
        draw = partial(single_run, population, rng)
        found = np.array([held(draw, 1, levels, times) for levels in LEVELS])
        row(name, *map(told, found.T.tolist()))
    print()
    row("effects of runs", "runs", *STATISTICS)
    row(*["---"] * (len(STATISTICS) + 2))
    for name, effect in EFFECTS.items():
        draw = partial(several_runs, effect, rng)
        for runs in RUNS:
            found = np.array([held(draw, runs, levels, times // 2) for levels in (5, 30, 100)])
            row(name, str(runs), *map(told, found.T.tolist()))
    print()
    for chance in (0.02, 0.5, 0.98):
        shares = [improvement_held(chance, levels, times, rng) for levels in LEVELS]
        row(f"better in {chance:.0%} of the levels, as good in others", told(shares))


if __name__ == "__main__":
    main()
