"""A working folder with modules of strangers, each of which leaves a mark if it is imported."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

DEPENDENCIES = ["babyrobot_levels", "gymnasium", "numpy", "pydantic", "scipy", "typer", "yaml"]


def strangers(folder: Path) -> Path:
    """Make a folder with a file for each module of Python and of libraries."""
    folder.mkdir()
    for name in (*sys.stdlib_module_names, *DEPENDENCIES):
        text = f"open({str(_mark(folder))!r}, 'a').write(__name__ + ' ')\n"
        (folder / f"{name}.py").write_text(text, "utf-8")
    return folder


def run_among(folder: Path, *command: str | Path, **variables: str) -> str:
    """Run a command in such a folder; what it prints is returned, if no file of it was imported."""
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, **variables},
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=180,
        check=False,
    )
    mark = _mark(folder)
    assert not mark.exists(), mark.read_text("utf-8")
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def _mark(folder: Path) -> Path:
    return folder.with_suffix(".mark")
