"""Walls, glass and doors along runs of sides, and openings in mazes."""

from collections.abc import Iterator

from babyrobot_levels.extensions.editor.changes.draft import Draft, RefusedError, names_of
from babyrobot_levels.extensions.editor.changes.shapes import Entry, Run, cut_sides
from babyrobot_levels.extensions.editor.gestures import Walls
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.cells import GLASS_PASS
from babyrobot_levels.language.drawing import consecutive
from babyrobot_levels.language.geometry import Cell, blocked_cells, show_cell
from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.grid import BIT, Grid, build_grid
from babyrobot_levels.text.words import listed

PLAIN_FIELDS = {"at", "side", "length"}
"""The fields of a wall that looks like any other."""

_MARKS = {"none": d.OPEN, "wall": d.SOLID, "glass": d.GLASS, "door": d.DOOR}

_FIELDS = {
    "none": ("openings",),
    "wall": ("walls",),
    "glass": ("walls",),
    "door": ("openings", "doors"),
}
"""The fields whose entries make a side so."""


def build(draft: Draft, gesture: Walls) -> None:
    """Build or remove walls along a run of sides."""
    run = Run.of(gesture.at, gesture.side, gesture.length)
    _check_place(draft.level, gesture, run)
    before = [*_kinds(draft.level, run)]
    to = gesture.to
    chance = gesture.pass_ if to == "glass" else 0.0
    if to == "glass" and not chance:
        to = "wall"
    is_known = not draft.level.has_random_maze or to != "none"
    if is_known and all(kind == (to, chance) for kind in before):
        return
    builder = _Builder(draft, to, chance)
    for part in _useful(draft.level, run, to):
        builder.build(part)


class _Builder:
    """Makes the sides of runs what they shall be.

    Args:
        draft: the level.
        to: what they shall be: none, wall, glass or door.
        chance: the probability of getting through glass.
    """

    def __init__(self, draft: Draft, to: str, chance: float) -> None:
        self.draft, self.to, self.chance = draft, to, chance

    def build(self, run: Run) -> None:
        """Change the sides of a run."""
        draft, to = self.draft, self.to
        kept = {field: self._entry_of(field, run) for field in _FIELDS[to]}
        for field in ("walls", "openings", "doors"):
            if field in draft.data:
                cut_sides(draft.entries(field), run, kept.get(field))
        if draft.canvas is not None:
            draft.canvas.mark(run, _MARKS[to])
        if to in ("none", "door") and kept["openings"] is None:
            parts = _parts(run, _maze_walls(draft.level, run))
            draft.entries("openings").extend(part.entry() for part in parts)
        if to == "door" and kept["doors"] is None:
            draft.entries("doors").append(run.entry(needs=_need(draft.level)))
        if to in ("wall", "glass"):
            self._put_wall(run, kept["walls"])

    def _entry_of(self, field: str, run: Run) -> Entry | None:
        """Return the last entry that runs along exactly these sides."""
        entries: list[Entry] = self.draft.data.get(field, [])
        return next((each for each in reversed(entries) if Run.of_entry(each) == run), None)

    def _put_wall(self, run: Run, kept: Entry | None) -> None:
        """Write an entry of `walls`, unless the drawing or the maze says it all."""
        is_drawn = self.draft.canvas is not None
        entry = run.entry() if kept is None else kept
        entry.pop("pass", None)
        if self.chance and not (is_drawn and self.chance == GLASS_PASS):
            entry["pass"] = self.chance
        is_plain = PLAIN_FIELDS.issuperset(entry)
        if is_plain and (is_drawn or _is_of_maze(self.draft.level, run)):
            cut_sides(self.draft.entries("walls"), run)
        elif kept is None:
            self.draft.entries("walls").append(entry)


def _check_place(level: Level, gesture: Walls, run: Run) -> None:
    (x, y), (width, height) = gesture.at, level.size
    lines, places = (width, height) if run.axis == "E" else (height, width)
    if x >= width or y >= height or run.stop > places:
        raise RefusedError(f"these sides are not all on the grid, which is {width}x{height}")
    if not 0 <= run.line < lines - 1:
        side = f"side {gesture.side} of {show_cell(gesture.at)}"
        raise RefusedError(f"{side} is part of the outer wall, which always stays")


