"""What players hand in, in files, folders and zip files, as school systems export them.

Everything is read within bounds, those of each player for themselves, and no file is written. What
is wrong with a file is told, and the others are read all the same.
"""

import codecs
import errno
import io
import os
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from lzma import LZMAError
from pathlib import Path, PurePosixPath
from typing import IO, NamedTuple

from babyrobot_levels.agents.plays import MAX_BYTES, SUFFIX, Play, plays_in
from babyrobot_levels.language.play import PlayError
from babyrobot_levels.text.files import is_environment, is_within, open_regular, open_zip
from babyrobot_levels.text.words import listed

ZIP = ".zip"

CODE = (".py", ".ipynb", ".json", ".npy", ".npz")
"""Files of code, and of answers."""

MAX_NAMES = 100_000
"""The most files of a player that are looked at."""

MAX_FILES = 1_000
"""The most files of a player that are read."""

MAX_TOTAL = 256 << 20
"""The most bytes of a player that are read; packed ones count when they are unpacked."""

MAX_STEPS = 1_000_000
"""The most steps that are graded, of all plays of a player."""

MAX_KEPT = 32 << 20
"""The most bytes of code and answers of a player."""

MAX_NOTES = 10
"""The most notes of a player that are told."""

METADATA = "submission_metadata.yml"
"""In which Gradescope tells who handed in what."""

_FOLDER = "(folder)"
"""The name that stands for a folder among its files."""

_BROKEN = (zipfile.BadZipFile, zlib.error, LZMAError, struct.error, NotImplementedError,
           RuntimeError, EOFError, ValueError, OSError)  # fmt: skip
"""What reading a damaged or an encrypted zip file raises."""

_ASIDE = re.compile(r"/$|(^|/)(__MACOSX/|\.[^./][^/]*$)")
"""Folders, and what computers put beside files."""

_EXPORTED = re.compile(
    r"(?P<moodle>(?:.*-)?participant_\d+|.+?)(?:_(?P<m>\d+))?_assignsubmission_[^_]*_?(?P<mf>.*)"
    r"|(?P<hidden>anon_[^_]+)(?:_late)?_\d+_(?P<hf>.*)"
    r"|(?P<canvas>.+?)(?:_late)?_(?P<c>\d+)_\d+_(?P<cf>.*)"
    r"|\d+-\d+ - (?P<brightspace>.+?) ?- [^-]{1,30} [AP]M",
    re.IGNORECASE,
)
"""What Moodle, Canvas and Brightspace make of a student's name, of the number, and of a file."""

_SUBMITTED = re.compile(r"^(submission_\d+):$", re.MULTILINE)
_SUBMITTER = re.compile(r"^ *-? *:(name|sid|email): *(.+?) *$", re.MULTILINE)


def _told_by(unit: str) -> tuple[str, str | None, str]:
    """Return the player, the number, and the name of the file that the name of a file tells."""
    told = _EXPORTED.fullmatch(unit)
    if told is None:
        return unit, None, unit

    def first(*names: str) -> str | None:
        return next((found for name in names if (found := told[name])), None)

    name = first("moodle", "hidden", "canvas", "brightspace") or unit
    return name, first("m", "c"), first("mf", "hf", "cf") or ""


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
        files: the files of code and answers by their paths, without what editors put around texts.
        faults: what is wrong with files, each with the place.
        notes: what is odd about files that were read all the same, each with the place.
        ids: the numbers and addresses by which the school's system knows the player.
        steps: the number of steps of all plays.
        is_there: whether there is a file to read.
    """

    player: str
    entries: list[Entry] = field(default_factory=list)
    files: dict[str, bytes] = field(default_factory=dict)
    faults: list[tuple[str, str]] = field(default_factory=list)
    notes: list[tuple[str, str]] = field(default_factory=list)
    ids: set[str] = field(default_factory=set)
    steps: int = 0
    is_there: bool = False

    @property
    def told(self) -> list[str]:
        """The first notes, as sentences."""
        return [f"{place}: {note}" for place, note in self.notes[:MAX_NOTES]]

    def take(self, name: str, place: str, data: bytes) -> None:
        """Take a file of code or answers."""
        if sum(map(len, self.files.values())) + len(data) > MAX_KEPT:
            told = f"it is not read: code and answers have more than {MAX_KEPT >> 20} MiB together"
            self.faults.append((place or name, told))
            return
        while name in self.files:
            # As who hands in the same file in two places.
            name = f"again/{name}"
        self.files[name] = data

    def take_plays(self, place: str, plays: list[Play]) -> None:
        """Take the plays of a file."""
        at = f"{place}, " if place else ""
        for number, play in enumerate(plays, 1):
            self.steps += play.steps
            if self.steps > MAX_STEPS:
                told = f"more than {MAX_STEPS:,} steps: from line {number} on, it is not graded"
                self.faults.append((place, told))
                break
            self.entries.append(Entry(f"{at}line {number}", play))


def words_of(name: str) -> frozenset[str]:
    """Return the words of a name, or of a file's, without case and what is in parentheses."""
    return frozenset(re.findall(r"[^\W_]+", re.sub(r"\([^()]*\)", "", name.casefold())))


