"""Making a pack of a folder: looked through as `lint` does, and written as an archive."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
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
from babyrobot_levels.lint.across import likeness, same_games
from babyrobot_levels.lint.runner import lint_file
from babyrobot_levels.lint.settings import settings_for
from babyrobot_levels.text.diagnostics import Diagnostic, Severity
from babyrobot_levels.text.files import MAX_DEPTH, PACK_FILE, NotRegularError, read_bytes
from babyrobot_levels.text.source import MAX_BYTES, START, SourceFile

_LOCAL_SCHEMA = re.compile(rb"^#.*\$schema=(?:file:|/|~|[A-Za-z]:[/\\])", re.MULTILINE)
"""A schema line that leads to a file of this machine."""


@dataclass(frozen=True, slots=True)
class Packed:
    """What became of a folder.

    Attributes:
        contents: what is in it.
        paths: the files that belong to the pack.
        left_out: the files that do not.
        diagnostics: everything that is to be mended before there is an archive, by file and place.
        data: the archive, None while there are diagnostics.
        local: the files that say where something lies on this machine, in their schema line.
    """

    contents: Contents
    paths: list[str]
    left_out: list[str]
    diagnostics: list[Diagnostic]
    data: bytes | None = None
    local: Sequence[str] = ()


def pack(folder: Path) -> Packed:
    """Check a folder, and if all is well, make a pack's archive of it.

    Its files are all YAML files below it, and those called `README.md` or `LICENSE`; hidden ones
    do not count. What the rules find counts as much as an error, under the settings that
    `babyrobot lint` has there.

    Raises:
        PackError: it has no `pack.yaml`, or more in it than a pack may have.
        SettingsError: the settings for linting are faulty.
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
    diagnostics = _merged(contents.diagnostics, _linted(folder, paths), paths, folder)
    fields = contents.fields
    if fields is None or diagnostics:
        return Packed(contents, paths, left_out, diagnostics)
    if not contents.levels and not contents.suites:
        raise PackError("it has neither levels nor suites")
    entries = {path: file_entry(data) for path, data in files.items()}
    manifest = Manifest(
        name=fields.name, version=fields.version, files=entries, levels=contents.levels
    )
    local = [path for path, data in files.items() if _LOCAL_SCHEMA.search(data)]
    return Packed(contents, paths, left_out, [], write_archive(manifest, files), local)


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


def _linted(folder: Path, paths: list[str]) -> list[Diagnostic]:
    """Return what linting finds in the levels and suites."""
    found = []
    texts: dict[Path, tuple[SourceFile, int]] = {}
    for path in paths:
        place = folder / path
        if path == PACK_FILE or is_theme(path) or place.name in TEXTS:
            continue
        report = lint_file(place, settings_for(place).rules_for(place))
        found += report.diagnostics
        if report.source and report.level and not report.level.has_random_maze:
            texts[place] = report.source, likeness(report.level)
    return [*found, *same_games(texts, lambda place: settings_for(place).rules_for(place)).values()]


def _merged(
    errors: list[Diagnostic], linted: list[Diagnostic], paths: list[str], folder: Path
) -> list[Diagnostic]:
    """Return all that was found, each once, by file and place."""
    order: Mapping[str, int] = {str(folder / path): number for number, path in enumerate(paths)}
    return sorted(
        [*errors, *(each for each in linted if each not in errors)],
        key=lambda each: (order.get(each.file, -1), each.line, each.column, each.code),
    )
