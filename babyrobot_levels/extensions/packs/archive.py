"""The format of packs: their errors, paths and manifest, and the archive.

The archive is a ZIP file in one canonical form, so that it is reproducible: first the manifest,
then the files sorted by path; stored without compression; dated 1980-01-01; regular files with mode
0644. The reader accepts nothing else, so it never has to guess how other programs would unpack it.
"""

import hashlib
import json
import re
import stat
import struct
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, StrictInt, StrictStr, StringConstraints, ValidationError

from babyrobot_levels.language.base import Model, Slug
from babyrobot_levels.language.names import SLUG
from babyrobot_levels.language.suite_list import Version
from babyrobot_levels.text.errors import BabyRobotError, HelpfulError
from babyrobot_levels.text.files import MAX_DEPTH, PACK_FILE, RESERVED, SUFFIXES, read_bytes
from babyrobot_levels.text.source import MAX_BYTES


class PackError(HelpfulError, public=True):
    """A pack that is damaged, too large, or different from its manifest.

    `help` says what to do, if it is known.
    """


class PackConflictError(HelpfulError, public=True):
    """Something exists that must not be replaced. `help` says what to do."""


class PackNotFoundError(BabyRobotError, LookupError, public=True):
    """No pack of that name is installed. `nearest` are the most similar names."""

    def __init__(self, name: str, nearest: Sequence[str] = ()):
        self.name, self.nearest = name, tuple(nearest)
        super().__init__(name, self.nearest)

    def __str__(self) -> str:
        name = self.name if len(self.name) <= 100 else self.name[:99] + "…"
        text = f"no pack named {name!r} is installed"
        if self.nearest:
            text += f"; did you mean {' or '.join(map(repr, self.nearest))}?"
        return text


TEXTS = ("README.md", "LICENSE", "LICENSE.md", "LICENSE.txt")
"""The files of a pack that are not YAML."""

MAX_PATH = 120
"""The largest number of characters of a path, for the limit of Windows with the user's folder."""

_PART = re.compile(r"[A-Za-z0-9_]([A-Za-z0-9 ._-]*[A-Za-z0-9_-])?", re.ASCII)


def belongs(name: str) -> bool:
    """Return whether a file of that name belongs into a pack."""
    return name in TEXTS or name.endswith(SUFFIXES)


def is_theme(path: str) -> bool:
    """Return whether the file of a path is a theme."""
    return "themes" in path.split("/")[:-1]


def path_fault(path: str) -> str | None:
    """Return why a path is not valid in a pack, as in `it …`, or None if it is valid."""
    parts = path.split("/")
    if "\\" in path:
        return "has a backslash in its path"
    if path.startswith("/"):
        return "has an absolute path"
    if re.match("[A-Za-z]:", path):
        return "has a drive in its path"
    if ".." in parts:
        return "is outside of the pack"
    if len(path) > MAX_PATH:
        return f"has a path of more than {MAX_PATH} characters"
    if len(parts) > MAX_DEPTH + 1:
        return f"is in more than {MAX_DEPTH} folders"
    for part in parts:
        if part.partition(".")[0].rstrip(" ").lower() in RESERVED:
            return "has a name that Windows reserves for a device"
        if not _PART.fullmatch(part):
            return (
                "has a name that is not portable: use ASCII letters and digits, `_` and `-`, and "
                "dots and blanks inside of it"
            )
    if not belongs(parts[-1]):
        return "is neither YAML nor a README.md or LICENSE"
    if parts[-1] == PACK_FILE and len(parts) > 1:
        return "is in a folder: a pack cannot contain other packs"
    return None


