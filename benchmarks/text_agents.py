"""Baselines of language agents, which need no model: the tables of docs/agents.md.

python benchmarks/text_agents.py            # both suites, in some minutes
python benchmarks/text_agents.py text-easy  # one of them
python benchmarks/text_agents.py --speed    # moves graded and labels made a second, best of 3
python benchmarks/text_agents.py --figure   # writes docs/images/regret.svg, in a minute
"""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import babyrobot_levels as brl

SUITES = ("text-easy", "text-hard")
SIGHTS = ("map", "view", "words")
SIDES = ("north", "east", "south", "west")
EPISODES = 5

COLUMNS = ("share", "worst tenth", "regret", "share, 95 %", "success", "moves")


def greedy(text: str) -> str:
    """Go towards the exit where no wall is in the way, else wait."""
    *_, walls = re.findall(r"The robot is at .*", text)
    *_, way = re.findall(r"exit is (.*)", text)
    ways = re.findall(r"north|east|south|west", way)
    return next((way for way in ways if way not in walls), "wait")


def wall_follower() -> Callable[[str], str]:
    """Return an agent that keeps a wall on its right: it turns right where it can."""
    heading = 0

    def agent(text: str) -> str:
        nonlocal heading
        if not re.search(r"^.*Step \d+ of", text, re.MULTILINE):
            heading = 0
        open_sides = {
            side for side in SIDES if not re.search(rf"^{side}: a (wall|closed door)", text, re.M)
        }
        for turn in (1, 0, 3, 2):
            if SIDES[(heading + turn) % 4] in open_sides:
                heading = (heading + turn) % 4
                return SIDES[heading]
        return "wait"

    return agent


def deaf_to_skids(level: brl.Level) -> Any:
    """Return a policy that is optimal if nothing skids, `[configurations * cells]` reshaped."""
    calm = level.replace(
        skid=None,
        puddle_types={size: {"skid": 0} for size in ("small", "large")},
        areas=[area.model_copy(update={"skid": None}) for area in level.areas],
    )
    best = np.asarray(brl.solve(calm).policy)
    known, own = calm.compile(), level.compile()
    if not level.has_things:
        return best
    number = {tuple(row): at for at, row in enumerate(known.configurations.tolist())}
    policy = np.zeros(own.shape, np.int64)
    for at, row in enumerate(own.configurations.tolist()):
        if tuple(row) in number:
            policy[at] = np.maximum(best[number[tuple(row)]], 0)
    return policy


def scored(levels: Sequence[brl.Level]) -> dict[str, brl.Scores]:
    """Return the scores of all baselines; those that are played read and write."""
    calm = {level.digest: deaf_to_skids(level) for level in levels}
    return {
        "random": brl.score(levels, "random"),
        "greedy": brl.score(levels, greedy, sight="map", episodes=EPISODES),
        "wall follower": brl.score(levels, wall_follower(), sight="words", episodes=EPISODES),
        "perfect, but deaf to skids": brl.score(levels, calm),
        "optimal": brl.score(levels, "best"),
    }


def row(name: str, scores: brl.Scores) -> str:
    """Return the row of an agent in the table."""
    summary = scores.summary
    steps = sum(score.steps for score in scores) / len(scores)
    interval = "exact"
    if not scores.is_exact:
        interval = f"{summary.low:.2f} to {summary.high:.2f}"
    cells = (
        f"{summary.mean:.2f}", f"{summary.worst_tenth:.2f}", f"{summary.regret:.1f}",
        interval, f"{summary.success:.2f}", f"{steps:.1f}",
    )  # fmt: skip
    return f"| {name} | {' | '.join(cells)} |"


def table(suite: str, levels: Sequence[brl.Level] | None = None) -> str:
    """Return the table of a suite."""
    found = levels or list(brl.load_suite(suite).split("test"))
    rows = [row(name, scores) for name, scores in scored(found).items()]
    head = f"| `{suite}` | {' | '.join(COLUMNS)} |"
    return "\n".join([head, "|---" * (len(COLUMNS) + 1) + "|", *rows])


def speed(levels: Sequence[brl.Level], sight: str = "words") -> tuple[float, float]:
    """Return how many moves are graded, and how many actions of states are labelled, a second."""
    moves, begin = 0, time.perf_counter()
    for level in levels:
        world = brl.TextWorld(level, sight=sight)
        for seed in range(5):
            world.reset(seed=seed)
            while not world.done:
                world.move(SIDES[(len(world.moves) * 7 + seed) % 4])
            moves += len(world.moves)
    graded = moves / (time.perf_counter() - begin)
    labels, begin = 0, time.perf_counter()
    for level in levels:
        solution = brl.solve(level)
        advantages = solution.action_values - solution.values[..., None]
        labels += int(np.isfinite(advantages).sum())
    return graded, labels / (time.perf_counter() - begin)


# -- the figure --------------------------------------------------------------------------------

FIGURE = Path(__file__).parents[1] / "docs" / "images" / "regret.svg"
LEVEL, PLAYED = "final-maze", 2_000
COLORS = ("#b25420", "#6d4aa8", "#2062a0")
WIDTH, HEIGHT, LEFT, TOP = 420, 320, 46, 46
"""The size of the axes, and the room beside and above them."""