def _need(level: Level) -> str:
    """Return the thing that opens a new door: the last one, if possible of no use yet."""
    names = names_of(level)
    if not names:
        nouns = listed([kind.one for kind in NEEDED], "or")
        raise RefusedError(f"a door needs {nouns} that opens it: add one first")
    used = {*level.exit_keys}
    for door in level.doors:
        used.update(door.keys, door.locks)
    return ([name for name in names if name not in used] or names)[-1]


# -- what is there -------------------------------------------------------------------------


def _kinds(level: Level, run: Run) -> Iterator[tuple[str, float]]:
    """Yield what each side of a run is now, and the probability of getting through glass.

    Where a maze is drawn at each reset, its walls do not count.
    """
    grid = grid_without_random_maze(level)
    doors = [Run.of(door.at, door.side, door.length) for door in level.doors]
    here = [door for door in doors if (door.axis, door.line) == (run.axis, run.line)]
    for place, (x, y) in enumerate(run.cells, run.first):
        cell = y * grid.width + x
        glass = grid.glass.get((cell, run.axis))
        if any(door.first <= place < door.stop for door in here):
            yield "door", 0.0
        elif glass is not None:
            yield "glass", glass
        else:
            yield "wall" if _has_wall(grid, run, (x, y)) else "none", 0.0


def grid_without_random_maze(level: Level) -> Grid:
    """Return the level's grid; of a maze that each reset draws, nothing."""
    if level.has_random_maze:
        return build_grid(level.model_copy(update={"maze": None}))
    return level.grid()


def _maze_walls(level: Level, run: Run) -> list[int]:
    """Return the places of a run at which the maze has a wall between two cells that can be opened.

    A maze that each reset draws may have one anywhere.
    """
    if level.maze is None:
        return []
    if level.has_random_maze:
        return [*range(run.first, run.stop)]
    bare, is_blocked = bare_grid(level), blocked_cells(level)
    return [
        place
        for place, cell in enumerate(run.cells, run.first)
        if _has_wall(bare, run, cell) and not any(map(is_blocked, (cell, _other(run, cell))))
    ]


def _is_of_maze(level: Level, run: Run) -> bool:
    """Tell whether the maze has a wall at each side of a run."""
    if level.maze is None or level.has_random_maze:
        return False
    bare = bare_grid(level)
    return all(_has_wall(bare, run, cell) for cell in run.cells)


def bare_grid(level: Level) -> Grid:
    """Return the grid of a level's maze alone."""
    return build_grid(level.model_copy(update={"walls": (), "openings": ()}))


def _has_wall(grid: Grid, run: Run, cell: Cell) -> bool:
    return bool(grid.wall_bits[cell[1] * grid.width + cell[0]] & BIT[run.axis])


def _useful(level: Level, run: Run, to: str) -> list[Run]:
    """Return the parts of a run at which something can stand, or be removed.

    Between two blocked cells there are no walls; beside one, neither glass nor doors.
    """
    if to == "none" or not level.blocked:
        return [run]
    is_blocked = blocked_cells(level)
    most = 1 if to == "wall" else 0
    places = [
        place
        for place, cell in enumerate(run.cells, run.first)
        if sum(map(is_blocked, (cell, _other(run, cell)))) <= most
    ]
    if not places:
        raise RefusedError(f"beside blocked cells, a {to} has no effect: unblock them first")
    return _parts(run, places)


def _other(run: Run, cell: Cell) -> Cell:
    """Return the cell on the other side of a side."""
    x, y = cell
    return (x + 1, y) if run.axis == "E" else (x, y + 1)


def _parts(run: Run, places: list[int]) -> list[Run]:
    """Return the parts of a run that consist of some of its places."""
    return [
        run.part(part[0], part[-1] + 1) for part in consecutive(places, lambda place: (0, place))
    ]
