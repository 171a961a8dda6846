"""Changes: what differs in one place of two levels, and lists of these."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from typing import Any


@dataclass(frozen=True, slots=True)
class Change:
    """One thing that differs.

    Attributes:
        before: its value before, as plain data.
        after: its value after.
        cell: its cell, `(x, y)`; None for what is not in one cell.
        name: the side, action, field or thing.
        things: what each thing is, by name, where the change is of one configuration; see
            `situation`.
    """

    before: Any
    after: Any
    cell: tuple[int, int] | None = None
    name: str | None = None
    things: dict[str, Any] | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data, without what does not apply."""
        return {
            **({"cell": list(self.cell)} if self.cell is not None else {}),
            **({"name": self.name} if self.name is not None else {}),
            **({"things": self.things} if self.things is not None else {}),
            "before": self.before,
            "after": self.after,
        }


@dataclass(frozen=True, slots=True)
class Changes:
    """Changes of one kind: `count` of `total` places differ; `first` lists the first of them."""

    count: int
    total: int
    first: tuple[Change, ...]

    @classmethod
    def of(
        cls, places: list[Any], total: int, describe: Callable[[Any], Change], limit: int | None
    ) -> Changes:
        """Return the changes at some places, of which only the first `limit` are described."""
        return cls(len(places), total, tuple(map(describe, islice(places, limit))))

    def to_dict(self) -> dict[str, Any]:
        """Return them as plain data."""
        first = [change.to_dict() for change in self.first]
        return {"count": self.count, "total": self.total, "first": first}


NO_CHANGES = Changes(0, 0, ())
