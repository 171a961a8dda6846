"""`babyrobot list --packs`: the packs, and where they are from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from babyrobot_levels.cli.console import ReportFormat, note, write, write_json
from babyrobot_levels.cli.table import table
from babyrobot_levels.library.catalogue import files_in, is_suite_file
from babyrobot_levels.library.packs.installed import fields
from babyrobot_levels.library.packs.known import KnownPack, known_packs
from babyrobot_levels.library.search_path import Place
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.language.pack import PackFields


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
