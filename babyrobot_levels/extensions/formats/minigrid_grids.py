"""Grids of MiniGrid as levels.

Walls are blocked cells, lava is an area that ends the episode. A door of MiniGrid is a cell, one of
a level stands on a side: the doorway becomes a plain cell, with doors on those of its sides from
which the robot can come. So it cannot be entered without the key, as in MiniGrid.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from babyrobot_levels.extensions.formats.blocks import (
    LAVA_COLOR,
    Edge,
    Rows,
    drawn,
    edge_of,
    replaced,
)
from babyrobot_levels.extensions.formats.conversion import Lost, World
from babyrobot_levels.language import drawing as d

# -- a grid and its task, apart from the package ------------------------------------------------

Cell = tuple[int, int]

LAVA = "~"
"""The mark of a cell with lava; walls, goals and free cells have those of a drawing."""


@dataclass(frozen=True, slots=True)
class Object:
    """An object on the grid that is neither wall, lava, goal nor floor.

    Attributes:
        kind: `door`, `key`, `ball`, `box`, or `obstacle` for a ball that moves.
        color: its colour in MiniGrid.
        at: its cell.
        state: of a door, `open`, `closed` or `locked`; of a key, `boxed` if a box hides it.
    """

    kind: str
    color: str
    at: Cell
    state: str = ""


@dataclass(frozen=True, slots=True)
class Task:
    """What ends an episode.

    Attributes:
        goals: the cells at which it succeeds.
        fails: the cells at which it fails; one that is a goal as well fails before `first`.
        first: the cells that the robot has to come to before a goal counts.
        shown: the cells whose objects are kept for being looked at.
        beside: whether it is enough to come next to a goal, so that its door may stay locked.
        note: how this differs from the task in MiniGrid; empty if it does not.
    """

    goals: tuple[Cell, ...]
    fails: tuple[Cell, ...] = ()
    first: tuple[Cell, ...] = ()
    shown: tuple[Cell, ...] = ()
    beside: bool = False
    note: str = ""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A grid after a reset.

    Attributes:
        rows: the cells row by row: `BLOCKED`, `PLAIN`, `EXIT` for a goal, or `LAVA`.
        objects: the objects, row by row.
        agents: the cells of the agent; an environment has one.
        heading: where it looks: N, E, S or W.
        task: the task; None if it is to reach a goal of `rows`.
        floor: the cells with floor in colours.
    """

    rows: tuple[str, ...]
    objects: tuple[Object, ...]
    agents: tuple[Cell, ...]
    heading: str
    task: Task | None = None
    floor: tuple[Cell, ...] = ()


# -- its level -------------------------------------------------------------------------------

_COLORS = {"yellow": "gold"}
"""Colours of MiniGrid that are hard to see on the ground of a level, and what they become."""

_SHAPES = {"key": "key", "ball": "coin", "box": "box"}
_STEPS = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}
_LETTERS = "abcdefghijklmnpqrstuvwxyzABCDFGHIJKLMNPQRTUVWXYZ0123456789"


def world_of(found: Snapshot, origin: str, texts: Mapping[str, Any] | None = None) -> World:
    """Return the world of a grid.

    Args:
        found: the grid.
        origin: where it comes from, as a sentence.
        texts: fields of the level that a grid does not have, such as its title.
    """
    task = found.task or Task(tuple(d.cells_with(found.rows, d.EXIT)))
    page = _Page(
        tuple(row.replace(d.EXIT, d.PLAIN).replace(d.START, d.PLAIN) for row in found.rows)
    )
    # The objects of the task are exits, or end the episode.
    taken = {*task.goals, *task.fails, *task.first}
    objects = [each for each in found.objects if each.at not in taken]
    keys = _keys(found, objects)
    doors = _doors(found, page, keys)
    things = _end(task, found, page)
    items = [*keys, *(each for each in objects if each.at in task.shown)]
    _draw_items(items, page)
    page.rows = replaced(page.rows, found.agents, d.START)
    obstacles = [each for each in objects if each.kind == "obstacle"]
    things |= _movers(obstacles, page)
    fields = {"version": 1, **(texts or {}), **page.drawing(doors)}
    if page.legend:
        fields["legend"] = page.legend
    if found.heading != "E":
        fields["heading"] = found.heading
    fields |= things
    if doors:
        fields["doors"] = list(doors.values())
    fields["rewards"] = {"step": 0, "exit": 1}
    comments = {"rewards": "MiniGrid's reward also shrinks with each step."}
    if LAVA in page.legend:
        comments["legend"] = "Lava ends the episode."
    left_out = [each for each in objects if each not in items and each.kind != "obstacle"]
    return World(fields, origin, comments, tuple(_lost(found, task, keys, obstacles, left_out)))


