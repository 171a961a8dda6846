"""Gestures carried out on the fields of a level."""

from __future__ import annotations

from babyrobot_levels.editor.changes import cells, fields, frame, things, walls
from babyrobot_levels.editor.changes.draft import Draft, RefusedError
from babyrobot_levels.editor.gestures import (
    Fill,
    Gesture,
    Move,
    Paint,
    Path,
    Remove,
    Resize,
    Resolve,
    Set,
    Walls,
    Warp,
    Wind,
)
from babyrobot_levels.language.kinds import NEEDED

_THINGS = {kind.name for kind in NEEDED}
"""The brushes that add a thing with a name."""


def change(draft: Draft, gesture: Gesture) -> None:
    """Change a draft as a gesture says.

    Raises:
        RefusedError: it cannot be carried out.
    """
    match gesture:
        case Walls():
            walls.build(draft, gesture)
        case Paint(brush=brush) if brush in _THINGS:
            things.add_things(draft, gesture)
        case Paint():
            cells.paint(draft, gesture)
        case Warp():
            things.add_warp(draft, gesture)
        case Path():
            things.add_mover(draft, gesture)
        case Move():
            fields.move_entry(draft, gesture)
        case Remove():
            fields.remove_entry(draft, gesture)
        case Set():
            fields.set_field(draft, gesture)
        case Fill():
            cells.fill(draft, gesture)
        case Resize():
            frame.resize(draft, gesture)
        case Wind():
            frame.blow(draft, gesture)
        case Resolve():
            frame.resolve(draft)
        case _:
            raise RefusedError(f"`{gesture.do}` is not known yet")
