"""A level in one line of a paper: its name, the versions that it was made with, its digest."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from babyrobot_levels import __version__
from babyrobot_levels.cli.console import fail, write, write_json
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level

_NAME = re.compile(r"[a-z0-9-]+/[a-z0-9-]+")


def cite(level: Level, argument: str, *, as_json: bool) -> None:
    """Print what a paper needs to say which game was played.

    Args:
        level: the level.
        argument: what it was called by: `pack/name` for a level of a pack.
        as_json: whether to print it as JSON.
    """
    if level.has_random_maze:
        fail(
            "each reset grows another maze of this level, so there is no one game to cite",
            "cite one that says its seed; `babyrobot resolve --maze-seed N` writes it out",
        )
    pack = _pack_in(argument)
    name = level.name if pack is None or level.name is None else f"{pack[0]}/{level.name}"
    if as_json:
        write_json(
            {
                "name": name,
                "pack": None if pack is None else {"name": pack[0], "version": pack[1]},
                "babyrobot_levels": __version__,
                "language": level.version,
                "digest": level.digest,
            }
        )
        return
    name = name or one_line(level.title or "a level without a name")
    made_with = f"babyrobot-levels {__version__}, level language {level.version}"
    if pack is not None:
        made_with = " ".join(["pack", *filter(None, pack)]) + f", {made_with}"
    write(f"{name} ({made_with}), {level.digest}\n")


def _pack_in(argument: str) -> tuple[str, str | None] | None:
    """Return name and version of the pack that an argument names; a folder may have no version."""
    from babyrobot_levels.library.packs.installed import fields
    from babyrobot_levels.library.search_path import pack_places

    # A file of that very name is meant where there is one.
    if not _NAME.fullmatch(argument) or Path(argument).is_file():
        return None
    pack = argument.partition("/")[0]
    folder = next((place.folder for place in pack_places() if place.pack == pack), None)
    if folder is None:
        return None
    found = fields(folder)
    return pack, None if found is None else found.version
