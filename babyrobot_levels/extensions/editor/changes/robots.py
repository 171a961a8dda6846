"""Several robots: added, with exits of their own, and removed."""

from collections.abc import Collection

from babyrobot_levels.extensions.editor.changes import routes
from babyrobot_levels.extensions.editor.changes.draft import (
    Draft,
    RefusedError,
    as_cell,
    one_or_several,
    put_exits,
    put_starts,
    replace_names,
    unused_name,
)
from babyrobot_levels.extensions.editor.changes.shapes import Entry
from babyrobot_levels.extensions.editor.gestures import Robot
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.geometry import Cell, show_cell
from babyrobot_levels.library.level import Level


def put_robot(draft: Draft, gesture: Robot) -> None:
    """Add a robot, unless one begins in the cell, and give it an exit of its own."""
    starts = draft.level.starts
    if gesture.at not in starts:
        _add(draft, gesture.at)
        number = -1
    elif gesture.to is None or not draft.level.robots:
        where = show_cell(gesture.at)
        raise RefusedError(f"a robot begins in {where}: put another one into another cell")
    else:
        number = starts.index(gesture.at)
    if gesture.to is not None:
        draft.data["robots"][number]["exit"] = [*gesture.to]


def _add(draft: Draft, cell: Cell) -> None:
    robots = draft.entries("robots")
    if not robots:
        robots.append(_named_alone(draft))
    robots.append({"name": unused_name(draft, "robot"), "start": [*cell]})


def _named_alone(draft: Draft) -> Entry:
    """Return the robot that a level has alone, which begins in the first of its starts."""
    starts = draft.level.starts
    draft.lost["start"] += len(starts) - 1
    put_starts(draft, starts[:1])
    name = unused_name(draft, "robot")
    if draft.canvas is not None:
        return {"name": name}
    draft.data.pop("start", None)
    return {"name": name, "start": [*starts[0]]}


def own_start(draft: Draft, number: int) -> None:
    """Let a robot begin by its own `start` where it does, and no longer by one of the level's."""
    entry = routes.get(draft.data, ["robots", number])
    if "start" in entry:
        return
    cell = draft.level.team_starts[number][1]
    entry["start"] = [*cell]
    if draft.canvas is not None:
        draft.canvas.put(cell, d.PLAIN)
        return
    given = draft.data.pop("start")
    left = [as_cell(each) for each in (given if isinstance(given[0], list) else [given])]
    left.remove(cell)
    if left:
        draft.data["start"] = one_or_several(left)


def remove_robot(draft: Draft, number: int) -> None:
    """Remove a robot. One that is left alone is that of a level without a list of robots."""
    own_start(draft, number)
    gone = draft.data["robots"].pop(number)
    draft.lost["exit"] += "exit" in gone
    replace_names(draft, {gone["name"]: None})
    if len(draft.data["robots"]) == 1:
        _leave_alone(draft)


def _leave_alone(draft: Draft) -> None:
    """Make the start and the exit of the last robot those of the level."""
    (entry,) = draft.data.pop("robots")
    draft.data.pop("team", None)
    replace_names(draft, {entry["name"]: None})
    if "exit" in entry:
        draft.lost["exit"] += len({*draft.level.common_exits} - {as_cell(entry["exit"])})
        _draw_over(draft, entry["exit"], d.EXIT)
        put_exits(draft, [as_cell(entry["exit"])])
    if "start" in entry:
        _draw_over(draft, entry["start"], d.START)
        draft.data |= {} if draft.canvas is not None else {"start": entry["start"]}


def _draw_over(draft: Draft, place: list[int], mark: str) -> None:
    """Show a mark in a cell of the drawing, if there is one, that shows nothing yet."""
    if draft.canvas is None:
        return
    cell = as_cell(place)
    if draft.canvas.at(cell) not in (d.PLAIN, mark):
        where = show_cell(cell)
        raise RefusedError(f"{where} shows something already: a cell of a drawing shows one thing")
    draft.canvas.put(cell, mark)


def own_ends(level: Level) -> set[Cell]:
    """Return where robots begin, and the exits that only one of them has."""
    exits = (robot.exit for robot in level.robots)
    return {*level.starts, *(cell for cell in exits if cell is not None)}


def erase_robots(draft: Draft, cells: Collection[Cell]) -> set[Cell]:
    """Remove the robots that begin in cells, and the own exits there; return where one stays.

    The first robot stays if all begin there.
    """
    starts = draft.level.starts
    gone = [number for number, start in enumerate(starts) if start in cells]
    stays = {starts[gone.pop(0)]} if len(gone) == len(starts) else set()
    for entry in draft.data["robots"]:
        if "exit" in entry and as_cell(entry["exit"]) in cells:
            del entry["exit"]
    for number in reversed(gone):
        remove_robot(draft, number)
    return stays
