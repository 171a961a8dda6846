"""Lines of text in a panel: how they are broken, and the room that they take."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

CHARACTER_WIDTH = 0.58
"""About how wide a character is, as a share of the text's size."""

LINE = 18.0
"""The height of a line."""

LINE_SIZE = 13.0
"""The size of its text."""

PANEL_EDGE = 10.0
"""What is free around the lines."""


def wrapped(texts: Sequence[str], width: float) -> list[str]:
    """Return texts as lines that fit into a panel so many pixels wide."""
    columns = max(1, int((width - 2 * PANEL_EDGE) / (LINE_SIZE * CHARACTER_WIDTH)))
    return [
        line
        for text in texts
        for part in text.splitlines() or [""]
        for line in textwrap.wrap(part, columns) or [""]
    ]


def height_of(lines: Sequence[str]) -> float:
    """Return the height of a panel that has room for the lines."""
    return 2 * PANEL_EDGE + LINE * len(lines)
