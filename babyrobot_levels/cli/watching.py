"""Watching files for changes."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from babyrobot_levels.render.terminal import moves_cursor

PAUSE = 0.2
"""Seconds between two checks of the files."""


def each_change(files: Callable[[], list[Path]]) -> Iterator[list[Path]]:
    """Yield the files immediately, and again whenever one is saved, added or removed.

    On a terminal, the screen is cleared before each round except the first. Stop with Ctrl-C.

    Args:
        files: returns the files to watch.
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
    """Return the modification time and the size of each file, None if there is no such file."""
    state: dict[Path, tuple[int, int] | None] = {}
    for path in files:
        try:
            status = path.stat()
            state[path] = (status.st_mtime_ns, status.st_size)
        except OSError:
            state[path] = None
    return state
