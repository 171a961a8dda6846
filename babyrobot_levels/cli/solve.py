"""`babyrobot solve`: an optimal policy of a level, and its values."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import (
    FormatOption,
    ReportFormat,
    fact_lines,
    fail,
    note,
    speaks_unicode,
    wants_color,
    write,
    write_json,
)
from babyrobot_levels.cli.inputs import LevelArgument, load_level
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.cli.pictures import policy_text, solution_of, values_text
from babyrobot_levels.render.text import WIDEST

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level


def solve(
    level: LevelArgument,
    discount: Annotated[
        float | None,
        typer.Option(
            metavar="G",
            help="Discount factor, above 0 and at most 1.  [default: the level's]",
            show_default=False,
        ),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Solve a level exactly: the optimal expected return, an optimal policy, the state values.

    The drawing shows the policy: an arrow in each cell. `max_steps` is ignored: the values are
    those of episodes without a time limit.

    Examples:

      babyrobot solve final-maze

      babyrobot solve frozen-lake --discount 0.99 --format json
    """
    loaded = load_level(level)
    if discount is not None and not 0 < discount <= 1:
        fail(f"--discount must be above 0 and at most 1, not {discount:g}")
    if loaded.has_random_maze:
        fail(
            "the maze of this level is random",
            "choose one first: babyrobot resolve LEVEL --maze-seed 0 | babyrobot solve -",
        )
    with working("solving"):
        solution = solution_of(loaded, discount)
    if report_format is ReportFormat.JSON:
        write_json(_data(loaded, solution))
        return
    if solution.explanation:
        note(solution.explanation)
    plain = not (wants_color(sys.stdout) and speaks_unicode(sys.stdout))
    if loaded.max_steps is not None:
        note(f"max_steps ({loaded.max_steps}) is ignored: these are episodes without a time limit")
    write(_summary(loaded, solution) + "\n" + policy_text(loaded, solution, plain=plain))
    # Wider tables are for `--format json`.
    if loaded.size[0] <= WIDEST:
        write("\n" + values_text(loaded, solution))


def _data(level: Level, solution: Solution) -> dict[str, Any]:
    """Return the solution for JSON: null for cells without a value, strings for infinities."""
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
    facts = {
        "expected return": f"{solution.expected_return:.6g}",
        "expected steps": f"{solution.expected_steps:.6g}",
        "reaches an exit": f"{100 * solution.exit_probability:.4g} %",
        "discount": f"{solution.discount:g}",
        "method": f"{solution.method}, residual {solution.residual:.1g}",
    }
    if not level.exits:
        del facts["reaches an exit"]
    return fact_lines(facts)
