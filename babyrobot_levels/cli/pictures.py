"""Pictures, films and pages of levels for commands, which end where there is none."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Set
from contextlib import contextmanager
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import typer

from babyrobot_levels.analysis.pictures import FORMATS, PictureFormat, titles_of
from babyrobot_levels.cli.console import FINDINGS, fail, note, speaks_unicode
from babyrobot_levels.cli.inputs import configuration_of
from babyrobot_levels.cli.parallel import Report
from babyrobot_levels.render.terminal import colors_of, room_of
from babyrobot_levels.render.text import WIDEST, TextPainter, number_lines
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.render.scene.layout import Overlay, Rows

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
    if isinstance(asked.get("policy"), str):
        check_policy(chosen, asked["policy"])
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
    from babyrobot_levels.analysis.guides import EndlessVisitsError
    from babyrobot_levels.analysis.solver.results import UndefinedReturnError

    try:
        yield
    except EndlessVisitsError as error:
        fail(str(error), "leave out --visits, or give the level an end")
    except UndefinedReturnError as error:
        _end_unsolved(error)
    except ValueError as error:
        fail(str(error), help_text)


def _end_unsolved(error: ArithmeticError) -> NoReturn:
    note(f"error: the level has no optimal policy: {error}")
    raise typer.Exit(FINDINGS) from None


def check_page_size(level: Level, help_text: str) -> None:
    """End the command if a level is too large for a page, before it is solved for one."""
    from babyrobot_levels.render.page import without_panels
    from babyrobot_levels.render.page_format import TooLargeError

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


_ALL_LINES = 1 << 30
"""More lines than any picture has: terminals scroll."""


def text_picture(level: Level, *, plain: bool = False, configuration: int | None = None) -> str:
    """Return the level for standard output."""
    if not plain and takes_pictures():
        return _picture(level, None, configuration)
    if configuration is None:
        return level.draw()
    return _joined(
        TextPainter(level, plain=True).lines(None, configuration=configuration, held=False)
    )


def solution_text(
    level: Level,
    solution: Solution,
    *,
    values: bool,
    policy: bool,
    plain: bool = False,
    configuration: int | None = None,
) -> str:
    """Return values and policy of a solution for standard output.

    In ASCII, values are a table below the drawing, up to a width of 16 cells. At the end there is
    what the marks mean.

    Args:
        level: the level.
        solution: its solution.
        values: whether to show the values.
        policy: whether to show the optimal actions.
        plain: whether to use ASCII in any case.
        configuration: what is where; None is where episodes begin.
    """
    from babyrobot_levels.analysis.shown import actions_shown, overlay_given

    number = shown_configuration(level, configuration)
    told = overlay_given(level, {"values": solution}).at(number)
    overlay = replace(
        told,
        values=_values(solution, number) if values else None,
        actions=actions_shown(solution, number) if policy else None,
        caption="",
    )
    plain = plain or not takes_pictures()
    if not plain:
        text = _picture(level, overlay, number)
    elif policy:
        painter = TextPainter(level, plain=True, overlay=replace(overlay, values=None))
        text = _joined(painter.lines(None, configuration=number, held=False))
    else:
        text = text_picture(level, plain=True, configuration=configuration)
    if plain and values and level.size[0] <= WIDEST:
        text += "\n" + values_text(solution, number, overlay.never)
    marks = TextPainter(level, plain=plain, overlay=replace(overlay, caption=told.caption))
    explained = _joined(marks.explained())
    return text + (explained and "\n" + explained)


def values_text(
    solution: Solution, configuration: int | None, never: Set[tuple[int, int]] = frozenset()
) -> str:
    """Return the values in rows and columns, with two decimals."""
    rows = solution.at(configuration or 0).values.tolist()
    return _joined(number_lines(rows, 2, never))


def takes_pictures() -> bool:
    """Return whether standard output shows Unicode and colour."""
    return colors_of(sys.stdout) > 0 and speaks_unicode(sys.stdout)


def _values(solution: Solution, configuration: int | None) -> Rows[float | None]:
    """Return the value of each cell, None where there is none."""
    rows = solution.at(configuration or 0).values.tolist()
    return [[None if math.isnan(value) else value for value in row] for row in rows]


def _picture(level: Level, overlay: Overlay | None, configuration: int | None) -> str:
    """Return a picture in colour: the whole level if the terminal is wide enough, else a part."""
    painter, colors = TextPainter(level, overlay=overlay), colors_of(sys.stdout)
    room = None
    if sys.stdout.isatty():
        columns, lines = room_of(sys.stdout)
        width = level.size[0]
        has_arrows = overlay is not None and overlay.actions is not None
        if 4 * width + 1 > columns and 2 * width + 1 <= columns and not has_arrows:
            return _joined(painter.blocks(configuration=configuration, colors=colors))
        is_cut = 4 * width + 1 > columns
        room = os.terminal_size((columns, max(1, lines - 2) if is_cut else _ALL_LINES))
    shown = painter.lines(None, configuration=configuration, colors=colors, held=False, room=room)
    return _joined(shown)


def _joined(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)
