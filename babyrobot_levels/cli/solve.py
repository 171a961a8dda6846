"""`babyrobot solve`: an optimal policy of a level, and its values."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import partial
from typing import Annotated, Any, Literal, NoReturn

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import (
    TableFormat,
    TableOption,
    fact_lines,
    fail,
    flag,
    note,
    value_option,
    write,
    write_json,
)
from babyrobot_levels.cli.inputs import (
    LevelsArgument,
    SightOption,
    SplitOption,
    ViewRadiusOption,
    configuration_of,
    load_level,
    sight_options,
)
from babyrobot_levels.cli.many import (
    Columns,
    KeepGoingOption,
    OverwriteOption,
    ResumeOption,
    RowOptions,
    RowsOption,
    levels_for_rows,
    number,
    write_rows,
)
from babyrobot_levels.cli.parallel import JobsOption, RayAddressOption, RayOption, Workers, working
from babyrobot_levels.cli.pictures import (
    shown_configuration,
    solution_of,
    solution_text,
    values_text,
)
from babyrobot_levels.cli.sights import sight_data, sight_solution, sight_summary
from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.plain_data import json_value
from babyrobot_levels.render.text import WIDEST, number_lines
from babyrobot_levels.render.words.phrases import limited, reaching, with_limit

LONGEST_FRACTION = 15
"""Fractions of more characters are decimals in the table; JSON has them."""

LONGEST_SHOWN = 60
"""Fractions of more characters are not shown in the summary."""

MAX_WRITTEN = 10_000_000
"""The most actions of a policy by step in JSON."""

MAX_OTHERS = 3
"""How many other sets of held things are named."""


ActionSet = Literal["all", "moves", "turns"]
"""The sets of actions that a robot may have."""


ActionsOption = Annotated[
    ActionSet,
    typer.Option(
        help="The actions of the robot: stay and the four moves; the moves; or turn left, turn "
        "right and forward."
    ),
]


def solve(
    levels: LevelsArgument,
    discount: Annotated[
        float | None,
        value_option("G", "Discount factor, above 0 and at most 1.  [default: the level's]"),
    ] = None,
    actions: ActionsOption = "all",
    within: Annotated[
        str | None,
        value_option(
            "N|max_steps",
            "Truncate episodes after N steps, or after the level's `max_steps`.  "
            "[default: no limit]",
        ),
    ] = None,
    held: Annotated[
        str | None,
        value_option(
            "NAMES",
            "Show policy and values while exactly these things are held or on, "
            "separated by commas; `nothing` for none.  [default: where episodes begin]",
        ),
    ] = None,
    exact: Annotated[
        bool,
        flag(
            "--exact",
            "Compute over the rationals: fractions, with a proof that no action is better. "
            "Needs the extra `exact`.",
        ),
    ] = False,
    criterion: Annotated[
        Literal["return", "average"],
        typer.Option(
            help="What is optimal: the expected return, or the average reward of a step in the "
            "long run, for levels that go on for ever."
        ),
    ] = "return",
    sight: SightOption = None,
    view_radius: ViewRadiusOption = None,
    gap: Annotated[
        float | None,
        value_option(
            "SHARE",
            "With --sight: stop when the bounds differ by no more than this share of the optimum, "
            "or of 1, such as 0.05.  [default: 0]",
            min=0.0,
        ),
    ] = None,
    beliefs: Annotated[
        int | None,
        value_option("N", "With --sight: explore at most N beliefs.  [default: 100,000]", min=1),
    ] = None,
    split: SplitOption = None,
    report_format: TableOption = TableFormat.TEXT,
    output: RowsOption = None,
    resume: ResumeOption = False,
    force: OverwriteOption = False,
    keep_going: KeepGoingOption = False,
    jobs: JobsOption = None,
    ray: RayOption = False,
    ray_address: RayAddressOption = None,
) -> None:
    """Solve levels exactly: the optimal expected return, an optimal policy, the state values.

    The drawing shows the policy: an arrow in each cell. Without --within, the values are those of
    episodes without a time limit; where `max_steps` makes a difference, a note says so. Within a
    limit, the policy that is shown is that of the first step; JSON has that of each step. For a
    robot that turns, policy and values are those of the heading at the start: L left, R right, F
    forward. JSON has all headings, and all configurations of things.

    With --criterion average, the values are the bias of each cell: how much more than the average
    it earns in all. Where the average depends on the cell, a note says so.

    With --sight, the answer is what the best agent can expect that observes only this, remembers
    it, and knows the rules: exactly, or between two bounds.

    Several levels, folders, packs and suites give a row for each level, without policies and
    values; with --format json, a line of JSON. Rows do not depend on --jobs. The exit
    status is 1 if a level has an error.

    Examples:

      babyrobot solve final-maze

      babyrobot solve first-key --held key

      babyrobot solve frozen-lake --within max_steps

      babyrobot solve frozen-lake --discount 0.99 --format json

      babyrobot solve russell-norvig-4x3 --exact

      babyrobot solve gridworld-3-5 --criterion average

      babyrobot solve shell-game --sight view --view-radius 1

      babyrobot solve final-maze frozen-lake

      babyrobot solve classics -o optimal.jsonl --jobs 4
    """
    options = RowOptions(
        split, report_format, output, resume, force, keep_going, Workers(jobs, ray, ray_address)
    )
    many = levels_for_rows(levels, options)
    if criterion == "average":
        returns = {"--discount": discount, "--within": within, "--held": held, "--sight": sight}
        for name, value in {**returns, "--exact": exact or None}.items():
            if value is not None:
                fail(f"{name} is for returns, not for the average reward", "leave it out")
        if many is not None:
            fail("--criterion average is for one level")
        _solve_average(_loaded(levels[0], None), actions, report_format)
        return
    search = {"--view-radius": view_radius, "--gap": gap, "--beliefs": beliefs}
    if sight is None:
        for name, value in search.items():
            if value is not None:
                fail(f"{name} is for --sight", "add --sight view, for example")
    elif many is None:
        if held is not None or exact:
            fail("--held and --exact are for one who sees everything", "leave out --sight, or them")
        how = {"discount": discount, "actions": str(actions)}
        how |= {key: value for key, value in {"gap": gap, "beliefs": beliefs}.items() if value}
        how |= sight_options(sight, view_radius)
        _solve_sight(levels[0], within, report_format, how)
        return
    if many is None:
        _solve_one(levels[0], discount, actions, within, held, report_format, exact)
        return
    only = {"--held": held is not None, "--exact": exact, "--sight": sight is not None}
    for name, given in only.items():
        if given:
            fail(f"{name} is for one level")
    _check_discount(discount)
    steps = int(within) if within and within.isdecimal() else within
    if steps not in (None, "max_steps") and not (isinstance(steps, int) and steps > 0):
        _refuse_within(within)
    _solve_many(many, options, within=steps, discount=discount, actions=str(actions))


def _solve_many(levels: brl.Suite | list[Any], options: RowOptions, **how: Any) -> None:
    """Write what each level is worth."""
    from dataclasses import fields

    shown = (
        ("states", "states", str),
        ("return", "expected_return", number),
        ("steps", "steps", number),
        ("reaches an exit", "success", lambda value: f"{100 * value:.4g} %"),
    )
    columns = Columns([field.name for field in fields(brl.LevelValue)], shown, "solving")
    write_rows(partial(brl.solve_many, **how), levels, columns, options)


def _check_discount(discount: float | None) -> None:
    if discount is not None and not 0 < discount <= 1:
        fail(f"--discount must be above 0 and at most 1, not {discount:g}")


def _loaded(level: str, discount: float | None) -> brl.Level:
    """Return the level that is solved; end the command if it cannot be."""
    loaded = load_level(level)
    _check_discount(discount)
    if loaded.has_random_maze:
        fail(
            "the maze of this level is random",
            "choose one first: babyrobot resolve LEVEL --maze-seed 0 | babyrobot solve -",
        )
    return loaded


def _solve_sight(
    level: str, within: str | None, report_format: TableFormat, how: dict[str, Any]
) -> None:
    """Write what the best agent with a sight can expect of one level."""
    loaded = _loaded(level, how["discount"])
    found = sight_solution(loaded, within=_limit(within, loaded), **how)
    if report_format is TableFormat.JSON:
        rules = {"discount": how["discount"] or loaded.discount, "actions": how["actions"]}
        write_json(sight_data(loaded, found) | rules)
        return
    if not found.is_exact and found.gap > how.get("gap", 0):
        note("the bounds may come closer with more --beliefs, or with --no-limit")
    write(sight_summary(loaded, found))


def _solve_one(
    level: str,
    discount: float | None,
    actions: ActionSet,
    within: str | None,
    held: str | None,
    report_format: TableFormat,
    exact: bool,
) -> None:
    """Write the solution of one level."""
    from babyrobot_levels.analysis.endings import ending_of

    loaded = _loaded(level, discount)
    configuration = None if held is None else configuration_of(loaded, held)
    limit = _limit(within, loaded)
    if exact and limit is not None:
        fail("--exact is without a limit of steps", "leave --within out")
    with working("solving"):
        solution = solution_of(loaded, discount, actions, limit)
        fractions = _fractions(loaded, discount, actions) if exact else None
    if report_format is TableFormat.JSON:
        if held is not None:
            note("--held has no effect on JSON, which has all configurations")
        write_json(_data(loaded, solution) | (_exact_data(fractions) if fractions else {}))
        return
    if solution.explanation:
        note(solution.explanation)
    if ending := ending_of(solution):
        note(ending.text)
    if within is None:
        _note_limit(loaded, solution)
    shown = shown_configuration(loaded, configuration)
    write(_summary(loaded, solution, shown, fractions) + "\n")
    if actions == "turns":
        write(_turns(loaded, solution, shown, values=fractions is None))
    else:
        values = fractions is None
        write(solution_text(loaded, solution, values=values, policy=True, configuration=shown))
    if fractions is not None:
        heading = loaded.heading if actions == "turns" else None
        write("\n" + _fraction_table(fractions.at(shown or 0, heading).values.tolist()))


def _solve_average(level: brl.Level, actions: ActionSet, report_format: TableFormat) -> None:
    """Write the greatest average reward of a level, and the bias of each cell."""
    with working("solving"):
        try:
            found = brl.solve(level, criterion="average", actions=str(actions))
        except brl.EpisodeTooLongError as error:
            fail(str(error))
    arrays = {
        name: json_value(getattr(found, name).tolist()) for name in ("gain", "bias", "policy")
    }
    if report_format is TableFormat.JSON:
        about = {"name": level.name, "digest": level.digest, "expected_gain": found.expected_gain}
        write_json(about | {"multichain": found.multichain, "actions": found.actions} | arrays)
        return
    if found.explanation:
        note(found.explanation)
    rounds = f"policy iteration, {found.iterations} policies, residual {found.residual:.2g}"
    write(fact_lines({"average reward": f"{found.expected_gain:.6g} a step", "method": rounds}))
    for name in ("gain", "bias") if found.multichain else ("bias",):
        table = getattr(found, name).reshape(-1, *found.gain.shape[-2:])
        if len(table) == 1:
            lines = "\n".join(number_lines(table[0].tolist(), 2, frozenset()))
            write(f"\n{name}:\n{lines}\n")


def _fractions(level: brl.Level, discount: float | None, actions: ActionSet) -> brl.ExactSolution:

    try:
        return brl.solve(level, discount, actions=str(actions), exact=True)
    except brl.NotExactError as error:
        fail(str(error))


def _fraction_table(rows: list[list[Fraction | float]]) -> str:
    """Return fractions in rows and columns; those that are long as decimals, after `~`."""

    def shown(value: Fraction | float) -> str:
        if value != value:
            return ""
        return text if len(text := str(value)) <= LONGEST_FRACTION else f"~{float(value):.6g}"

    table = [[shown(value) for value in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    lines = (
        "  ".join(text.rjust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in table
    )
    return "".join(f"{line}\n" for line in lines)


def _exactly(value: Fraction | float, rounded: str) -> str:
    """Return a fraction beside the number that it is about."""
    text = str(value)
    if isinstance(value, float) or value.denominator == 1:
        return rounded
    if len(text) > LONGEST_SHOWN:
        return f"{rounded}, a fraction of {len(text)} characters (--format json)"
    return f"{text} = {rounded}"


def _exact_data(found: brl.ExactSolution) -> dict[str, Any]:
    """Return for JSON what a solution has over the rationals: fractions as text."""

    def text(values: Any) -> Any:
        if isinstance(values, list):
            return [text(value) for value in values]
        return str(values) if isinstance(values, Fraction) else json_value(values)

    return {
        "expected_return": text(found.expected_return),
        "expected_steps": text(found.expected_steps),
        "exit_probability": text(found.exit_probability),
        "method": "policy iteration over the rationals",
        "iterations": found.iterations,
        "residual": 0,
        "values": text(found.values.tolist()),
        "action_values": text(found.action_values.tolist()),
        "policy": found.policy.tolist(),
        "greedy": found.greedy.tolist(),
    }


def _limit(within: str | None, level: brl.Level) -> int | None:
    """Return the number of steps that --within asks for, None for no limit."""
    from babyrobot_levels.analysis.solver.results import check_within

    try:
        return check_within(
            int(within) if within and within.isdecimal() else within, level.max_steps
        )
    except ValueError:
        if within == "max_steps":
            fail("the level has no max_steps", "give a number of steps, such as --within 200")
        _refuse_within(within)


def _refuse_within(within: str | None) -> NoReturn:
    fail(f"--within must be a number of steps from 1 on, or max_steps, not {within}")


def _note_limit(level: brl.Level, solution: brl.Solution) -> None:
    """Say that the level has a time limit, if that changes what an optimal policy earns."""
    from babyrobot_levels.analysis.solver.horizon import best_return_within

    steps = level.max_steps
    if steps is None:
        return
    ignored = f"max_steps ({steps}) is ignored: these are figures {limited(None)}"
    try:
        within = best_return_within(
            level, steps, actions=solution.actions, discount=solution.discount, quick=True
        )
    except brl.EpisodeTooLongError:
        note(ignored)
        return
    if not math.isclose(within, solution.expected_return, rel_tol=1e-6, abs_tol=1e-6):
        best = with_limit("the best expected return", steps, steps)
        note(f"{ignored}; {best} is {within:.4g} (--within max_steps)")


def _turns(
    level: brl.Level, solution: brl.Solution, configuration: int | None, *, values: bool
) -> str:
    """Return letters and values of a robot that looks as at the start."""
    part = solution.at(configuration or 0, level.heading)
    rows = part.policy.tolist()
    text = "".join(" ".join(".LRF"[action + 1] for action in row) + "\n" for row in rows)
    # Wider tables are for `--format json`.
    return text + ("\n" + values_text(part, None) if values and level.size[0] <= WIDEST else "")


def _data(level: brl.Level, solution: brl.Solution) -> dict[str, Any]:
    """Return the solution for JSON: null for cells without a value, strings for infinities."""
    from babyrobot_levels.analysis.endings import ending_of
    from babyrobot_levels.analysis.solver.results import action_names

    data = {
        "name": level.name,
        "digest": level.digest,
        "discount": solution.discount,
        "within": solution.within,
        "expected_return": json_value(solution.expected_return),
        "expected_steps": json_value(solution.expected_steps),
        "exit_probability": json_value(solution.exit_probability),
        "ending": None if (ending := ending_of(solution)) is None else ending.text,
        "method": solution.method,
        "iterations": solution.iterations,
        "residual": json_value(solution.residual),
        "actions": action_names(solution.actions, level.compile())[solution.first_action :],
        "values": json_value(solution.values.tolist()),
        "action_values": json_value(solution.action_values.tolist()),
        "policy": solution.policy.tolist(),
        "greedy": solution.greedy.tolist(),
    }
    if solution.policies is not None:
        if solution.policies.size > MAX_WRITTEN:
            fail(
                f"a policy of {solution.policies.size:,} actions is too large for JSON; the limit "
                f"is {MAX_WRITTEN:,}",
                "give a smaller --within, or leave out --format json",
            )
        data["policies"] = solution.policies.tolist()
    if solution.actions == "turns":
        data["headings"] = list(SIDES)
    if level.has_things:
        things, rows = level.things(), level.compile().configurations.tolist()
        data["things"] = list(things.names)
        data["initial_configuration"] = shown_configuration(level, None)
        data["configurations"] = [_configuration(things, values) for values in rows]
    return data


def _configuration(things: brl.Things, values: list[int]) -> dict[str, Any]:
    """Return for JSON what is where in a configuration."""
    found = things.at(values)
    return {
        "values": values,
        "held": list(found.held),
        "on": things.told(values).get("on", []),
        "movers": [list(cell) for cell in found.movers],
        "exits": [list(cell) for cell in found.exits],
        "exit_is_open": found.exit_is_open,
    }


def _summary(
    level: brl.Level,
    solution: brl.Solution,
    configuration: int | None,
    fractions: brl.ExactSolution | None,
) -> str:

    reaches = reaching(level)
    best = f"{solution.expected_return:.6g}"
    facts = {
        "expected return": with_limit(best, solution.within, level.max_steps),
        "expected steps": f"{solution.expected_steps:.6g}",
        reaches: f"{100 * solution.exit_probability:.4g} %",
        "discount": f"{solution.discount:g}",
        "method": f"{solution.method}, residual {solution.residual:.1g}",
    }
    if fractions is not None:
        exact = {
            "expected return": fractions.expected_return,
            "expected steps": fractions.expected_steps,
            reaches: fractions.exit_probability,
        }
        facts |= {name: _exactly(value, facts[name]) for name, value in exact.items()}
        facts["method"] = "policy iteration over the rationals: no action is better"
    if not level.has_goal:
        del facts[reaches]
    if solution.actions == "turns":
        facts["heading"] = f"{level.heading} (L turns left, R turns right, F goes forward, . none)"
    if configuration is not None:
        facts["configurations"] = _shown(level, configuration)
    return fact_lines(facts)


def _shown(level: brl.Level, configuration: int) -> str:
    """Return how many configurations there are, which one is shown, and how to see others."""
    from babyrobot_levels.mdp.states import configuration_words, held_sets

    words, rows = configuration_words(level, configuration), level.compile().configurations
    met, sets = level.things().met(rows[configuration].tolist()), held_sets(level)
    others = [f"--held {','.join(names) or 'nothing'}" for names in sets if met != {*names}]
    others[MAX_OTHERS:] = ["…"] * (len(others) > MAX_OTHERS)
    told = f"{len(rows)}, shown is {configuration}, {words}"
    return f"{told}; others: {', '.join(others)}" if others else told
