"""`babyrobot list`: the catalogue."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import (
    FormatOption,
    ReportFormat,
    note,
    wants_color,
    write,
    write_json,
)
from babyrobot_levels.diagnostics import one_line
from babyrobot_levels.source import columns

if TYPE_CHECKING:
    from babyrobot_levels.catalogue import LevelInfo


def list_levels(
    tag: Annotated[
        list[str] | None,
        typer.Option(metavar="TAG", help="Only levels with this tag; may be repeated."),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """List the levels that can be loaded by name.

    They are looked for in the gallery, in the user's own folder, in levels/ of the current folder,
    in the folders of the variable BABYROBOT_LEVELS, and in installed packs.

    Examples:

      babyrobot list --tag maze
    """
    from babyrobot_levels.catalogue import catalogue, suite_files

    infos, broken = catalogue()
    wanted = set(tag or ())
    infos = [info for info in infos if wanted <= set(info.tags)]
    if report_format is ReportFormat.JSON:
        write_json([info.to_dict() for info in infos])
    elif infos:
        write(_table(infos, bold=wants_color(sys.stdout)))
    else:
        note("no level has " + " and ".join(f"the tag {name!r}" for name in tag or ["(any)"]))
    if report_format is ReportFormat.TEXT and not tag and sys.stdout.isatty():
        # For people: in a pipe it would stand among what went wrong.
        note("suites: " + ", ".join(sorted(suite_files())))
    for path in map(one_line, map(str, broken)):
        note(f"{path} has errors and is left out (`babyrobot validate {path}` shows them)")


def _table(infos: list[LevelInfo], *, bold: bool) -> str:
    rows = [("NAME", "SIZE", "TITLE", "TAGS")]
    rows += [
        (
            info.name,
            f"{info.size[0]}x{info.size[1]}",
            one_line(info.title or ""),
            ", ".join(info.tags),
        )
        for info in infos
    ]
    widths = [max(columns(row[number]) for row in rows) for number in range(3)]
    lines = []
    for *cells, tags in rows:
        padded = [
            text + " " * (width - columns(text)) for text, width in zip(cells, widths, strict=True)
        ]
        lines.append("  ".join([*padded, tags]).rstrip())
    if bold:
        lines[0] = f"\x1b[1m{lines[0]}\x1b[0m"
    return "\n".join(lines) + "\n"
