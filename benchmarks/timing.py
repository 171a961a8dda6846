"""Measuring side by side: rounds in turn, so that a machine whose speed drifts slows all alike."""

from __future__ import annotations

import platform
import statistics
from collections.abc import Callable, Iterable
from importlib.metadata import version

Measure = Callable[[], float]
"""Runs once and returns its rate, in things done per second."""


def rounds(measures: dict[str, Measure], count: int = 7) -> dict[str, list[float]]:
    """Run all measures in turn, `count` times after one round that does not count."""
    rates: dict[str, list[float]] = {name: [] for name in measures}
    for number in range(count + 1):
        for name, measure in measures.items():
            rate = measure()
            if number:
                rates[name].append(rate)
    return rates


def table(rates: dict[str, list[float]], baseline: str, unit: str) -> str:
    """Return minimum, median and maximum of each, and the ratio to the baseline round by round."""
    lines = [f"{unit:<44}{'min':>12}{'median':>12}{'max':>12}{'ratio':>9}  (spread)"]
    for name, values in rates.items():
        ratios = sorted(a / b for a, b in zip(values, rates[baseline], strict=True))
        lines.append(
            f"{name:<44}{min(values):>12,.0f}{statistics.median(values):>12,.0f}"
            f"{max(values):>12,.0f}{statistics.median(ratios):>9.2f}"
            f"  ({ratios[0]:.2f} to {ratios[-1]:.2f})"
        )
    return "\n".join(lines)


def versions(packages: Iterable[str]) -> str:
    """Return what was compared, on what."""
    told = ", ".join(f"{name} {version(name)}" for name in packages)
    return f"Python {platform.python_version()}, {told}, {platform.machine()}"
