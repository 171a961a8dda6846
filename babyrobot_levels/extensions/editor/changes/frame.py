"""The size of a level, the wind in its columns and rows, and its maze written out as walls."""

from __future__ import annotations

from collections.abc import Iterable

from babyrobot_levels.extensions.editor.changes.draft import (
    GROUND,
    KIND_OF_FIELD,
    STANDING,
    Draft,
    RefusedError,
    as_cell,
    cells_of,
    drawn_field,
    forget_missing,
    put_exits,
    put_starts,
)
from babyrobot_levels.extensions.editor.changes.placement import Placement
from babyrobot_levels.extensions.editor.changes.robots import own_start
from babyrobot_levels.extensions.editor.changes.shapes import Box
from babyrobot_levels.extensions.editor.gestures import Resize, Wind
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.drawn import resolved_fields
from babyrobot_levels.mdp.grid import OPPOSITE

_NAMES = {side: name for name, side in SIDE_NAMES.items()}


def resize(draft: Draft, gesture: Resize) -> None:
    """Give the level another size.

    What would lie outside is removed, but for the last start and the last exit, which come to lie
    in the nearest cells that are free, as those of each of several robots do.
    """
    level = draft.level
    change = Placement(level.size, gesture.size, gesture.shift, is_frame=True)
    starts, exits = change.cells(level.starts), change.cells(level.common_exits)
    for number, start in enumerate(level.starts if level.robots else ()):
        # In a drawing, those that stay inside are drawn still.
        if draft.canvas is None or change.cell(start) is None:
            own_start(draft, number)
    is_default = not {"exit", "exit_one_of", "map"} & {*draft.data}
    if is_default:
        exits = [(change.new[0] - 1, change.new[1] - 1)] if level.common_exits else []
        starts = [cell for cell in starts if cell not in exits]
    if draft.canvas is not None:
        cells = [(x, y) for y, row in enumerate(draft.canvas.cells) for x in range(len(row))]
        outside = [drawn_field(draft, cell) for cell in cells if change.cell(cell) is None]
        draft.lost.update(KIND_OF_FIELD[field].name for field in outside if field in STANDING)
        draft.canvas.resize(*change.new, *change.shift)
    else:
        draft.data["size"] = [*change.new]
    for field in KIND_OF_FIELD:
        if field in draft.data and field != "robots":
            moved = [change.entry(field, entry) for entry in draft.data[field]]
            draft.data[field] = [entry for entry in moved if entry is not None]
            if field in STANDING or field == "doors":
                draft.lost[KIND_OF_FIELD[field].name] += moved.count(None)
    ends = [*starts, *exits]
    for field, places in (("start_weights", level.starts), ("exit_weights", level.exits)):
        if draft.data.get(field):
            draft.data[field] = change.weights(places, draft.data[field])
    if not starts and not level.robots:
        starts = [_nearest_free(draft, change, level.starts[0], ends)]
    if level.common_exits and not exits:
        exits = [_nearest_free(draft, change, level.common_exits[0], [*ends, *starts])]
    if level.robots:
        _move_robots(draft, change, {*starts, *exits})
    else:
        put_starts(draft, starts)
    if not is_default:
        put_exits(draft, exits, is_drawn_by_lot=level.exit_one_of is not None)
    _move_wind(draft, change)
    forget_missing(draft)


def _move_robots(draft: Draft, change: Placement, taken: set[Cell]) -> None:
    """Move the starts and exits that robots have of their own, in turn."""
    for entry in draft.data["robots"]:
        for name in {"start", "exit"} & entry.keys():
            cell = as_cell(entry[name])
            moved = change.cell(cell) or _nearest_free(draft, change, cell, taken)
            taken.add(moved)
            entry[name] = [*moved]


def _nearest_free(draft: Draft, change: Placement, cell: Cell, ends: Iterable[Cell]) -> Cell:
    """Return the cell nearest to one outside in which nothing stands, for a start or an exit."""
    width, height = change.new
    standing = (entry for field in STANDING for entry in draft.data.get(field, ()))
    taken = {*ends, *(at for entry in standing for at in cells_of(entry))}
    closed = [
        Box.of(entry)
        for field in GROUND
        for entry in draft.data.get(field, ())
        if field == "blocked" or entry.get("ends")
    ]
    canvas, (x, y) = draft.canvas, (cell[0] + change.shift[0], cell[1] + change.shift[1])
    free = (
        at
        for at in Box(0, 0, width, height).cells
        if at not in taken
        and not any(box.has(at) for box in closed)
        and (canvas is None or canvas.at(at) == d.PLAIN)
    )
    found = min(free, key=lambda at: (at[0] - x) ** 2 + (at[1] - y) ** 2, default=None)
    if found is None:
        raise RefusedError("start and exit would have no free cell there")
    return found


def blow(draft: Draft, gesture: Wind) -> None:
    """Set the wind in a column or row, instead of one that blows the other way there."""
    count = draft.level.size[0 if gesture.side in ("N", "S") else 1]
    if gesture.index >= count:
        what = "columns" if gesture.side in ("N", "S") else "rows"
        raise RefusedError(f"the level has {count} {what}, counted from 0")
    wind = draft.data.get("wind") or {}
    strengths = {gesture.side: gesture.strength}
    if gesture.strength:
        strengths[OPPOSITE[gesture.side]] = 0
    for side, strength in strengths.items():
        values = [*(wind.get(_NAMES[side]) or [0] * count)]
        values[gesture.index] = strength
        wind[_NAMES[side]] = values
    _put_wind(draft, wind)


def resolve(draft: Draft) -> None:
    """Write the maze out as walls."""
    level = draft.level
    if level.maze is None:
        raise RefusedError("the level has no maze")
    if level.has_random_maze:
        raise RefusedError("each reset draws another maze: give it a seed first")
    for field, value in resolved_fields(level, level.grid()).items():
        if value is None:
            draft.data.pop(field, None)
        else:
            draft.data[field] = value


def _put_wind(draft: Draft, wind: dict[str, list[int]]) -> None:
    blows = {side: wind[side] for side in SIDE_NAMES if any(wind.get(side) or ())}
    how = {name: wind[name] for name in ("varies", "probability") if name in wind}
    draft.data["wind"] = blows | (how if blows else {})


def _move_wind(draft: Draft, change: Placement) -> None:
    if wind := draft.data.get("wind"):
        across, down = change.shift
        _put_wind(
            draft,
            wind
            | {
                side: _moved_line(wind[side] or [], *args)
                for side in SIDE_NAMES & wind.keys()
                for args in [
                    (across, change.new[0]) if side in ("north", "south") else (down, change.new[1])
                ]
            },
        )


def _moved_line(values: list[int], shift: int, count: int) -> list[int]:
    """Return a value for each of so many columns or rows, 0 for those that are new."""
    places = range(-shift, count - shift)
    return [values[place] if 0 <= place < len(values) else 0 for place in places]
