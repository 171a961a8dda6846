"""The page that keeps a run's results: machine, versions, the table, and what is missing."""

from __future__ import annotations

import datetime
import os
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from report import HEADS, rows, table
from timing import ROUNDS, Comparison

PROCESSORS = Path("/proc/cpuinfo")


@dataclass(frozen=True)
class Result:
    """What a benchmark came to.

    Attributes:
        name: the script's.
        comparisons: what it measured, all of it unless it failed.
        failure: why it did not come to its end, if so.
    """

    name: str
    comparisons: tuple[Comparison, ...]
    failure: str | None = None


def result_table(results: Sequence[Result]) -> str:
    """Return one table of all that was measured."""
    return table(
        (
            (result.name, *row.cells)
            for result in results
            for comparison in result.comparisons
            for row in rows(comparison)
        ),
        ("benchmark", *HEADS),
    )


def remarks(results: Sequence[Result], names: Sequence[str]) -> list[str]:
    """Return what else is to be told, a line each: notes, what is missing, and what failed.

    Args:
        results: what there is.
        names: the benchmarks that were asked for.
    """
    told = [
        f"- {comparison.note}"
        for result in results
        for comparison in result.comparisons
        if comparison.note
    ]
    # A peer is missing once, however often it would have been measured.
    told += dict.fromkeys(
        f"- missing: {why}"
        for result in results
        for comparison in result.comparisons
        for why in comparison.missing.values()
    )
    told += [f"- failed: {result.name}: {result.failure}" for result in results if result.failure]
    done = {result.name for result in results}
    return told + [f"- not run: {name}" for name in names if name not in done]


def page(results: Sequence[Result], names: Sequence[str], count: int) -> str:
    """Return the page: results of the benchmarks asked for, by their names, with so many rounds."""
    versions: dict[str, str] = {}
    for result in results:
        for comparison in result.comparisons:
            versions |= comparison.versions
    packages = ", ".join(f"{name} {versions[name]}" for name in sorted(versions))
    quick = "" if count >= ROUNDS else " **A quick run: too few rounds to be relied on.**"
    lines = [
        "# Results",
        "",
        "Written by `python benchmarks/run.py`; [README.md](README.md) tells what is measured.",
        f"Each figure is the median of {count} rounds in turn.{quick}",
        "",
        f"- date: {datetime.datetime.now(datetime.UTC):%Y-%m-%d}",
        f"- machine: {os.cpu_count()} processors, {processor()}, {platform.system()}",
        f"- Python {platform.python_version()}",
        f"- {packages or 'nothing was measured'}",
        "",
        result_table(results),
        "",
        "A ratio is ours over the peer's, round by round: its median, and from the least to the",
        "most. Where there is no peer, the spread is that of the rate. Aims are what the project",
        "has set itself: a least ratio, or a least rate.",
    ]
    told = remarks(results, names)
    return "\n".join([*lines, *(["", *told] if told else [])]) + "\n"


def processor() -> str:
    """Return the processor's model, as far as the system tells."""
    if PROCESSORS.exists():
        for line in PROCESSORS.read_text("utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
