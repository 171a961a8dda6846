"""Puddles, blocked cells, starts and exits: what is painted into cells."""

from __future__ import annotations

from babyrobot_levels.edit.draft import Draft, RefusedError
from babyrobot_levels.edit.gestures import Paint


def paint(draft: Draft, gesture: Paint) -> None:
    """Paint cells."""
    if gesture.brush not in ("small", "large"):
        raise RefusedError(f"the brush {gesture.brush!r} does not paint yet")
    puddles = draft.entries("puddles")
    cells = [[*cell] for cell in gesture.cells]
    puddles[:] = [each for each in puddles if each["at"] not in cells]
    puddles += [{"at": cell, "size": gesture.brush} for cell in cells]
