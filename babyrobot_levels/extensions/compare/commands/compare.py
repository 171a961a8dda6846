"""`babyrobot compare`: whether two levels are the same MDP."""

from __future__ import annotations

import json
import re
from dataclasses import asdict
from typing import Annotated

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import (
    FINDINGS,
    FormatOption,
    ReportFormat,
    fact_lines,
    fail,
    value_option,
    write,
    write_json,
)
from babyrobot_levels.cli.inputs import (
    LevelArgument,
    ResetSeedOption,
    json_mapping,
    load_level,
    load_two,
)
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.cli.reporting import shown_name
from babyrobot_levels.language.base import SIDES
from babyrobot_levels.text.source import printable


def compare(
    level: LevelArgument,
    other: Annotated[
        str,
        typer.Argument(
            metavar="OTHER",
            help="Another level, `gymnasium:ID`, an environment with a table `P`, or "
            "`minigrid:ID`, one of MiniGrid without objects.",
        ),
    ],
    actions: Annotated[
        str | None,
        value_option(
            "A,B,…",
            "The level's action for each action of the other: 0 stay, 1 north, 2 east, "
            "3 south, 4 west; for example 4,3,2,1.  [default: found by search]",
        ),
    ] = None,
    kwargs: Annotated[
        str | None, value_option("JSON", "Keyword arguments of the environment.")
    ] = None,
    seed: ResetSeedOption = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Test whether two levels are the same MDP, or show the first difference.

    All start states and transitions are compared; `max_steps` is not. Actions may be numbered
    differently. MiniGrid is compared with the robot that turns, and without rewards, because
    MiniGrid's shrink with each step.

    Exits with status 0 if they are the same, and with 1 if they differ.

    Examples:

      babyrobot compare frozen-lake gymnasium:FrozenLake-v1

      babyrobot compare frozen-lake-dry gymnasium:FrozenLake-v1 --kwargs '{"is_slippery": false}'

      babyrobot compare four-rooms.yaml minigrid:MiniGrid-FourRooms-v0 --seed 3
    """
    from babyrobot_levels.analysis.compare import GYMNASIUM, VERSION
    from babyrobot_levels.analysis.environments import MINIGRID

    given = None if actions is None else _numbers(actions)
    keywords = None if kwargs is None else json_mapping(kwargs)
    loaded: brl.Level
    peer: brl.Level | str
    is_minigrid = other.startswith(MINIGRID)
    if seed is not None and not is_minigrid:
        fail("--seed is for environments of MiniGrid", f"`{MINIGRID}ID`")
    if actions is not None and is_minigrid:
        fail("--actions is not for MiniGrid, whose actions are left, right and forward")
    if is_minigrid or other.startswith(GYMNASIUM) or VERSION.search(other):
        loaded, peer = load_level(level), other
    else:
        loaded, peer = load_two(level, other)
    level, other = shown_name(level), shown_name(other)
    with working("comparing"):
        certificate = brl.compare(loaded, peer, actions=given, kwargs=keywords, seed=seed or 0)
    if report_format is ReportFormat.JSON:
        write_json({"level": level, "other": other, "kwargs": keywords, **asdict(certificate)})
    else:
        made = other if keywords is None else f"{other} {json.dumps(keywords)}"
        write(printable(_text(loaded, certificate, level, made, is_minigrid=is_minigrid)))
    if not certificate.equal:
        raise typer.Exit(FINDINGS)


def _numbers(text: str) -> tuple[int, ...]:
    if not re.fullmatch(r"[0-4](,[0-4])*", text):
        fail(f"invalid --actions {text!r}", "expected numbers from 0 to 4, for example 4,3,2,1")
    return tuple(map(int, text.split(",")))


def _text(
    loaded: brl.Level, certificate: brl.Certificate, level: str, other: str, *, is_minigrid: bool
) -> str:
    from babyrobot_levels.analysis.solver.results import action_names

    if not certificate.equal:
        return f"{level} and {other} are different MDPs\n\n{certificate.difference}\n"
    actions = certificate.actions or ()
    is_turning = len(actions) == len(brl.Turn)
    mdp = loaded.compile()
    states = mdp.num_states * (len(SIDES) if is_turning else 1)
    every = action_names("turns" if is_turning else "all", mdp)
    names = [every[action] for action in actions]
    facts = {
        "states": f"{certificate.states} of {states} are reachable, all equal",
        "transitions": f"{certificate.outcomes}, all equal",
        "unreachable": "equal" if certificate.everywhere else "different, which has no effect",
        "actions": ", ".join(f"{number} = {name}" for number, name in enumerate(names)),
    }
    if is_minigrid:
        del facts["unreachable"]
        facts["rewards"] = "not compared: MiniGrid's shrink with each step"
    facts["digest"] = certificate.digest
    return f"{level} and {other} are the same MDP\n\n{fact_lines(facts)}"
