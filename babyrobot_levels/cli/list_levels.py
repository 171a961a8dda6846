"""`babyrobot list`: the catalogue."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import (
    FormatOption,
    ReportFormat,
    fail,
    note,
    write,
    write_json,
)
from babyrobot_levels.cli.table import table
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.library.catalogue import LevelInfo


def list_levels(
    tag: Annotated[
        list[str] | None,
        typer.Option(metavar="TAG", help="Only levels with this tag; may be repeated."),
    ] = None,
    packs: Annotated[
        bool, typer.Option("--packs", help="List packs, and where they are from.")
    ] = False,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """List the levels that can be loaded by name, or the packs.

    Levels are looked for in the gallery, in the user's own folder, in levels/ of the current
    folder, in the folders of the variable BABYROBOT_LEVELS, in installed packs and in packs that
    Python packages carry.

    Examples:

      babyrobot list --tag maze

      babyrobot list --packs
    """
    from babyrobot_levels.library.catalogue import catalogue, suite_files
    from babyrobot_levels.library.packs.known import unusable_packs
    from babyrobot_levels.library.search_path import PATH_VARIABLE, path_folders

    if packs:
        from babyrobot_levels.cli.list_packs import list_packs

        if tag:
            fail("--tag is for levels; packs have no tags")
        list_packs(report_format)
        _tell_of(unusable_packs())
        return
    infos, broken = catalogue()
    wanted = set(tag or ())
    infos = [info for info in infos if wanted <= set(info.tags)]
    if report_format is ReportFormat.JSON:
        write_json([info.to_dict() for info in infos])
    elif infos:
        write(_table(infos))
    else:
        note("no level has " + " and ".join(f"the tag {name!r}" for name in tag or ["(any)"]))
    if report_format is ReportFormat.TEXT and not tag and sys.stdout.isatty():
        # For people: in a pipe it would stand among what went wrong.
        note("suites: " + ", ".join(sorted(suite_files())))
    _tell_of(
        f"{path} has errors and is left out (`babyrobot validate {path}` shows them)"
        for path in broken
    )
    _tell_of(
        f"{PATH_VARIABLE} names {folder}, which is no folder that can be read"
        for folder in path_folders()
        if not folder.is_dir()
    )
    _tell_of(unusable_packs())


def _tell_of(faults: Iterable[str]) -> None:
    for fault in faults:
        note(one_line(fault))


def _table(infos: list[LevelInfo]) -> str:
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
    return table(rows)
