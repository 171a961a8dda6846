"""Starts and exits of a level that is being changed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from babyrobot_levels.editor.changes.draft import Draft
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.geometry import Cell


def put_starts(draft: Draft, cells: Sequence[Cell]) -> None:
    """Make some cells the starts. There has to be one."""
    if [*cells] == [*draft.level.starts]:
        return
    if draft.canvas is not None:
        _draw(draft, d.START, cells)
    else:
        draft.data["start"] = _one_or_several(cells)


def put_exits(draft: Draft, cells: Sequence[Cell], *, is_drawn_by_lot: bool = False) -> None:
    """Make some cells the exits; without any, there is none.

    Args:
        draft: the level.
        cells: the cells.
        is_drawn_by_lot: whether one of several is drawn at each reset (`exit_one_of`).
    """
    is_drawn_by_lot = is_drawn_by_lot and len(cells) > 1
    if [*cells] == [*draft.level.exits] and is_drawn_by_lot == ("exit_one_of" in draft.data):
        return
    draft.data.pop("exit_one_of", None)
    if is_drawn_by_lot:
        draft.data.pop("exit", None)
        draft.data["exit_one_of"] = [[*cell] for cell in cells]
    if draft.canvas is not None:
        _draw(draft, d.EXIT, () if is_drawn_by_lot else cells)
    elif not is_drawn_by_lot:
        draft.data["exit"] = _one_or_several(cells) if cells else "none"


def _draw(draft: Draft, character: str, cells: Sequence[Cell]) -> None:
    """Show a character in some cells and nowhere else."""
    assert draft.canvas is not None
    for cell in draft.canvas.find(character):
        if cell not in cells:
            draft.canvas.put(cell, d.PLAIN)
    for cell in cells:
        draft.canvas.put(cell, character)


def _one_or_several(cells: Sequence[Cell]) -> list[Any]:
    return [*cells[0]] if len(cells) == 1 else [[*cell] for cell in cells]