def clashes(paths: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the paths that clash with others on some system, and why, as in `it …`."""
    seen: dict[str, tuple[str, bool]] = {}
    for path in paths:
        parts = path.split("/")
        for count in range(1, len(parts) + 1):
            begin, is_file = "/".join(parts[:count]), count == len(parts)
            known = seen.setdefault(begin.lower(), (begin, is_file))
            if known[0] != begin:
                yield path, f"differs from {known[0]} only in upper and lower case"
            elif known[1] != is_file:
                yield path, f"needs {begin} to be both a file and a folder"
            else:
                continue
            break


MANIFEST = "MANIFEST.json"

FORMAT = "babyrobot-levels pack"

Sum = Annotated[StrictStr, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
Digest = Annotated[StrictStr, StringConstraints(pattern=r"^sha256:[0-9a-f]{64}$")]
FilePath = Annotated[StrictStr, StringConstraints(max_length=MAX_PATH)]
LevelName = Annotated[StrictStr, StringConstraints(pattern=SLUG, max_length=MAX_PATH)]


class FileEntry(Model):
    """A file: its size in bytes, and the SHA-256 of its bytes."""

    sha256: Sum
    size: Annotated[StrictInt, Field(ge=0)]


class LevelEntry(Model):
    """A level: its file, and its digest, None for a random maze."""

    digest: Digest | None
    file: FilePath


class Manifest(Model):
    """The manifest of a pack: its files by path, its levels by name."""

    format: Literal["babyrobot-levels pack"] = "babyrobot-levels pack"
    format_version: Literal[1] = 1
    name: Slug
    version: Version
    files: dict[FilePath, FileEntry]
    levels: dict[LevelName, LevelEntry]

    def to_bytes(self) -> bytes:
        """Return the manifest as canonical JSON."""
        return (json.dumps(self.model_dump(), indent=2, sort_keys=True) + "\n").encode("ascii")


def file_entry(data: bytes) -> FileEntry:
    """Return the entry of a file."""
    return FileEntry(sha256=hashlib.sha256(data).hexdigest(), size=len(data))


def read_manifest(data: bytes) -> Manifest:
    """Parse a manifest.

    Raises:
        PackError: it is not a canonical manifest of this version.
    """
    try:
        found: Any = json.loads(data)
    except (ValueError, RecursionError):
        raise PackError("its manifest is not JSON") from None
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        raise PackError("its manifest is not that of a pack of levels")
    version = found.get("format_version")
    if isinstance(version, int) and version > 1:
        raise PackError(
            f"it has version {version} of the format, and this babyrobot-levels reads version 1; "
            "a newer one may read it"
        )
    try:
        manifest = Manifest.model_validate(found)
    except ValidationError as error:
        place = "/".join(map(str, error.errors(include_url=False)[0]["loc"]))
        raise PackError(f"its manifest is invalid, at {place[:100]!r}") from None
    if manifest.to_bytes() != data:
        raise PackError("its manifest is not in canonical form")
    return manifest


def check_files(manifest: Manifest, files: Mapping[str, bytes]) -> None:
    """Check that files are those of a manifest, byte for byte.

    Raises:
        PackError: one is missing, unexpected, or different.
    """
    for path in sorted(manifest.files.keys() - files.keys()):
        raise PackError(f"{path!r} is in its manifest, but not in the archive")
    for path, data in files.items():
        entry = manifest.files.get(path)
        if entry is None:
            raise PackError(f"{path!r} is in the archive, but not in its manifest")
        if entry != file_entry(data):
            raise PackError(f"{path!r} is damaged: its SHA-256 is not the manifest's")


SUFFIX = ".brlpack"

MAX_FILES = 10_000
MAX_TOTAL = 16 << 20
"""The limit of bytes of all files together; each file has the limit of a level file."""
MAX_MANIFEST = 8 << 20

_LOCAL = struct.Struct("<4s5H3I2H")
_CENTRAL = struct.Struct("<4s6H3I5H2I")
_END = struct.Struct("<4s4H2IH")
MAX_ARCHIVE = MAX_TOTAL + MAX_MANIFEST + MAX_FILES * 600

_NEEDED, _MADE_BY = 10, 3 << 8 | 10
_DATE = 1 << 5 | 1
_FILE_ATTRIBUTES = (stat.S_IFREG | 0o644) << 16
_ENCRYPTED = 1 << 0


@dataclass(frozen=True, slots=True)
class Archive:
    """A pack's archive that was read and checked.

    Attributes:
        manifest: its manifest.
        files: its files by path, without the manifest.
        sha256: the SHA-256 of the whole archive, in hex.
    """

    manifest: Manifest
    files: Mapping[str, bytes]
    sha256: str


def write_archive(manifest: Manifest, files: Mapping[str, bytes]) -> bytes:
    """Return the archive of files. The same files give the same bytes on every system."""
    whole = {MANIFEST: manifest.to_bytes(), **dict(sorted(files.items()))}
    body, directory = bytearray(), bytearray()
    for path, data in whole.items():
        directory += _central(path, data, len(body))
        body += _local(path, data) + data
    count = len(whole)
    end = _END.pack(b"PK\5\6", 0, 0, count, count, len(directory), len(body), 0)
    return bytes(body + directory) + end


def read_archive(path: Path) -> Archive:
    """Read and check an archive.

    Raises:
        OSError: the file cannot be read.
        PackError: it is not a valid archive of a pack.
    """
    data = read_bytes(path, MAX_ARCHIVE)
    if len(data) > MAX_ARCHIVE:
        raise PackError(f"it is larger than the limit of {MAX_ARCHIVE:,} bytes")
    return parse_archive(data)


def parse_archive(data: bytes) -> Archive:
    """Check the bytes of an archive; see `read_archive`."""
    files = _entries(data)
    manifest = read_manifest(files.pop(MANIFEST))
    check_files(manifest, files)
    return Archive(manifest, files, hashlib.sha256(data).hexdigest())


def check_sizes(files: Mapping[str, bytes]) -> None:
    """Check the number and the sizes of files.

    Raises:
        PackError: they are too many or too large.
    """
    if len(files) > MAX_FILES:
        raise PackError(f"it contains more than {MAX_FILES:,} files")
    for path, data in files.items():
        if len(data) > MAX_BYTES:
            raise PackError(f"{path!r} is larger than {MAX_BYTES >> 20} MiB")
    if sum(map(len, files.values())) > MAX_TOTAL:
        raise PackError(f"its files are larger than {MAX_TOTAL >> 20} MiB together")


def _local(path: str, data: bytes) -> bytes:
    head = _LOCAL.pack(b"PK\3\4", _NEEDED, 0, 0, 0, _DATE, *_sums(data), len(path), 0)
    return head + path.encode("ascii")


def _central(path: str, data: bytes, offset: int) -> bytes:
    head = (b"PK\1\2", _MADE_BY, _NEEDED, 0, 0, 0, _DATE, *_sums(data))
    tail = (len(path), 0, 0, 0, 0, _FILE_ATTRIBUTES, offset)
    return _CENTRAL.pack(*head, *tail) + path.encode("ascii")


def _sums(data: bytes) -> tuple[int, int, int]:
    return zlib.crc32(data), len(data), len(data)


def _entries(data: bytes) -> dict[str, bytes]:
    """Return the checked entries of an archive, the manifest first."""
    count, directory = _directory(data)
    found: dict[str, bytes] = {}
    place, offset = directory, 0
    for _ in range(count):
        name = _name(data, place)
        size = _size(data, place, name, found)
        local = offset + _LOCAL.size + len(name)
        content = data[local : local + size]
        if local + size > directory:
            raise PackError(f"its entries overlap, or {name!r} is larger than the archive")
        if _CENTRAL.unpack_from(data, place)[-1] != offset:
            raise PackError(f"its entries overlap or leave gaps, at {name!r}")
        head, record = _local(name, content), _central(name, content, offset)
        if data[place + 16 : place + 20] != record[16:20]:
            raise PackError(f"{name!r} is damaged: its CRC-32 is wrong")
        if data[offset:local] != head:
            raise PackError(f"the two headers of {name!r} contradict each other")
        if data[place : place + len(record)] != record:
            raise PackError(f"the entry {name!r} is not in canonical form")
        found[name] = content
        place, offset = place + len(record), local + size
    if offset != directory:
        raise PackError("there is data between its last entry and its directory")
    if place != len(data) - _END.size:
        raise PackError("its directory is longer than its entries")
    if next(iter(found)) != MANIFEST:
        raise PackError(f"its first entry is not {MANIFEST}")
    if list(found)[1:] != sorted(list(found)[1:]):
        raise PackError("its entries are not in order")
    paths = [path for path in found if path != MANIFEST]
    for path, why in clashes(paths):
        raise PackError(f"the entry {path!r} {why}")
    check_sizes({path: found[path] for path in paths})
    return found


def _directory(data: bytes) -> tuple[int, int]:
    """Return the number of entries and the offset of their directory, from the end record."""
    if not data.startswith(b"PK\3\4"):
        raise PackError("it is not a pack: it does not begin like a ZIP file")
    at = len(data) - _END.size
    if at < 0 or not data.startswith(b"PK\5\6", at):
        has_end = 0 <= data.rfind(b"PK\5\6") <= at
        raise PackError(
            "there is data after its end" if has_end else "it is cut off: it has no end"
        )
    _, disk, first, here, count, size, start, comment = _END.unpack_from(data, at)
    if count > MAX_FILES + 1 or here > MAX_FILES + 1:
        raise PackError(f"it contains more than {MAX_FILES:,} files")
    if disk or first or here != count or comment or not count or start + size != at:
        raise PackError("its end record contradicts the rest of it")
    return count, start


def _name(data: bytes, place: int) -> str:
    """Return the name of the entry whose directory record begins at `place`."""
    if place + _CENTRAL.size > len(data) - _END.size or not data.startswith(b"PK\1\2", place):
        raise PackError("its directory is damaged")
    length = _CENTRAL.unpack_from(data, place)[10]
    begin = place + _CENTRAL.size
    raw = data[begin : begin + length]
    try:
        name = raw.decode("ascii")
    except UnicodeDecodeError:
        shown = raw.decode("utf-8", "replace")
        raise PackError(f"the name of the entry {shown[:100]!r} is not ASCII") from None
    fault = None if name == MANIFEST else path_fault(name)
    if fault:
        raise PackError(f"the entry {name[:100]!r} {fault}")
    return name


def _size(data: bytes, place: int, name: str, found: Mapping[str, bytes]) -> int:
    """Return the size of an entry, after checking that it is a regular file."""
    record = _CENTRAL.unpack_from(data, place)
    made_by, _, flags, method = record[1:5]
    packed, size, _, extra, comment = record[8:13]
    kind = stat.S_IFMT(record[15] >> 16)
    if name in found:
        raise PackError(f"the entry {name!r} is duplicated")
    if flags & _ENCRYPTED:
        raise PackError(f"the entry {name!r} is encrypted")
    if made_by >> 8 == 3 and kind == stat.S_IFLNK:
        raise PackError(f"the entry {name!r} is a link")
    if method:
        raise PackError(f"the entry {name!r} is compressed")
    if extra or comment or packed != size:
        raise PackError(f"the entry {name!r} is not in canonical form")
    if size > (MAX_MANIFEST if name == MANIFEST else MAX_BYTES):
        raise PackError(f"the entry {name!r} is too large: {size:,} bytes")
    return int(size)
