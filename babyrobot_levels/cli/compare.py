"""`babyrobot compare`: whether two levels are the same MDP."""

from __future__ import annotations

import json
import re
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import (
    FINDINGS,
    FormatOption,
    ReportFormat,
    fact_lines,
    fail,
    write,
    write_json,
)
from babyrobot_levels.cli.inputs import LevelArgument, load_level, load_two
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.cli.reporting import shown_name
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    from babyrobot_levels.analysis.certificate import Certificate
    from babyrobot_levels.library.level import Level


def compare(
    level: LevelArgument,
    other: Annotated[
        str,
        typer.Argument(
            metavar="OTHER",
            help="Another level, or `gymnasium:ID`, an environment with a table `P`.",
        ),
    ],
    actions: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,…",
            help="The level's action for each action of the other: 0 stay, 1 north, 2 east, "
            "3 south, 4 west; for example 4,3,2,1.  [default: found by search]",
            show_default=False,
        ),
    ] = None,
    kwargs: Annotated[
        str | None,
        typer.Option(
            metavar="JSON", help="Keyword arguments of the environment.", show_default=False
        ),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Test whether two levels are the same MDP, or show the first difference.

    All start states and transitions are compared; `max_steps` is not. Actions may be numbered
    differently.

    Exits with status 0 if they are the same, and with 1 if they differ.

    Examples:

      babyrobot compare frozen-lake gymnasium:FrozenLake-v1

      babyrobot compare frozen-lake-dry gymnasium:FrozenLake-v1 --kwargs '{"is_slippery": false}'
    """
    from babyrobot_levels.analysis.compare import GYMNASIUM
    from babyrobot_levels.analysis.compare import compare as compared

    given = None if actions is None else _numbers(actions)
    keywords = None if kwargs is None else _mapping(kwargs)
    loaded: Level
    peer: Level | str
    if other.startswith(GYMNASIUM):
        loaded, peer = load_level(level), other
    else:
        loaded, peer = load_two(level, other)
    level, other = shown_name(level), shown_name(other)
    with working("comparing"):
        certificate = compared(loaded, peer, actions=given, kwargs=keywords)
    if report_format is ReportFormat.JSON:
        write_json({"level": level, "other": other, "kwargs": keywords, **asdict(certificate)})
    else:
        made = other if keywords is None else f"{other} {json.dumps(keywords)}"
        write(printable(_text(loaded, certificate, level, made)))
    if not certificate.equal:
        raise typer.Exit(FINDINGS)


def _numbers(text: str) -> tuple[int, ...]:
    if not re.fullmatch(r"[0-4](,[0-4])*", text):
        fail(f"invalid --actions {text!r}", "expected numbers from 0 to 4, for example 4,3,2,1")
    return tuple(map(int, text.split(",")))


def _mapping(text: str) -> dict[str, Any]:
    try:
        keywords = json.loads(text)
    except (ValueError, RecursionError) as error:
        fail(f"--kwargs is not JSON: {error}", "for example '{\"is_slippery\": false}'")
    if not isinstance(keywords, dict):
        fail("--kwargs must be a JSON object", "for example '{\"is_slippery\": false}'")
    return keywords


def _text(loaded: Level, certificate: Certificate, level: str, other: str) -> str:
    from babyrobot_levels.mdp.actions import Action

    if not certificate.equal:
        return f"{level} and {other} are different MDPs\n\n{certificate.difference}\n"
    width, height = loaded.size
    names = [Action(action).name.lower() for action in certificate.actions or ()]
    facts = {
        "states": f"{certificate.states} of {width * height} are reachable, all equal",
        "transitions": f"{certificate.outcomes}, all equal",
        "unreachable": "equal" if certificate.everywhere else "different, which has no effect",
        "actions": ", ".join(f"{number} = {name}" for number, name in enumerate(names)),
        "digest": certificate.digest,
    }
    return f"{level} and {other} are the same MDP\n\n{fact_lines(facts)}"
