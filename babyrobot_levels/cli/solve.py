"""`babyrobot solve`: the answer key of a level."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import (
    FormatOption,
    ReportFormat,
    fail,
    speaks_unicode,
    wants_color,
    write,
    write_json,
)
from babyrobot_levels.cli.inputs import LevelArgument, load_level
from babyrobot_levels.cli.pictures import policy_text, solution_of, values_text
from babyrobot_levels.render.numbers import WIDEST

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level


def solve(
    level: LevelArgument,
    discount: Annotated[
        float | None,
        typer.Option(
            metavar="G",
            help="How much each further reward counts.  [default: the level's]",
            show_default=False,
        ),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Solve a level exactly: the best expected return, a policy that earns it, the values.

    The drawing shows one optimal policy: where the best action leads from each cell.

    Examples:

      babyrobot solve final-maze

      babyrobot solve frozen-lake --discount 0.99 --format json
    """
    loaded = load_level(level)
    if discount is not None and not 0 < discount <= 1:
        fail(f"a discount is above 0 and at most 1, not {discount:g}")
    if loaded.has_random_maze:
        fail("each reset grows another maze of this level", "solve one that says its seed")
    solution = solution_of(loaded, discount)
    if report_format is ReportFormat.JSON:
        write_json(_data(loaded, solution))
        return
    plain = not (wants_color(sys.stdout) and speaks_unicode(sys.stdout))
    write(_summary(loaded, solution) + "\n" + policy_text(loaded, solution, plain=plain))
    # Wider ones are left to `--format json`.
    if loaded.size[0] <= WIDEST:
        write("\n" + values_text(solution))


def _data(level: Level, solution: Solution) -> dict[str, Any]:
    """Return the solution as JSON can hold it: null for cells without a value, texts for inf."""
    return {
        "name": level.name,
        "digest": level.digest,
        "discount": solution.discount,
        "expected_return": _number(solution.expected_return),
        "expected_steps": _number(solution.expected_steps),
        "exit_probability": _number(solution.exit_probability),
        "method": solution.method,
        "iterations": solution.iterations,
        "residual": _number(solution.residual),
        "actions": ["stay", "north", "east", "south", "west"][solution.first_action :],
        "values": _nested(solution.values.tolist()),
        "action_values": _nested(solution.action_values.tolist()),
        "policy": solution.policy.tolist(),
        "greedy": solution.greedy.tolist(),
    }


def _nested(values: Any) -> Any:
    return [_nested(value) for value in values] if isinstance(values, list) else _number(values)


def _number(value: float) -> float | str | None:
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else "inf" if value > 0 else "-inf"


def _summary(level: Level, solution: Solution) -> str:
    told = {
        "expected return": f"{solution.expected_return:.6g}",
        "expected steps": f"{solution.expected_steps:.6g}",
        "reaches an exit": f"{100 * solution.exit_probability:.4g} %",
        "discount": f"{solution.discount:g}",
        "method": f"{solution.method}, residual {solution.residual:.1g}",
    }
    if not level.exits:
        del told["reaches an exit"]
    width = max(map(len, told))
    bold = wants_color(sys.stdout)
    lines = []
    for name, value in told.items():
        label = f"{name}:".ljust(width + 1)
        lines.append((f"\x1b[1m{label}\x1b[0m" if bold else label) + f" {value}\n")
    return "".join(lines)
