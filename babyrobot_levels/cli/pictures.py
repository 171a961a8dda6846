"""Pictures, films and pages of levels for commands, which end where there is none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import typer

from babyrobot_levels.analysis.pictures import FORMATS, PictureFormat, titles_of
from babyrobot_levels.cli.console import FINDINGS, fail, note
from babyrobot_levels.cli.inputs import configuration_of
from babyrobot_levels.cli.parallel import Report
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level


Name = TypeVar("Name", bound=str)


class PolicyName(StrEnum):
    """Policies of films and pages."""

    BEST = "best"
    RANDOM = "random"


def picture(
    level: Level, format_name: str, asked: Mapping[str, Any], report: Report
) -> str | bytes:
    """Return a picture, film or page, of whose making `report` is told.

    Args:
        level: the level.
        format_name: a format that is not made for the terminal.
        asked: the options; those that the format does not have are left out.
        report: told of how much is done.
    """
    chosen = FORMATS[format_name]
    check_policy(chosen, asked.get("policy"))
    if "held" in chosen.options and asked.get("held") is not None:
        configuration_of(level, asked["held"])
    smaller = "use a smaller --scale or --cell"
    other = "save a picture instead: -o FILE.svg or -o FILE.png"
    given = {name: value for name, value in asked.items() if name in chosen.options}
    hears = {"progress": report, "tell": note}
    assert chosen.make is not None
    with _refusing(smaller if "scale" in chosen.options else other):
        return chosen.make(level, **given, **{name: hears[name] for name in chosen.hears})


def format_by_suffix(output: Path, suffixes: Mapping[str, Name]) -> Name:
    """Return the format of a file, by its suffix; end the command if there is none."""
    suffix = output.suffix.lower()
    if suffix not in suffixes:
        fail(
            f"unknown suffix {suffix or '(none)'}",
            f"use one of {', '.join(suffixes)}, or add --format",
        )
    return suffixes[suffix]


def check_policy(chosen: PictureFormat, policy: str | None) -> None:
    """End the command if a picture shall show a policy that only films and pages can follow."""
    if policy == PolicyName.RANDOM and "seed" not in chosen.options:
        others = listed(titles_of("seed"), "or")
        fail(
            f"a {chosen.kind} cannot show a random policy",
            f"use --policy best, or a {others} output",
        )


@contextmanager
def _refusing(help_text: str) -> Iterator[None]:
    """End the command if a picture cannot be made."""
    from babyrobot_levels.analysis.solver.results import UndefinedReturnError

    try:
        yield
    except UndefinedReturnError as error:
        _end_unsolved(error)
    except ValueError as error:
        fail(str(error), help_text)


def _end_unsolved(error: ArithmeticError) -> NoReturn:
    note(f"error: the level has no optimal policy: {error}")
    raise typer.Exit(FINDINGS) from None


def check_page_size(level: Level, help_text: str) -> None:
    """End the command if a level is too large for a page, before it is solved for one."""
    from babyrobot_levels.render.page_data import TooLargeError, without_panels

    try:
        without_panels(level)
    except TooLargeError as error:
        fail(str(error), help_text)


def shown_configuration(level: Level, configuration: int | None) -> int | None:
    """Return the configuration whose values are shown; None without things.

    By default it is the one in which episodes begin.
    """
    if not level.has_things or configuration is not None:
        return configuration
    from babyrobot_levels.mdp.states import initial_configuration

    return initial_configuration(level)


def solution_of(
    level: Level,
    discount: float | None = None,
    actions: str = "all",
    within: int | None = None,
) -> Solution:
    """Return the solution of a level; end the command if it has none."""
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError

    try:
        return solve(level, discount, actions=actions, within=within)
    except UndefinedReturnError as error:
        _end_unsolved(error)
    except EpisodeTooLongError as error:
        fail(str(error))
