"""Making a pack of a folder: check its files and write them as an archive."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.library.packs.archive import MAX_FILES, check_sizes, write_archive
from babyrobot_levels.library.packs.contents import Contents, survey
from babyrobot_levels.library.packs.format import (
    TEXTS,
    Manifest,
    PackError,
    belongs,
    clashes,
    file_entry,
    is_theme,
    path_fault,
)
from babyrobot_levels.text.diagnostics import Diagnostic, Severity
from babyrobot_levels.text.files import (
    MAX_DEPTH,
    PACK_FILE,
    NotRegularError,
    is_gallery,
    read_bytes,
)
from babyrobot_levels.text.source import MAX_BYTES, START, SourceFile

_LOCAL_SCHEMA = re.compile(rb"^#.*\$schema=(?:file:|/|~|[A-Za-z]:[/\\])", re.MULTILINE)
"""A schema line that leads to a file of this machine."""


@dataclass(frozen=True, slots=True, repr=False)
class Packed:
    """What became of a folder.

    Attributes:
        contents: what is in it.
        paths: the files that belong to the pack.
        left_out: the files that do not.
        diagnostics: all findings, by file and position.
        data: the archive, None if there are errors among the diagnostics.
        local: the files that say where something lies on this machine, in their schema line.
        path: the file of the archive, None if none was written.
    """

    __module__ = "babyrobot_levels"

    contents: Contents
    paths: list[str]
    left_out: list[str]
    diagnostics: list[Diagnostic]
    data: bytes | None = None
    local: Sequence[str] = ()
    path: Path | None = None

    def __repr__(self) -> str:
        return f"<Packed {self.path or 'nothing'}: {self.contents.summary()}>"


def pack(folder: Path, lint: Callable[[Sequence[Path]], list[Diagnostic]]) -> Packed:
    """Check a folder and, if there are no errors, make a pack's archive of it.

    Its files are all YAML files below it, and those called `README.md` or `LICENSE`; hidden files
    are left out. Findings that are no errors do not prevent the archive.

    Args:
        folder: the folder.
        lint: returns the findings in level files, such as `brl.lint`.

    Raises:
        PackError: the folder has no `pack.yaml`, or contains more than a pack may.
        OSError: the folder cannot be read.
    """
    if not os.path.lexists(folder / PACK_FILE):
        raise PackError(f"it has no {PACK_FILE}")
    paths, left_out = _paths(folder)
    unfit = list(_unfit(folder, paths))
    if unfit:
        return Packed(Contents(), paths, left_out, unfit)
    files = _read(folder, paths)
    contents = survey(folder, paths, folder)
    diagnostics = _merged(contents.diagnostics, lint(_linted(folder, paths)), paths, folder)
    fields = contents.fields
    errors = any(each.severity is Severity.ERROR for each in diagnostics)
    if fields is None or errors:
        return Packed(contents, paths, left_out, diagnostics)
    if not contents.levels and not contents.suites:
        raise PackError("it has neither levels nor suites")
    entries = {path: file_entry(data) for path, data in files.items()}
    manifest = Manifest(
        name=fields.name, version=fields.version, files=entries, levels=contents.levels
    )
    local = [path for path, data in files.items() if _LOCAL_SCHEMA.search(data)]
    return Packed(contents, paths, left_out, diagnostics, write_archive(manifest, files), local)


def _paths(folder: Path) -> tuple[list[str], list[str]]:
    """Return the files that belong to a pack, and those that do not, relative to its folder."""
    found: list[str] = []
    others: list[str] = []

    def fail(error: OSError) -> None:
        raise error

    for here, folders, names in os.walk(folder, onerror=fail):
        inside = Path(here).relative_to(folder)
        folders[:] = [name for name in folders if not name.startswith(".")]
        # Links are not followed, and must not be missed in silence.
        found += [(inside / name).as_posix() for name in folders if Path(here, name).is_symlink()]
        if len(inside.parts) == MAX_DEPTH:
            others += [f"{(inside / name).as_posix()}/" for name in folders]
            folders.clear()
        galleries = [name for name in folders if is_gallery(Path(here, name))]
        others += [f"{(inside / name).as_posix()}/" for name in galleries]
        folders[:] = [name for name in folders if name not in galleries]
        for name in names:
            if not name.startswith("."):
                (found if belongs(name) else others).append((inside / name).as_posix())
        if len(found) > MAX_FILES:
            raise PackError(f"it contains more than {MAX_FILES:,} files")
    return sorted(found), sorted(others)


def _unfit(folder: Path, paths: list[str]) -> Iterator[Diagnostic]:
    """Yield what keeps files out of a pack, whatever is in them."""
    twins = dict(clashes(paths))
    for path in paths:
        why = path_fault(path) or twins.get(path)
        if (folder / path).is_symlink():
            why = "is a link, and a pack contains only files"
        if why:
            name = str(folder / path)
            yield Diagnostic(
                "BR702",
                Severity.ERROR,
                f"this file {why}",
                name,
                1,
                1,
                START,
                help="rename it, or move it out of the pack's folder",
                source=SourceFile(name, ""),
            )


def _read(folder: Path, paths: list[str]) -> dict[str, bytes]:
    files = {}
    for path in paths:
        try:
            files[path] = read_bytes(folder / path, MAX_BYTES)
        except (IsADirectoryError, NotRegularError):
            raise PackError(f"{path!r} is not a regular file") from None
    check_sizes(files)
    return files


def _linted(folder: Path, paths: list[str]) -> list[Path]:
    """Return the levels and suites, which are linted."""
    return [
        folder / path
        for path in paths
        if path != PACK_FILE and not is_theme(path) and Path(path).name not in TEXTS
    ]


def _merged(
    errors: list[Diagnostic], linted: list[Diagnostic], paths: list[str], folder: Path
) -> list[Diagnostic]:
    """Return all that was found, each once, by file and place."""
    order: Mapping[str, int] = {str(folder / path): number for number, path in enumerate(paths)}
    return sorted(
        [*errors, *(each for each in linted if each not in errors)],
        key=lambda each: (order.get(each.file, -1), each.line, each.column, each.code),
    )
