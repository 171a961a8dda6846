"""How comparisons are shown: one row for each of ours and each peer that it is set beside."""

from __future__ import annotations

import argparse
import platform
import statistics
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from timing import FEW, ROUNDS, Compare, Comparison

NONE = "–"
HEADS = ("what", "ours", "rate", "peer", "its rate", "ratio", "spread", "aim", "reached")
RIGHT = {"rate", "its rate", "ratio", "spread", "aim"}


@dataclass(frozen=True)
class Row:
    """One of ours beside one peer, or alone. Rates that are missing are empty.

    Attributes:
        unit: what the rates count.
        ours: its name.
        rates: its rates, one a round.
        peer: the peer's name.
        peer_rates: its rates.
        aim: the least ratio that is aimed at, or the least rate without a peer.
    """

    unit: str
    ours: str
    rates: Sequence[float]
    peer: str | None = None
    peer_rates: Sequence[float] = ()
    aim: float | None = None

    @property
    def found(self) -> list[float]:
        """The ratios round by round, or the rates without a peer, in order; empty if missing."""
        if self.peer is None:
            return sorted(self.rates)
        if not self.rates or not self.peer_rates:
            return []
        return sorted(a / b for a, b in zip(self.rates, self.peer_rates, strict=True))

    @property
    def cells(self) -> tuple[str, ...]:
        """What the table shows, under `HEADS`."""
        found, aim = self.found, self.aim
        show = rate if self.peer is None else times
        reached = NONE if aim is None else "missing"
        if aim is not None and found:
            reached = "yes" if statistics.median(found) >= aim else "no"
        return (
            self.unit,
            self.ours,
            _middle(self.rates),
            self.peer or NONE,
            NONE if self.peer is None else _middle(self.peer_rates),
            times(statistics.median(found)) if found and self.peer else NONE,
            f"{show(found[0])} to {show(found[-1])}" if len(found) > 1 else NONE,
            NONE if aim is None else f"≥ {show(aim)}",
            reached,
        )


def rows(comparison: Comparison) -> Iterator[Row]:
    """Yield each of ours beside each peer, whether or not they could be measured."""
    for name, rates in comparison.ours.items():
        for peer, peer_rates in comparison.peers.items():
            aim = comparison.aims.get((name, peer))
            yield Row(comparison.unit, name, rates, peer, peer_rates, aim)
        alone = comparison.aims.get((name, None))
        if alone is not None or not comparison.peers:
            yield Row(comparison.unit, name, rates, aim=alone)


def table(lines: Iterable[tuple[str, ...]], heads: tuple[str, ...] = HEADS) -> str:
    """Return a table in Markdown whose columns stand under one another."""
    whole = [heads, *lines]
    widths = [max(map(len, column)) for column in zip(*whole, strict=True)]
    rule = tuple(
        f"{'-' * (width - 1)}:" if head in RIGHT else "-" * width
        for head, width in zip(heads, widths, strict=True)
    )
    whole.insert(1, rule)
    return "\n".join(
        "| "
        + " | ".join(
            cell.rjust(width) if head in RIGHT else cell.ljust(width)
            for head, cell, width in zip(heads, line, widths, strict=True)
        )
        + " |"
        for line in whole
    )


def rate(value: float) -> str:
    """Return a rate as people read it."""
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def times(value: float) -> str:
    """Return a ratio as people read it."""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def told(versions: Mapping[str, str]) -> str:
    """Return what was compared, on what."""
    packages = "".join(f", {name} {number}" for name, number in versions.items())
    return f"Python {platform.python_version()}{packages}, {platform.machine()}"


def main(description: str, compare: Compare, sizes: Sequence[int] = ()) -> None:
    """Measure as a script does that is called by itself, and print the tables.

    Args:
        description: the script's.
        compare: what it measures.
        sizes: how many environments it measures with; with an option for others, which `compare`
            takes then.
    """
    parser = argparse.ArgumentParser(description=description.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few rounds")
    if sizes:
        told_sizes = "how many environments: " + ", ".join(map(str, sizes))
        parser.add_argument("--sizes", type=int, nargs="+", default=sizes, help=told_sizes)
    asked = parser.parse_args()
    count = FEW if asked.quick else ROUNDS
    heading = ""
    for comparison in compare(count, asked.sizes) if sizes else compare(count):
        if told(comparison.versions) != heading:
            heading = told(comparison.versions)
            print(heading)
        print(table(row.cells for row in rows(comparison)))
        for why in sorted({*comparison.missing.values()}):
            print(f"missing: {why}")
        print(f"{comparison.note}\n" if comparison.note else "", flush=True)


def _middle(rates: Sequence[float]) -> str:
    return rate(statistics.median(rates)) if rates else "missing"
