"""`babyrobot solve`: an optimal policy of a level, and its values."""

from __future__ import annotations

import math
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import (
    FormatOption,
    ReportFormat,
    fact_lines,
    fail,
    note,
    write,
    write_json,
)
from babyrobot_levels.cli.inputs import LevelArgument, configuration_of, load_level
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.cli.pictures import (
    shown_configuration,
    solution_of,
)
from babyrobot_levels.cli.texts import solution_text, values_text
from babyrobot_levels.language.base import SIDES
from babyrobot_levels.render.text import WIDEST

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.mdp.configurations import Things


class ActionSet(StrEnum):
    """The sets of actions that a robot may have."""

    ALL = "all"
    MOVES = "moves"
    TURNS = "turns"


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
    actions: Annotated[
        ActionSet,
        typer.Option(
            help="The actions of the robot: stay and the four moves; the moves; or turn left, turn "
            "right and forward."
        ),
    ] = ActionSet.ALL,
    held: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Show policy and values while exactly these items are held and switches on, "
            "separated by commas; `nothing` for none.  [default: where episodes begin]",
            show_default=False,
        ),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Solve a level exactly: the optimal expected return, an optimal policy, the state values.

    The drawing shows the policy: an arrow in each cell. `max_steps` is ignored: the values are
    those of episodes without a time limit; where a limit makes a difference, a note says so. For a
    robot that turns, policy and values are those of the heading at the start: L left, R right, F
    forward. JSON has all headings, and all configurations of items, switches and movers.

    Examples:

      babyrobot solve final-maze

      babyrobot solve first-key --held key

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
    configuration = None if held is None else configuration_of(loaded, held)
    with working("solving"):
        solution = solution_of(loaded, discount, actions)
    if report_format is ReportFormat.JSON:
        if held is not None:
            note("--held has no effect on JSON, which has all configurations")
        write_json(_data(loaded, solution))
        return
    if solution.explanation:
        note(solution.explanation)
    _note_limit(loaded, solution)
    shown = shown_configuration(loaded, configuration)
    write(_summary(loaded, solution, shown) + "\n")
    if actions is ActionSet.TURNS:
        write(_turns(loaded, solution, shown))
    else:
        write(solution_text(loaded, solution, values=True, policy=True, configuration=shown))


def _note_limit(level: Level, solution: Solution) -> None:
    """Say that the level has a time limit, if that changes what an optimal policy earns."""
    from babyrobot_levels.analysis.solver.horizon import MAX_STATE_STEPS, best_return_within

    steps = level.max_steps
    if steps is None:
        return
    ignored = f"max_steps ({steps}) is ignored: these are episodes without a time limit"
    if solution.values.size * steps > MAX_STATE_STEPS:
        note(ignored)
        return
    within = best_return_within(level, steps, actions=solution.actions, discount=solution.discount)
    if not math.isclose(within, solution.expected_return, rel_tol=1e-6, abs_tol=1e-6):
        note(f"{ignored}; within it, the best expected return is {within:.4g}")


def _turns(level: Level, solution: Solution, configuration: int | None) -> str:
    """Return letters and values of a robot that looks as at the start."""
    part = solution.at(configuration or 0, level.heading)
    rows = part.policy.tolist()
    text = "".join(" ".join(".LRF"[action + 1] for action in row) + "\n" for row in rows)
    # Wider tables are for `--format json`.
    return text + ("\n" + values_text(part, None) if level.size[0] <= WIDEST else "")


def _data(level: Level, solution: Solution) -> dict[str, Any]:
    """Return the solution for JSON: null for cells without a value, strings for infinities."""
    from babyrobot_levels.analysis.solver.results import action_names

    data = {
        "name": level.name,
        "digest": level.digest,
        "discount": solution.discount,
        "expected_return": _number(solution.expected_return),
        "expected_steps": _number(solution.expected_steps),
        "exit_probability": _number(solution.exit_probability),
        "method": solution.method,
        "iterations": solution.iterations,
        "residual": _number(solution.residual),
        "actions": action_names(solution.actions)[solution.first_action :],
        "values": _nested(solution.values.tolist()),
        "action_values": _nested(solution.action_values.tolist()),
        "policy": solution.policy.tolist(),
        "greedy": solution.greedy.tolist(),
    }
    if solution.actions == ActionSet.TURNS:
        data["headings"] = list(SIDES)
    if level.has_things:
        things, rows = level.things(), level.compile().configurations.tolist()
        data["things"] = list(things.names)
        data["initial_configuration"] = shown_configuration(level, None)
        data["configurations"] = [_configuration(things, values) for values in rows]
    return data


def _configuration(things: Things, values: list[int]) -> dict[str, Any]:
    """Return for JSON what is where in a configuration."""
    found = things.at(values)
    switches = things.names[things.switches]
    return {
        "values": values,
        "held": list(found.held),
        "on": [name for name, is_on in zip(switches, found.on, strict=True) if is_on],
        "movers": [list(cell) for cell in found.movers],
        "exits": [list(cell) for cell in found.exits],
        "exit_is_open": found.exit_is_open,
    }


def _nested(values: Any) -> Any:
    return [_nested(value) for value in values] if isinstance(values, list) else _number(values)


def _number(value: float) -> float | str | None:
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else "inf" if value > 0 else "-inf"


def _summary(level: Level, solution: Solution, configuration: int | None) -> str:
    facts = {
        "expected return": f"{solution.expected_return:.6g}",
        "expected steps": f"{solution.expected_steps:.6g}",
        "reaches an exit": f"{100 * solution.exit_probability:.4g} %",
        "discount": f"{solution.discount:g}",
        "method": f"{solution.method}, residual {solution.residual:.1g}",
    }
    if not level.exits:
        del facts["reaches an exit"]
    if solution.actions == ActionSet.TURNS:
        facts["heading"] = f"{level.heading} (L turns left, R turns right, F goes forward)"
    if configuration is not None:
        facts["configurations"] = _shown(level, configuration)
    return fact_lines(facts)


def _shown(level: Level, configuration: int) -> str:
    """Return how many configurations there are, and which one is shown."""
    rows = level.compile().configurations
    condition = level.things().condition(rows[configuration].tolist())
    return f"{len(rows)}, shown is {configuration}{condition and ', ' + condition}"
