"""Installing and removing packs, atomically and one process at a time."""

import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.extensions.packs.archive import (
    Archive,
    PackConflictError,
    PackNotFoundError,
    read_archive,
)
from babyrobot_levels.extensions.packs.build import Contents, check_contents, survey
from babyrobot_levels.language.suite_list import version_order
from babyrobot_levels.library.packs import (
    CURRENT,
    InstalledPack,
    current,
    has_current,
    installed,
    is_name,
    packs,
    packs_folder,
    version_of,
)
from babyrobot_levels.text.files import is_folder, make_folder, write_text
from babyrobot_levels.text.words import nearest

LOCK = ".lock"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Create a folder and hold its lock; wait while another process holds it.

    The system releases the lock when the process ends, in whatever way. The lock file is removed
    afterwards, and so is the folder if it is empty.
    """
    path = folder / LOCK
    descriptor = _opened(path)
    try:
        yield
    finally:
        with suppress(OSError):
            # Windows does not remove an open file, which is harmless.
            path.unlink()
            folder.rmdir()
            folder.parent.rmdir()
        os.close(descriptor)


def _opened(path: Path) -> int:
    """Return the lock file's descriptor, locked."""
    while True:
        make_folder(path.parent)
        with suppress(FileNotFoundError):
            # A broken link could be neither opened nor created.
            flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
            descriptor = os.open(path, flags, 0o666)
            try:
                _wait(descriptor)
                # The last holder may have removed the file, and another process made a new one.
                if os.path.samestat(os.fstat(descriptor), path.stat()):
                    return descriptor
            except BaseException:
                os.close(descriptor)
                raise
            os.close(descriptor)


if sys.platform == "win32":
    import msvcrt
    import time

    def _wait(descriptor: int) -> None:
        while True:
            try:
                msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
            except PermissionError:
                time.sleep(0.05)
            else:
                return
else:
    import fcntl

    def _wait(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX)


_PART = ".part-"
"""The prefix of folders that are being installed or removed."""


@dataclass(frozen=True, slots=True, repr=False)
class Installation:
    """The result of installing an archive.

    Attributes:
        pack: the installed pack.
        archive: what was read of its file.
        contents: its contents; None if the same pack was already installed.
        before: the version that was installed before, None if there was none.
    """

    __module__ = "babyrobot_levels"

    pack: InstalledPack
    archive: Archive
    contents: Contents | None
    before: str | None

    def __repr__(self) -> str:
        what = "" if self.contents is None else f": {self.contents.summary()}"
        return f"<Installation of {self.pack.name} {self.pack.version}{what}>"


def install(pack: str | os.PathLike[str] | Archive, *, force: bool = False) -> Installation:
    """Install a pack, whose levels are then called PACK/LEVEL, as `babyrobot install` does.

    An earlier version is replaced: what is installed is always whole.

    Args:
        pack: the path of a `.brlpack` file, or what was read of it.
        force: whether to replace also a later version, another pack of the same version, or the
            same pack.

    Raises:
        PackError: the file is no pack, or the levels are invalid or differ from the manifest.
        PackConflictError: `force` is needed, or there is a folder that was put there by hand.
        OSError: the folder cannot be written.
    """
    archive = pack if isinstance(pack, Archive) else read_archive(Path(pack))
    home, name = packs_folder(), archive.manifest.name
    with locked(home):
        _sweep(home)
        before = installed(name)
        if before is not None and not force:
            own = before.folder.name.removesuffix("-again")
            if own == _folder_name(archive, None):
                return Installation(before, archive, None, before.version)
        _permit(home / name, before, archive, force)
        part = Path(tempfile.mkdtemp(prefix=_PART, dir=home))
        try:
            folder = part / name / _folder_name(archive, before)
            _unpack(archive, folder)
            contents = survey(folder, archive.files)
            check_contents(contents, archive.manifest)
            _put(folder, home / name)
        finally:
            _remove(part)
            _sweep(home)
        done = InstalledPack(name, home / name / folder.name, archive.manifest.version)
    return Installation(done, archive, contents, None if before is None else before.version)


