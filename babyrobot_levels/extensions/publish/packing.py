"""`pack`: a folder of levels, checked and written as one file."""

import os
from dataclasses import replace
from pathlib import Path

from babyrobot_levels.extensions.packs import build
from babyrobot_levels.extensions.packs.archive import SUFFIX, PackError
from babyrobot_levels.extensions.packs.build import Packed
from babyrobot_levels.linter.linting import lint
from babyrobot_levels.text.diagnostics import Severity
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import write_new


def pack(
    folder: str | os.PathLike[str] = ".",
    path: str | os.PathLike[str] | None = None,
    *,
    force: bool = False,
) -> Packed:
    """Check a folder of levels, and pack it into one file, as `babyrobot pack` does.

    Args:
        folder: the folder, with a `pack.yaml`.
        path: the file to write; by default `NAME-VERSION.brlpack` in the current folder.
        force: whether to replace an existing file.

    Returns:
        What is in the pack, the files that were left out, and the findings that are no errors.

    Raises:
        PackError: there is no such folder, it has no `pack.yaml`, or contains more than a pack may.
        LevelError: there are errors in the files; its `diagnostics` tell them.
        FileExistsError: there is a file, and `force` is not given.
    """
    if not Path(folder).is_dir():
        raise PackError(f"there is no folder {os.fspath(folder)}")
    try:
        packed = build.pack(Path(folder), lint)
    except PackError as error:
        raise PackError(f"{os.fspath(folder)} cannot be packed: {error}") from None
    fields = packed.contents.fields
    if fields is None or packed.data is None:
        raise LevelError(e for e in packed.diagnostics if e.severity is Severity.ERROR)
    file = Path(f"{fields.name}-{fields.version}{SUFFIX}" if path is None else path)
    write_new(file, packed.data, force=force)
    return replace(packed, path=file)
