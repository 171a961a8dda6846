"""Which packs there are: installed ones, and those of Python packages."""

from __future__ import annotations

import re
import stat
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import Distribution, EntryPoint, distributions
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from babyrobot_levels.language.names import SLUG, VERSION
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import PACK_FILE, is_folder, user_folder

if TYPE_CHECKING:
    from babyrobot_levels.language.suite_list import PackFields

CURRENT = "current"
MAX_LINE = 100
_FOLDER = re.compile(rf"({VERSION[1:-1]})-[0-9a-f]{{12}}(-again)?", re.ASCII)


@dataclass(frozen=True, slots=True)
class InstalledPack:
    """A pack in the user's folder.

    Attributes:
        name: the prefix of its levels.
        folder: the folder of its levels.
        version: the installed version; None for a folder that was put there by hand.
    """

    __module__ = "babyrobot_levels"

    name: str
    folder: Path
    version: str | None = None


def packs() -> Iterator[InstalledPack]:
    """Yield the packs in the user's folder, sorted by name, without incomplete ones."""
    home = packs_folder()
    try:
        names = sorted(path.name for path in home.iterdir())
    except OSError:
        return
    for name in names:
        found = None if name.startswith(".") else installed(name)
        if found is not None:
            yield found


def installed(name: str) -> InstalledPack | None:
    """Return the installed pack of a name, None if there is none that is readable."""
    home = packs_folder() / name
    if not is_folder(home):
        return None
    try:
        if not has_current(home):
            return InstalledPack(name, home)
    except OSError:
        return None
    folder = current(home)
    return None if folder is None else InstalledPack(name, folder, version_of(folder.name))


def has_current(home: Path) -> bool:
    """Return whether a pack was installed, even if its `current` is damaged.

    Raises:
        OSError: the pack's folder may not be entered.
    """
    try:
        (home / CURRENT).lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


def current(home: Path) -> Path | None:
    """Return the folder that a pack's `current` names, None if it is not a valid one."""
    path = home / CURRENT
    try:
        if not stat.S_ISREG(path.lstat().st_mode):
            return None
        with path.open("rb") as file:
            line = file.read(MAX_LINE).decode("ascii").removesuffix("\n")
        folder = home / line if version_of(line) is not None else None
        if folder is None or not stat.S_ISDIR(folder.lstat().st_mode):
            return None
    except (OSError, ValueError):
        return None
    return folder


def version_of(folder: str) -> str | None:
    """Return the version in the name of an installed folder, None for other names."""
    match = _FOLDER.fullmatch(folder)
    return match[1] if match else None


def fields(folder: Path) -> PackFields | None:
    """Return the fields of a pack's `pack.yaml`, None if it is missing or invalid."""
    # Here, because which packs there are is known by their folders.
    from babyrobot_levels.language.suite_list import PackFields
    from babyrobot_levels.language.validation import check
    from babyrobot_levels.text.reader import open_document

    try:
        return check(open_document(folder / PACK_FILE), PackFields).value
    except LevelError:
        return None


def packs_folder() -> Path:
    """Return the folder of all packs, which may not exist."""
    return user_folder() / "packs"


PACK_GROUP = "babyrobot_levels.packs"
"""The entry-point group of packs: the name of an entry is the pack's, its value an import path."""

_NAME = re.compile(SLUG)


@dataclass(frozen=True, slots=True)
class CarriedPack:
    """A pack that an entry point declares.

    Attributes:
        name: the entry's name, which is the pack's.
        value: the entry's value, an import path.
        folder: the folder of its levels; None if the value is no folder or the name is invalid.
        distribution: the installed package.
    """

    name: str
    value: str
    folder: Path | None
    distribution: Distribution

    @property
    def has_valid_name(self) -> bool:
        """Whether the name is valid for a pack."""
        return is_name(self.name)

    @property
    def package(self) -> str:
        """Name and version of the Python package, as in `pip list`."""
        texts = (self._metadata(field) for field in ("Name", "Version"))
        return " ".join(filter(None, texts)) or "without a name"

    @property
    def package_name(self) -> str | None:
        """Name of the Python package, None if its metadata is damaged."""
        return self._metadata("Name")

    def _metadata(self, field: str) -> str | None:
        # As in `_entries`: its files may be damaged.
        with suppress(Exception):
            metadata = self.distribution.metadata
            if field in metadata:
                return metadata[field]
        return None