def hand_ins(paths: Iterable[str | os.PathLike[str]], *, code: bool = False) -> list[HandIn]:
    """Return what is handed in, by player, in the order of the first file of each.

    A folder, and a zip file, may have a folder or a zip file for each player, or files of all. A
    file is of the player that its plays name, if the name of the file has that name, too; else the
    name of the file stands for the player. Two students of one name are a fault.

    Args:
        paths: files, folders and zip files.
        code: whether files of code and of answers are read, too. They are those of one player, who
            is called as the folder, if they stand in it without the name of a player.

    Raises:
        FileNotFoundError: there is nothing at a path.
        ValueError: there is no file to read in folders and zip files.
    """
    places = [*map(Path, paths)]
    for path in places:
        if not os.path.lexists(path):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    found: dict[str, HandIn] = {}
    students: dict[tuple[Path, str], set[str]] = {}
    kinds = (SUFFIX, ZIP, *(CODE if code else ()))
    for path in places:
        names: dict[str, dict[str, str]] = {}
        for unit, place, name, data in _files(path, kinds, names):
            plays, fault, notes = [], data if isinstance(data, str) else None, list[str]()
            if isinstance(data, bytes):
                plain, notes = _plain(name, data)
                try:
                    plays = plays_in(io.BytesIO(plain), "") if kind_of(name) == SUFFIX else []
                except PlayError as error:
                    fault = re.sub(r"^:(?:(\d+):)? ", lambda at: f"line {at[1]}: " if at[1] else "",
                                   str(error))  # fmt: skip
            player, number, _ = _told_by(unit)
            told = names.get(player, {})
            claims = {play.player for play in plays}
            claim = claims.pop() if len(claims) == 1 else None
            if place == "" and claim and frozenset() < words_of(claim) <= words_of(player):
                player = claim
            player = told.get("name", player)
            hand_in = found.setdefault(player, HandIn(player))
            ids = {*filter(None, [number])}
            students.setdefault((path, player), set()).update(ids)
            hand_in.ids |= ids | {told[each] for each in ("sid", "email") if each in told}
            hand_in.notes += [(place or name, each) for each in notes]
            hand_in.is_there |= name != ""
            if isinstance(data, bytes) and kind_of(name) != SUFFIX:
                hand_in.take(name, place, plain)
            hand_in.take_plays(place, plays)
            if fault is not None:
                hand_in.faults.append((place, fault))
    for (_, player), several in students.items():
        if len(several) > 1:
            clash = f"students {listed(sorted(several))} have the same name: give them two"
            found[player].faults.append(("", clash))
    is_around = all(path.is_dir() or path.suffix.lower() == ZIP for path in places)
    if is_around and not any(each.is_there for each in found.values()):
        faults = [fault for each in found.values() for _, fault in each.faults]
        why = f": {faults[0]}" if faults else ""
        raise ValueError(f"nothing can be graded in {listed([*map(str, places)])}{why}")
    return list(found.values())


def kind_of(name: str) -> str:
    """Return the suffix of a file; editors may have put `.txt` behind it."""
    path = PurePosixPath(name.lower())
    inner = PurePosixPath(path.stem).suffix
    return inner if path.suffix == ".txt" and inner in (SUFFIX, *CODE) else path.suffix


def _plain(name: str, data: bytes) -> tuple[bytes, list[str]]:
    """Return a file without what editors put around texts, and what is odd about it."""
    notes = []
    if name.lower().endswith(".txt"):
        notes.append("its name ends in .txt")
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        notes.append("it is encoded as UTF-16")
        data = data.decode("utf-16", "replace").encode("utf-8", "replace")
    elif data.startswith(codecs.BOM_UTF8):
        notes.append("it has a byte order mark")
        data = data.removeprefix(codecs.BOM_UTF8)
    return data, notes


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


class _File(NamedTuple):
    """A file: whose it is, its path there (empty for one of its own), its name, and its data."""

    unit: str
    place: str
    name: str
    data: bytes | str
    """What is in it, or its fault."""


_Names = dict[str, dict[str, str]]
"""What is told of players, by the names of their folders."""


def _files(path: Path, kinds: Sequence[str], names: _Names) -> Iterator[_File]:
    """Yield the files of a path, and who has none."""
    if path.is_dir():
        name = path.resolve().name if path.name in ("", "..") else path.name
        yield from _Sorter(kinds, names).sort(_in_folder(path), None, name or "player")
    elif path.suffix.lower() != ZIP:
        yield _File(path.stem, "", path.name, _read_file(path, _Budget()))
    else:
        try:
            with open_regular(path) as file:
                yield from _Sorter(kinds, names).unpack(file, None, path.name)
        except OSError as error:
            yield _File(path.stem, "", path.name, error.strerror or str(error))


