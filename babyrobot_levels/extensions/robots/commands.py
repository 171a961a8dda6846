"""`babyrobot check-plan`: plans of multi-agent path finding are checked, and what they cost."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import (
    FINDINGS,
    FormatOption,
    ReportFormat,
    fact_lines,
    value_option,
    write,
    write_json,
)


def check_plan(
    plan: Annotated[
        Path,
        typer.Argument(metavar="PLAN", help="A plan of the MAPF tracker, of PIBT or of LaCAM."),
    ],
    scen: Annotated[
        Path,
        typer.Argument(
            metavar="SCEN", help="MovingAI's scenarios (.scen), or a level with robots."
        ),
    ],
    map_file: Annotated[
        Path | None,
        value_option(
            "FILE", "The map.  [default: that of the scenarios, in their folder]", "--map"
        ),
    ] = None,
    agents: Annotated[
        int | None,
        value_option("N", "How many agents the plan must have; of several plans, which.", min=1),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Check a plan for many agents, and tell what it costs.

    A plan is valid if each agent begins at its start, ends at its goal and moves by one free cell
    at most, no two are in one cell, and no two change places. The first fault is told. A cost is
    the steps until an agent is at its goal for good; no plan costs less than the lower bounds, the
    shortest paths of all agents alone. In a level with several robots, its own rules are followed,
    in which nothing may happen by chance. The exit status is 1 if the plan is not valid.

    Examples:

      babyrobot check-plan plan.txt lane.scen

      babyrobot check-plan plan.txt lane.scen --map lane.map --agents 2

      babyrobot check-plan plan.txt team.yaml

      babyrobot check-plan plan.txt passing-place
    """
    from babyrobot_levels.extensions.robots.plans import names_level

    found = brl.check_plan(plan, scen, map_file, agents=agents)
    if report_format is ReportFormat.JSON:
        write_json({**asdict(found), "valid": found.is_valid})
    else:
        bounded = not ({plan.suffix, scen.suffix} & {".yaml", ".yml"} or names_level(scen))
        write(fact_lines(_facts(found, bounded=bounded)))
    if not found.is_valid:
        raise typer.Exit(FINDINGS)


def _facts(found: brl.PlanCheck, *, bounded: bool) -> dict[str, str]:
    return {
        "agents": f"{found.agents:,}",
        "valid": "yes" if found.fault is None else f"no: {found.fault}",
        "sum of costs": _cost(found.sum_of_costs, found.sum_of_costs_lower_bound, bounded=bounded),
        "makespan": _cost(found.makespan, found.makespan_lower_bound, bounded=bounded),
    }


def _cost(cost: int | None, bound: int | None, *, bounded: bool) -> str:
    if not bounded:
        return "unknown" if cost is None else f"{cost:,}"
    told = "a goal cannot be reached" if bound is None else f"at least {bound:,}"
    return told if cost is None else f"{cost:,} ({told})"