def carried_packs() -> Iterator[CarriedPack]:
    """Yield the packs of Python packages, in the order of Python's search path."""
    for distribution in distributions():
        for entry in _entries(distribution):
            module = entry.value.partition(":")[0].strip()
            folder = package_folder(module) if is_name(entry.name) else None
            yield CarriedPack(entry.name, entry.value, folder, distribution)


def is_name(text: str) -> bool:
    """Return whether a text is a valid name of a pack."""
    return _NAME.fullmatch(text) is not None


def _entries(distribution: Distribution) -> Sequence[EntryPoint]:
    """Return the entry points of a package for packs; none if it is damaged."""
    try:
        # Most packages have none, so a search in the text saves parsing it.
        if PACK_GROUP not in (distribution.read_text("entry_points.txt") or ""):
            return ()
        return [entry for entry in distribution.entry_points if entry.group == PACK_GROUP]
    except Exception:
        # A damaged package of somebody else must not break everything.
        return ()


def package_folder(module: str) -> Path | None:
    """Return the folder of an import path without importing anything, None if it has none.

    The folder may be any one inside a package. A package in a ZIP archive has no folder.
    """
    parts = module.split(".")
    if not all(part.isidentifier() for part in parts):
        return None
    for depth in range(1, len(parts) + 1):
        for location in _locations(".".join(parts[:depth])):
            folder = Path(location, *parts[depth:])
            try:
                if folder.is_dir():
                    return folder
            except OSError:
                # It is not accessible, or the name is too long.
                continue
    return None


def _locations(package: str) -> Sequence[str]:
    """Return the folders of a package; of a nested one only if a finder knows its full name."""
    try:
        if "." not in package:
            spec = find_spec(package)
            return [*(spec.submodule_search_locations or ())] if spec else ()
        # `find_spec` would import the parent packages. The finders of editable installs need no
        # path.
        for finder in sys.meta_path:
            spec = finder.find_spec(package, [])
            if spec is not None:
                return [*(spec.submodule_search_locations or ())]
    except Exception:
        # Finders may be those of other packages, too.
        return ()
    return ()


@dataclass(frozen=True, slots=True)
class KnownPack:
    """A pack, and where it comes from.

    Attributes:
        name: the pack's name.
        folder: the folder of its levels.
        origin: `"installed"`, `"folder"` for one that was put among the installed ones by hand, or
            `"package NAME VERSION"`.
    """

    name: str
    folder: Path
    origin: str


def known_packs() -> Iterator[KnownPack]:
    """Yield all packs. The first one of a name hides the others.

    First the user's, sorted by name, then those of packages, in the order of Python's search path.
    """
    for mine in packs():
        yield KnownPack(mine.name, mine.folder, "installed" if mine.version else "folder")
    for carried in carried_packs():
        if carried.folder is not None:
            yield KnownPack(carried.name, carried.folder, f"package {carried.package}")


def unusable_packs() -> Iterator[str]:
    """Yield a message for each pack that is damaged or missing."""
    try:
        inside = sorted(packs_folder().iterdir())
    except FileNotFoundError:
        inside = []
    except OSError as error:
        inside = []
        yield f"{packs_folder()} is left out: {error.strerror}"
    for folder in inside:
        if folder.name.startswith(".") or not is_folder(folder):
            continue
        if installed(folder.name) is not None:
            continue
        try:
            has_current(folder)
        except OSError:
            yield f"{folder} is left out: permission denied"
        else:
            why = "its file `current` is damaged; install the pack again"
            yield f"{folder} is left out: {why}"
    for carried in carried_packs():
        if carried.folder is None:
            where = f"{carried.value!r} is not a folder"
            why = where if carried.has_valid_name else "invalid name, use a-z, 0-9 and `-`"
            yield f"the pack {carried.name!r} of package {carried.package} is left out: {why}"