LOW, HIGH = -6.0, 16.0
"""The range of the vertical axis."""

Floats = NDArray[np.float64]


def policies(level: brl.Level) -> dict[str, Floats]:
    """Return agents as probabilities of actions, `[configurations * cells, actions]`."""
    best = np.eye(5)[np.asarray(brl.solve(level).policy).ravel().clip(0)]
    deaf = np.eye(5)[np.asarray(deaf_to_skids(level)).ravel().clip(0)]
    return {"every fifth move is random": 0.8 * best + 0.04, "deaf to skids": deaf, "optimal": best}


def lost(level: brl.Level, policy: Floats, count: int) -> tuple[Floats, Floats]:
    """Return the regret of each episode, and what its return lacks of the optimum."""
    world, rng = brl.TextWorld(level, sight="words"), np.random.default_rng(0)
    found = np.zeros((2, count))
    for seed in range(count):
        world.reset(seed=seed)
        while not world.done:
            side = ("wait", *SIDES)[rng.choice(5, p=policy[world.state])]
            _ = world.wait() if side == "wait" else world.move(side)
        found[:, seed] = world.regret, world.optimum - world.return_
    return found[0], found[1]


def figure(count: int = PLAYED) -> str:
    """Return a picture: the means of regrets and of returns, and the exact values they go to."""
    level, numbers = brl.load(LEVEL), np.arange(1, count + 1)
    kept = np.unique(np.geomspace(1, count, 300).astype(int)) - 1
    right, bottom = LEFT + WIDTH, TOP + HEIGHT
    shapes = [
        _text(LEFT, 18, f"Means over the first episodes in {LEVEL}", 'font-weight="600"'),
        _text(LEFT, 36, "thick: the regret; thin: the optimum less the return", MUTED),
    ]
    for value in range(-5, 16, 5):
        shapes.append(_text(LEFT - 8, _down(value) + 4, f"{value}", f'{MUTED} text-anchor="end"'))
        shapes.append(_line(LEFT, _down(value), right, _down(value), "#e5e7eb"))
    for power in range(int(np.log10(count)) + 1):
        across = _across(10**power, count)
        shapes.append(_text(across, bottom + 18, f"{10**power:,}", f'{MUTED} text-anchor="middle"'))
    for (name, policy), color in zip(policies(level).items(), COLORS, strict=True):
        (score,) = brl.score(level, policy.reshape(*level.compile().shape, 5))
        for each, style in zip(lost(level, policy, count), (2.4, 0.8), strict=True):
            means = np.cumsum(each) / numbers
            points = " ".join(
                f"{_across(at + 1, count):.1f},{_down(means[at]):.1f}" for at in kept.tolist()
            )
            shapes.append(
                f'<polyline points="{points}" fill="none" stroke="{color}" '
                f'stroke-width="{style}" clip-path="url(#axes)"/>'
            )
        exact = _down(score.regret)
        shapes.append(_line(LEFT, exact, right, exact, color, 'stroke-dasharray="2 4"'))
        label = f"{score.regret:.2f}  {name}"
        shapes.append(_text(right + 8, exact + 4, label, f'fill="{color}" xml:space="preserve"'))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {right + 220} {bottom + 30}" '
        f'width="{right + 220}" height="{bottom + 30}" font-family="sans-serif" font-size="13" '
        'fill="#1f2937"><title>Mean regrets come to the exact ones</title>'
        '<rect width="100%" height="100%" fill="#ffffff"/><clipPath id="axes">'
        f'<rect x="{LEFT}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}"/></clipPath>'
        f"{''.join(shapes)}</svg>\n"
    )


MUTED = 'fill="#6b7280"'


def _across(number: int, count: int) -> float:
    return LEFT + WIDTH * float(np.log(number) / np.log(count))


def _down(value: float) -> float:
    return TOP + HEIGHT * (HIGH - value) / (HIGH - LOW)


def _text(x: float, y: float, text: str, style: str) -> str:
    told = text.replace("-", "\N{MINUS SIGN}")
    return f'<text x="{x:.1f}" y="{y:.1f}" {style}>{told}</text>'


def _line(x: float, y: float, to_x: float, to_y: float, color: str, style: str = "") -> str:
    ends = f'x1="{x:.1f}" y1="{y:.1f}" x2="{to_x:.1f}" y2="{to_y:.1f}"'
    return f'<line {ends} stroke="{color}" {style}/>'


def main(words: Sequence[str]) -> None:
    if "--figure" in words:
        FIGURE.write_text(figure(), "utf-8")
        return
    for suite in [word for word in words if word in SUITES] or SUITES:
        if "--speed" in words:
            levels = list(brl.load_suite(suite).split("test")[:20])
            rounds = [speed(levels, sight) for sight in SIGHTS for _ in range(3)]
            for number, sight in enumerate(SIGHTS):
                graded = max(moves for moves, _ in rounds[3 * number : 3 * number + 3])
                print(f"{suite}, {sight}: {graded:,.0f} moves graded and told a second")
            print(f"{suite}: {max(labels for _, labels in rounds):,.0f} labels a second")
        else:
            print(table(suite), end="\n\n")


if __name__ == "__main__":
    main(sys.argv[1:])
