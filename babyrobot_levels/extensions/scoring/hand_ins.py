"""What players hand in: plays in files, folders and zip files, as school systems export them.

Everything is read within bounds, those of each player for themselves, and no file is written. What
is wrong with a file is told, and the others are read all the same.
"""

import errno
import io
import os
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial
from lzma import LZMAError
from pathlib import Path, PurePosixPath
from typing import IO, NamedTuple

from babyrobot_levels.agents.plays import MAX_BYTES, SUFFIX, Play, plays_in
from babyrobot_levels.language.play import PlayError
from babyrobot_levels.text.files import is_within, open_regular, open_zip
from babyrobot_levels.text.words import listed

ZIP = ".zip"

MAX_NAMES = 100_000
"""The most files of a player that are looked at."""

MAX_FILES = 1_000
"""The most files of a player that are read."""

MAX_TOTAL = 256 << 20
"""The most bytes of a player that are read; packed ones count when they are unpacked."""

MAX_STEPS = 1_000_000
"""The most steps that are graded, of all plays of a player."""

_BROKEN = (zipfile.BadZipFile, zlib.error, LZMAError, struct.error, NotImplementedError,
           RuntimeError, EOFError, ValueError, OSError)  # fmt: skip
"""What reading a damaged or an encrypted zip file raises."""

_ASIDE = re.compile(r"/$|(^|/)(__MACOSX/|\.[^./][^/]*$)")
"""Folders, and what computers put beside files."""

_EXPORTED = re.compile(
    r"((?:.*-)?participant_\d+|.+?)(?:_(\d+))?_assignsubmission_.*"
    r"|(anon_[^_]+)(?:_late)?_\d+_.*|(.+?)(?:_late)?_(\d+)_\d+_.*"
    r"|\d+-\d+ - (.+?) ?- [^-]{1,30} [AP]M",
    re.IGNORECASE,
)
"""What Moodle, Canvas and Brightspace make of a student's name, and of the number, if they do."""


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
        steps: the number of steps of all plays.
    """

    player: str
    entries: list[Entry] = field(default_factory=list)
    faults: list[tuple[str, str]] = field(default_factory=list)
    steps: int = 0


def words_of(name: str) -> frozenset[str]:
    """Return the words of a name, or of a file's, without case and what is in parentheses."""
    return frozenset(re.findall(r"[^\W_]+", re.sub(r"\([^()]*\)", "", name.casefold())))


def hand_ins(paths: Iterable[str | os.PathLike[str]]) -> list[HandIn]:
    """Return what is handed in, by player, in the order of the first file of each.

    A folder, and a zip file, may have a folder or a zip file for each player, or files of all. A
    file is of the player that its plays name, if the name of the file has that name, too; else the
    name of the file stands for the player. Two students of one name are a fault.

    Raises:
        FileNotFoundError: there is nothing at a path.
    """
    places = [*map(Path, paths)]
    for path in places:
        if not os.path.lexists(path):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    found: dict[str, HandIn] = {}
    students: dict[tuple[Path, str], set[str]] = {}
    for path in places:
        for unit, place, data in _files(path):
            plays, fault = [], data if isinstance(data, str) else None
            if isinstance(data, bytes):
                try:
                    plays = plays_in(io.BytesIO(data), "")
                except PlayError as error:
                    fault = re.sub(r"^:(?:(\d+):)? ", lambda at: f"line {at[1]}: " if at[1] else "",
                                   str(error))  # fmt: skip
            exported = _EXPORTED.fullmatch(unit)
            player, *ids = filter(None, exported.groups()) if exported else [unit]
            claims = {play.player for play in plays}
            claim = claims.pop() if len(claims) == 1 else None
            if place == "" and claim and frozenset() < words_of(claim) <= words_of(player):
                player = claim
            hand_in = found.setdefault(player, HandIn(player))
            students.setdefault((path, player), set()).update(ids)
            at = f"{place}, " if place else ""
            for number, play in enumerate(plays, 1):
                hand_in.steps += play.steps
                if hand_in.steps > MAX_STEPS:
                    fault = (
                        f"more than {MAX_STEPS:,} steps: from line {number} on, it is not graded"
                    )
                    break
                hand_in.entries.append(Entry(f"{at}line {number}", play))
            if fault is not None:
                hand_in.faults.append((place, fault))
    for (_, player), several in students.items():
        if len(several) > 1:
            told = f"students {listed(sorted(several))} have the same name: give them two"
            found[player].faults.append(("", told))
    return list(found.values())


class _Budget:
    """How much of a player may still be read."""

    def __init__(self) -> None:
        self.names, self.files, self.bytes = MAX_NAMES, MAX_FILES, MAX_TOTAL

    def read(self, file: IO[bytes]) -> bytes | str:
        """Return what is in a file, or why it is not read."""
        self.files -= 1
        if self.files < 0:
            return f"it is not read: these are more than {MAX_FILES:,} files"
        if self.bytes <= 0:
            return f"it is not read: the files have more than {MAX_TOTAL >> 20} MiB together"
        data = file.read(min(MAX_BYTES, self.bytes) + 1)
        self.bytes -= len(data)
        return data if len(data) <= MAX_BYTES else f"it is larger than {MAX_BYTES >> 20} MiB"