@dataclass(frozen=True)
class _Sorter:
    """Tells whose files are."""

    kinds: Sequence[str]
    names: _Names

    @property
    def wanted(self) -> str:
        """What can be handed in, as words."""
        kinds = listed([each for each in self.kinds if each != ZIP], "or")
        return f"{kinds} files, or a {ZIP} of them"

    def sort(
        self,
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
        units: dict[str, list[str]] = {}
        read_of: set[str] = set()
        budgets: dict[str, _Budget] = {}
        files = [*files]
        inside = place if owner else ""
        owner = owner or self._owner(files, place)
        for path, read in files:
            if owner is None and path.name == METADATA:
                self._read_names(read(_Budget()))
        for path, read in files:
            is_own = owner is None and len(path.parts) == 1
            if owner is None and path.name == METADATA:
                continue
            unit = owner or (path.stem if is_own else path.parts[0])
            left = budget or budgets.setdefault(unit, _Budget())
            left.names -= 1
            if left.names < 0:
                if left.names == -1:
                    told = f"more than {MAX_NAMES:,} files: the rest is not read"
                    yield _File(unit, "", "", told)
                continue
            if kind_of(path.name) not in self.kinds:
                if not is_own:
                    units.setdefault(unit, []).append(path.name)
                continue
            read_of.add(unit)
            inner = "" if is_own else str(path if owner else PurePosixPath(*path.parts[1:]))
            where = f"{inside}/{inner}" if inside else inner
            data = read(left)
            name = inner or _told_by(path.name)[2]
            if path.suffix.lower() != ZIP or isinstance(data, str):
                yield _File(unit, where, name, data)
            elif owner:
                yield _File(unit, where, name, "a zip file in the zip file of a player is not read")
            else:
                yield from self.unpack(io.BytesIO(data), unit, where or path.name, left)
        if not (units or read_of):
            units = {owner or place: []}
        for unit, others in units.items():
            if unit not in read_of:
                told = listed([each for each in others if each != _FOLDER][:3])
                told = f", but {told}: hand in {self.wanted}" * bool(told)
                yield _File(unit, "", "", f"there is no file to grade{told}")

    def _owner(self, files: Sequence[tuple[PurePosixPath, _Read]], place: str) -> str | None:
        """Return the one player whose files these are, if some of code stand here by themselves."""
        own = [
            path
            for path, _ in files
            if len(path.parts) == 1 and kind_of(path.name) in set(self.kinds).intersection(CODE)
        ]
        return place if any(_EXPORTED.fullmatch(path.name) is None for path in own) else None

    def _read_names(self, data: bytes | str) -> None:
        """Read the names of players from what Gradescope tells."""
        text = data.decode("utf-8", "replace") if isinstance(data, bytes) else ""
        _, *parts = _SUBMITTED.split(text)
        for unit, part in zip(parts[::2], parts[1::2], strict=True):
            told: dict[str, str] = {}
            # Others may have been part of a group.
            for key, value in _SUBMITTER.findall(part.partition(":created_at:")[0]):
                value = value.strip("\"'")
                joined = key == "name" and key in told
                told[key] = f"{told[key]} and {value}" if joined else told.get(key, value)
            self.names[unit] = told

    def unpack(
        self, file: IO[bytes], owner: str | None, place: str, budget: _Budget | None = None
    ) -> Iterator[_File]:
        """Yield the files in a zip file, as `sort` does."""
        try:
            archive = open_zip(file)
        except _BROKEN as error:
            told = f"the zip file is damaged ({error})"
            yield _File(owner or place, place if owner else "", "", told)
            return
        members = [each for each in archive.infolist() if not _ASIDE.search(each.filename)]
        paths = [PurePosixPath(each.filename.replace("\\", "/")) for each in members]
        # A folder around the folders of all players is none of a player.
        inside = [path for path in paths if path.name != METADATA]
        tops, next_ones = ({path.parts[:n] for path in inside} for n in (1, 2))
        skip = owner is None and len(tops) == 1 < len(next_ones)
        skip = skip and all(len(path.parts) > 2 for path in inside)

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
        yield from self.sort(files, owner, place if owner else Path(place).stem, budget)


def _in_folder(folder: Path) -> Iterator[tuple[PurePosixPath, _Read]]:
    """Yield the files in a folder, and the folders in it, which are no files of plays."""
    for place, folders, names in os.walk(folder):
        # Neither what version control and Python keep, nor virtual environments.
        folders[:] = sorted(
            each
            for each in folders
            if not each.startswith((".", "__")) and not is_environment(Path(place, each))
        )
        inner = PurePosixPath(Path(place).relative_to(folder).as_posix())
        if inner.parts:
            yield inner / _FOLDER, _refuse_link
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