def uninstall(name: str) -> InstalledPack:
    """Remove a pack from the user's folder, and return it.

    Raises:
        PackNotFoundError: no pack of that name is installed.
        PackConflictError: it was put there by hand.
        OSError: the folder cannot be written.
    """
    home = packs_folder()
    if name not in (pack.name for pack in packs()) and not _is_ours(home, name):
        # The argument may be the name of a level or of an archive of the pack.
        own = re.split(r"[/\\]|-[0-9]+\.", name, maxsplit=1)[0]
        raise PackNotFoundError(name, nearest(own, (pack.name for pack in packs())))
    with locked(home):
        _sweep(home)
        found = installed(name)
        if not _is_ours(home, name):
            if found is None:
                raise PackNotFoundError(name)
            raise PackConflictError(
                f"{name} was not installed, but put into {home} by hand",
                f"remove the folder {found.folder}",
            )
        part = Path(tempfile.mkdtemp(prefix=_PART, dir=home))
        try:
            (home / name).rename(part / name)
            _sync(home)
        finally:
            _remove(part)
    return found or InstalledPack(name, home / name)


def _is_ours(home: Path, name: str) -> bool:
    """Return whether a pack was installed, not put there by hand."""
    return is_name(name) and not (home / name).is_symlink() and has_current(home / name)


def _permit(place: Path, before: InstalledPack | None, archive: Archive, force: bool) -> None:
    """Check that nothing is replaced without permission."""
    manifest = archive.manifest
    if os.path.lexists(place) and (place.is_symlink() or not has_current(place)):
        raise PackConflictError(
            f"{place} already exists and was put there by hand",
            "remove it, and install the pack again",
        )
    if before is None or before.version is None or force:
        return
    if version_order(before.version) > version_order(manifest.version):
        raise PackConflictError(
            f"{manifest.name} {before.version} is installed, which is later than "
            f"{manifest.version}",
            "use --force to install the older version",
        )
    if before.version == manifest.version:
        raise PackConflictError(
            f"another {manifest.name} {manifest.version} is installed", "use --force to replace it"
        )


def _folder_name(archive: Archive, before: InstalledPack | None) -> str:
    """Return the name of an archive's folder, which differs from the installed one."""
    name = f"{archive.manifest.version}-{archive.sha256[:12]}"
    return name if before is None or before.folder.name != name else f"{name}-again"


def _unpack(archive: Archive, folder: Path) -> None:
    """Write the files of an archive into a new folder, and sync them to the disk."""
    for path, data in archive.files.items():
        place = folder / path
        make_folder(place.parent)
        with place.open("xb") as file:
            file.write(data)
    # Syncing after all writes is much faster than after each.
    for here, _, names in os.walk(folder):
        for name in names:
            _sync(Path(here, name))
        _sync(Path(here))


def _put(folder: Path, place: Path) -> None:
    """Move a new folder into its place, atomically."""
    line = f"{folder.name}\n"
    if place.exists():
        # If `current` is damaged, `_sweep` may have left something there.
        _remove(place / folder.name)
        folder.rename(place / folder.name)
        _sync(place)
        write_text(place / CURRENT, line)
        _sync(place)
    else:
        write_text(folder.parent / CURRENT, line)
        _sync(folder.parent)
        folder.parent.rename(place)
    _sync(place.parent)


def _sweep(home: Path) -> None:
    """Remove what interrupted calls left, and versions that are not current any more."""
    for place in home.iterdir():
        if place.name.startswith(_PART):
            _remove(place)
        elif is_folder(place) and not place.is_symlink():
            # An unreadable other pack is no reason to fail.
            with suppress(OSError):
                _sweep_pack(place)


def _sweep_pack(place: Path) -> None:
    kept = current(place)
    for inner in place.iterdir() if kept is not None else ():
        if inner.name.startswith(f".{CURRENT}.") or (
            version_of(inner.name) is not None and inner != kept
        ):
            _remove(inner)


def _remove(path: Path) -> None:
    """Remove a file or a folder; what cannot be removed is left to the next sweep."""
    if is_folder(path) and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _sync(path: Path) -> None:
    """Sync a file or a folder to the disk."""
    if sys.platform == "win32" and path.is_dir():
        # Windows cannot open folders, and does not need it.
        return
    descriptor = os.open(path, os.O_RDWR if sys.platform == "win32" else os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
