"""Pictures, GIFs and pages of levels for commands, which end where there is none."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from typing import TYPE_CHECKING, NoReturn

import typer

from babyrobot_levels.cli.console import FINDINGS, fail, note
from babyrobot_levels.cli.inputs import configuration_of
from babyrobot_levels.cli.parallel import Report

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level


class PolicyName(StrEnum):
    """Policies of GIFs and pages."""

    BEST = "best"
    RANDOM = "random"


@dataclass(frozen=True, slots=True)
class PictureOptions:
    """What a picture shows, and how.

    Attributes:
        values: whether to show the optimal value of each cell.
        policy: the policy that a still picture shows, or that a GIF or page follows.
        seed: the random seed of GIFs and pages.
        scale: the size, where 1 is 64 pixels per cell; None chooses one for the level.
        held: what is held and on in a still picture, as for `--held`; None shows the level as a
            whole, and the solution where episodes begin.
        answers: whether a page knows the solution.
        rules: whether to show the rules of the level.
    """

    values: bool = False
    policy: PolicyName | None = None
    seed: int = 0
    scale: float | None = None
    held: str | None = None
    answers: bool = True
    rules: bool = False


def picture(
    level: Level, options: PictureOptions, report: Report | None = None, *, kind: str
) -> str | bytes:
    """Return a still picture: `svg`, `pdf`, or `png`, of whose making `report` is told."""
    from babyrobot_levels.analysis import pictures

    if options.policy is PolicyName.RANDOM:
        fail(
            "a still picture cannot show a random policy",
            "use --policy best, or a GIF or HTML output",
        )
    if options.held is not None:
        configuration_of(level, options.held)
    makers: dict[str, Callable[..., str | bytes]] = {
        "svg": pictures.to_svg,
        "pdf": pictures.to_pdf,
        "png": partial(pictures.to_png, progress=report),
    }
    with _refusing("use a smaller --scale or --cell"):
        return makers[kind](
            level,
            values=options.values,
            policy=options.policy,
            held=options.held,
            rules=options.rules,
            scale=options.scale,
        )


def gif(level: Level, options: PictureOptions, report: Report) -> bytes:
    """Return an episode as an animated GIF, of whose making `report` is told."""
    from babyrobot_levels.analysis import pictures

    with _refusing("use a smaller --scale or --cell"):
        return pictures.to_gif(
            level,
            policy=options.policy,
            seed=options.seed,
            values=options.values,
            rules=options.rules,
            scale=options.scale,
            progress=report,
            tell=note,
        )


def page(level: Level, options: PictureOptions) -> str:
    """Return an HTML page on which the level can be played."""
    from babyrobot_levels.analysis import pictures

    with _refusing("save a picture instead: -o FILE.svg or -o FILE.png"):
        return pictures.to_html(
            level,
            values=options.values,
            policy=options.policy,
            seed=options.seed,
            answers=options.answers,
            tell=note,
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
