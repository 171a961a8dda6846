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

from babyrobot_levels.render.charts import Bar, Curve, bars_scene, curves_svg
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
CURVES = {"mna": "MNA", "learnability": "p(1-p)", "maxmc": "MaxMC", "pvl": "PVL"}
COLORS = ("#0b4f8a", "#8f2f2f", "#2f7d3a", "#6a4c9c")
METHODS = {"dr": "domain randomisation", "plr": "PLR", "accel": "ACCEL"}
SCORES = {"regret": "exact regret", "maxmc": "MaxMC", "learnability": "p(1-p)"}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where the results are")
    parser.add_argument("--images", type=Path, help="where charts are written")
    options = parser.parse_args()
    results = {path.stem: json.loads(path.read_text()) for path in options.folder.glob("*.json")}
    families, curricula = results.get("estimates", {}), results.get("curricula", {})
    print_estimates(families)
    print_times(results.get("times", {}))
    print_curricula(curricula)
    if options.images is not None:
        write_charts(options.images, families, curricula)


def interval(values: Sequence[float]) -> tuple[float, float]:
    """Return the mean and half the width of its 95 % confidence interval, by Student's t."""
    if len(values) < 2:
        return fmean(values), 0.0
    width = t.ppf(0.975, len(values) - 1) * stdev(values) / len(values) ** 0.5
    return fmean(values), float(width)


def told(values: Sequence[float], digits: int = 2) -> str:
    middle, width = interval(values)
    return f"{middle:.{digits}f} ± {width:.{digits}f}"


def row(cells: Iterable[Any]) -> None:
    print(f"| {' | '.join(map(str, cells))} |")


def head(cells: Sequence[str]) -> None:
    row(cells)
    row(["---"] * len(cells))


def in_training(result: dict[str, Any], measure: str, name: str, number: int) -> list[float]:
    """Return the mean over the stages after the first update, of each seed."""
    stages = result["stages"][1:]
    return [fmean(each) for each in zip(*(s[measure][name][number] for s in stages), strict=True)]


def print_estimates(families: dict[str, Any]) -> None:
    for family, result in families.items():
        stages, counts = result["stages"], result["episodes"]
        middle = len(counts) // 2
        points = [0, len(stages) // 3, len(stages) - 1]
        print(f"\n{FAMILIES[family]}: {result['levels']} levels, {result['seeds']} seeds, "
              f"{result['device']}, JAX {result['jax']}, {result['seconds']:.0f} s\n")  # fmt: skip
        head(["steps", "share", "regret", "success"])
        for stage in stages:
            row([f"{stage['steps']:,}", told(stage["share"]), told(stage["regret"], 3),
                 told(stage["success"])])  # fmt: skip
        print()
        head([
            "estimate", *(f"{stages[point]['steps']:,} steps" for point in points),
            f"in training, {counts[middle]} episodes",
            *(f"{count} episodes" for number, count in enumerate(counts) if number != middle),
            "top tenth",
        ])  # fmt: skip
        for name, title in ESTIMATES.items():
            others = [told(in_training(result, "correlation", name, number))
                      for number in range(len(counts)) if number != middle]  # fmt: skip
            row(
                [
                    title,
                    *(told(stages[point]["correlation"][name][middle]) for point in points),
                    told(in_training(result, "correlation", name, middle)),
                    *others,
                    told(in_training(result, "overlap", name, middle)),
                ]
            )


def print_times(times: dict[str, Any]) -> None:
    for family, result in times.items():
        print(f"\n{FAMILIES[family]}: microseconds a level, {result['levels']} at once, "
              f"{result['device']}\n")  # fmt: skip
        head(["of a level", "microseconds"])
        for name, microseconds in result["microseconds"].items():
            row([name, f"{microseconds:.2f}"])


def print_curricula(curricula: dict[str, Any]) -> None:
    print()
    head(["levels by", "steps", "share in mazes", "regret", "share in new levels", "regret",
          "walls", "seconds"])  # fmt: skip
    for name, each in curricula.items():
        method, score = name.split()
        last = each["stages"][-1]
        row([
            METHODS[method] + (f", {SCORES[score]}" if method != "dr" else ""),
            f"{last['steps']:,}",
            *(told(last[test][name], digits) for test in ("mazes", "new")
              for name, digits in (("share", 3), ("regret", 2))),
            told(last["walls"], 1), f"{each['seconds']:.0f}",
        ])  # fmt: skip


def write_charts(folder: Path, families: dict[str, Any], curricula: dict[str, Any]) -> None:
    bars = []
    for name, title in ESTIMATES.items():
        for family, result in families.items():
            middle = len(result["episodes"]) // 2
            mean, width = interval(in_training(result, "correlation", name, middle))
            bars.append(
                Bar(f"{CURVES.get(name, title)}, {family}", mean, mean - width, mean + width)
            )
    if bars:
        scene = bars_scene(bars, title="Rank correlation with exact regret, in training",
                           zero="none", one="the same order")  # fmt: skip
        (folder / "estimates.svg").write_text(to_svg(scene), encoding="utf-8")
    for family, result in families.items():
        middle = len(result["episodes"]) // 2
        curves = [
            Curve(title, [(stage["steps"], fmean(stage["correlation"][name][middle]))
                          for stage in result["stages"]], color)
            for (name, title), color in zip(CURVES.items(), COLORS, strict=True)
        ]  # fmt: skip
        # The range of the chart is that of the last curve: the one that goes lowest.
        curves.sort(key=lambda curve: -min(y for _, y in curve.points))
        text = curves_svg(curves, goal=("regret", 1.0), x_title="steps",
                          y_title="rank correlation")  # fmt: skip
        (folder / f"estimates-{family}.svg").write_text(text, encoding="utf-8")
    shown = {"dr regret": "random", "plr regret": "PLR", "accel regret": "ACCEL"}
    curves = [
        Curve(title, [(stage["steps"], fmean(stage["mazes"]["regret"]))
                      for stage in curricula[name]["stages"]], color)
        for (name, title), color in zip(shown.items(), COLORS, strict=False) if name in curricula
    ]  # fmt: skip
    curves.sort(key=lambda curve: max(y for _, y in curve.points))
    text = curves_svg(curves, goal=("optimum", 0.0), x_title="steps learned from",
                      y_title="regret in mazes")  # fmt: skip
    if text:
        (folder / "curricula.svg").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
