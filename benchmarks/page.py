"""The page with the results of a run: machine, versions, the table, and what is missing."""

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
    """The result of a benchmark.

    Attributes:
        name: the script's.
        comparisons: its measurements, up to a failure.
        failure: the reason why it failed, if it did.
    """

    name: str
    comparisons: tuple[Comparison, ...]
    failure: str | None = None


def result_table(results: Sequence[Result]) -> str:
    """Return one table of all measurements."""
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
    """Return lines with notes, missing peers, failures, and benchmarks that were not run.

    Args:
        results: the results.
        names: the requested benchmarks.
    """
    notes = [
        f"- {comparison.note}"
        for result in results
        for comparison in result.comparisons
        if comparison.note
    ]
    # A missing peer is listed once, however often it would have been measured.
    notes += dict.fromkeys(
        f"- missing: {why}"
        for result in results
        for comparison in result.comparisons
        for why in comparison.missing.values()
    )
    notes += [f"- failed: {result.name}: {result.failure}" for result in results if result.failure]
    done = {result.name for result in results}
    return notes + [f"- not run: {name}" for name in names if name not in done]


def page(results: Sequence[Result], names: Sequence[str], count: int) -> str:
    """Return the page with the results of the requested benchmarks, measured in `count` rounds."""
    versions: dict[str, str] = {}
    for result in results:
        for comparison in result.comparisons:
            versions |= comparison.versions
    packages = ", ".join(f"{name} {versions[name]}" for name in sorted(versions))
    quick = "" if count >= ROUNDS else " **A quick run: too few rounds for reliable results.**"
    lines = [
        "# Results",
        "",
        "Written by `python benchmarks/run.py`; [README.md](README.md) describes what is measured.",
        f"Each figure is the median of {count} rounds in turn.{quick}",
        "",
        f"- date: {datetime.datetime.now(datetime.UTC):%Y-%m-%d}",
        f"- machine: {os.cpu_count()} processors, {processor()}, {platform.system()}",
        f"- Python {platform.python_version()}",
        f"- {packages or 'nothing was measured'}",
        "",
        result_table(results),
        "",
        "A ratio is ours over the peer's, round by round: its median, minimum and maximum. Without",
        "a peer, the spread is that of the rate. Aims are the project's own: a smallest ratio or",
        "rate.",
    ]
    notes = remarks(results, names)
    return "\n".join([*lines, *(["", *notes] if notes else [])]) + "\n"


def processor() -> str:
    """Return the processor's model, if the system reports it."""
    if PROCESSORS.exists():
        for line in PROCESSORS.read_text("utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
