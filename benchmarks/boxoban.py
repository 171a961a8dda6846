"""Boxoban as exact MDPs: how many of its levels fit, how large they are, and what they cost.

    python benchmarks/boxoban.py FILE... [--count N] [--check] [--no-solve]

The files are those of https://github.com/google-deepmind/boxoban-levels, such as `hard/000.txt`; of
each, the first N levels are taken. For each level, the table has the states of robot and boxes that
can occur, the states of the tables, the fewest moves, the fewest pushes with these, and the seconds
of the processor to compile and to solve it. `--check` counts the states and the fewest moves again,
by the plain search of `plain_search.py`, with its seconds, and how many times as long the compiler
takes. A second table has the medians and the most of each file.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import time
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import babyrobot_levels as brl

FIGURES = {
    **{"reached": ",.0f", "moves": "g", "pushes": "g", "compiled": ".2f", "solved": ".2f"},
    **{"searched": ".2f", "ratio": ".1f"},
}
"""What the summary of a file has of `Row`, and how it is written."""

HEAD = (
    *("robot and boxes", "states", "moves", "pushes", "compile (s)", "solve (s)"),
    *("search (s)", "ratio", "equal"),
)


class Row(NamedTuple):
    """What is told of a level; without figures if it is too large.

    `found` is the states and the fewest moves of the plain search, and `searched` its seconds; None
    if it was not asked for.
    """

    name: str
    reached: int = 0
    states: int = 0
    moves: float = 0
    pushes: float = 0
    compiled: float = 0
    solved: float = 0
    found: tuple[int, int] | None = None
    searched: float | None = None

    @property
    def ratio(self) -> float | None:
        """How many times as long as the plain search the compiler takes."""
        return self.compiled / self.searched if self.searched else None

    @property
    def agrees(self) -> bool:
        """Whether the plain search finds the same; the moves are 0 if they were not asked for."""
        states, moves = self.found or (0, 0)
        return states == self.reached and self.moves in (0, moves)


def maps(path: Path) -> Iterator[tuple[str, list[str]]]:
    """Yield the levels of a file, each with its name."""
    for part in path.read_text(encoding="utf-8").split("; ")[1:]:
        number, *rows = part.splitlines()
        yield f"{path.with_suffix('')} {number.strip()}", [row for row in rows if row.strip()]


def fields_of(rows: list[str]) -> dict[str, Any]:
    """Return a map without the walls around it as the fields of a level."""
    cells = {(x, y): mark for y, row in enumerate(rows) for x, mark in enumerate(row)}
    free = [cell for cell, mark in cells.items() if mark != "#"]
    left, top = (min(cell[axis] for cell in free) for axis in (0, 1))
    right, foot = (max(cell[axis] for cell in free) for axis in (0, 1))

    def at(marks: str) -> list[list[int]]:
        return [
            [x - left, y - top]
            for (x, y), mark in cells.items()
            if mark in marks and left <= x <= right and top <= y <= foot
        ]

    return {
        "version": 1,
        "size": [right - left + 1, foot - top + 1],
        "start": at("@+")[0],
        "blocked": [{"at": cell} for cell in at("#")],
        "boxes": [{"at": cell} for cell in at("$*")],
        "targets": [{"at": cell} for cell in at(".*+")],
    }


def measured(name: str, fields: dict[str, Any], *, solve: bool) -> Row:
    """Return what is told of a level."""
    level = brl.load(fields)
    begin = time.process_time()
    try:
        mdp = level.compile()
    except brl.LevelError:
        return Row(name)
    compiled = time.process_time() - begin
    reached = int((~mdp.is_terminal).sum())
    if not solve:
        return Row(name, reached, mdp.num_states, compiled=compiled)
    begin = time.process_time()
    found = brl.metrics(level)
    moves = found.best_steps or 0
    solved = time.process_time() - begin
    return Row(name, reached, mdp.num_states, moves, found.pushes or 0, compiled, solved)


def checked(row: Row, fields: dict[str, Any]) -> Row:
    """Return what is told of a level with what a plain search finds."""
    from plain_search import searched

    begin = time.process_time()
    found = searched(fields)
    return row._replace(found=found, searched=time.process_time() - begin)


def rows_of(path: Path, count: int, *, check: bool, solve: bool) -> Iterator[Row]:
    """Measure the first levels of a file, and print a line for each."""
    for name, drawn in islice(maps(path), count):
        fields = fields_of(drawn)
        row = measured(name, fields, solve=solve)
        if check and row.states:
            row = checked(row, fields)
        told: list[object] = [f"{row.reached:,}", f"{row.states:,}", f"{row.moves:g}"]
        told += [f"{row.pushes:g}", f"{row.compiled:.2f}", f"{row.solved:.2f}"]
        if row.found:
            told += [f"{row.searched:.3f}", f"{row.ratio:.1f}", row.agrees]
        shown = told if row.states else ["more than the bound"]
        shown += [""] * (len(HEAD) - len(shown))
        print(f"| {' | '.join(map(str, [name, *shown]))} |", flush=True)
        yield row


def summary(path: Path, rows: list[Row]) -> str:
    """Return the line of a file: how many levels fit, and medians and the most of these."""
    fit = [row for row in rows if row.states]
    checked = [row.agrees for row in fit if row.found]
    columns = ([getattr(row, name) for row in fit] for name in FIGURES)
    told = map(middle, columns, FIGURES.values())
    cells = [path, len(rows), len(fit), *told, f"{sum(checked)} of {len(checked)}"]
    return f"| {' | '.join(map(str, cells))} |"


def middle(figures: list[float | None], form: str) -> str:
    """Return the median and the most; nothing of no figures."""
    there = [each for each in figures if each is not None]
    return f"{statistics.median(there):{form}}; {max(there):{form}}" if there else ""


def main() -> None:
    """Measure, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--no-solve", action="store_true")
    options = parser.parse_args()
    # The first compilation takes longer: it loads machine code.
    brl.load(fields_of(next(maps(options.files[0]))[1])).compile()
    print(f"| level | {' | '.join(HEAD)} |\n|{'---|' * (1 + len(HEAD))}")
    rows = {
        path: [*rows_of(path, options.count, check=options.check, solve=not options.no_solve)]
        for path in options.files
    }
    print("\nMedian; most:\n")
    head = [name for name in HEAD if name != "states"]
    print(f"| file | levels | fit | {' | '.join(head)} |\n|{'---|' * (3 + len(head))}")
    print(*(summary(path, each) for path, each in rows.items()), sep="\n")
    fit = [row for each in rows.values() for row in each if row.states]
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    print(f"\nAt most {most:,.0f} MB", end="")
    if fit:
        rates = [row.reached / row.compiled for row in fit]
        print(f"; {statistics.median(rates):,.0f} states of robot and boxes a second of compiling")


if __name__ == "__main__":
    main()
