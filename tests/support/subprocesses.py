"""Fresh interpreters, for what depends on which package is imported first."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import babyrobot_levels

HOME = Path(babyrobot_levels.__file__).parents[1]
"""The folder from which the package is imported."""


def python(
    *arguments: str | Path,
    cwd: Path,
    path: Path | None = None,
    timeout: float = 60,
    warnings: str = "error",
) -> subprocess.CompletedProcess[str]:
    """Run Python with the package under test, warnings being errors, and `path` before it.

    What it prints and how it exits is returned, whatever it is.
    """
    places = [str(folder) for folder in (path, HOME) if folder is not None]
    return subprocess.run(
        [sys.executable, "-W", warnings, *map(str, arguments)],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(places)},
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=timeout,
        check=False,
    )


def run(code: str, cwd: Path, path: Path | None = None, timeout: float = 60) -> str:
    """Run code in a fresh interpreter, which must succeed and not complain; return what it prints.

    Args:
        code: the code.
        cwd: the current folder.
        path: a folder from which packages are imported first.
        timeout: the seconds that it may take.
    """
    done = python("-c", code, cwd=cwd, path=path, timeout=timeout)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    return done.stdout
