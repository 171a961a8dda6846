"""Changes as values: what stood somewhere before, and what stands there after."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from typing import Any


@dataclass(frozen=True, slots=True)
class Change:
    """One thing that differs.

    Attributes:
        before: what it was, as plain data.
        after: what it is.
        cell: where, `(x, y)`; None for what is not in one cell.
        name: which side, action or field.
    """

    before: Any
    after: Any
    cell: tuple[int, int] | None = None
    name: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data, without what does not apply."""
        return {
            **({"cell": list(self.cell)} if self.cell is not None else {}),
            **({"name": self.name} if self.name is not None else {}),
            "before": self.before,
            "after": self.after,
        }


@dataclass(frozen=True, slots=True)
class Changes:
    """Changes of one kind. `count` is how many there are of `total`; `first` holds the first."""

    count: int
    total: int
    first: tuple[Change, ...]

    @classmethod
    def of(
        cls, places: list[Any], total: int, tell: Callable[[Any], Change], limit: int | None
    ) -> Changes:
        """Return the changes in some places, of which only the first `limit` are told."""
        return cls(len(places), total, tuple(map(tell, islice(places, limit))))

    def to_dict(self) -> dict[str, Any]:
        """Return them as plain data."""
        first = [change.to_dict() for change in self.first]
        return {"count": self.count, "total": self.total, "first": first}
