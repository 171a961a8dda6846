"""All packs that there are: the user's own, and those that Python packages carry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.library.packs.carried import carried_packs
from babyrobot_levels.library.packs.installed import has_current, installed, packs, packs_folder
from babyrobot_levels.text.files import is_folder


@dataclass(frozen=True, slots=True)
class KnownPack:
    """A pack by the name under which its levels are found.

    Attributes:
        name: the pack's name.
        folder: where its levels are.
        origin: how it came here: `"installed"`, `"folder"` for one that was put among the installed
            ones by hand, or `"package NAME VERSION"`.
    """

    name: str
    folder: Path
    origin: str


def known_packs() -> Iterator[KnownPack]:
    """Yield all packs; of those of one name, the first hides the others.

    The user's come first, by name, then those of packages, as Python finds them.
    """
    for mine in packs():
        yield KnownPack(mine.name, mine.folder, "installed" if mine.version else "folder")
    for carried in carried_packs():
        if carried.folder is not None:
            yield KnownPack(carried.name, carried.folder, f"package {carried.package}")


def unusable_packs() -> Iterator[str]:
    """Yield what is to be said of each pack that is announced but cannot be found."""
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
            yield f"{folder} is left out: it may not be entered"
        else:
            why = "its file `current` names no version; install the pack again"
            yield f"{folder} is left out: {why}"
    for carried in carried_packs():
        if carried.folder is None:
            where = f"{carried.value!r} leads to no folder"
            why = where if carried.has_valid_name else "a pack's name has a-z, 0-9 and `-` only"
            yield f"the pack {carried.name!r} of package {carried.package} is left out: {why}"
