"""Theme files: `themes/NAME.yaml` beside a level, or further up in its pack."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from babyrobot_levels.language.looks import Theme
from babyrobot_levels.language.validation import Checked, check
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import (
    MAX_DEPTH,
    PACK_FILE,
    SUFFIXES,
    is_file,
)
from babyrobot_levels.text.reader import open_document


def theme_folders(folder: Path) -> list[Path]:
    """Return where the themes of the levels in a folder stand, the nearest first.

    In `themes/` of the folder itself; of a folder in a pack, also of those around it, up to the one
    that holds the `pack.yaml`.
    """
    # Up by names, not by links: what a link leads to may lie in another pack, or in none.
    here = Path(os.path.abspath(folder))  # noqa: PTH100
    around = [folder, *here.parents[:MAX_DEPTH]]
    for number, each in enumerate(around, 1):
        if os.path.lexists(each / PACK_FILE):
            return [inner / "themes" for inner in around[:number]]
    return [folder / "themes"]


def read_theme(name: str, folders: Sequence[Path]) -> Checked[Theme]:
    """Return the theme of that name from the first folder that has it, or what is wrong with it.

    None, and nothing wrong, where no folder has it.
    """
    for folder in folders:
        for suffix in SUFFIXES:
            path = folder / f"{name}{suffix}"
            if is_file(path):
                try:
                    return check(open_document(path), Theme)
                except LevelError as error:
                    return Checked(None, [*error.diagnostics])
    return Checked(None, [])


def theme_names(folders: Sequence[Path]) -> list[str]:
    """Return the names of the themes in some folders, sorted."""
    return sorted(
        {path.stem for folder in folders for path in _inside(folder) if path.suffix in SUFFIXES}
    )


def _inside(folder: Path) -> list[Path]:
    """Return what is in a folder: nothing where it is not there, or not for us to see."""
    try:
        return [*folder.iterdir()]
    except OSError:
        return []
