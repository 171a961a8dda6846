"""`babyrobot show`: all about one level."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.cite import cite
from babyrobot_levels.cli.console import (
    FormatOption,
    ReportFormat,
    note,
    wants_color,
    write,
    write_json,
)
from babyrobot_levels.cli.preview import LevelArgument, load_level, text_picture
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level


def show(
    level: LevelArgument,
    citation: Annotated[
        bool,
        typer.Option("--cite", help="Print one line for a paper: name, versions and digest."),
    ] = False,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Tell all about one level: its texts, numbers, digest, metrics and drawing.

    The metrics are what `brl.metrics` tells in Python. Levels of more than 5,000 cells are not
    solved for them.

    Examples:

      babyrobot show final-maze

      babyrobot show final-maze --format json

      babyrobot show final-maze --cite
    """
    loaded = load_level(level)
    if citation:
        cite(loaded, level, as_json=report_format is ReportFormat.JSON)
        return
    facts = _facts(loaded)
    if report_format is ReportFormat.JSON:
        write_json({**facts, "drawing": None if loaded.has_random_maze else loaded.draw()})
        return
    facts |= facts.pop("metrics") or {}
    width = max(map(len, facts))
    bold = wants_color(sys.stdout)
    for name, value in facts.items():
        label = f"{name}:".ljust(width + 1)
        text = printable(_told(value))
        if text:
            shown = f"\x1b[1m{label}\x1b[0m" if bold else label
            write(f"{shown} " + text.replace("\n", "\n" + " " * (width + 2)) + "\n")
    if loaded.has_random_maze:
        note("each reset grows another maze; `babyrobot preview` shows one of them")
    else:
        write("\n" + text_picture(loaded))


def _facts(level: Level) -> dict[str, Any]:
    """Return what there is to tell, in the order in which it is told."""
    facts: dict[str, Any] = {
        "name": level.name,
        "title": level.title,
        "description": level.description.strip() if level.description else None,
        "author": level.author,
        "license": level.license,
        "source": level.source,
        "tags": list(level.tags),
        "size": list(level.size),
        "starts": [list(cell) for cell in level.starts],
        "exits": [list(cell) for cell in level.exits],
        "max_steps": level.max_steps,
        "discount": level.discount,
        "theme": level.theme if isinstance(level.theme, str) else None,
        "random_maze": level.has_random_maze,
        "states": None,
        "outcomes": None,
        "chance": None,
        "digest": None,
        "metrics": None,
    }
    if not level.has_random_maze:
        mdp = level.compile()
        happens = mdp.probability > 0
        facts["states"] = int((~level.grid().blocked).sum())
        facts["outcomes"] = int(happens.sum())
        facts["chance"] = bool(happens[~mdp.is_terminal].sum(axis=2).max(initial=0) > 1)
        facts["digest"] = level.digest
        facts["metrics"] = _metrics(level)
    return facts


def _metrics(level: Level) -> dict[str, Any]:
    """Return the metrics as JSON can hold them: texts for inf, null for what cannot be told."""
    from babyrobot_levels.analysis.metrics import metrics
    from babyrobot_levels.lint.optimal_policy import MAX_SOLVED

    found = metrics(level)
    numbers = found.to_dict(solve=found.cells <= MAX_SOLVED)
    return {name: _number(value) for name, value in numbers.items()}


def _number(value: float | None) -> float | str | None:
    if not isinstance(value, float):
        return value
    # Nine digits are the same on every platform, all of them are not.
    return float(f"{value:.9g}") if math.isfinite(value) else str(value)


def _told(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list) and value and isinstance(value[0], list):
        return ", ".join(f"[{x}, {y}]" for x, y in value)
    if isinstance(value, list) and value and isinstance(value[0], int):
        return f"{value[0]} x {value[1]}"
    if isinstance(value, list):
        return ", ".join(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    return "" if value is None else str(value)
