"""Folders that are packs, and archives made by hand: with whatever a hostile one may hold."""

from __future__ import annotations

import stat
import struct
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from babyrobot_levels.extensions.packs.archive import MANIFEST, LevelEntry, Manifest, file_entry
from babyrobot_levels.library.level import loads
from babyrobot_levels.text.files import user_folder
from support.folders import babyrobot, write_files

Snapshot = dict[str, bytes | None]


def level(size: str = "4, 3", exit_at: str = "3, 2") -> str:
    """Return a level in which nothing is to be found."""
    head = "# yaml-language-server: $schema=https://example.org/level.schema.json\n"
    return (
        f"{head}version: 1\ndescription: A level of a pack.\nsize: [{size}]\nexit: [{exit_at}]\n"
    ).replace("exit: [3, 2]\n", "")


def pack_text(name: str = "zoo", version: str = "1.0.0") -> str:
    """Return a `pack.yaml`."""
    return f"name: {name}\nversion: {version}\ndescription: Animals.\n"


def zoo(version: str = "1.0.0") -> dict[str, str]:
    """Return the files of a pack with two levels, a suite and a theme. Each version differs."""
    grown = 3 + int(version[0])
    return {
        "LICENSE": "Do as you like.\n",
        "levels/bear.yaml": level(f"{grown}, 4", f"{grown - 1}, 3"),
        "levels/lion.yaml": level() + "theme: sea\n",
        "levels/themes/sea.yaml": "widths: {walls: 6}\n",
        "pack.yaml": pack_text(version=version),
        "suites/herd.yaml": "version: 1\nkind: suite\ncount: 10\n",
    }


def packed(version: str = "1.0.0", files: Mapping[str, str | bytes] | None = None) -> Path:
    """Pack a zoo, or other files, in the current folder, and return the archive."""
    folder = write_files(Path(f"source-{version}"), files or zoo(version))
    archive = Path(f"{folder}.brlpack")
    result = babyrobot("pack", folder, "-o", archive, "--force")
    assert result.status == 0, result.out + result.err
    return archive


def snapshot(folder: Path) -> Snapshot:
    """Return all that is below a folder: files with their bytes, folders, links."""
    found: Snapshot = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        is_file = path.is_file() and not path.is_symlink()
        found[name] = path.read_bytes() if is_file else None
    return found


def users_files() -> Snapshot:
    """Return all that is in the user's folder, and whether there is one."""
    return {".": None, **snapshot(user_folder())} if user_folder().exists() else {}


# -- archives by hand ------------------------------------------------------------------------


@dataclass
class Entry:
    """An entry of a zip file, and all that may be wrong about it."""

    name: str
    data: bytes = b""
    flags: int = 0
    method: int = 0
    mode: int = stat.S_IFREG | 0o644
    extra: bytes = b""
    comment: bytes = b""
    date: int = 33
    made_by: int = 3 << 8 | 10
    size: int | None = None
    """The size that both headers state, if it is not that of the data."""
    crc: int | None = None
    offset: int | None = None
    """Where the directory says that it is."""
    local_name: str | None = None
    """What its own header calls it."""
    raw_name: bytes | None = None
    encoded: bytes = field(init=False, default=b"")

    def __post_init__(self) -> None:
        self.encoded = self.name.encode() if self.raw_name is None else self.raw_name

    def local(self) -> bytes:
        """Return its own header and its data."""
        name = self.encoded if self.local_name is None else self.local_name.encode()
        head = (b"PK\3\4", 10, self.flags, self.method, 0, self.date, *self._sums())
        return struct.pack("<4s5H3I2H", *head, len(name), 0) + name + self.data

    def central(self, offset: int) -> bytes:
        """Return its record in the directory."""
        at = offset if self.offset is None else self.offset
        head = (b"PK\1\2", self.made_by, 10, self.flags, self.method, 0, self.date, *self._sums())
        tail = (len(self.encoded), len(self.extra), len(self.comment), 0, 0, self.mode << 16, at)
        record = struct.pack("<4s6H3I5H2I", *head, *tail)
        return record + self.encoded + self.extra + self.comment

    def _sums(self) -> tuple[int, int, int]:
        size = len(self.data) if self.size is None else self.size
        return zlib.crc32(self.data) if self.crc is None else self.crc, len(self.data), size


def forged(entries: Iterable[Entry]) -> bytes:
    """Return the zip file of entries, just as they are."""
    body, directory, number = b"", b"", 0
    for entry in entries:
        directory += entry.central(len(body))
        body += entry.local()
        number += 1
    end = (b"PK\5\6", 0, 0, number, number, len(directory), len(body), 0)
    return body + directory + struct.pack("<4s4H2IH", *end)


def good_files() -> dict[str, bytes]:
    """Return the files of a small sound pack."""
    return {"levels/lion.yaml": level().encode(), "pack.yaml": pack_text().encode()}


def manifest_of(files: Mapping[str, bytes]) -> Manifest:
    """Return the manifest that fits to files; the valid levels among them are listed."""
    digest = loads(level()).digest
    # Not checked, as what is forged need not be right.
    return Manifest.model_construct(
        name="zoo",
        version="1.0.0",
        files={path: file_entry(data) for path, data in files.items()},
        levels={"lion": LevelEntry(digest=digest, file="levels/lion.yaml")},
    )


def sealed(
    files: Mapping[str, bytes] | None = None,
    manifest: bytes | None = None,
    more: Iterable[Entry] = (),
) -> bytes:
    """Return an archive of files, with a manifest that fits to them and to further entries."""
    whole = dict(good_files() if files is None else files)
    extra = {entry.name: entry.data for entry in more}
    if manifest is None:
        manifest = manifest_of({**whole, **extra}).to_bytes()
    entries = [Entry(path, data) for path, data in whole.items()] + list(more)
    entries.sort(key=lambda entry: entry.encoded)
    return forged([Entry(MANIFEST, manifest), *entries])
