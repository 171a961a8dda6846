"""What can be known: the optimum of partial observation, in suites and in the gallery.

python benchmarks/sight.py --suites   # the tables of docs/benchmark.md and docs/agents.md: minutes
python benchmarks/sight.py --gallery  # the table of docs/partial-observation.md, 10 s a level
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Iterator, Sequence
from typing import Any

import babyrobot_levels as brl
from babyrobot_levels.extensions.sight import SightSolution, solve_sight

BENCH: tuple[dict[str, Any], ...] = (
    {"sight": "view"},
    {"sight": "view", "view_radius": 1},
    {"sight": "position"},
)
TEXT: tuple[dict[str, Any], ...] = (
    {"sight": "text-map"},
    {"sight": "text-view"},
    {"sight": "text-words"},
)
SUITES: dict[str, tuple[str, tuple[dict[str, Any], ...]]] = {
    **dict.fromkeys(("bench-easy", "bench-hard", "bench-keys"), ("moves", BENCH)),
    **dict.fromkeys(("text-easy", "text-hard"), ("all", TEXT)),
}
"""The actions and the sights of each suite."""

BELIEFS = 10_000
"""As many as `brl.score` explores for what can be known."""

SECONDS = 10.0
CLOSE = 0.05
"""Bounds that differ by no more than this share are close."""


def suite_table(names: Sequence[str]) -> Iterator[str]:
    """Yield the lines of what can be known in the test splits of suites, within their limits."""
    yield "| suite | sight | random | knowable | knowable in one of them | optimum | share |"
    yield "|---" * 7 + "|"
    for name in names:
        actions, sights = SUITES[name]
        levels = list(brl.load_suite(name).split("test"))
        chance = statistics.fmean(
            row.random for row in brl.score(levels, "random", actions=actions)
        )
        for sight in sights:
            how: dict[str, Any] = {"actions": actions, "within": "max_steps", "beliefs": BELIEFS}
            each = statistics.fmean(solve_sight(level, **sight, **how).upper for level in levels)
            told = (
                f"| `{name}` | `{', '.join(map(str, sight.values()))}` | {chance:.3f} | {each:.3f}"
            )
            try:
                one = solve_sight(levels, **sight, **how)
            except brl.EpisodeTooLongError:
                yield f"{told} | too many states | – | – |"
                continue
            share = (one.upper - chance) / (one.full - chance)
            yield f"{told} | {within(one)} | {one.full:.3f} | {share:.3f} |"


def within(found: SightSolution) -> str:
    """Return an optimum, or the bounds of one."""
    ends = dict.fromkeys(f"{bound:.3f}" for bound in (found.lower, found.upper))
    return " to ".join(ends)


def gallery_table(names: Sequence[str]) -> Iterator[str]:
    """Yield the lines of the gallery's levels in which a view costs something, and a summary."""
    yield "| level | bounds | full sight | gap | beliefs |"
    yield "|---" * 5 + "|"
    found = {}
    for name in names or [info.name for info in brl.levels()]:
        level = brl.load(name)
        if not level.has_random_maze:
            found[name] = solve_sight(level, "view", beliefs=10**9, seconds=SECONDS)
            if not found[name].is_exact or found[name].cost[0] > 1e-9:
                yield gallery_row(name, found[name])
    close = sum(each.gap <= CLOSE for each in found.values())
    exact = sum(each.is_exact for each in found.values())
    yield f"\n{len(found)} levels, {close} within {CLOSE:.0%}, of which {exact} are exact"


def gallery_row(name: str, found: SightSolution) -> str:
    """Return the row of a level."""
    bounds = f"{found.lower:.4g}" if found.is_exact else f"{found.lower:.4g} to {found.upper:.4g}"
    return f"| `{name}` | {bounds} | {found.full:.4g} | {found.gap:.1%} | {found.beliefs:,} |"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--suites", action="store_true", help="what can be known in suites")
    what.add_argument("--gallery", action="store_true", help="bounds in the gallery's levels")
    parser.add_argument("names", nargs="*", help="only these suites, or levels")
    args = parser.parse_args()
    lines = suite_table(args.names or [*SUITES]) if args.suites else gallery_table(args.names)
    for line in lines:
        print(line, flush=True)


if __name__ == "__main__":
    main()
