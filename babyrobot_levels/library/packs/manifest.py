"""The manifest: what a pack's archive says of itself, in its first entry."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, StrictInt, StrictStr, StringConstraints, ValidationError

from babyrobot_levels.language.base import SLUG, Model, Slug
from babyrobot_levels.language.pack import Version
from babyrobot_levels.library.packs.errors import PackError
from babyrobot_levels.library.packs.paths import MAX_PATH

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
    """A level: its file, and its digest, which a level with a random maze does not have."""

    digest: Digest | None
    file: FilePath


class Manifest(Model):
    """What is in a pack: all its files by their paths, all its levels by their names."""

    format: Literal["babyrobot-levels pack"] = "babyrobot-levels pack"
    format_version: Literal[1] = 1
    name: Slug
    version: Version
    files: dict[FilePath, FileEntry]
    levels: dict[LevelName, LevelEntry]

    def to_bytes(self) -> bytes:
        """Return the manifest as it stands in the archive: JSON in one form."""
        return (json.dumps(self.model_dump(), indent=2, sort_keys=True) + "\n").encode("ascii")


def file_entry(data: bytes) -> FileEntry:
    """Return what a manifest says of a file."""
    return FileEntry(sha256=hashlib.sha256(data).hexdigest(), size=len(data))


def read_manifest(data: bytes) -> Manifest:
    """Return the manifest that bytes hold.

    Raises:
        PackError: they are not a manifest of this version, in the one form that it has.
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
            f"it is in version {version} of the format, and this babyrobot-levels reads version 1: "
            "a newer one may read it"
        )
    try:
        manifest = Manifest.model_validate(found)
    except ValidationError as error:
        place = "/".join(map(str, error.errors(include_url=False)[0]["loc"]))
        raise PackError(f"its manifest is faulty, at {place[:100]!r}") from None
    if manifest.to_bytes() != data:
        raise PackError("its manifest is not written as manifests are")
    return manifest


def check_files(manifest: Manifest, files: Mapping[str, bytes]) -> None:
    """Make sure that files are those of a manifest, byte for byte.

    Raises:
        PackError: one is missing, too many, or different.
    """
    for path in sorted(manifest.files.keys() - files.keys()):
        raise PackError(f"{path!r} is in its manifest, but not in the archive")
    for path, data in files.items():
        entry = manifest.files.get(path)
        if entry is None:
            raise PackError(f"{path!r} is in the archive, but not in its manifest")
        if entry != file_entry(data):
            raise PackError(f"{path!r} is damaged: its SHA-256 is not the manifest's")
