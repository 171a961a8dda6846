"""Boxoban as exact MDPs: how many of its levels fit, how large they are, and what they cost.

    python benchmarks/boxoban.py FILE... [--count N] [--check] [--no-solve]

The files are those of https://github.com/google-deepmind/boxoban-levels, such as `hard/000.txt`; of
each, the first N levels are taken. For each level, the table has the states of robot and boxes that
can occur, the states of the tables, the fewest moves, the pushes on such a way, and the seconds of
the processor to compile and to solve it. `--check` finds the fewest moves again, by a plain search
that is written apart.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import sys
import time
from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import babyrobot_levels as brl

STEPS = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}


class Row(NamedTuple):
    """What is told of a level; without figures if it is too large."""

    name: str
    reached: int = 0
    states: int = 0
    moves: float = 0
    pushes: int = 0
    compiled: float = 0
    solved: float = 0


def maps(path: Path) -> Iterator[tuple[str, list[str]]]:
    """Yield the levels of a file, each with its name."""
    for part in path.read_text(encoding="utf-8").split("; ")[1:]:
        number, *rows = part.splitlines()
        yield f"{path.stem} {number.strip()}", [row for row in rows if row.strip()]


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
    cells = {(x, y) for y in range(height) for x in range(width)}
    free = cells - {tuple(entry["at"]) for entry in fields["blocked"]}
    goal = frozenset(tuple(entry["at"]) for entry in fields["targets"])
    begin = tuple(fields["start"]), frozenset(tuple(entry["at"]) for entry in fields["boxes"])
    seen, waiting = {begin}, deque([(begin, 0)])
    while waiting:
        ((x, y), boxes), moves = waiting.popleft()
        for dx, dy in STEPS.values():
            to, beyond = (x + dx, y + dy), (x + 2 * dx, y + 2 * dy)
            after = boxes
            if to in boxes:
                if beyond not in free or beyond in boxes:
                    continue
                after = boxes - {to} | {beyond}
            if to not in free:
                continue
            if goal <= after:
                return moves + 1
            if (to, after) not in seen:
                seen.add((to, after))
                waiting.append(((to, after), moves + 1))
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
    begin = time.process_time()
    solution = brl.solve(level) if solve else None
    solved = time.process_time() - begin
    if solution is None:
        return Row(name, reached, mdp.num_states, compiled=compiled)
    state, pushes = int(np.flatnonzero(mdp.start)[0]), 0
    while not mdp.is_terminal[state] and np.isfinite(solution.expected_steps):
        after = int(mdp.next_state[state, solution.policy.ravel()[state], 0])
        pushes += mdp.configuration(after) != mdp.configuration(state)
        state = after
    return Row(name, reached, mdp.num_states, solution.expected_steps, pushes, compiled, solved)


def main() -> None:
    """Measure, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--no-solve", action="store_true")
    options = parser.parse_args()
    print("| level | robot and boxes | states | moves | pushes | compile (s) | solve (s) |")
    print("|---|---|---|---|---|---|---|")
    rows = []
    for path in options.files:
        for name, drawn in list(maps(path))[: options.count]:
            fields = fields_of(drawn)
            row = measured(name, fields, solve=not options.no_solve)
            rows.append(row)
            told = [f"{row.reached:,}", f"{row.states:,}", f"{row.moves:g}", row.pushes]
            told += [f"{row.compiled:.2f}", f"{row.solved:.2f}"]
            shown = told if row.states else ["more than the bound", *[""] * 5]
            print(f"| {' | '.join(map(str, [name, *shown]))} |", flush=True)
            if options.check and row.moves and searched(fields) != row.moves:
                sys.exit(f"{name}: a plain search finds {searched(fields)} moves")
    fit = [row for row in rows if row.states]
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    print(f"\n{len(fit)} of {len(rows)} fit; at most {most:,.0f} MB", end="")
    if fit:
        rates = [row.reached / row.compiled for row in fit]
        print(f"; {statistics.median(rates):,.0f} states of robot and boxes a second of compiling")


if __name__ == "__main__":
    main()