_Read = Callable[[_Budget], bytes | str]
"""Returns what is in a file, or why it is not read."""

_File = tuple[str, str, bytes | str]
"""A file: whose it is, its path there (empty for one of its own), what is in it, or its fault."""


def _files(path: Path) -> Iterator[_File]:
    """Yield the files of plays of a path, and who has none."""
    if path.is_dir():
        yield from _sorted_out(_in_folder(path), None, path.name)
    elif path.suffix.lower() != ZIP:
        yield path.stem, "", _read_file(path, _Budget())
    else:
        try:
            with open_regular(path) as file:
                yield from _zipped(file, None, path.name)
        except OSError as error:
            yield path.stem, "", error.strerror or str(error)


def _sorted_out(
    files: Iterable[tuple[PurePosixPath, _Read]],
    owner: str | None,
    place: str,
    budget: _Budget | None = None,
) -> Iterator[_File]:
    """Yield the files of one player, or without an `owner` of a class, and who has none.

    Args:
        files: all files with their paths.
        owner: the player.
        place: where the files are.
        budget: how much of the owner may still be read.
    """
    units: dict[str, bool] = {}
    budgets: dict[str, _Budget] = {}
    for path, read in files:
        is_own = owner is None and len(path.parts) == 1
        unit = owner or (path.stem if is_own else path.parts[0])
        left = budget or budgets.setdefault(unit, _Budget())
        left.names -= 1
        if left.names < 0:
            if left.names == -1:
                yield unit, "", f"more than {MAX_NAMES:,} files: the rest is not read"
            continue
        if path.suffix.lower() not in (SUFFIX, ZIP):
            if not is_own:
                units.setdefault(unit, False)
            continue
        units[unit] = True
        inner = "" if is_own else str(path if owner else PurePosixPath(*path.parts[1:]))
        where = f"{place}/{inner}" if owner else inner
        data = read(left)
        if path.suffix.lower() == SUFFIX or isinstance(data, str):
            yield unit, where, data
        elif owner:
            yield unit, where, "a zip file in the zip file of a player is not read"
        else:
            yield from _zipped(io.BytesIO(data), unit, where or path.name, left)
    for unit in (each for each in units or {owner or place: False} if not units.get(each)):
        yield unit, "", f"there is no file of plays ({SUFFIX})"


def _in_folder(folder: Path) -> Iterator[tuple[PurePosixPath, _Read]]:
    """Yield the files in a folder, and the folders in it, which are no files of plays."""
    for place, folders, names in os.walk(folder):
        folders.sort()
        inner = PurePosixPath(Path(place).relative_to(folder).as_posix())
        if inner.parts:
            yield inner / "(folder)", _refuse_link
        for name in sorted(names):
            path = Path(place, name)
            yield (
                inner / name,
                partial(_read_file, path) if is_within(path, folder) else _refuse_link,
            )


def _refuse_link(_: _Budget) -> str:
    return "it is a link out of the folder"


def _read_file(path: Path, budget: _Budget) -> bytes | str:
    try:
        with open_regular(path) as file:
            return budget.read(file)
    except OSError as error:
        return error.strerror or str(error)


def _zipped(
    file: IO[bytes], owner: str | None, place: str, budget: _Budget | None = None
) -> Iterator[_File]:
    """Yield the files in a zip file, as `_sorted_out` does."""
    try:
        archive = open_zip(file)
    except _BROKEN as error:
        yield owner or place, place if owner else "", f"the zip file is damaged ({error})"
        return
    members = [each for each in archive.infolist() if not _ASIDE.search(each.filename)]
    paths = [PurePosixPath(each.filename.replace("\\", "/")) for each in members]
    # A folder around the folders of all players is none of a player.
    tops, next_ones = ({path.parts[:n] for path in paths} for n in (1, 2))
    skip = owner is None and len(tops) == 1 < len(next_ones)
    skip = skip and all(len(path.parts) > 2 for path in paths)

    def read(member: zipfile.ZipInfo, path: PurePosixPath, budget: _Budget) -> bytes | str:
        if ".." in path.parts or path.is_absolute():
            return f"its path {path} leaves the zip file"
        try:
            with archive.open(member) as unpacked:
                return budget.read(unpacked)
        except _BROKEN as error:
            return f"it cannot be unpacked ({error})"

    files = (
        (PurePosixPath(*path.parts[int(skip) :]), partial(read, member, path))
        for member, path in zip(members, paths, strict=True)
    )
    yield from _sorted_out(files, owner, place if owner else Path(place).stem, budget)
