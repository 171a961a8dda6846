"""Baselines of language agents, which need no model: the tables of docs/agents.md.

python benchmarks/text_agents.py            # both suites, in some minutes
python benchmarks/text_agents.py text-easy  # one of them
python benchmarks/text_agents.py --speed    # moves graded and labels made a second
"""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import babyrobot_levels as brl

SUITES = ("text-easy", "text-hard")
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
        "random": brl.score("random", levels),
        "greedy": brl.score(greedy, levels, sight="map", episodes=EPISODES),
        "wall follower": brl.score(wall_follower(), levels, sight="words", episodes=EPISODES),
        "perfect, but deaf to skids": brl.score(calm, levels),
        "optimal": brl.score("best", levels),
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


def speed(levels: Sequence[brl.Level]) -> tuple[float, float]:
    """Return how many moves are graded, and how many actions of states are labelled, a second."""
    moves, begin = 0, time.perf_counter()
    for level in levels:
        world = brl.TextWorld(level, sight="words")
        for seed in range(20):
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


def main(words: Sequence[str]) -> None:
    for suite in [word for word in words if word in SUITES] or SUITES:
        if "--speed" in words:
            graded, labels = speed(list(brl.load_suite(suite).split("test")))
            print(f"{suite}: {graded:,.0f} moves graded a second, {labels:,.0f} labels a second")
        else:
            print(table(suite), end="\n\n")


if __name__ == "__main__":
    main(sys.argv[1:])
