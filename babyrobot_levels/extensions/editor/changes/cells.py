"""What is put into cells: puddles, blocked cells, areas, starts, exits, things, and nothing."""

from collections import defaultdict, deque
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any

from babyrobot_levels.extensions.editor.changes.draft import (
    GROUND,
    PUDDLES,
    STANDING,
    Draft,
    RefusedError,
    as_cell,
    erase,
    forget_missing,
    put_exits,
    put_starts,
    unused_name,
)
from babyrobot_levels.extensions.editor.changes.robots import erase_robots, own_ends, own_start
from babyrobot_levels.extensions.editor.changes.routes import ordered, plain_value
from babyrobot_levels.extensions.editor.changes.shapes import (
    Box,
    Entry,
    Run,
    add_box,
    boxes_of,
    cut_sides,
    traits_of,
)
from babyrobot_levels.extensions.editor.changes.walls import grid_without_random_maze
from babyrobot_levels.extensions.editor.gestures import Fill, Paint, Path, Warp
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.geometry import Cell, blocked_cells, is_inside, show_cell
from babyrobot_levels.language.kinds import KIND, NEEDED
from babyrobot_levels.language.things import SHAPES, hit_reward
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import DELTAS, MOVES
from babyrobot_levels.mdp.grid import BIT, grid_with_doors
from babyrobot_levels.text.words import listed

MAX_CELLS = 1 << 16
"""The most cells that are painted at once."""


def paint(draft: Draft, gesture: Paint) -> None:
    """Paint cells."""
    cells = _cells_of(draft.level, gesture)
    match gesture.brush:
        case "start":
            _paint_starts(draft, cells, add=gesture.add)
        case "exit":
            _paint_exits(draft, cells, add=gesture.add)
        case "erase":
            _erase_all(draft, cells)
        case brush:
            _paint_ground(draft, brush, cells, gesture.fields)


def fill(draft: Draft, gesture: Fill) -> None:
    """Paint the cells that a fill paints, see `filled`."""
    cells = filled(draft.level, gesture)
    if gesture.brush == "erase":
        erase(draft, cells, STANDING | GROUND)
    else:
        _paint_ground(draft, gesture.brush, cells, gesture.fields)


def filled(level: Level, gesture: Fill) -> list[Cell]:
    """Return a cell and all cells like it that are reached without passing walls.

    Starts and exits are not erased or blocked, and then are none of them.

    Raises:
        RefusedError: the cell is off the grid, or these are too many cells.
    """
    _check_inside(level, gesture.at)
    stay = {*level.starts, *level.exits} if gesture.brush in ("blocked", "erase") else ()
    return [cell for cell in _alike(level, gesture.at) if cell not in stay]


def _paint_ground(draft: Draft, brush: str, cells: list[Cell], fields: Entry) -> None:
    match brush:
        case "small" | "large":
            _paint_puddles(draft, cells, brush)
        case "blocked":
            _paint_blocked(draft, cells)
        case "area":
            _paint_area(draft, cells, fields)


def _cells_of(level: Level, gesture: Paint) -> list[Cell]:
    """Return the cells of a gesture, each once.

    Raises:
        RefusedError: some are off the grid, or there are too many.
    """
    for cell in gesture.cells:
        _check_inside(level, cell)
    cells = [*dict.fromkeys(gesture.cells)]
    if gesture.rectangle:
        return [*box_between(level, cells[0], cells[-1]).cells]
    _check_count(len(cells))
    return cells


def box_between(level: Level, one: Cell, other: Cell) -> Box:
    """Return the rectangle of which two cells are opposite corners.

    Raises:
        RefusedError: one is off the grid, or these are too many cells.
    """
    for cell in (one, other):
        _check_inside(level, cell)
    box = Box.between(one, other)
    _check_count(box.columns * box.rows)
    return box


def _check_inside(level: Level, cell: Cell) -> None:
    if not is_inside(level, cell):
        width, height = level.size
        raise RefusedError(f"the cell {show_cell(cell)} is off the grid, which is {width}x{height}")


