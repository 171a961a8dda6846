"""Gestures carried out on the fields of a level."""

from __future__ import annotations

from babyrobot_levels.edit import cells, walls
from babyrobot_levels.edit.draft import Draft, RefusedError
from babyrobot_levels.edit.gestures import Gesture, Paint, Walls


def change(draft: Draft, gesture: Gesture) -> None:
    """Change a draft as a gesture says.

    Raises:
        RefusedError: it cannot be carried out.
    """
    match gesture:
        case Walls():
            walls.build(draft, gesture)
        case Paint():
            cells.paint(draft, gesture)
        case _:
            raise RefusedError(f"`{gesture.do}` is not known yet")
