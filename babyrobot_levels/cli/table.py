"""Tables: columns as wide as what stands in them."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from babyrobot_levels.cli.console import wants_color
from babyrobot_levels.text.source import columns


def table(rows: Sequence[Sequence[str]]) -> str:
    """Return rows of cells as a text with aligned columns; the first row is the heading."""
    widths = [max(columns(row[number]) for row in rows) for number in range(len(rows[0]))]
    lines = [
        "  ".join(
            text + " " * (width - columns(text)) for text, width in zip(row, widths, strict=True)
        ).rstrip()
        for row in rows
    ]
    if wants_color(sys.stdout):
        lines[0] = f"\x1b[1m{lines[0]}\x1b[0m"
    return "\n".join(lines) + "\n"