def _check_count(count: int) -> None:
    if count > MAX_CELLS:
        raise RefusedError(f"these are {count:,} cells; paint at most {MAX_CELLS:,} at once")


# -- starts and exits ----------------------------------------------------------------------


def _paint_starts(draft: Draft, cells: list[Cell], *, add: bool) -> None:
    """Make cells the starts; an exit there gives way if there are others."""
    level = draft.level
    if level.robots:
        raise RefusedError("each robot has a start of its own: drag the robot there")
    exits = [cell for cell in level.exits if cell not in cells]
    if level.exits and not exits:
        raise RefusedError("the exit is there: move it to another cell first")
    put_exits(draft, exits, is_drawn_by_lot=level.exit_one_of is not None)
    _unblock(draft, cells)
    put_starts(draft, _with(level.starts, cells, add=add))
    erase(draft, cells, ["areas"], lambda entry: entry.get("ends") is True)
    erase(draft, cells, ["warps"], lambda entry: _acts_in(entry, cells))


def _paint_exits(draft: Draft, cells: list[Cell], *, add: bool) -> None:
    """Make cells the exits; a start there gives way if there are others."""
    level = draft.level
    _free_of_starts(draft, cells)
    _unblock(draft, cells)
    exits = _with(level.common_exits, cells, add=add)
    put_exits(draft, exits, is_drawn_by_lot=add and level.exit_one_of is not None)
    erase(draft, cells, [kind.field for kind in NEEDED])
    erase(draft, cells, ["warps"], lambda entry: as_cell(entry["at"]) in cells)


def _free_of_starts(draft: Draft, cells: list[Cell]) -> None:
    """Remove starts from cells; of several robots, who can leave elsewhere begins there still."""
    level = draft.level
    if level.robots:
        for number, start in enumerate(level.starts):
            if start in cells:
                own_start(draft, number)
        return
    starts = [cell for cell in level.starts if cell not in cells]
    if not starts:
        raise RefusedError("the start is there: move it to another cell first")
    put_starts(draft, starts)


def _with(there: Sequence[Cell], cells: list[Cell], *, add: bool) -> list[Cell]:
    """Return cells that are painted, and those that are there if these are to stay."""
    return [*dict.fromkeys((*there, *cells))] if add else cells


def _acts_in(warp: Entry, cells: list[Cell]) -> bool:
    """Tell whether a warp acts as the robot enters one of some cells."""
    return warp.get("when", "enter") == "enter" and as_cell(warp["at"]) in cells


# -- the ground ----------------------------------------------------------------------------


def _paint_puddles(draft: Draft, cells: list[Cell], size: str) -> None:
    if draft.canvas is not None:
        free = [cell for cell in cells if draft.canvas.at(cell) not in (d.START, d.EXIT)]
        if not free:
            raise RefusedError("a drawing shows one thing in a cell: move the start or exit first")
        for cell in free:
            draft.canvas.put(cell, PUDDLES[size])
        forget_missing(draft)
        return
    _unblock(draft, cells)
    puddles = draft.entries("puddles")
    dry = dict.fromkeys(cells)
    for index, puddle in enumerate(puddles):
        cell = as_cell(puddle["at"])
        if cell in dry:
            del dry[cell]
            if puddle.get("size", "small") != size:
                puddles[index] = {**puddle, "size": size}
    puddles += [{"at": [*cell], "size": size} for cell in dry]


def _paint_blocked(draft: Draft, cells: list[Cell]) -> None:
    """Block cells, and erase what cannot stand there."""
    cells = _freed_of_ends(draft, cells, are_exits_kept=True)
    if not cells:
        raise RefusedError("the start or the exit is there: move it to another cell first")
    erase(draft, cells, STANDING)
    _remove_doors(draft, cells)
    if draft.canvas is not None:
        for cell in cells:
            draft.canvas.put(cell, d.BLOCKED)
        forget_missing(draft)
        return
    is_blocked = blocked_cells(draft.level)
    for box in boxes_of(cell for cell in cells if not is_blocked(cell)):
        add_box(draft.entries("blocked"), box, {}, in_order=False)


