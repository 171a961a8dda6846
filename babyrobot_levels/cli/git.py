"""Level files in `git diff`: what git gives to a diff driver, told in words.

Git calls a driver with seven arguments: a path, then of each version a file, a hash and a mode. Of
a file that was renamed there are two more, its new path and what git says of it; of one that is not
merged there is only the path. `/dev/null` stands for no file.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from babyrobot_levels.cli.console import wants_color
from babyrobot_levels.cli.differences import difference_text
from babyrobot_levels.cli.diffs import unified
from babyrobot_levels.diagnostics import one_line
from babyrobot_levels.source import SourceFile

if TYPE_CHECKING:
    from babyrobot_levels.level import Level

_NO_FILES = ("/dev/null", "nul")


def is_from_git(arguments: list[str]) -> bool:
    """Tell whether it is git that called."""
    is_unmerged = len(arguments) == 1 and "GIT_DIFF_PATH_COUNTER" in os.environ
    return len(arguments) in (7, 9) or is_unmerged


def text_for_git(arguments: list[str], limit: int | None) -> str:
    """Return the difference that git asks for, a blank line below it.

    What cannot be compared is told as well: git takes a driver that fails for a crash.
    """
    from babyrobot_levels.files import ReadFault

    path = arguments[0]
    if len(arguments) == 1:
        return f"{one_line(path)}: not merged yet\n\n"
    new_path = arguments[7] if len(arguments) > 7 else path
    title = path if path == new_path else f"{path} -> {new_path}"
    try:
        before, after = _read(arguments[1], path), _read(arguments[4], new_path)
    except ReadFault as fault:
        return f"{one_line(title)}: {one_line(str(fault))}\n\n"
    return _told(title, before, after, limit) + "\n"


Version = tuple[SourceFile, "Level | None"] | None
"""A version of a file: its text, and the level that it is, if it is one. None for no file."""


def _read(file: str, path: str) -> Version:
    from babyrobot_levels.files import read_source
    from babyrobot_levels.reading import read_level

    if file in _NO_FILES:
        return None
    source = read_source(Path(file), path)
    # The other version may lie in a folder of git's, but its themes lie where the path says.
    return source, read_level(source, Path(path))[0]


def _told(title: str, before: Version, after: Version, limit: int | None) -> str:
    from babyrobot_levels.difference.levels import diff

    if before is None or after is None:
        return _told_alone(title, after, "is gone" if after is None else "is new")
    if before[1] is None or after[1] is None:
        which = " and ".join(
            name for name, version in (("before", before), ("after", after)) if version[1] is None
        )
        text = unified(before[0].text, after[0].text, title, color=wants_color(sys.stdout))
        return f"{one_line(title)}: no valid level {which} the change\n\n{text}"
    difference = diff(before[1], after[1], limit=limit)
    told = "the same game" if difference.same_game else "another game"
    return difference_text(difference, f"{title}: {told}")


def _told_alone(title: str, version: Version, told: str) -> str:
    text = f"{one_line(title)}: the level {told}\n"
    level = version[1] if version is not None else None
    if version is not None and level is None:
        text += "it is not valid\n"
    elif level is not None and not level.has_random_maze:
        text += f"\n{level.draw()}"
    return text
