"""Where worlds are read from: files, folders and zip files, whose bytes become texts."""

import os
import zlib
from collections.abc import Iterator
from pathlib import Path, PurePath, PurePosixPath
from typing import NamedTuple
from zipfile import BadZipFile, ZipFile, ZipInfo

from babyrobot_levels.extensions.formats.conversion import ConversionError
from babyrobot_levels.extensions.formats.formats import FORMATS
from babyrobot_levels.language.names import slug
from babyrobot_levels.text.files import (
    RESERVED,
    is_environment,
    is_folder,
    is_within,
    open_regular,
    open_zip,
    read_data,
    source_of,
)
from babyrobot_levels.text.source import MAX_BYTES, SourceFile

_ZIP = b"PK\x03\x04"

MAX_UNPACKED = 256 << 20
"""The most bytes that the files of an archive may come to."""


class Found(NamedTuple):
    """A file that may hold worlds.

    Attributes:
        name: what messages call it.
        place: its path below the folder or the archive, without a suffix, of names of levels.
        path: the file; that of the archive if it is in one.
        data: its bytes, if it is in an archive.
    """

    name: str
    place: Path
    path: Path
    data: bytes | None = None

    @property
    def folder(self) -> Path | None:
        """The folder of the file, in which others may be that it names; None in an archive."""
        return self.path.parent if self.data is None else None


def single(path: Path) -> Found:
    """Return a file that is given by itself."""
    return Found(str(path), place_of(PurePath(path.name)), path)


def decoded(data: bytes, name: str) -> SourceFile:
    """Return bytes as a text: those of a binary format as the text that they stand for.

    Raises:
        LevelError: they are too many, not UTF-8, or damaged.
    """
    for each in FORMATS.own.values():
        if (text := each.codec.decodes(data) if each.codec.decodes else None) is not None:
            return SourceFile(name, text, is_made=True)
    return source_of(data, name)


def opened(found: Found) -> SourceFile:
    """Return the text of a file; see `decoded` for errors."""
    data = read_data(found.path, found.name) if found.data is None else found.data
    return decoded(data, found.name)


def is_archive(path: Path) -> bool:
    """Return whether a file is a zip file, by what it begins with."""
    try:
        with open_regular(path) as file:
            return file.read(len(_ZIP)) == _ZIP
    except OSError:
        return False


def found_in(path: Path) -> Iterator[Found]:
    """Yield the files below a folder or in a zip file, sorted; not hidden ones, nor links out.

    Raises:
        ConversionError: the archive is damaged, or holds too much.
    """
    yield from _in_folder(path) if is_folder(path) else _in_archive(path)


def _in_folder(folder: Path) -> Iterator[Found]:
    for here, folders, names in os.walk(folder):
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".") and not is_environment(Path(here, name))
        )
        for name in sorted(names):
            path = Path(here, name)
            if not name.startswith(".") and is_within(path, folder):
                yield Found(str(path), place_of(path.relative_to(folder)), path)


def _in_archive(path: Path) -> Iterator[Found]:
    try:
        with open_regular(path) as file, open_zip(file) as archive:
            members = sorted(archive.infolist(), key=lambda member: member.filename)
            if sum(member.file_size for member in members) > MAX_UNPACKED:
                raise ConversionError(
                    f"{path}: its files come to more than {MAX_UNPACKED >> 20} MiB", "unpack it"
                )
            for member in members:
                name = PurePosixPath(member.filename)
                if not member.is_dir() and not any(part.startswith(".") for part in name.parts):
                    shown = f"{path}:{member.filename}"
                    yield Found(shown, place_of(name), path, _content(archive, member))
    except (BadZipFile, OSError, EOFError, zlib.error) as error:
        raise ConversionError(f"{path} is no zip file that can be read ({error})") from None


def _content(archive: ZipFile, member: ZipInfo) -> bytes:
    """Return what a member holds, nothing if that cannot be read."""
    try:
        with archive.open(member) as file:
            return file.read(MAX_BYTES + 1)
    except (NotImplementedError, RuntimeError):
        # Encrypted, or compressed in a way that this Python lacks.
        return b""


def place_of(path: PurePath) -> Path:
    """Return a path that names of levels make up, which leads nowhere else."""
    names = (slug(part) or "level" for part in (*path.parent.parts, path.stem))
    return Path(*(f"{name}-level" if name in RESERVED else name for name in names))
