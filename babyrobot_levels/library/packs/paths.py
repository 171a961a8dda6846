"""Which files a pack may hold: those whose paths mean the same on every system."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from babyrobot_levels.language.pack import RESERVED
from babyrobot_levels.text.files import MAX_DEPTH, PACK_FILE, SUFFIXES

TEXTS = ("README.md", "LICENSE", "LICENSE.md", "LICENSE.txt")
"""The files of a pack that are not YAML."""

MAX_PATH = 120
"""So many characters a path has at most: on Windows, it is to fit behind the user's folder."""

_PART = re.compile(r"[A-Za-z0-9_]([A-Za-z0-9 ._-]*[A-Za-z0-9_-])?", re.ASCII)


def belongs(name: str) -> bool:
    """Tell whether a file of that name, without its folders, goes into a pack."""
    return name in TEXTS or name.endswith(SUFFIXES)


def is_theme(path: str) -> bool:
    """Tell whether the file with that path is a theme."""
    return "themes" in path.split("/")[:-1]


def path_fault(path: str) -> str | None:
    """Return why a path cannot be that of a pack's file, as `it …`, or None where it can."""
    parts = path.split("/")
    if "\\" in path:
        return "has a backslash in its path"
    if path.startswith("/"):
        return "has an absolute path"
    if re.match("[A-Za-z]:", path):
        return "has a drive in its path"
    if ".." in parts:
        return "lies outside of the pack"
    if len(path) > MAX_PATH:
        return f"has a path of more than {MAX_PATH} characters"
    if len(parts) > MAX_DEPTH + 1:
        return f"lies in more than {MAX_DEPTH} folders"
    for part in parts:
        if part.partition(".")[0].rstrip(" ").lower() in RESERVED:
            return "has a name that Windows keeps for a device"
        if not _PART.fullmatch(part):
            return (
                "has a name that is not the same everywhere: letters and digits of ASCII, `_`, "
                "`-`, and inside of it dots and blanks, are"
            )
    if not belongs(parts[-1]):
        return "is neither YAML nor a README.md or a LICENSE"
    if parts[-1] == PACK_FILE and len(parts) > 1:
        return "is in a folder: a pack holds no other packs"
    return None


def clashes(paths: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield each path that some system takes for another one, and why, as `it …`."""
    seen: dict[str, tuple[str, bool]] = {}
    for path in paths:
        parts = path.split("/")
        for count in range(1, len(parts) + 1):
            begin, is_file = "/".join(parts[:count]), count == len(parts)
            known = seen.setdefault(begin.lower(), (begin, is_file))
            if known[0] != begin:
                yield path, f"differs from {known[0]} by nothing but capital letters"
            elif known[1] != is_file:
                yield path, f"needs {begin} to be a file and a folder"
            else:
                continue
            break
