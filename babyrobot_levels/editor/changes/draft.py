"""A level that a gesture is changing."""

from __future__ import annotations

from typing import Any

from babyrobot_levels.editor.changes.canvas import Canvas
from babyrobot_levels.language.formatting import NOTHING, Fields, fields_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import BabyRobotError


class RefusedError(BabyRobotError):
    """A gesture that cannot be carried out; the text stays as it is."""


class Draft:
    """The fields of a level while they change.

    Attributes:
        data: the fields as the text gives them, which gestures change in place.
        level: the level before the gesture.
        document: the text before the gesture.
        canvas: the drawing of `map`, which gestures change in place; None if there is none.
    """

    def __init__(self, document: Document, level: Level) -> None:
        self.document, self.level = document, level
        self.data: dict[str, Any] = _copied(document.data)
        self.canvas = None if level.drawing is None else Canvas(level.drawing)

    def entries(self, field: str) -> list[Any]:
        """Return the entries of a list, to be changed in place; a new list if there is none."""
        entries: list[Any] = self.data.setdefault(field, [])
        return entries

    def result(self) -> dict[str, Any]:
        """Return the fields as they are now, in order, without those that became empty."""
        if self.canvas is not None and self.canvas.drawing() != self.level.drawing:
            self.data["map"] = self.canvas.text()
        before = self.document.data
        data = _in_order(self.data, fields_of(Level))
        return {
            name: value
            for name, value in data.items()
            if value not in ([], {}) or before.get(name) == value
        }


def _copied(value: Any) -> Any:
    """Return a copy of plain data, in which nothing is an alias of anything else."""
    if isinstance(value, dict):
        return {key: _copied(inner) for key, inner in value.items()}
    return [*map(_copied, value)] if isinstance(value, list) else value


def _in_order(value: Any, fields: Fields) -> Any:
    """Return plain data with its fields in the order in which they are written."""
    if isinstance(value, dict):
        return {key: _in_order(value[key], fields.of(key)) for key in fields.order(value)}
    if isinstance(value, list) and fields is not NOTHING:
        return [_in_order(each, fields) for each in value]
    return value
