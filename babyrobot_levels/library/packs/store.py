"""Installing and removing packs: at every moment, the old one or the new one is there whole."""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.language.pack import version_order
from babyrobot_levels.library.packs.archive import Archive
from babyrobot_levels.library.packs.carried import is_name
from babyrobot_levels.library.packs.contents import Contents, check_contents, survey
from babyrobot_levels.library.packs.errors import PackConflictError, PackNotFoundError
from babyrobot_levels.library.packs.installed import (
    CURRENT,
    InstalledPack,
    current,
    has_current,
    installed,
    packs,
    packs_folder,
    version_of,
)
from babyrobot_levels.library.packs.lock import locked
from babyrobot_levels.text.files import is_folder, write_text
from babyrobot_levels.text.words import nearest

_PART = ".part-"
"""What is being put there or taken away lies in folders whose names begin so."""


@dataclass(frozen=True, slots=True)
class Installation:
    """What became of an archive.

    Attributes:
        pack: the pack as it is installed now.
        contents: what is in it; None where the very same pack was there already.
        before: the version that was there before, None if there was none.
    """

    pack: InstalledPack
    contents: Contents | None
    before: str | None


def install(archive: Archive, *, force: bool = False) -> Installation:
    """Put a pack into the user's folder, in the place of an earlier version.

    Args:
        archive: the archive, which was read and checked.
        force: whether to put it also in the place of a later version, of another pack of the same
            version, or of the very same one.

    Raises:
        PackError: the levels are not those that the manifest says, or are not valid.
        PackConflictError: it would take the place of what only `force` replaces, or of a folder
            that was put there by hand.
        OSError: the folder cannot be written.
    """
    home, name = packs_folder(), archive.manifest.name
    with locked(home):
        _sweep(home)
        before = installed(name)
        if before is not None and _is_same(before, archive) and not force:
            return Installation(before, None, before.version)
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
        pack = InstalledPack(name, home / name / folder.name, archive.manifest.version)
    return Installation(pack, contents, None if before is None else before.version)


def uninstall(name: str) -> InstalledPack:
    """Take a pack out of the user's folder, and return what it was.

    Raises:
        PackNotFoundError: no pack of that name is there.
        PackConflictError: it was put there by hand.
        OSError: the folder cannot be written.
    """
    home = packs_folder()
    if name not in (pack.name for pack in packs()) and not _is_ours(home, name):
        # Whoever gives the name of a level, or of an archive, means the pack's.
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
                f"take the folder {found.folder} away",
            )
        part = Path(tempfile.mkdtemp(prefix=_PART, dir=home))
        try:
            (home / name).rename(part / name)
            _sync(home)
        finally:
            _remove(part)
    return found or InstalledPack(name, home / name)


def _is_ours(home: Path, name: str) -> bool:
    """Tell whether a pack was installed, and not put there by hand."""
    return is_name(name) and not (home / name).is_symlink() and has_current(home / name)


def _is_same(before: InstalledPack, archive: Archive) -> bool:
    return before.folder.name.removesuffix("-again") == _folder_name(archive, None)


def _permit(place: Path, before: InstalledPack | None, archive: Archive, force: bool) -> None:
    """Make sure that nothing is overwritten that must not be."""
    manifest = archive.manifest
    if os.path.lexists(place) and (place.is_symlink() or not has_current(place)):
        raise PackConflictError(
            f"{place} is there already, and was put there by hand",
            "take it away, and install the pack then",
        )
    if before is None or before.version is None or force:
        return
    if version_order(before.version) > version_order(manifest.version):
        raise PackConflictError(
            f"{manifest.name} {before.version} is there already, which is later than "
            f"{manifest.version}",
            "put the older one in its place with --force",
        )
    if before.version == manifest.version:
        raise PackConflictError(
            f"another {manifest.name} {manifest.version} is there already",
            "put this one in its place with --force",
        )


def _folder_name(archive: Archive, before: InstalledPack | None) -> str:
    """Return the name of the folder for an archive: another one than that which is there."""
    name = f"{archive.manifest.version}-{archive.sha256[:12]}"
    return name if before is None or before.folder.name != name else f"{name}-again"


def _unpack(archive: Archive, folder: Path) -> None:
    """Write the files of an archive into a new folder, and wait until the disk has them."""
    for path, data in archive.files.items():
        place = folder / path
        place.parent.mkdir(parents=True, exist_ok=True)
        with place.open("xb") as file:
            file.write(data)
    # All of them are written by then, so that the disk has little to do for each.
    for here, _, names in os.walk(folder):
        for name in names:
            _sync(Path(here, name))
        _sync(Path(here))


def _put(folder: Path, place: Path) -> None:
    """Put a new folder into its place, by one step that either happened or not."""
    line = f"{folder.name}\n"
    if place.exists():
        # What a sweep cannot judge, because `current` is damaged, may be in the way.
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
    """Take away what interrupted calls left, and versions that are not current any more."""
    for place in home.iterdir():
        if place.name.startswith(_PART):
            _remove(place)
        elif is_folder(place) and not place.is_symlink():
            # Another pack, into which we may not look, is nothing to stop at.
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
    """Take a file or a folder away; what cannot be taken away is left to the next sweep."""
    if is_folder(path) and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _sync(path: Path) -> None:
    """Wait until the disk has a file or a folder."""
    if sys.platform == "win32" and path.is_dir():
        # There, folders cannot be opened, and need not be.
        return
    descriptor = os.open(path, os.O_RDWR if sys.platform == "win32" else os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