def _remove_doors(draft: Draft, cells: list[Cell]) -> None:
    """Remove the doors at cells."""
    if not draft.level.doors:
        return
    for cell in cells:
        for side in SIDES:
            run = Run.of(cell, side)
            cut_sides(draft.entries("doors"), run)
            if draft.canvas is not None and run.line >= 0:
                draft.canvas.unmark(run, d.DOOR)


def _paint_area(draft: Draft, cells: list[Cell], fields: Entry) -> None:
    """Add areas; those that lie below them and would have no effect any more go."""
    traits = traits_of(fields)
    if not traits:
        raise RefusedError("an area needs a colour, a reward, or another property")
    areas = draft.entries("areas")
    for box in boxes_of(cells):
        areas[:] = [
            area
            for area in areas
            if box.within(Box.of(area)) != Box.of(area) or not {*traits_of(area)} <= {*traits}
        ]
        add_box(areas, box, traits, in_order=True)


def _unblock(draft: Draft, cells: list[Cell]) -> None:
    if draft.level.blocked:
        erase(draft, cells, ["blocked"])


# -- the eraser ----------------------------------------------------------------------------


def _erase_all(draft: Draft, cells: list[Cell]) -> None:
    """Take everything out of cells. The last start stays."""
    free = _freed_of_ends(draft, cells, are_exits_kept=False)
    before = draft.result()
    erase(draft, cells, STANDING | GROUND)
    if not free and draft.result() == before:
        raise RefusedError("a level needs a start: put it into another cell instead")


def _freed_of_ends(draft: Draft, cells: list[Cell], *, are_exits_kept: bool) -> list[Cell]:
    """Remove starts and exits from cells, and return the cells without those that have to stay.

    Args:
        draft: the level.
        cells: the cells.
        are_exits_kept: whether the last exits have to stay, like the last starts.
    """
    level = draft.level
    stay: set[Cell] = set()
    exits = [cell for cell in level.common_exits if cell not in cells]
    if exits or not are_exits_kept:
        put_exits(draft, exits, is_drawn_by_lot=level.exit_one_of is not None)
    else:
        stay.update(level.common_exits)
    starts = [cell for cell in level.starts if cell not in cells]
    if level.robots:
        stay |= own_ends(level) if are_exits_kept else erase_robots(draft, cells)
    elif starts:
        put_starts(draft, starts)
    else:
        stay.update(level.starts)
    return [cell for cell in cells if cell not in stay]


# -- filling -------------------------------------------------------------------------------


def _alike(level: Level, first: Cell) -> list[Cell]:
    """Return the cells that are like a cell and reached from it without passing walls."""
    grid = grid_without_random_maze(level)
    if level.doors:
        grid = grid_with_doors(level, grid, [True] * len(level.doors))
    ground = _ground(level)
    found, waiting = {first: None}, deque([first])
    while waiting:
        x, y = waiting.popleft()
        walls = grid.wall_bits[y * grid.width + x]
        for side, (dx, dy) in zip(SIDES, (DELTAS[move] for move in MOVES), strict=True):
            cell = (x + dx, y + dy)
            if not walls & BIT[side] and cell not in found and ground(cell) == ground(first):
                found[cell] = None
                waiting.append(cell)
        _check_count(len(found))
    return sorted(found, key=lambda cell: (cell[1], cell[0]))


def _ground(level: Level) -> Callable[[Cell], Any]:
    """Return a function that tells what a cell is like: blocked, its puddle, and its areas."""
    is_blocked = blocked_cells(level)
    wet = {puddle.at: puddle.size for puddle in level.puddles}
    areas: dict[Cell, list[Any]] = defaultdict(list)
    for area in level.areas:
        traits = (area.color, area.reward, area.skid, area.ends, area.label)
        (x, y), (columns, rows) = area.at, area.size
        for cell in Box(x, y, columns, rows).cells:
            areas[cell].append(traits)
    return lambda cell: (is_blocked(cell), wet.get(cell), areas.get(cell))


# -- things --------------------------------------------------------------------------------


