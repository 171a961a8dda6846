"""Boxoban as exact MDPs: how many of its levels fit, how large they are, and what they cost.

    python benchmarks/boxoban.py FILE... [--count N] [--check] [--no-solve]

The files are those of https://github.com/google-deepmind/boxoban-levels, such as `hard/000.txt`; of
each, the first N levels are taken. For each level, the table has the states of robot and boxes that
can occur, the states of the tables, the fewest moves, the fewest pushes with these, and the seconds
of the processor to compile and to solve it. `--check` finds the fewest moves again, by a plain
search that is written apart. A second table has the medians and the most of each file.
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

FIGURES = {"reached": ",.0f", "moves": "g", "pushes": "g", "compiled": ".2f", "solved": ".2f"}
"""What the summary of a file has of `Row`, and how it is written."""

STEPS = ((0, -1), (1, 0), (0, 1), (-1, 0))


class Row(NamedTuple):
    """What is told of a level; without figures if it is too large.

    `found` is the fewest moves of the plain search; None if it was not asked for.
    """

    name: str
    reached: int = 0
    states: int = 0
    moves: float = 0
    pushes: float = 0
    compiled: float = 0
    solved: float = 0
    found: int | None = None


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


def searched(fields: dict[str, Any]) -> int:
    """Return the fewest moves, by a plain search over the robot and the set of boxes."""
    width, height = fields["size"]
    blocked = {tuple(entry["at"]) for entry in fields["blocked"]}
    cells = [(x, y) for y in range(height) for x in range(width) if (x, y) not in blocked]
    number = {cell: index for index, cell in enumerate(cells)}
    # The set of boxes is an integer with a bit for each cell.
    goal, boxes = (
        sum(1 << number[tuple(entry["at"])] for entry in fields[name])
        for name in ("targets", "boxes")
    )
    steps = [
        [
            (number[x + dx, y + dy], 1 << number.get((x + 2 * dx, y + 2 * dy), len(cells)))
            for dx, dy in STEPS
            if (x + dx, y + dy) in number
        ]
        for x, y in cells
    ]
    # What is not free is as if a box stood there for ever.
    boxes |= 1 << len(cells)
    begin = number[tuple(fields["start"])], boxes
    seen, layer, moves = {begin}, [begin], 0
    while layer:
        moves += 1
        after = []
        for at, boxes in layer:
            for to, beyond in steps[at]:
                if not boxes >> to & 1:
                    state = to, boxes
                elif boxes & beyond:
                    continue
                else:
                    state = to, boxes ^ (1 << to) ^ beyond
                    if goal & ~state[1] == 0:
                        return moves
                if state not in seen:
                    seen.add(state)
                    after.append(state)
        layer = after
    return -1


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


def rows_of(path: Path, count: int, *, check: bool, solve: bool) -> Iterator[Row]:
    """Measure the first levels of a file, and print a line for each."""
    for name, drawn in islice(maps(path), count):
        fields = fields_of(drawn)
        row = measured(name, fields, solve=solve)
        if check and row.moves:
            row = row._replace(found=searched(fields))
        told: list[object] = [f"{row.reached:,}", f"{row.states:,}", f"{row.moves:g}"]
        told += [f"{row.pushes:g}", f"{row.compiled:.2f}", f"{row.solved:.2f}"]
        told.append("" if row.found is None else row.found)
        shown = told if row.states else ["more than the bound", *[""] * 6]
        print(f"| {' | '.join(map(str, [name, *shown]))} |", flush=True)
        yield row


def summary(path: Path, rows: list[Row]) -> str:
    """Return the line of a file: how many levels fit, and medians and the most of these."""
    fit = [row for row in rows if row.states]
    checked = [row.found == row.moves for row in fit if row.found is not None]
    told = [middle([getattr(row, name) for row in fit], form) for name, form in FIGURES.items()]
    cells = [path, len(rows), len(fit), *told, f"{sum(checked)} of {len(checked)}"]
    return f"| {' | '.join(map(str, cells))} |"


def middle(figures: list[float], form: str) -> str:
    """Return the median and the most; nothing of no figures."""
    return f"{statistics.median(figures):{form}}; {max(figures):{form}}" if figures else ""


def main() -> None:
    """Measure, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--no-solve", action="store_true")
    options = parser.parse_args()
    head = ["robot and boxes", "states", "moves", "pushes", "compile (s)", "solve (s)", "searched"]
    print(f"| level | {' | '.join(head)} |\n|{'---|' * 8}")
    rows = {
        path: [*rows_of(path, options.count, check=options.check, solve=not options.no_solve)]
        for path in options.files
    }
    print("\nMedian; most:\n")
    head.remove("states")
    print(f"| file | levels | fit | {' | '.join(head)} |\n|{'---|' * 9}")
    print(*(summary(path, each) for path, each in rows.items()), sep="\n")
    fit = [row for each in rows.values() for row in each if row.states]
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    print(f"\nAt most {most:,.0f} MB", end="")
    if fit:
        rates = [row.reached / row.compiled for row in fit]
        print(f"; {statistics.median(rates):,.0f} states of robot and boxes a second of compiling")


if __name__ == "__main__":
    main()
