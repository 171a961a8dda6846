"""The folders in which levels are searched: the project's, the gallery, the user's, packs."""

import errno
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from babyrobot_levels.text.files import (
    MAX_DEPTH,
    PACK_FILE,
    SUFFIXES,
    is_aside,
    is_within,
    user_folder,
)

PATH_VARIABLE = "BABYROBOT_LEVELS"
GALLERY = "gallery"
"""`gallery/NAME` is the gallery's level, whatever levels of that name a project has."""


@dataclass(frozen=True, slots=True)
class Place:
    """A folder of levels.

    Attributes:
        folder: the folder.
        pack: the name of the pack that it is, None if it is none.
        origin: what `babyrobot list` calls it.
    """

    folder: Path
    pack: str | None = None
    origin: str = field(default="", compare=False)

    def named(self, name: str) -> str:
        """Return what a level of this name in this place is called: in a pack, `pack/name`."""
        return name if self.pack is None else f"{self.pack}/{name}"


def places() -> Iterator[Place]:
    """Yield the folders in which levels are searched; the first that has a name wins.

    In this order: `levels/` of the current folder, the folders of `BABYROBOT_LEVELS`, the
    gallery, the user's own folder, the user's packs, the packs of installed packages. Later ones
    are determined only when they are asked for. Of packs with the same name, only the first is
    yielded.
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
    from babyrobot_levels.library.packs import known_packs

    names = set()
    for pack in known_packs():
        if pack.name not in names:
            names.add(pack.name)
            yield Place(pack.folder, pack.name, f"pack {pack.name}")


def _candidates() -> Iterator[Place]:
    gallery = gallery_place()
    project = Path("levels")
    # In a checkout of this project, they are the same folder.
    if _real(project) != _real(gallery.folder):
        yield Place(project, origin="levels/")
    yield from (Place(folder, origin=str(folder)) for folder in path_folders())
    yield gallery
    yield Place(user_folder() / "levels", origin="your folder")
    yield from pack_places()


def gallery_place() -> Place:
    """Return the place of the levels that come with this package."""
    return Place(gallery_folder(), origin=GALLERY)


def path_folders() -> list[Path]:
    """Return the folders in the variable `BABYROBOT_LEVELS`."""
    return [Path(name) for name in os.environ.get(PATH_VARIABLE, "").split(os.pathsep) if name]


def _real(folder: Path) -> Path | None:
    """Return the resolved path of a folder, None if it is no readable folder."""
    try:
        return folder.resolve() if folder.is_dir() else None
    except (OSError, RuntimeError):
        return None


def data_folder(name: str) -> Path:
    """Return a folder of data: inside the installed package, or beside it in a checkout."""
    package = Path(__file__).parents[1]
    inside = package / "data" / name
    return inside if inside.is_dir() else package.parent / name


def gallery_folder() -> Path:
    """Return the gallery's folder."""
    return data_folder("levels")


def gallery_order() -> list[str]:
    """Return the names of the gallery's levels, those to look at first at the beginning."""
    lines = (gallery_folder() / "order.txt").read_text("utf-8").splitlines()
    return " ".join(line for line in lines if not line.startswith("#")).split()


def yaml_files(folder: Path, *, all_of_them: bool = False) -> Iterator[Path]:
    """Yield the YAML files below a folder, sorted; not those of themes, nor hidden ones.

    The copies in galleries of web pages are left out, unless the folder is itself in one, and
    virtual environments.

    Args:
        folder: the folder.
        all_of_them: whether none may be left out. Otherwise, what lies too deep and what may not
            be looked into is passed over. Whoever asks for all files means those of the folder, not
            what links in it lead to.

    Raises:
        OSError: none may be left out, and a folder may not be looked into, or a link leads out.
    """
    for here, folders, names in os.walk(folder, onerror=_refuse if all_of_them else None):
        depth = len(Path(here).relative_to(folder).parts)
        folders[:] = sorted(
            name
            for name in folders
            if name != "themes"
            and not name.startswith(".")
            and (all_of_them or depth < MAX_DEPTH)
            and not is_aside(Path(here, name))
        )
        for name in sorted(names):
            path = Path(here, name)
            if path.suffix in SUFFIXES and not name.startswith(".") and name != PACK_FILE:
                if all_of_them and path.is_symlink() and not is_within(path, folder):
                    raise OSError(errno.EPERM, "this link leads out of the folder", str(path))
                yield path


def _refuse(error: OSError) -> None:
    raise error
