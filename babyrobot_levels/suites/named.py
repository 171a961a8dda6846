"""What people name levels by: a level, several, a folder of level files, a pack, or a suite."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from babyrobot_levels.language.share_code import is_code
from babyrobot_levels.library.catalogue import LevelLike, is_suite_file, level_path, suite_path
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.search_path import GALLERY, gallery_place, pack_places, yaml_files
from babyrobot_levels.suites.suite import Suite, load_suite
from babyrobot_levels.text.errors import LevelNotFoundError
from babyrobot_levels.text.files import is_file, is_folder

Levels = LevelLike | Suite | Iterable[LevelLike]
"""A level, several, or what `named_levels` finds by a name or a path."""


def named_levels(levels: Levels) -> Suite | Iterable[LevelLike]:
    """Return a suite, or what `load` takes for each level.

    Args:
        levels: the name, the path, or a mapping of a level or a suite; the path of a folder of
            level files; the name of a pack; a `Level`, a `Suite`, or several levels, which are
            returned unchanged.

    Raises:
        LevelNotFoundError: nothing has that name; the error names the nearest ones.
        LevelError: it is a suite, and not valid.
        ValueError: there are no level files in the folder.
        TypeError: it is nothing of these.
        OSError: the folder cannot be read.
    """
    if isinstance(levels, Mapping):
        return load_suite(levels) if levels.get("kind") == "suite" else [levels]
    if isinstance(levels, Level):
        return [levels]
    if not isinstance(levels, str | os.PathLike):
        if not isinstance(levels, Iterable):
            raise TypeError(
                "levels are a name, a path, a mapping, a Level, a Suite, or several levels, "
                f"not {type(levels).__name__}"
            )
        return levels
    if isinstance(levels, str) and is_code(levels):
        return [levels]
    if (suite := suite_named(levels)) is not None:
        return load_suite(suite)
    folder = folder_named(levels)
    if folder is None:
        return [level_path(levels)]
    # The files of packs may be links: some installers of packages make them so.
    is_pack = not is_folder(Path(levels)) and not str(levels).startswith("~")
    found = yaml_files(folder, all_of_them=not is_pack)
    files = [path for path in found if not is_suite_file(path)]
    if not files:
        raise ValueError(f"no level files (.yaml) in {levels}")
    return files


def suite_named(name: str | os.PathLike[str]) -> Path | None:
    """Return the file of the suite that a name or a path stands for, None if there is none."""
    if isinstance(name, str):
        return suite_path(name)
    path = Path(name)
    return path if is_file(path) and is_suite_file(path) else None


def folder_named(name: str | os.PathLike[str]) -> Path | None:
    """Return the folder of levels that a name or a path stands for, None if there is none.

    A level of that name comes before a folder, and a folder before a pack.
    """
    if isinstance(name, str) and (is_code(name) or "\n" in name):
        return None
    try:
        path = level_path(name)
    except LevelNotFoundError:
        if is_folder(Path(name)):
            return Path(name)
        packs = (gallery_place(), *pack_places()) if isinstance(name, str) else ()
        return next((each.folder for each in packs if name == (each.pack or GALLERY)), None)
    return path if is_folder(path) else None