def add_things(draft: Draft, gesture: Paint) -> None:
    """Add a thing of the brush's kind in each cell of a gesture that has none yet."""
    brush = KIND[gesture.brush]
    things = [thing for kind in NEEDED for thing in kind.of(draft.level)]
    taken = {cell for thing in things for cell in thing.places}
    cells = [cell for cell in dict.fromkeys(gesture.cells) if cell not in taken]
    if not cells:
        where = show_cell(gesture.cells[0])
        nouns = listed([kind.one for kind in NEEDED], "or")
        raise RefusedError(f"{where} has {nouns} already: a cell holds one")
    fields = plain_value(gesture.fields)
    has_shape = "shape" in brush.properties
    usual = SHAPES[0] if has_shape else brush.noun
    base = str(fields.pop("name", None) or fields.get("shape") or usual)
    if has_shape and base in SHAPES:
        fields.setdefault("shape", base)
    for cell in cells:
        name = unused_name(draft, base)
        entry = {**fields, "name": name, "at": [*cell]}
        if entry.get("shape") == name:
            # The shape of its name is its shape anyway.
            del entry["shape"]
        draft.entries(brush.field).append(ordered(brush.field, entry))


def add_boxes(draft: Draft, gesture: Paint) -> None:
    """Add a box, or a target, in each cell of a gesture that has none yet."""
    kind = KIND[gesture.brush]
    taken = {entry.at for entry in kind.of(draft.level)}
    cells = [cell for cell in dict.fromkeys(gesture.cells) if cell not in taken]
    if not cells:
        where = show_cell(gesture.cells[0])
        raise RefusedError(f"{where} has {kind.one} already: a cell holds one")
    fields = plain_value(gesture.fields)
    mark = next(iter(kind.marks))
    for cell in cells:
        both = d.together(draft.canvas.at(cell), mark) if draft.canvas and not fields else None
        if draft.canvas is not None and both is not None and both not in draft.level.legend:
            draft.canvas.put(cell, both)
        else:
            draft.entries(kind.field).append(ordered(kind.field, {**fields, "at": [*cell]}))


def add_warp(draft: Draft, gesture: Warp) -> None:
    """Add a warp, or lead the warp that the cell has to another one."""
    for warp in draft.data.get("warps", []):
        if tuple(warp["at"]) == gesture.at:
            warp["to"] = [*gesture.to]
            warp.pop("weights", None)
            return
    draft.entries("warps").append({"at": [*gesture.at], "to": [*gesture.to]})


def add_mover(draft: Draft, gesture: Path) -> None:
    """Add a guard on a path, or a wanderer in a rectangle. To meet the first costs something."""
    cost_of_hits(draft)
    if gesture.rectangle:
        x, y, columns, rows = Box.between(gesture.cells[0], gesture.cells[-1])
        draft.entries("movers").append({"within": {"at": [x, y], "size": [columns, rows]}})
        return
    path = [*_joined(gesture.cells)]
    if len(path) > 1 and path[0] == path[-1]:
        path.pop()
    is_loop = sum(abs(to - at) for at, to in zip(path[-1], path[0], strict=True)) <= 1
    back = {} if is_loop else {"back": True}
    draft.entries("movers").append({"path": [[*cell] for cell in path], **back})


def cost_of_hits(draft: Draft) -> None:
    """Let it cost something to meet the first mover."""
    if not draft.level.movers and "hit" not in draft.data:
        draft.data["hit"] = {"reward": hit_reward(draft.level.rewards, draft.level.size)}


def _joined(cells: list[Cell]) -> Iterator[Cell]:
    """Yield cells with those between two of a row or a column, which a fast pointer leaves out."""
    yield cells[0]
    for (x, y), (to_x, to_y) in pairwise(cells):
        steps = max(abs(to_x - x), abs(to_y - y))
        if min(abs(to_x - x), abs(to_y - y)):
            yield to_x, to_y
            continue
        for step in range(1, steps + 1):
            yield x + (to_x - x) * step // steps, y + (to_y - y) * step // steps
