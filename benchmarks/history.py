"""How the ratios of the results moved from run to run, as far as git knows.

    python benchmarks/history.py            # writes benchmarks/HISTORY.md

Each run of all benchmarks is one version of RESULTS.md. Machines differ from run to run, and so
do the rates; a ratio sets ours beside a peer on the same machine, so that it can be followed.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from report import NONE, table, times

from babyrobot_levels.text.files import write_text

RESULTS = Path(__file__).with_name("RESULTS.md")
HISTORY = Path(__file__).with_name("HISTORY.md")

BARS = "▁▂▃▄▅▆▇█"

Compared = tuple[str, str, str, str]
"""A benchmark, what it counts, ours, and the peer."""


@dataclass(frozen=True)
class Run:
    """The ratios of one run.

    Attributes:
        date: when it was, as its page says.
        ratios: the median of each comparison.
    """

    date: str
    ratios: dict[Compared, float]


def read(text: str) -> Run:
    """Return the run that a page of results tells of."""
    lines = text.splitlines()
    date = next((line[8:] for line in lines if line.startswith("- date: ")), NONE)
    ratios: dict[Compared, float] = {}
    for line in lines:
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if len(cells) == 10 and cells[6].replace(".", "").isdigit():
            benchmark, what, ours, _, peer, _, ratio, *_ = cells
            ratios[benchmark, what, ours, peer] = float(ratio)
    return Run(date, ratios)


def runs_of(pages: Iterable[str]) -> list[Run]:
    """Return the runs of pages, the oldest first; what only words of a page changed is no run."""
    runs: list[Run] = []
    for run in map(read, pages):
        if runs and list(runs[-1].ratios.values()) == list(run.ratios.values()):
            runs.pop()
        runs.append(run)
    return runs


def bars(ratios: Sequence[float | None]) -> str:
    """Return a bar for each ratio, from 0 to the largest, and a gap where there is none."""
    most = max(ratio for ratio in ratios if ratio is not None) or 1
    return "".join(
        " " if ratio is None else BARS[round(ratio / most * (len(BARS) - 1))] for ratio in ratios
    )


def history(runs: Sequence[Run]) -> str:
    """Return a page with the ratios of the last run that an earlier one has, too."""
    lines = []
    for compared, last in runs[-1].ratios.items():
        ratios = [run.ratios.get(compared) for run in runs]
        known = [ratio for ratio in ratios if ratio is not None]
        if len(known) > 1:
            lines.append((*compared, f"`{bars(ratios)}`", times(known[0]), times(last)))
    heads = ("benchmark", "what", "ours", "peer", "runs", "first", "last")
    dates = ", ".join(run.date for run in runs)
    return (
        "# Ratios from run to run\n\n"
        "Written by `python benchmarks/history.py` from the versions of [RESULTS.md](RESULTS.md).\n"
        "A ratio is ours over the peer's, measured in turn; bars go from 0 to the largest.\n\n"
        f"Runs: {dates}.\n\n{table(lines, heads)}\n"
    )


def committed(path: Path) -> list[str]:
    """Return all versions of a file that git has, the oldest first."""

    def git(*words: str) -> str:
        return subprocess.run(
            ["git", "-C", path.parent, *words], check=True, capture_output=True, encoding="utf-8"
        ).stdout

    hashes = git("log", "--reverse", "--format=%H", "--", path.name).split()
    return [git("show", f"{revision}:./{path.name}") for revision in hashes]


def main() -> None:
    """Write the page, with the file as it is now for the last run."""
    write_text(HISTORY, history(runs_of([*committed(RESULTS), RESULTS.read_text("utf-8")])))


if __name__ == "__main__":
    main()
