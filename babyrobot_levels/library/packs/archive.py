"""The archive of a pack: a ZIP file in one canonical form, so that it is reproducible.

First the manifest, then the files sorted by path; stored without compression; dated 1980-01-01;
regular files with mode 0644. The reader accepts nothing else, so it never has to guess how other
programs would unpack it.
"""

from __future__ import annotations

import hashlib
import stat
import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.library.packs.format import (
    MANIFEST,
    Manifest,
    PackError,
    check_files,
    clashes,
    path_fault,
    read_manifest,
)
from babyrobot_levels.text.files import read_bytes
from babyrobot_levels.text.source import MAX_BYTES

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
    return bytes(body + directory) + _end(len(whole), len(directory), len(body))


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


def _end(count: int, size: int, offset: int) -> bytes:
    return _END.pack(b"PK\5\6", 0, 0, count, count, size, offset, 0)


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
