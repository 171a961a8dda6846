"""Level files in `git diff`: what git gives to a diff driver, told in words.

Git calls a driver with seven arguments: a path, then of each version a file, a hash and a mode. Of
a file that was renamed there are two more, its new path and what git says of it; of one that is not
merged there is only the path. `/dev/null` stands for no file.
"""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from babyrobot_levels.cli.console import wants_color
from babyrobot_levels.cli.differences import difference_text
from babyrobot_levels.cli.diffs import unified
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.source import SourceFile

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level

_NO_FILES = ("/dev/null", "nul")


def is_from_git(arguments: list[str]) -> bool:
    """Tell whether it is git that called."""
    is_unmerged = len(arguments) == 1 and "GIT_DIFF_PATH_COUNTER" in os.environ
    return len(arguments) in (7, 9) or is_unmerged


def text_for_git(arguments: list[str], limit: int | None) -> str:
    """Return the difference that git asks for, a blank line below it.

    What cannot be compared is told as well: git takes a driver that fails for a crash.
    """
    path = arguments[0]
    if len(arguments) == 1:
        return f"{one_line(path)}: not merged yet\n\n"
    new_path = arguments[7] if len(arguments) > 7 else path
    title = path if path == new_path else f"{path} -> {new_path}"
    try:
        before, after = _read(arguments[1], path), _read(arguments[4], new_path)
    except LevelError as fault:
        return f"{one_line(title)}: {one_line(fault.diagnostics[0].message)}\n\n"
    return _told(title, before, after, limit) + "\n"


@dataclass(frozen=True, slots=True)
class Version:
    """A version of a file: its text, and the level that it is, or else what is wrong with it."""

    source: SourceFile
    level: Level | None
    faults: tuple[str, ...]


def _read(file: str, path: str) -> Version | None:
    """Return a version, None for no file."""
    from babyrobot_levels.library.reading import load_source
    from babyrobot_levels.text.files import read_source

    if file in _NO_FILES:
        return None
    source = read_source(Path(file), path)
    # The other version may lie in a folder of git's, but its themes lie where the path says.
    try:
        return Version(source, load_source(source, Path(path)), ())
    except LevelError as error:
        first = error.diagnostics[0]
        return Version(source, None, (f"line {first.line}: {one_line(first.message)}",))


def _told(title: str, before: Version | None, after: Version | None, limit: int | None) -> str:
    from babyrobot_levels.analysis.diff import diff

    if before is None or after is None:
        return _told_alone(title, before, after)
    if before.level is None or after.level is None:
        versions = {"before": before, "after": after}
        which = " and ".join(name for name, version in versions.items() if version.level is None)
        return f"{one_line(title)}: no valid level {which} the change\n" + _lines(
            title, before, after
        )
    difference = diff(before.level, after.level, limit=limit)
    told = "the same game" if difference.same_game else "another game"
    return difference_text(difference, f"{title}: {told}")


def _told_alone(title: str, before: Version | None, after: Version | None) -> str:
    told, version = ("is gone", before) if after is None else ("is new", after)
    if version is not None and version.level is None:
        text = f"{one_line(title)}: the file {told}, and no valid level\n"
        return text + _lines(title, before, after)
    text = f"{one_line(title)}: the level {told}\n"
    new = after.level if after is not None else None
    return text + f"\n{new.draw()}" if new is not None and not new.has_random_maze else text


def _lines(title: str, before: Version | None, after: Version | None) -> str:
    """Return what is wrong with the versions that are no levels, and which lines differ."""
    faults = [
        f"  {name}, {fault}\n"
        for name, version in (("before", before), ("after", after))
        for fault in (version.faults if version is not None else ())
    ]
    one, two = (version.source.text if version else "" for version in (before, after))
    return "".join(faults) + "\n" + unified(one, two, title, color=wants_color(sys.stdout))
