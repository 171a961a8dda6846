"""What players hand in: plays in files, folders and zip files, as school systems export them.

Everything is read within bounds, and no file is written. What is wrong with a file is told, and
the others are read all the same.
"""

from __future__ import annotations

import io
import os
import re
import struct
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from lzma import LZMAError
from pathlib import Path, PurePosixPath
from typing import IO, NamedTuple

from babyrobot_levels.language.play import PlayError
from babyrobot_levels.scoring.plays import MAX_BYTES, SUFFIX, Play, plays_in
from babyrobot_levels.text.files import is_within, open_regular, read_bytes

ZIP = ".zip"

MAX_FILES = 100_000
"""The most files that are looked at, in all."""

MAX_TOTAL = 1 << 30
"""The most bytes that are read, in all; packed ones count when they are unpacked."""

_BROKEN = (zipfile.BadZipFile, zlib.error, LZMAError, struct.error, NotImplementedError,
           RuntimeError, EOFError, ValueError, OSError)  # fmt: skip
"""What reading a damaged or an encrypted zip file raises."""

_ASIDE = re.compile(r"/$|(^|/)(__MACOSX/|\.[^./][^/]*$)")
"""Folders, and what computers put beside files."""

_EXPORTED = re.compile(r"_\d+_assignsubmission_.*$|(_late)?_\d+_\d+_.*$", re.IGNORECASE)
"""What Moodle puts behind a student's name, and Canvas."""


class Entry(NamedTuple):
    """A play, and where it stands: the file, as it is told, and the line."""

    place: str
    play: Play


@dataclass(eq=False)
class HandIn:
    """What a player handed in.

    Attributes:
        player: the player.
        entries: the plays.
        faults: what is wrong with files, each with the place.
    """

    player: str
    entries: list[Entry] = field(default_factory=list)
    faults: list[tuple[str, str]] = field(default_factory=list)


def words_of(name: str) -> frozenset[str]:
    """Return the words of a name, or of a file's name, without their case."""
    return frozenset(re.findall(r"[^\W_]+", name.casefold()))


def hand_ins(paths: Iterable[str | os.PathLike[str]]) -> list[HandIn]:
    """Return what is handed in, by player, in the order of the first file of each.

    A folder, and a zip file, may have a folder or a zip file for each player, or files of all. A
    file is of the player that its plays name, if the name of the file has that name, too; else the
    name of the file stands for the player.
    """
    budget = _Budget()
    found: dict[str, HandIn] = {}
    for path in map(Path, paths):
        for unit, place, data in _files(path, budget):
            plays, fault = [], data if isinstance(data, str) else None
            if isinstance(data, bytes):
                try:
                    plays = plays_in(io.BytesIO(data), "")
                except PlayError as error:
                    fault = re.sub(r"^:(?:(\d+):)? ", lambda at: f"line {at[1]}: " if at[1] else "",
                                   str(error))  # fmt: skip
            player = _EXPORTED.sub("", unit)
            claims = {play.player for play in plays}
            claim = claims.pop() if len(claims) == 1 else None
            if place == "" and claim and words_of(claim) <= words_of(player):
                player = claim
            hand_in = found.setdefault(player, HandIn(player))
            at = f"{place}, " if place else ""
            hand_in.entries += [Entry(f"{at}line {n}", play) for n, play in enumerate(plays, 1)]
            if fault is not None:
                hand_in.faults.append((place, fault))
    return list(found.values())


class _Budget:
    """How much may still be read."""

    def __init__(self) -> None:
        self.files, self.bytes = MAX_FILES, MAX_TOTAL

    def read(self, file: IO[bytes]) -> bytes | str:
        """Return what is in a file, or why it is not read."""
        if self.bytes <= 0:
            return f"it is not read: all files together have more than {MAX_TOTAL >> 20} MiB"
        data = file.read(min(MAX_BYTES, self.bytes) + 1)
        self.bytes -= len(data)
        if len(data) > MAX_BYTES:
            return f"the file is larger than {MAX_BYTES >> 20} MiB"
        return data


_File = tuple[str, str, bytes | str]
"""A file: whose it is, its path there (empty for one of its own), what is in it, or its fault."""


