"""What makes levels hard: how metrics of 500 levels correlate, also with the regret of an agent.

    python benchmarks/hardness.py

prints the table of docs/mazes.md and writes docs/images/hardness.svg: Spearman's rank correlations.
The levels are mazes with keys, guards, wind, puddles and coins. The agent is tabular Q-learning
(four moves, epsilon 0.1, step size 0.1, values that begin at 0); all agents take their steps
together, from the exact tables. It measures no time.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import babyrobot_levels as brl

SUITE: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "count": 500,
    "seed": 1,
    "size": {"min": [4, 4], "max": [7, 7]},
    "maze": {"algorithm": ["depth-first", "wilson", "prim"], "loops": {"max": 1}},
    "start": "random",
    "exit": "random",
    "keys": {"max": 2},
    "guards": {"max": 1},
    "wind": {"max": 2},
    "puddles": {"max": 4},
    "coins": {"max": 2},
}
NAMES = (
    *("states", "path_length", "dead_ends", "detour", "difficulty"),
    *("irreversible", "decisions", "fragility", "dependencies", "distractors"),
)
RUNS, STEPS, LIMIT = 4, 20_000, 200
"""Agents of each level, steps of each, and after how many an episode is cut off."""

STEP_SIZE, EPSILON = 0.1, 0.1

Floats = NDArray[np.float64]

FIGURE = Path(__file__).parents[1] / "docs" / "images" / "hardness.svg"


def mean_returns(levels: Sequence[brl.Level]) -> Floats:
    """Return the mean return of the episodes of an agent that learns, in each level."""
    tables = [level.compile() for level in levels]
    first = np.cumsum([0, *(mdp.num_states for mdp in tables)])
    width = max(mdp.probability.shape[2] for mdp in tables)

    def joined(name: str) -> Any:
        """Return a table of all levels' states and moves, with rows of one width."""
        parts = (getattr(mdp, name)[:, 1:] for mdp in tables)
        return np.concatenate(
            [np.pad(part, [(0, 0), (0, 0), (0, width - part.shape[2])]) for part in parts]
        )

    cumulated = np.cumsum(joined("probability"), axis=2)
    reward, over = joined("reward"), joined("terminal")
    following = joined("next_state") + np.repeat(first[:-1], np.diff(first))[:, None, None]
    level = np.tile(np.arange(len(levels)), RUNS)
    agent = np.arange(level.size)
    rng = np.random.default_rng(0)
    starts = [begin + np.flatnonzero(mdp.start) for begin, mdp in zip(first, tables, strict=False)]

    def begun(agents: NDArray[np.intp]) -> list[int]:
        return [int(rng.choice(starts[level[each]])) for each in agents]

    values = np.zeros((RUNS, int(first[-1]), 4))
    run, state = agent // len(levels), np.array(begun(agent))
    total, taken = np.zeros(agent.size), np.zeros(agent.size, int)
    returns, episodes = np.zeros(agent.size), np.zeros(agent.size, int)
    for _ in range(STEPS):
        # Ties are broken at random.
        best = (values[run, state] + 1e-9 * rng.random((agent.size, 4))).argmax(axis=1)
        explores = rng.random(agent.size) < EPSILON
        action = np.where(explores, rng.integers(4, size=agent.size), best)
        chance = rng.random(agent.size)[:, None] * (1 - 1e-12)
        outcome = (chance >= cumulated[state, action]).sum(axis=1).clip(max=width - 1)
        at = state, action, outcome
        ends = over[at]
        target = reward[at] + np.where(ends, 0.0, values[run, following[at]].max(axis=1))
        values[run, state, action] += STEP_SIZE * (target - values[run, state, action])
        total += reward[at]
        taken += 1
        state = following[at]
        done = np.flatnonzero(ends | (taken == LIMIT))
        returns[done] += total[done]
        episodes[done] += 1
        total[done], taken[done], state[done] = 0.0, 0, begun(done)
    means: Floats = (returns / episodes).reshape(RUNS, -1).mean(axis=0)
    return means


