"""What a page knows of a sight through which its level is played."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class PageSight:
    """A sight through which a level is played.

    Attributes:
        best: what the best agent with this sight can expect, as a text; empty if it is not known.
        data: what the page's script reads: what is shown in each state, which cells are seen, and
            the best agent; see `extensions/sight/page.py`.
    """

    best: str
    data: dict[str, Any]