# -- the cells that belong to the level ------------------------------------------------------


def cropped(found: Snapshot) -> Snapshot:
    """Return a grid without what cannot be entered around it, and with the rest of that as walls.

    What remains are the cells that are connected, doors and objects aside, to the agent or to a
    goal.
    """
    goals = found.task.goals if found.task else d.cells_with(found.rows, d.EXIT)
    kept = _distances(found.rows, (*found.agents, *goals))
    left, top = (min(cell[axis] for cell in kept) for axis in (0, 1))
    right, bottom = (max(cell[axis] for cell in kept) + 1 for axis in (0, 1))
    rows = tuple(
        "".join(found.rows[y][x] if (x, y) in kept else d.BLOCKED for x in range(left, right))
        for y in range(top, bottom)
    )
    return moved(found, rows, left, top)


def moved(found: Snapshot, rows: Rows, left: int, top: int) -> Snapshot:
    """Return a grid with other rows, which begin at another cell."""

    def cell(at: Cell) -> Cell:
        return at[0] - left, at[1] - top

    task = found.task
    if task is not None:
        names = ("goals", "fails", "first", "shown")
        cells: dict[str, Any] = {each: tuple(map(cell, getattr(task, each))) for each in names}
        task = replace(task, **cells)
    objects = tuple(replace(each, at=cell(each.at)) for each in found.objects)
    agents, floor = (tuple(map(cell, cells)) for cells in (found.agents, found.floor))
    return replace(found, rows=rows, objects=objects, agents=agents, floor=floor, task=task)


def _distances(rows: Rows, begin: Iterable[Cell], closed: Collection[Cell] = ()) -> dict[Cell, int]:
    """Return the cells that are connected to some others, with their distances in steps."""
    distances = dict.fromkeys(begin, 0)
    # The list grows while it is gone through.
    waiting = list(distances)
    for x, y in waiting:
        for right, down in _STEPS.values():
            near = x + right, y + down
            if not (0 <= near[0] < len(rows[0]) and 0 <= near[1] < len(rows)):
                continue
            if near not in distances and near not in closed and rows[near[1]][near[0]] != d.BLOCKED:
                distances[near] = distances[x, y] + 1
                waiting.append(near)
    return distances


# -- the drawing -----------------------------------------------------------------------------


@dataclass
class _Page:
    """The cells of a drawing, and its legend."""

    rows: Rows
    legend: dict[str, dict[str, Any]] = field(default_factory=dict)

    def draw(self, cells: Collection[Cell], preferred: str, meaning: dict[str, Any]) -> None:
        """Draw something in some cells, with the first character that is not yet in use."""
        character = next(each for each in preferred + _LETTERS if each not in self.legend)
        self.legend[character] = meaning
        self.rows = replaced(self.rows, cells, character)

    def drawing(self, doors: Mapping[Edge, Any]) -> dict[str, Any]:
        """Return the field `map`, with doors."""
        width, height = len(self.rows[0]), len(self.rows)
        east, south = (
            tuple(
                "".join(d.DOOR if (x, y, side) in doors else d.OPEN for x in range(columns))
                for y in range(lines)
            )
            for side, columns, lines in (("E", width - 1, height), ("S", width, height - 1))
        )
        return drawn(self.rows, east, south)


def _draw_items(items: Iterable[Object], page: _Page) -> None:
    names: Counter[str] = Counter()
    for item in items:
        name = f"{item.color}-{item.kind}"
        names[name] += 1
        meaning = {
            "item": name if names[name] == 1 else f"{name}-{names[name]}",
            "shape": _SHAPES[item.kind],
            "color": _color(item),
        }
        page.draw([item.at], item.kind[0] + item.color[0], meaning)


def _end(task: Task, found: Snapshot, page: _Page) -> dict[str, Any]:
    """Draw what ends the episode, and return the fields for what a drawing cannot say."""
    fields: dict[str, Any] = {}
    if any(LAVA in row for row in page.rows):
        page.legend[LAVA] = {"color": LAVA_COLOR, "ends": True}
    if fails := [cell for cell in task.fails if cell not in task.goals]:
        page.draw(fails, "x", {"color": LAVA_COLOR, "ends": True})
    page.rows = replaced(page.rows, task.goals, d.EXIT)
    needs = []
    for each in found.objects:
        if each.at in task.first:
            needs.append(f"{each.color}-{each.kind}")
            meaning = {"switch": needs[-1], "once": True, "color": _color(each)}
            page.draw([each.at], each.color[0], meaning)
    if needs:
        fields["exit_needs"] = needs[0] if len(needs) == 1 else needs
    both = [{"at": list(cell), "ends": True} for cell in task.goals if cell in task.fails]
    return fields | ({"areas": both} if both else {})