def ranks(values: Floats) -> Floats:
    """Return the rank of each value, the mean one where values are equal."""
    _, which, count = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(count)
    means: Floats = (last - (count - 1) / 2)[which]
    return means


def measured() -> Floats:
    """Return all metrics and the regret, `[metrics, levels]`."""
    levels = list(brl.load_suite(SUITE))
    found = [brl.metrics(level) for level in levels]
    rows = [[float(getattr(each, name)) for each in found] for name in NAMES]
    best = np.array([each.best_return for each in found], float)
    return np.array([*rows, best - mean_returns(levels)])


# -- the figure --------------------------------------------------------------------------------

CELL, LABELS, HEADING, GAP = 46, 130, 28, 8
"""The size of a cell, the room of names beside and above, and that between metrics and regret."""

LOW, MIDDLE, HIGH = (178, 84, 32), (247, 245, 240), (32, 98, 160)


def color(value: float) -> str:
    """Return the colour of a correlation."""
    end = HIGH if value > 0 else LOW
    mixed = (round(m + abs(value) * (e - m)) for m, e in zip(MIDDLE, end, strict=True))
    return "#" + "".join(f"{each:02x}" for each in mixed)


def figure(table: Floats, names: Sequence[str]) -> str:
    """Return a picture of correlations: each pair once, those with the regret below the others."""
    count = len(names)
    width, height = LABELS + CELL * count + 50, HEADING + CELL * (count - 1) + GAP + 8
    shapes = [_text(LABELS + 8, HEADING - 8, names[0], 'fill="#6b7280"')]
    for row in range(1, count):
        is_regret = row == count - 1
        top = HEADING + CELL * (row - 1) + GAP * is_regret
        middle = top + CELL / 2 + 4.5
        weight = ' font-weight="600"' * is_regret
        shapes.append(_text(LABELS - 10, middle, names[row], f'text-anchor="end"{weight}'))
        for column in range(row):
            value, left = round(float(table[row, column]), 2) + 0.0, LABELS + CELL * column
            shapes.append(
                f'<rect x="{left + 1}" y="{top + 1}" width="{CELL - 2}" height="{CELL - 2}" '
                f'rx="4" fill="{color(value)}"/>'
            )
            ink = "#ffffff" if abs(value) > 0.75 else "#1f2937"
            text = f"{value:.2f}".replace("-", "\N{MINUS SIGN}")
            style = f'text-anchor="middle" fill="{ink}"'
            shapes.append(_text(left + CELL / 2, middle, text, style))
        if row < count - 1:
            # Above the first cell of its column.
            shapes.append(_text(LABELS + CELL * row + 8, middle, names[row], 'fill="#6b7280"'))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'width="{width}" height="{height}" font-family="sans-serif" font-size="13" '
        'fill="#1f2937"><title>Rank correlations of metrics and regret</title>'
        f'<rect width="100%" height="100%" fill="#ffffff"/>{"".join(shapes)}</svg>\n'
    )


def _text(x: float, y: float, text: str, style: str) -> str:
    return f'<text x="{x}" y="{y}" {style}>{text}</text>'


def main() -> None:
    """Measure, print the table, and write the figure."""
    rows = measured()
    table = np.corrcoef([ranks(row) for row in rows])
    print("| with regret | metric | median | range |\n|---:|---|---:|---:|")
    for number in np.argsort(-table[-1, :-1]).tolist():
        low, middle, high = np.quantile(rows[number], [0, 0.5, 1], method="nearest")
        told = f"{NAMES[number]} | {middle:.3g} | {low:.3g} to {high:.3g}"
        print(f"| {table[-1, number]:.2f} | {told} |")
    FIGURE.write_text(figure(table, [*NAMES, "regret"]), "utf-8")


if __name__ == "__main__":
    main()
