"""`babyrobot compare`: whether a level is the same game as another one."""

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
    fail,
    write,
    write_json,
)
from babyrobot_levels.cli.inputs import LevelArgument, load_level, load_two
from babyrobot_levels.cli.reporting import shown_name
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    from babyrobot_levels.analysis.compare import Certificate
    from babyrobot_levels.library.level import Level


def compare(
    level: LevelArgument,
    other: Annotated[
        str,
        typer.Argument(
            metavar="OTHER",
            help="Another level, or `gymnasium:ID`, an environment that has a table of outcomes.",
        ),
    ],
    actions: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,…",
            help="For each action of the other the level's own: 0 stay, 1 north, 2 east, 3 south, "
            "4 west.  [default: found]",
            show_default=False,
        ),
    ] = None,
    kwargs: Annotated[
        str | None,
        typer.Option(metavar="JSON", help="What the environment is made with.", show_default=False),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Prove that a level is the same game as another one, or show the first difference.

    Starts and all outcomes are compared, entry by entry; limits of steps are not.
    Ends with status 0 if the games are the same, and with 1 if they differ.

    Examples:

      babyrobot compare frozen-lake gymnasium:FrozenLake-v1

      babyrobot compare frozen-lake-dry gymnasium:FrozenLake-v1 --kwargs '{"is_slippery": false}'
    """
    from babyrobot_levels.analysis.compare import compare as compared
    from babyrobot_levels.analysis.transition_tables import GYMNASIUM

    given = None if actions is None else _numbers(actions)
    keywords = None if kwargs is None else _mapping(kwargs)
    loaded: Level
    peer: Level | str
    if other.startswith(GYMNASIUM):
        loaded, peer = load_level(level), other
    else:
        loaded, peer = load_two(level, other)
    level, other = shown_name(level), shown_name(other)
    certificate = compared(loaded, peer, actions=given, kwargs=keywords)
    if report_format is ReportFormat.JSON:
        write_json({"level": level, "other": other, "kwargs": keywords, **asdict(certificate)})
    else:
        made = other if keywords is None else f"{other} {json.dumps(keywords)}"
        write(printable(_told(loaded, certificate, level, made)))
    if not certificate.equal:
        raise typer.Exit(FINDINGS)


def _numbers(text: str) -> tuple[int, ...]:
    if not re.fullmatch(r"[0-4](,[0-4])*", text):
        fail(f"--actions takes numbers from 0 to 4 with commas between, not {text!r}")
    return tuple(map(int, text.split(",")))


def _mapping(text: str) -> dict[str, Any]:
    try:
        keywords = json.loads(text)
    except (ValueError, RecursionError) as error:
        fail(f"--kwargs is not JSON: {error}", "such as '{\"is_slippery\": false}'")
    if not isinstance(keywords, dict):
        fail("--kwargs takes a JSON object", "such as '{\"is_slippery\": false}'")
    return keywords


def _told(loaded: Level, certificate: Certificate, level: str, other: str) -> str:
    from babyrobot_levels.mdp.actions import Action

    if not certificate.equal:
        return f"{level} and {other} are different games\n\n{certificate.difference}\n"
    width, height = loaded.size
    names = [Action(action).name.lower() for action in certificate.actions or ()]
    told = {
        "states": f"{certificate.states} compared, of {width * height}",
        "outcomes": f"{certificate.outcomes} compared",
        "elsewhere": "the same"
        if certificate.everywhere
        else "different, but no episode comes there",
        "actions": ", ".join(f"{number} = {name}" for number, name in enumerate(names)),
        "digest": certificate.digest,
    }
    lines = "".join(f"{name + ':':<10} {value}\n" for name, value in told.items())
    return f"{level} and {other} are the same game\n\n{lines}"
