"""A level in one line of a paper: its name, the versions that it was made with, its digest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from babyrobot_levels import __version__
from babyrobot_levels.cli.console import fail, write, write_json
from babyrobot_levels.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.level import Level


def cite(level: Level, *, as_json: bool) -> None:
    """Print what a paper needs to say which game was played."""
    if level.has_random_maze:
        fail(
            "each reset grows another maze of this level, so there is no one game to cite",
            "cite one that says its seed; `babyrobot resolve --maze-seed N` writes it out",
        )
    if as_json:
        write_json(
            {
                "name": level.name,
                "babyrobot_levels": __version__,
                "language": level.version,
                "digest": level.digest,
            }
        )
        return
    name = level.name or one_line(level.title or "a level without a name")
    made_with = f"babyrobot-levels {__version__}, level language {level.version}"
    write(f"{name} ({made_with}), {level.digest}\n")