def _movers(obstacles: Sequence[Object], page: _Page) -> dict[str, Any]:
    room = {"at": [0, 0], "size": [len(page.rows[0]), len(page.rows)]}
    movers = [
        {"name": f"ball-{number}", "within": room, "start": list(each.at), "color": _color(each)}
        for number, each in enumerate(obstacles, 1)
    ]
    return {"movers": movers} if movers else {}


def _color(each: Object) -> str:
    return _COLORS.get(each.color, each.color)


# -- keys and doors --------------------------------------------------------------------------


def _locked(found: Snapshot) -> list[Object]:
    """Return the locked doors that have to be opened to enter their cells."""
    goals = found.task.goals if found.task is not None and found.task.beside else ()
    return [each for each in found.objects if each.state == "locked" and each.at not in goals]


def _keys(found: Snapshot, objects: Sequence[Object]) -> list[Object]:
    """Return for each colour of a locked door its key: the one nearest to the agent."""
    locked = _locked(found)
    distances = _distances(found.rows, found.agents, {door.at for door in locked})
    nearest: dict[str, Object] = {}
    for key in sorted(objects, key=lambda each: distances.get(each.at, len(distances))):
        if key.kind == "key" and any(key.color == door.color for door in locked):
            nearest.setdefault(key.color, key)
    return [each for each in objects if each in nearest.values()]


def _doors(found: Snapshot, page: _Page, keys: Iterable[Object]) -> dict[Edge, dict[str, Any]]:
    """Return the doors on the sides of doorways; a doorway that no key opens becomes a wall."""
    doors: dict[Edge, dict[str, Any]] = {}
    colors = {key.color for key in keys}
    for door in _locked(found):
        if door.color not in colors:
            page.rows = replaced(page.rows, [door.at], d.BLOCKED)
            continue
        reached = _distances(found.rows, found.agents, [door.at])
        x, y = door.at
        for side, (right, down) in _STEPS.items():
            if (x + right, y + down) in reached:
                needs = f"{door.color}-key"
                looks = {"color": _color(door)}
                doors[edge_of(x, y, side)] = {"at": [x, y], "side": side, "needs": needs, **looks}
    return doors


# -- what differs ----------------------------------------------------------------------------

_PLURALS = {"ball": "balls", "box": "boxes", "key": "keys"}


def _lost(
    found: Snapshot,
    task: Task,
    keys: Sequence[Object],
    obstacles: Sequence[Object],
    left_out: Sequence[Object],
) -> Iterable[Lost]:
    """Yield what differs from MiniGrid."""
    if task.note:
        yield Lost("task", task.note)
    elif not task.goals:
        yield Lost("goal", "none is drawn, so the level has no exit and no reward")
    if keys:
        message = "a key is taken by stepping onto it, and kept; in MiniGrid, by an action"
        yield Lost("pickup", message, keys[0].at)
        message = "holding its key opens a door; in MiniGrid, an action does"
        yield Lost("toggle", message, _locked(found)[0].at)
    if boxed := [each for each in keys if each.state == "boxed"]:
        yield Lost("box", "the key in it lies open", boxed[0].at)
    colors = {key.color for key in keys}
    if walls := [each for each in _locked(found) if each.color not in colors]:
        become = "a wall" if len(walls) == 1 else "walls"
        yield Lost("doors", f"{len(walls)} locked, without a key: {become}", walls[0].at)
    if closed := [each for each in left_out if each.state == "closed"]:
        message = f"{len(closed)} closed, not locked: open; in MiniGrid, an action opens it"
        yield Lost("doors", message, closed[0].at)
    if task.shown:
        yield Lost("objects", "stepping onto one takes it; in MiniGrid, they are in the way")
    if others := [each for each in left_out if each.kind != "door"]:
        counts = Counter(each.kind for each in others)
        objects = (f"{n} {kind if n == 1 else _PLURALS[kind]}" for kind, n in counts.items())
        message = f"{', '.join(objects)} left out; in MiniGrid, in the way until moved"
        yield Lost("objects", message, others[0].at)
    if obstacles:
        message = (
            "they step to one of four neighbours, also onto each other and the goal; in MiniGrid, "
            "to any of eight that is free"
        )
        yield Lost("obstacles", message)
        yield Lost("walls", "walking into one changes nothing; in MiniGrid, it ends the episode")
    if found.floor:
        yield Lost("floor", "it gets the colour of the theme", found.floor[0])
    if len(found.agents) > 1:
        message = f"{len(found.agents)} are drawn: each reset draws one of them"
        yield Lost("agents", message, found.agents[1])
