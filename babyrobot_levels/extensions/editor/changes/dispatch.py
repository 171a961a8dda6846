"""Gestures carried out on the fields of a level, and whether one made the maze grow anew."""

from babyrobot_levels.extensions.editor.changes import cells, fields, frame, robots, walls
from babyrobot_levels.extensions.editor.changes.draft import Draft
from babyrobot_levels.extensions.editor.gestures import (
    Fill,
    Gesture,
    Move,
    Paint,
    Path,
    Remove,
    Resize,
    Resolve,
    Robot,
    Set,
    Walls,
    Warp,
    Wind,
)
from babyrobot_levels.language.geometry import blocked_cells
from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.grid import BIT

_THINGS = {kind.name for kind in NEEDED}
"""The brushes that add a thing with a name."""


def change(draft: Draft, gesture: Gesture) -> None:
    """Change a draft as a gesture says.

    Raises:
        RefusedError: it cannot be carried out.
    """
    match gesture:
        case Walls():
            walls.build(draft, gesture)
        case Paint(brush="box" | "target"):
            cells.add_boxes(draft, gesture)
        case Paint(brush=brush) if brush in _THINGS:
            cells.add_things(draft, gesture)
        case Paint():
            cells.paint(draft, gesture)
        case Warp():
            cells.add_warp(draft, gesture)
        case Path():
            cells.add_mover(draft, gesture)
        case Robot():
            robots.put_robot(draft, gesture)
        case Move():
            fields.move_entry(draft, gesture)
        case Remove():
            fields.remove_entry(draft, gesture)
        case Set():
            fields.set_field(draft, gesture)
        case Fill():
            cells.fill(draft, gesture)
        case Resize():
            frame.resize(draft, gesture)
        case Wind():
            frame.blow(draft, gesture)
        case Resolve():
            frame.resolve(draft)


# -- mazes -------------------------------------------------------------------------------


def is_regrown(before: Level, after: Level, gesture: Gesture) -> bool:
    """Return whether a gesture that is not about the maze has changed the walls of the maze.

    A maze grows from the first start through all cells that are not blocked. Only walls between
    cells count that are there before and after, and blocked neither before nor after.
    """
    match gesture:
        case Resolve() | Set(route=["maze", *_]) | Remove(route=["maze", *_]):
            return False
    if before.maze is None or after.maze is None:
        return False
    if before.has_random_maze or after.has_random_maze:
        return False
    grown_from = [(level.size, level.starts[0], level.blocked) for level in (before, after)]
    if grown_from[0] == grown_from[1]:
        return False
    across, down = gesture.shift if isinstance(gesture, Resize) else (0, 0)
    old, new = _walls(before), _walls(after)
    shifted = (((x + across, y + down, side), wall) for (x, y, side), wall in old.items())
    return any(new.get(place, wall) != wall for place, wall in shifted)


def _walls(level: Level) -> dict[tuple[int, int, str], bool]:
    """Return for each inner side of cells that are not blocked whether the maze has a wall."""
    grid = walls.bare_grid(level)
    width, height = level.size
    is_blocked = blocked_cells(level)
    found = {}
    for y in range(height):
        for x in range(width):
            for side, other in (("E", (x + 1, y)), ("S", (x, y + 1))):
                is_inside = other[0] < width and other[1] < height
                if is_inside and not is_blocked((x, y)) and not is_blocked(other):
                    found[x, y, side] = bool(grid.wall_bits[y * width + x] & BIT[side])
    return found
