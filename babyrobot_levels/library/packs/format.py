"""The format of packs: their errors, the paths of their files, and the manifest."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import Field, StrictInt, StrictStr, StringConstraints, ValidationError

from babyrobot_levels.language.base import SLUG, Model, Slug
from babyrobot_levels.language.suite_list import Version
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.files import MAX_DEPTH, PACK_FILE, RESERVED, SUFFIXES


class PackError(BabyRobotError):
    """A pack that is damaged, too large, or different from its manifest."""

    __module__ = "babyrobot_levels"


class PackConflictError(BabyRobotError):
    """Something exists that must not be replaced. `help` says what to do."""

    __module__ = "babyrobot_levels"

    def __init__(self, message: str, help_text: str):
        self.help = help_text
        super().__init__(message, help_text)

    def __str__(self) -> str:
        return str(self.args[0])


class PackNotFoundError(BabyRobotError, LookupError):
    """No pack of that name is installed. `nearest` are the most similar names."""

    __module__ = "babyrobot_levels"

    def __init__(self, name: str, nearest: Sequence[str] = ()):
        self.name, self.nearest = name, tuple(nearest)
        super().__init__(name, self.nearest)

    def __str__(self) -> str:
        name = self.name if len(self.name) <= 100 else self.name[:99] + "…"
        text = f"no pack named {name!r} is installed"
        if self.nearest:
            text += f"; did you mean {' or '.join(map(repr, self.nearest))}?"
        return text


TEXTS = ("README.md", "LICENSE", "LICENSE.md", "LICENSE.txt")
"""The files of a pack that are not YAML."""

MAX_PATH = 120
"""The largest number of characters of a path, for the limit of Windows with the user's folder."""

_PART = re.compile(r"[A-Za-z0-9_]([A-Za-z0-9 ._-]*[A-Za-z0-9_-])?", re.ASCII)


def belongs(name: str) -> bool:
    """Return whether a file of that name belongs into a pack."""
    return name in TEXTS or name.endswith(SUFFIXES)


def is_theme(path: str) -> bool:
    """Return whether the file of a path is a theme."""
    return "themes" in path.split("/")[:-1]


def path_fault(path: str) -> str | None:
    """Return why a path is not valid in a pack, as in `it …`, or None if it is valid."""
    parts = path.split("/")
    if "\\" in path:
        return "has a backslash in its path"
    if path.startswith("/"):
        return "has an absolute path"
    if re.match("[A-Za-z]:", path):
        return "has a drive in its path"
    if ".." in parts:
        return "is outside of the pack"
    if len(path) > MAX_PATH:
        return f"has a path of more than {MAX_PATH} characters"
    if len(parts) > MAX_DEPTH + 1:
        return f"is in more than {MAX_DEPTH} folders"
    for part in parts:
        if part.partition(".")[0].rstrip(" ").lower() in RESERVED:
            return "has a name that Windows reserves for a device"
        if not _PART.fullmatch(part):
            return (
                "has a name that is not portable: use ASCII letters and digits, `_` and `-`, and "
                "dots and blanks inside of it"
            )
    if not belongs(parts[-1]):
        return "is neither YAML nor a README.md or LICENSE"
    if parts[-1] == PACK_FILE and len(parts) > 1:
        return "is in a folder: a pack cannot contain other packs"
    return None


def clashes(paths: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the paths that clash with others on some system, and why, as in `it …`."""
    seen: dict[str, tuple[str, bool]] = {}
    for path in paths:
        parts = path.split("/")
        for count in range(1, len(parts) + 1):
            begin, is_file = "/".join(parts[:count]), count == len(parts)
            known = seen.setdefault(begin.lower(), (begin, is_file))
            if known[0] != begin:
                yield path, f"differs from {known[0]} only in upper and lower case"
            elif known[1] != is_file:
                yield path, f"needs {begin} to be both a file and a folder"
            else:
                continue
            break


MANIFEST = "MANIFEST.json"

FORMAT = "babyrobot-levels pack"

Sum = Annotated[StrictStr, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
Digest = Annotated[StrictStr, StringConstraints(pattern=r"^sha256:[0-9a-f]{64}$")]
FilePath = Annotated[StrictStr, StringConstraints(max_length=MAX_PATH)]
LevelName = Annotated[StrictStr, StringConstraints(pattern=SLUG, max_length=MAX_PATH)]


class FileEntry(Model):
    """A file: its size in bytes, and the SHA-256 of its bytes."""

    sha256: Sum
    size: Annotated[StrictInt, Field(ge=0)]


class LevelEntry(Model):
    """A level: its file, and its digest, None for a random maze."""

    digest: Digest | None
    file: FilePath


class Manifest(Model):
    """The manifest of a pack: its files by path, its levels by name."""

    format: Literal["babyrobot-levels pack"] = "babyrobot-levels pack"
    format_version: Literal[1] = 1
    name: Slug
    version: Version
    files: dict[FilePath, FileEntry]
    levels: dict[LevelName, LevelEntry]

    def to_bytes(self) -> bytes:
        """Return the manifest as canonical JSON."""
        return (json.dumps(self.model_dump(), indent=2, sort_keys=True) + "\n").encode("ascii")


def file_entry(data: bytes) -> FileEntry:
    """Return the entry of a file."""
    return FileEntry(sha256=hashlib.sha256(data).hexdigest(), size=len(data))


def read_manifest(data: bytes) -> Manifest:
    """Parse a manifest.

    Raises:
        PackError: it is not a canonical manifest of this version.
    """
    try:
        found: Any = json.loads(data)
    except (ValueError, RecursionError):
        raise PackError("its manifest is not JSON") from None
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        raise PackError("its manifest is not that of a pack of levels")
    version = found.get("format_version")
    if isinstance(version, int) and version > 1:
        raise PackError(
            f"it has version {version} of the format, and this babyrobot-levels reads version 1; "
            "a newer one may read it"
        )
    try:
        manifest = Manifest.model_validate(found)
    except ValidationError as error:
        place = "/".join(map(str, error.errors(include_url=False)[0]["loc"]))
        raise PackError(f"its manifest is invalid, at {place[:100]!r}") from None
    if manifest.to_bytes() != data:
        raise PackError("its manifest is not in canonical form")
    return manifest


def check_files(manifest: Manifest, files: Mapping[str, bytes]) -> None:
    """Check that files are those of a manifest, byte for byte.

    Raises:
        PackError: one is missing, unexpected, or different.
    """
    for path in sorted(manifest.files.keys() - files.keys()):
        raise PackError(f"{path!r} is in its manifest, but not in the archive")
    for path, data in files.items():
        entry = manifest.files.get(path)
        if entry is None:
            raise PackError(f"{path!r} is in the archive, but not in its manifest")
        if entry != file_entry(data):
            raise PackError(f"{path!r} is damaged: its SHA-256 is not the manifest's")
