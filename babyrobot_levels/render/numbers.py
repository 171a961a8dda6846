"""Numbers of cells as lines of text, in rows and columns."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

WIDEST = 16
"""Numbers of wider levels do not fit on a screen."""


def number_lines(rows: Sequence[Sequence[float | None]], precision: int) -> Iterator[str]:
    """Yield a line for each row. None and nan leave their cells empty."""
    shown = [
        ["" if value is None or math.isnan(value) else f"{value:.{precision}f}" for value in row]
        for row in rows
    ]
    width = max(len(text) for row in shown for text in row)
    for row in shown:
        yield "  ".join(text.rjust(width) for text in row).rstrip()
