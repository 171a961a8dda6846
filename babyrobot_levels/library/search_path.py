"""Where levels are looked for: the gallery, the user's folders, and packs."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.text.files import MAX_DEPTH, PACK_FILE, SUFFIXES, user_folder

PATH_VARIABLE = "BABYROBOT_LEVELS"


@dataclass(frozen=True, slots=True)
class Place:
    """A folder of levels, and the name of the pack that it is, if it is one."""

    folder: Path
    pack: str | None = None

    def named(self, name: str) -> str:
        """Return what a level of this name in this place is called: in a pack, `pack/name`."""
        return name if self.pack is None else f"{self.pack}/{name}"


def places() -> Iterator[Place]:
    """Yield where levels are looked for, the first that has a name winning.

    In this order: the gallery, the user's own folder, `levels/` of the current folder, the
    folders of `BABYROBOT_LEVELS`, the user's packs, the packs of installed packages. What comes
    later is looked up only when it is needed. Of packs with the same name, only the first
    is a place.
    """
    seen: set[tuple[Path, str | None]] = set()
    for place in _candidates():
        real = _real(place.folder)
        # The same folder may be a pack as well.
        if real is not None and (real, place.pack) not in seen:
            seen.add((real, place.pack))
            yield place


def pack_places() -> Iterator[Place]:
    """Yield the places that are packs."""
    # Here, because looking for files in folders needs nothing of it.
    from babyrobot_levels.library.packs.known import known_packs

    names = set()
    for pack in known_packs():
        if pack.name not in names:
            names.add(pack.name)
            yield Place(pack.folder, pack.name)


def _candidates() -> Iterator[Place]:
    yield Place(gallery_folder())
    yield Place(user_folder() / "levels")
    yield Place(Path("levels"))
    yield from map(Place, path_folders())
    yield from pack_places()


def path_folders() -> list[Path]:
    """Return what the variable `BABYROBOT_LEVELS` names."""
    names = os.environ.get(PATH_VARIABLE, "").split(os.pathsep)
    return [Path(name) for name in names if name]


def _real(folder: Path) -> Path | None:
    """Return a folder without the links that lead to it, or None if it is none that we may see."""
    try:
        return folder.resolve() if folder.is_dir() else None
    except (OSError, RuntimeError):
        return None


def gallery_folder() -> Path:
    """Return the gallery's folder: inside the installed package, or beside it in a checkout."""
    package = Path(__file__).parents[1]
    inside = package / "data" / "levels"
    return inside if inside.is_dir() else package.parent / "levels"


def yaml_files(folder: Path, *, all_of_them: bool = False) -> Iterator[Path]:
    """Yield the YAML files below a folder, sorted; not those of themes, nor hidden ones.

    Args:
        folder: the folder.
        all_of_them: whether none may be left out. Otherwise, what lies too deep and what may not
            be looked into is passed over.

    Raises:
        OSError: none may be left out, and a folder may not be looked into.
    """
    for here, folders, names in os.walk(folder, onerror=_refuse if all_of_them else None):
        depth = len(Path(here).relative_to(folder).parts)
        folders[:] = sorted(
            name
            for name in folders
            if name != "themes" and not name.startswith(".") and (all_of_them or depth < MAX_DEPTH)
        )
        for name in sorted(names):
            path = Path(here, name)
            if path.suffix in SUFFIXES and not name.startswith(".") and name != PACK_FILE:
                yield path


def _refuse(error: OSError) -> None:
    raise error
