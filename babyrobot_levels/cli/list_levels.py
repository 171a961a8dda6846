"""`babyrobot list`: the levels that have names, and the packs."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import (
    FormatOption,
    ReportFormat,
    fail,
    note,
    write_json,
    write_table,
)
from babyrobot_levels.library.catalogue import files_in, is_suite_file
from babyrobot_levels.library.packs.known import KnownPack, fields, known_packs
from babyrobot_levels.library.search_path import Place
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.language.suite_list import PackFields
    from babyrobot_levels.library.catalogue import LevelInfo


def list_levels(
    tag: Annotated[
        list[str] | None,
        typer.Option(
            metavar="TAG",
            help="Only levels with this tag; may be repeated, for levels with all of them.",
        ),
    ] = None,
    packs: Annotated[bool, typer.Option("--packs", help="List packs instead of levels.")] = False,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """List the levels that have names, or the packs.

    Levels are searched in levels/ of the current folder, in the folders of the environment
    variable BABYROBOT_LEVELS, in the gallery that comes with this package, in your own folder, and
    in packs, installed or part of Python packages. The first one of a name is used. gallery/NAME
    is always the gallery's.

    Examples:

      babyrobot list --tag maze

      babyrobot list --packs
    """
    from babyrobot_levels.library.catalogue import catalogue, suite_files
    from babyrobot_levels.library.packs.known import unusable_packs
    from babyrobot_levels.library.search_path import PATH_VARIABLE, path_folders

    if packs:
        if tag:
            fail("--tag cannot be combined with --packs", "leave out --tag")
        list_packs(report_format)
        _note_all(unusable_packs())
        return
    infos, broken = catalogue()
    wanted = set(tag or ())
    infos = [info for info in infos if wanted <= set(info.tags)]
    if report_format is ReportFormat.JSON:
        write_json([info.to_dict() for info in infos])
    elif infos:
        _write_levels(infos)
    else:
        note("no level has " + " and ".join(f"the tag {name!r}" for name in tag or ["(any)"]))

    if report_format is ReportFormat.TEXT and not tag and sys.stdout.isatty():
        # Only for people: standard error of a pipeline is for errors.
        note("suites: " + ", ".join(sorted(suite_files())))
    _note_all(
        f"{path} is left out because of errors (see `babyrobot validate {path}`)" for path in broken
    )
    _note_all(
        f"{PATH_VARIABLE} contains {folder}, which is not a readable folder"
        for folder in path_folders()
        if not folder.is_dir()
    )
    _note_all(unusable_packs())


def _note_all(problems: Iterable[str]) -> None:
    for problem in problems:
        note(one_line(problem))


def _write_levels(infos: list[LevelInfo]) -> None:
    rows = [
        (
            info.name,
            f"{info.size[0]}x{info.size[1]}",
            one_line(info.title or ""),
            ", ".join(info.tags),
            one_line(info.origin),
        )
        for info in infos
    ]
    write_table(("NAME", "SIZE", "TITLE", "TAGS", "FROM"), rows, ("TAGS", "FROM", "TITLE", "SIZE"))


@dataclass(frozen=True)
class _Row:
    """A pack, the packs of the same name that it hides, its `pack.yaml`, and its counts."""

    pack: KnownPack
    hides: Sequence[KnownPack]
    fields: PackFields | None
    levels: int
    suites: int

    def to_dict(self) -> dict[str, Any]:
        """Return the row as plain data."""
        texts = ("version", "description", "author", "license", "source")
        return {
            "name": self.pack.name,
            **{name: self.fields and getattr(self.fields, name) for name in texts},
            "levels": self.levels,
            "suites": self.suites,
            **_source(self.pack),
            "hides": [_source(hidden) for hidden in self.hides],
        }

    def cells(self) -> tuple[str, ...]:
        """Return the row as cells of the table."""
        version, description = (
            (self.fields.version, self.fields.description) if self.fields else ("", "")
        )
        counts = (str(self.levels), str(self.suites))
        cells = (self.pack.name, version or "-", *counts, self.pack.origin, description)
        return tuple(map(one_line, cells))


def list_packs(report_format: ReportFormat) -> None:
    """Write the packs, and note which of them are hidden by another one of the same name."""
    named: dict[str, list[KnownPack]] = {}
    for pack in known_packs():
        named.setdefault(pack.name, []).append(pack)
    rows = [_row(*named[name]) for name in sorted(named)]
    if report_format is ReportFormat.JSON:
        write_json([row.to_dict() for row in rows])
    elif rows:
        heading = ("NAME", "VERSION", "LEVELS", "SUITES", "FROM", "DESCRIPTION")
        write_table(heading, [row.cells() for row in rows], ("DESCRIPTION", "FROM"))
    else:
        note("no packs are installed (see `babyrobot install`)")
    for row in rows:
        for hidden in row.hides:
            name, front, behind = row.pack.name, row.pack.origin, hidden.origin
            note(one_line(f"{name} ({behind}) is hidden by {name} ({front})"))


def _row(pack: KnownPack, *hides: KnownPack) -> _Row:
    suites: set[str] = set()
    levels: set[str] = set()
    for file in files_in(Place(pack.folder)):
        (suites if is_suite_file(file.path) else levels).add(file.name)
    return _Row(pack, hides, fields(pack.folder), len(levels), len(suites))


def _source(pack: KnownPack) -> dict[str, str]:
    return {"from": pack.origin, "folder": str(pack.folder)}
