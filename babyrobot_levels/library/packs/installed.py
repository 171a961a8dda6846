"""The packs in the user's folder, as their readers see them.

`packs/NAME/` holds a folder for the installed version, and a file `current` that names it: what
`current` does not name is not there yet, or no more. A folder without `current` was put there by
hand, and is a pack as it is.
"""

from __future__ import annotations

import re
import stat
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.language.pack import VERSION, PackFields
from babyrobot_levels.language.validation import check
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import PACK_FILE, is_folder, user_folder
from babyrobot_levels.text.reader import open_document

CURRENT = "current"
MAX_LINE = 100
_FOLDER = re.compile(rf"({VERSION[1:-1]})-[0-9a-f]{{12}}(-again)?", re.ASCII)


@dataclass(frozen=True, slots=True)
class InstalledPack:
    """A pack in the user's folder.

    Attributes:
        name: what its levels are found under.
        folder: where its levels are.
        version: which version was installed; None for a folder that was put there by hand.
    """

    name: str
    folder: Path
    version: str | None = None


def packs() -> Iterator[InstalledPack]:
    """Yield the packs in the user's folder, by name. What is half there is not seen."""
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
    """Return the pack that is found under a name, or None if there is none for us to see."""
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
    """Tell whether a pack was installed, also where its `current` is faulty.

    Raises:
        OSError: the pack's folder may not be entered.
    """
    try:
        (home / CURRENT).lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


def current(home: Path) -> Path | None:
    """Return the folder that a pack's `current` names, or None where it names none of ours."""
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
    """Return the version for which an installed folder is named; None for other names."""
    match = _FOLDER.fullmatch(folder)
    return match[1] if match else None


def fields(folder: Path) -> PackFields | None:
    """Return what a pack's `pack.yaml` says, or None where there is none that is valid."""
    try:
        return check(open_document(folder / PACK_FILE), PackFields).value
    except LevelError:
        return None


def packs_folder() -> Path:
    """Return the folder of all packs, which need not be there."""
    return user_folder() / "packs"
