"""Files written below a folder, and commands that run there."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from support.sessions import Result, run_here


def write_files(folder: Path, files: Mapping[str, str | bytes]) -> Path:
    """Write files below a folder, and return it."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode() if isinstance(text, str) else text)
    return folder


def babyrobot(*arguments: str | Path) -> Result:
    """Run a command in the current folder, for the current user."""
    return run_here([str(word) for word in arguments], dict(os.environ))
