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
    table,
    write,
    write_json,
)
from babyrobot_levels.library.catalogue import files_in, is_suite_file
from babyrobot_levels.library.packs.installed import fields
from babyrobot_levels.library.packs.known import KnownPack, known_packs
from babyrobot_levels.library.search_path import Place
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.language.pack import PackFields
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


@dataclass(frozen=True)
class _Row:
    """A pack, those of its name that it hides, what its `pack.yaml` says, and what it holds."""

    pack: KnownPack
    hides: Sequence[KnownPack]
    said: PackFields | None
    levels: int
    suites: int

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        texts = ("version", "description", "author", "license", "source")
        return {
            "name": self.pack.name,
            **{name: self.said and getattr(self.said, name) for name in texts},
            "levels": self.levels,
            "suites": self.suites,
            **_whence(self.pack),
            "hides": [_whence(hidden) for hidden in self.hides],
        }

    def cells(self) -> tuple[str, ...]:
        """Return it as a row of the table."""
        version, description = (self.said.version, self.said.description) if self.said else ("", "")
        counts = (str(self.levels), str(self.suites))
        cells = (self.pack.name, version or "-", *counts, self.pack.origin, description)
        return tuple(map(one_line, cells))


def list_packs(report_format: ReportFormat) -> None:
    """Write which packs there are, and note which of them are hidden by another of their name."""
    named: dict[str, list[KnownPack]] = {}
    for pack in known_packs():
        named.setdefault(pack.name, []).append(pack)
    rows = [_row(*named[name]) for name in sorted(named)]
    if report_format is ReportFormat.JSON:
        write_json([row.to_dict() for row in rows])
    elif rows:
        heading = ("NAME", "VERSION", "LEVELS", "SUITES", "FROM", "DESCRIPTION")
        write(table([heading, *(row.cells() for row in rows)]))
    else:
        note("there are no packs (`babyrobot install FILE` installs one)")
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


def _whence(pack: KnownPack) -> dict[str, str]:
    return {"from": pack.origin, "folder": str(pack.folder)}
