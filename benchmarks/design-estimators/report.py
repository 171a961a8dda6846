"""Tables and charts of results.

python benchmarks/design-estimators/report.py FOLDER --images docs/images
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

from scipy.stats import t

from babyrobot_levels.extensions.learning.charts import Bar, Curve, bars_scene, curves_svg
from babyrobot_levels.render.svg import to_svg

FAMILIES = {"walls": "walls", "stochastic": "puddles and wind", "keys": "keys and doors"}
ESTIMATES = {
    "pvl": "positive value loss",
    "maxmc": "MaxMC",
    "learnability": "learnability p(1-p)",
    "mna": "MNA",
    "failures": "share of failures",
    "exact-learnability": "p(1-p), exact p",
    "optimum-less-returns": "optimum less returns",
}
BARS = {
    "pvl": "PVL",
    "maxmc": "MaxMC",
    "mna": "MNA",
    "learnability": "p(1-p)",
    "exact-learnability": "exact p",
    "failures": "failures",
}
COLORS = {"pvl": "#6a4c9c", "maxmc": "#2f7d3a", "mna": "#0b4f8a", "learnability": "#8f2f2f"}
TIMES = {
    "network": "asking the network about all states",
    "regret": "exact regret, given its answers and the optimum",
    "optimum": "optimum, once",
    "rollouts": "playing with the network",
    "estimates": "playing by its answers, and estimates",
}
METHODS = {"dr": "domain randomisation", "plr": "PLR", "accel": "ACCEL"}
SCORES = {"regret": "exact regret", "maxmc": "MaxMC", "learnability": "p(1-p)"}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where the results are")
    parser.add_argument("--images", type=Path, help="where charts are written")
    options = parser.parse_args()
    results = {path.stem: json.loads(path.read_text()) for path in options.folder.glob("*.json")}
    families = results.get("estimates", {})
    print_estimates(families)
    print_times(results.get("times", {}))
    print_curricula(results.get("curricula", {}))
    if options.images is not None:
        write_charts(options.images, families)


def interval(values: Sequence[float]) -> tuple[float, float]:
    """Return the mean and half the width of its 95 % confidence interval, by Student's t."""
    if len(values) < 2:
        return fmean(values), 0.0
    width = t.ppf(0.975, len(values) - 1) * stdev(values) / len(values) ** 0.5
    return fmean(values), float(width)


def told(values: Sequence[float], digits: int = 2) -> str:
    middle, width = interval(values)
    # Without spaces, at which narrow tables would break.
    return f"{middle:.{digits}f}±{width:.{digits}f}"


def row(cells: Iterable[Any]) -> None:
    print(f"| {' | '.join(map(str, cells))} |")


def head(cells: Sequence[str]) -> None:
    print()
    row(cells)
    print(f"|{'---|' * len(cells)}")


def in_training(result: dict[str, Any], measure: str, name: str, number: int) -> list[float]:
    """Return the mean over the stages after the first update, of each seed."""
    stages = result["stages"][1:]
    return [fmean(each) for each in zip(*(s[measure][name][number] for s in stages), strict=True)]


def print_estimates(families: dict[str, Any]) -> None:
    head(["share, success", *(FAMILIES[family] for family in families)])
    for stages in zip(*(result["stages"][::2] for result in families.values()), strict=False):
        cells = [f"{told(stage['share'])}, {told(stage['success'])}" for stage in stages]
        row([f"{stages[0]['steps']:,} steps", *cells])
    for family, result in families.items():
        stages, counts = result["stages"], result["episodes"]
        middle = len(counts) // 2
        points = [stages[0], stages[len(stages) // 3], stages[-1]]
        head([
            FAMILIES[family], *(f"{stage['steps']:,} steps" for stage in points),
            *(f"{count} episode{'s' * (count > 1)}" for count in counts),
            "top tenth",
        ])  # fmt: skip
        for name, title in ESTIMATES.items():
            row([
                title,
                *(told(stage["correlation"][name][middle]) for stage in points),
                *(told(in_training(result, "correlation", name, number))
                  for number in range(len(counts))),
                told(in_training(result, "overlap", name, middle)),
            ])  # fmt: skip


def print_times(times: dict[str, Any]) -> None:
    head(["microseconds a level", *(FAMILIES[family] for family in times)])
    of_each = [result["microseconds"] for result in times.values()]
    for name in of_each[0] if of_each else ():
        kind, _, count = name.partition("-")
        many = f", {count} episode{'s' * (count != '1')}" if count else ""
        row([TIMES[kind] + many, *(f"{each[name]:.1f}" for each in of_each)])


def print_curricula(curricula: dict[str, Any]) -> None:
    """Print what policies are worth at the end; the same seed has the same network at first."""
    head(["levels by", "mazes: share", "difference", "regret", "new levels: share", "difference",
          "regret", "walls"])  # fmt: skip
    last = {name: each["stages"][-1] for name, each in curricula.items()}
    random = last.get("dr regret")
    for name, stage in sorted(last.items(), key=lambda each: -fmean(each[1]["new"]["share"])):
        method, score = name.split()
        cells = [METHODS[method] + (f", {SCORES[score]}" if method != "dr" else "")]
        for test in ("mazes", "new"):
            share = stage[test]["share"]
            paired = "-"
            if random not in (None, stage):
                others = random[test]["share"]
                paired = told([one - other for one, other in zip(share, others, strict=True)], 3)
            cells += [told(share, 3), paired, told(stage[test]["regret"], 1)]
        row([*cells, told(stage["walls"], 1)])


def write_charts(folder: Path, families: dict[str, Any]) -> None:
    bars = []
    for name, title in BARS.items():
        for family, result in families.items():
            middle = len(result["episodes"]) // 2
            mean, width = interval(in_training(result, "correlation", name, middle))
            bars.append(Bar(f"{title}, {family}", mean, mean - width, mean + width))
    if bars:
        scene = bars_scene(bars, title="Rank correlation with exact regret, in training",
                           zero="none", one="the same order")  # fmt: skip
        (folder / "estimates.svg").write_text(to_svg(scene), encoding="utf-8")
    for family, result in families.items():
        middle = len(result["episodes"]) // 2
        curves = [
            Curve(BARS[name], [(stage["steps"] / 1e6, fmean(stage["correlation"][name][middle]))
                               for stage in result["stages"]], color)
            for name, color in COLORS.items()
        ]  # fmt: skip
        # The range of the chart is that of the last curve: the one that goes lowest.
        curves.sort(key=lambda curve: -min(y for _, y in curve.points))
        x_title = f"million steps, {FAMILIES[family]}"
        text = curves_svg(curves, goal=("regret", 1.0), x_title=x_title, y_title="rank correlation")
        (folder / f"estimates-{family}.svg").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