def _files(path: Path, budget: _Budget) -> Iterator[_File]:
    """Yield the files of plays of a path, and who has none."""
    units: dict[str, bool] = {}
    for unit, place, data in _found(path, budget, units):
        units[unit] = True
        yield unit, place, data
    if not units:
        units[path.stem] = False
    for unit, has_files in units.items():
        if not has_files:
            yield unit, "", f"there is no file of plays ({SUFFIX})"


def _found(path: Path, budget: _Budget, units: dict[str, bool]) -> Iterator[_File]:
    """Yield the files of a path; whose folders there are is added to `units`."""
    if not path.is_dir():
        if path.suffix.lower() != ZIP:
            yield path.stem, "", _bytes_of(path, budget)
            return
        try:
            with open_regular(path) as opened:
                yield from _zipped(opened, None, path.name, budget, units)
        except OSError as error:
            yield path.stem, "", error.strerror or str(error)
        return
    for folder, folders, names in os.walk(path):
        folders.sort()
        inner = Path(folder).relative_to(path)
        if folder == str(path):
            units.update(dict.fromkeys(folders, False))
        for name in sorted(names):
            budget.files -= 1
            if budget.files < 0:
                yield path.name, str(inner / name), f"more than {MAX_FILES:,} files: it is not read"
                return
            file, suffix = inner / name, Path(name).suffix.lower()
            if suffix not in (SUFFIX, ZIP):
                continue
            own = len(file.parts) == 1
            unit = file.stem if own else file.parts[0]
            place = "" if own else str(file.relative_to(unit))
            if not is_within(path / file, path):
                yield unit, place, "it is a link out of the folder"
                continue
            data = _bytes_of(path / file, budget)
            if suffix == ZIP and isinstance(data, bytes):
                yield from _zipped(io.BytesIO(data), unit, place or name, budget, {})
            else:
                yield unit, place, data


def _bytes_of(path: Path, budget: _Budget) -> bytes | str:
    try:
        return budget.read(io.BytesIO(read_bytes(path, MAX_BYTES)))
    except OSError as error:
        return error.strerror or str(error)


def _zipped(
    file: IO[bytes], owner: str | None, place: str, budget: _Budget, units: dict[str, bool]
) -> Iterator[_File]:
    """Yield the files in a zip file: of one player, or without an `owner` of a class."""
    outer = owner if owner is not None else Path(place).stem
    try:
        archive = zipfile.ZipFile(file)
        members = [each for each in archive.infolist() if not _ASIDE.search(each.filename)]
    except _BROKEN as error:
        yield outer, place, f"the zip file is damaged ({error})"
        return
    paths = [PurePosixPath(each.filename.replace("\\", "/")) for each in members]
    tops = {path.parts[:1] for path in paths}
    # A folder around the folders of all players is none of a player.
    skip = owner is None and len(tops) == 1 and len({path.parts[1:2] for path in paths}) > 1
    skip = skip and all(len(path.parts) > 2 for path in paths)
    if owner is None:
        units.update((path.parts[skip], False) for path in paths if len(path.parts) > skip + 1)
    for member, path in zip(members, paths, strict=True):
        budget.files -= 1
        if budget.files < 0:
            yield outer, place, f"more than {MAX_FILES:,} files: the rest is not read"
            return
        suffix, parts = path.suffix.lower(), path.parts[int(skip) :]
        if suffix not in (SUFFIX, ZIP):
            continue
        if ".." in parts or path.is_absolute() or ":" in parts[0]:
            yield outer, f"{place}/{path}", "its path leaves the zip file"
            continue
        own = owner is None and len(parts) == 1
        unit = owner if owner is not None else path.stem if own else parts[0]
        inner = "" if own else "/".join(parts if owner is not None else parts[1:])
        where = f"{place}/{inner}" if owner is not None else inner
        try:
            with archive.open(member) as unpacked:
                content = budget.read(unpacked)
        except _BROKEN as error:
            yield unit, where, f"it cannot be unpacked ({error})"
            continue
        if suffix == ZIP and isinstance(content, bytes):
            if owner is not None:
                yield unit, where, "a zip file in the zip file of a player is not read"
            else:
                yield from _zipped(io.BytesIO(content), unit, where or path.name, budget, {})
        else:
            yield unit, where, content
