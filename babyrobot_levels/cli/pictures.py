"""Pictures, films and pages of levels for commands, which end where there is none."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Set
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NoReturn, TypeVar

import typer

import babyrobot_levels as brl
from babyrobot_levels.analysis.picture_formats import FORMATS, PictureFormat, titles_of
from babyrobot_levels.cli.console import FINDINGS, fail, note, speaks_unicode
from babyrobot_levels.cli.inputs import configuration_of
from babyrobot_levels.cli.parallel import Report
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.render.terminal import colors_of, room_of
from babyrobot_levels.render.text import WIDEST, TextPainter, number_lines
from babyrobot_levels.render.words.rules import MOST
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.render.scene.layout import Overlay, Rows

Name = TypeVar("Name", bound=str)


PolicyName = Literal["best", "random"]
"""Policies of films and pages."""


def picture(
    level: brl.Level, format_name: str, asked: Mapping[str, Any], report: Report
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
    if policy == "random" and "seed" not in chosen.options:
        others = listed(titles_of("seed"), "or")
        fail(
            f"a {chosen.kind} cannot show a random policy",
            f"use --policy best, or a {others} output",
        )


@contextmanager
def _refusing(help_text: str) -> Iterator[None]:
    """End the command if a picture cannot be made."""
    from babyrobot_levels.analysis.guides import EndlessVisitsError

    try:
        yield
    except EndlessVisitsError as error:
        fail(str(error), "leave out --visits, or give the level an end")
    except brl.UndefinedReturnError as error:
        _end_unsolved(error)
    except ValueError as error:
        fail(str(error), help_text)


def _end_unsolved(error: ArithmeticError) -> NoReturn:
    note(f"error: the level has no optimal policy: {error}")
    raise typer.Exit(FINDINGS) from None


def check_page_size(level: brl.Level, help_text: str) -> None:
    """End the command if a level is too large for a page, before it is solved for one."""
    from babyrobot_levels.render.page import without_panels
    from babyrobot_levels.render.page_format import TooLargeError

    try:
        without_panels(level)
    except TooLargeError as error:
        fail(str(error), help_text)


def shown_configuration(level: brl.Level, configuration: int | None) -> int | None:
    """Return the configuration whose values are shown; None without things.

    By default it is the one in which episodes begin.
    """
    if not level.has_things or configuration is not None:
        return configuration
    from babyrobot_levels.mdp.states import initial_configuration

    return initial_configuration(level)


def solution_of(
    level: brl.Level, discount: float | None = None, actions: str = "all", within: int | None = None
) -> brl.Solution:
    """Return the solution of a level; end the command if it has none."""
    try:
        return brl.solve(level, discount, actions=actions, within=within)
    except brl.UndefinedReturnError as error:
        _end_unsolved(error)
    except brl.EpisodeTooLongError as error:
        fail(str(error))


_ALL_LINES = 1 << 30
"""More lines than any picture has: terminals scroll."""

_COLUMNS = 100
"""How long the lines of a legend are where there is no terminal."""


def text_picture(
    level: brl.Level,
    *,
    plain: bool = False,
    configuration: int | None = None,
    lost: frozenset[Cell] = frozenset(),
    all_rules: bool = False,
) -> str:
    """Return the level for standard output, and what the marks mean."""
    from babyrobot_levels.render.scene.layout import Overlay

    plain = plain or not takes_pictures()
    overlay = Overlay(lost=lost) if lost else None
    return _text(level, overlay, configuration, plain=plain, all_rules=all_rules)


def solution_text(
    level: brl.Level,
    solution: brl.Solution,
    *,
    values: bool,
    policy: bool,
    plain: bool = False,
    configuration: int | None = None,
    lost: frozenset[Cell] = frozenset(),
    all_rules: bool = False,
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
        lost: cells that are marked, as boxes can reach no target from there.
        all_rules: whether to tell all rules, however many there are.
    """
    from babyrobot_levels.analysis.shown import actions_shown, overlay_given

    number = shown_configuration(level, configuration)
    plain = plain or not takes_pictures()
    overlay = replace(
        overlay_given(level, {"values": solution}).at(number),
        values=_values(solution, number) if values and not plain else None,
        actions=actions_shown(solution, number) if policy else None,
        lost=lost,
    )
    below = ""
    if plain and values and level.size[0] <= WIDEST:
        below = "\n" + values_text(solution, number, overlay.never)
    return _text(level, overlay, number, plain=plain, below=below, all_rules=all_rules)


def values_text(
    solution: brl.Solution, configuration: int | None, never: Set[tuple[int, int]] = frozenset()
) -> str:
    """Return the values in rows and columns, with two decimals."""
    return _joined(number_lines(solution.at(configuration or 0).values.tolist(), 2, never))


def takes_pictures() -> bool:
    """Return whether standard output shows Unicode and colour."""
    return colors_of(sys.stdout) > 0 and speaks_unicode(sys.stdout)


def _values(solution: brl.Solution, configuration: int | None) -> Rows[float | None]:
    """Return the value of each cell, None where there is none."""
    rows = solution.at(configuration or 0).values.tolist()
    return [[None if math.isnan(value) else value for value in row] for row in rows]


def _text(
    level: brl.Level,
    overlay: Overlay | None,
    configuration: int | None,
    *,
    plain: bool,
    below: str = "",
    all_rules: bool = False,
) -> str:
    """Return a drawing, what is to stand below it, and its legend."""
    # The caption is a part of the legend.
    caption, drawn = "", None
    if overlay is not None:
        caption, drawn = overlay.caption, replace(overlay, caption="")
    painter, colors = TextPainter(level, plain=plain, overlay=drawn), colors_of(sys.stdout)
    by_color = not plain and _is_small(level, drawn)
    colors = 0 if plain else colors
    is_shown = sys.stdout.isatty()
    columns, height = room_of(sys.stdout) if is_shown else (_COLUMNS, _ALL_LINES)
    legend = painter.explained(
        caption=caption,
        configuration=configuration,
        colors=colors,
        columns=columns,
        most=None if all_rules else MOST,
        by_color=by_color,
    )
    if by_color:
        lines = painter.blocks(configuration=configuration, colors=colors)
    else:
        if 4 * level.size[0] + 1 <= columns:
            height = _ALL_LINES
        room = os.terminal_size((columns, max(height // 2, height - len(legend) - 3)))
        lines = painter.lines(
            None,
            configuration=configuration,
            colors=colors,
            held=False,
            room=room if is_shown and not plain else None,
        )
    return _joined(lines) + below + ("\n" + _joined(legend) if legend else "")


def _is_small(level: brl.Level, overlay: Overlay | None) -> bool:
    """Return whether a level is too wide for a terminal but as blocks of colour."""
    columns = room_of(sys.stdout).columns if sys.stdout.isatty() else sys.maxsize
    has_arrows = overlay is not None and overlay.actions is not None
    width = level.size[0]
    return 2 * width + 1 <= columns < 4 * width + 1 and not has_arrows


def _joined(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)
