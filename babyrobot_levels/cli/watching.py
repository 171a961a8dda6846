"""Runs something again whenever a file is saved."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from babyrobot_levels.render.terminal import moves_cursor

PAUSE = 0.2
"""Seconds between two looks at the files."""


def each_change(files: Callable[[], list[Path]]) -> Iterator[list[Path]]:
    """Yield the files at once, and again whenever one is saved, comes or goes, without end.

    On a terminal, the screen is cleared before each round but the first. Ends with Ctrl-C.

    Args:
        files: gives the files that are watched now.
    """
    shown = files()
    seen = _state(shown)
    while True:
        yield shown
        sys.stdout.flush()
        while True:
            time.sleep(PAUSE)
            shown = files()
            state = _state(shown)
            if state != seen:
                break
        seen = state
        if moves_cursor(sys.stdout):
            sys.stdout.write("\x1b[2J\x1b[H")


def _state(files: list[Path]) -> dict[Path, tuple[int, int] | None]:
    """Return what tells a saved file from the one before: when, and how large."""
    state: dict[Path, tuple[int, int] | None] = {}
    for path in files:
        try:
            status = path.stat()
            state[path] = (status.st_mtime_ns, status.st_size)
        except OSError:
            state[path] = None
    return state
