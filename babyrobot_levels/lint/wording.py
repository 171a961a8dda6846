"""How findings speak of cells."""

from __future__ import annotations

from collections.abc import Sequence

SHOWN = 4
"""So many cells are named; of the others, only how many they are."""


def cells_text(cells: Sequence[tuple[int, int]]) -> str:
    """Return cells as a message names them: `[1, 2]`, `[1, 2] and [1, 3]`, `… and 7 more`."""
    names = [f"[{x}, {y}]" for x, y in cells[:SHOWN]]
    if len(cells) > SHOWN:
        names.append(f"{len(cells) - SHOWN} more")
    if len(names) == 1:
        return names[0]
    return f"{', '.join(names[:-1])} and {names[-1]}"


def cells_count(cells: Sequence[tuple[int, int]]) -> str:
    """Return how many cells there are, and which: `the cell [1, 2]`, `2 cells ([1, 2] and …)`."""
    if len(cells) == 1:
        return f"the cell {cells_text(cells)}"
    return f"{len(cells)} cells ({cells_text(cells)})"
