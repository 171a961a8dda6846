"""`babyrobot show`: all about one level."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import ReportFormat, wants_color, write
from babyrobot_levels.cli.preview import LevelArgument

if TYPE_CHECKING:
    from babyrobot_levels.level import Level


def show(
    level: LevelArgument,
    report_format: Annotated[
        ReportFormat, typer.Option("--format", help="How to report.")
    ] = ReportFormat.TEXT,
) -> None:
    """Tell all about one level: what it is, its numbers, its digest, and its drawing.

    Examples:

      babyrobot show final-maze
    """
    from babyrobot_levels.catalogue import load

    loaded = load(level)
    facts = _facts(loaded)
    if report_format is ReportFormat.JSON:
        write(json.dumps(facts, indent=2, ensure_ascii=False) + "\n")
        return
    drawing = facts.pop("drawing")
    width = max(map(len, facts))
    bold = wants_color(sys.stdout)
    for name, value in facts.items():
        label = f"{name}:".ljust(width + 1)
        text = _told(value)
        if text:
            shown = f"\x1b[1m{label}\x1b[0m" if bold else label
            write(f"{shown} " + text.replace("\n", "\n" + " " * (width + 2)) + "\n")
    if drawing:
        write("\n" + drawing)


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
        "theme": level.theme if isinstance(level.theme, str) else "its own",
    }
    if level.has_random_maze:
        return {**facts, "maze": "another one at each reset", "digest": None, "drawing": None}
    mdp = level.compile()
    facts["states"] = int((~level.grid().blocked).sum())
    facts["outcomes"] = int((mdp.probability > 0).sum())
    facts["chance"] = bool((mdp.probability[~mdp.over] > 0).sum(axis=2).max(initial=0) > 1)
    return {**facts, "digest": level.digest, "drawing": level.draw()}


def _told(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list) and value and isinstance(value[0], list):
        return ", ".join(f"[{x}, {y}]" for x, y in value)
    if isinstance(value, list) and value and isinstance(value[0], int):
        return f"{value[0]} x {value[1]}"
    if isinstance(value, list):
        return ", ".join(value)
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return "" if value is None else str(value)
