"""A level that a gesture is changing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from babyrobot_levels.library.level import Level
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import BabyRobotError


class RefusedError(BabyRobotError):
    """A gesture that cannot be carried out; the text stays as it is."""


@dataclass(slots=True)
class Draft:
    """The fields of a level while they change.

    Attributes:
        data: the fields as the text gives them, which gestures change in place.
        level: the level before the gesture.
        document: the text before the gesture.
    """

    data: dict[str, Any]
    level: Level
    document: Document

    @property
    def is_drawn(self) -> bool:
        """Whether the level is drawn: `map` gives size, start, exit, puddles and blocked cells."""
        return self.level.map is not None

    def entries(self, field: str) -> list[Any]:
        """Return the entries of a list, to be changed in place; a new list if there is none."""
        entries: list[Any] = self.data.setdefault(field, [])
        return entries
