"""What must hold between things and the level around them; walls are looked at with the grid."""

from collections.abc import Callable, Iterator
from itertools import pairwise

from babyrobot_levels.language.cells import sides_of
from babyrobot_levels.language.drawing import mark_of
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.geometry import Cell, Route, is_inside, off_the_grid, show_cell
from babyrobot_levels.language.kinds import NAMED, NEEDED, Kind
from babyrobot_levels.language.things import DRAWN_NAMES, Item, Mover, as_names
from babyrobot_levels.text.diagnostics import Issue, Key, Location
from babyrobot_levels.text.words import did_you_mean, listed

IsBlocked = Callable[[Cell], bool]

MAX_WAYS = 1 << 14
"""The most cells that the paths and rectangles of all movers may have together."""


def check_things(level: LevelFields, blocked: IsBlocked) -> Iterator[Issue]:
    """Yield the errors of the things of a level, and of what its exits need."""
    if level.exit_one_of is not None and "exit" in level.model_fields_set:
        yield Issue(
            "BR206",
            Key(("exit_one_of",)),
            "`exit_one_of` cannot be combined with `exit`",
            "remove one of them",
        )
    yield from _check_names(level)
    yield from _check_needs(level)
    yield from _check_places(level, blocked)
    if level.robots:
        yield from _check_robots(level)
    else:
        yield from _check_one_robot(level)
    if level.boxes:
        yield from _check_boxes(level, blocked)
    for index, _ in enumerate(level.doors):
        yield from _check_door(level, index)
    if _cells_of_movers(level) > MAX_WAYS:
        message = f"the movers' paths and rectangles have {_cells_of_movers(level):,} cells"
        yield Issue("BR205", ("movers",), f"{message}; the limit is {MAX_WAYS:,}")
    else:
        for index, mover in enumerate(level.movers):
            yield from _check_mover(level, mover, ("movers", index), blocked)
    if level.maze is not None and level.maze.seed == "random":
        yield from _check_random_maze(level)


# -- names ---------------------------------------------------------------------------------


def _check_names(level: LevelFields) -> Iterator[Issue]:
    seen: dict[str, Kind] = {}
    for kind in NAMED:
        for index, thing in enumerate(kind.of(level)):
            if thing.name is not None and thing.name in seen:
                yield Issue(
                    "BR320",
                    _place(level, kind.field, index, "name"),
                    f"the name `{thing.name}` is already that of {seen[thing.name].one}",
                    f"give each {listed([kind.noun for kind in NAMED])} a name of its own",
                )
            seen.setdefault(thing.name, kind)


Part = tuple[str, int, str, *tuple[int, ...]]
"""A part of a thing with a name: the field of the level, its number there, and which."""


def _place(level: LevelFields, field: str, index: int, *more: str | int) -> Location:
    """Return the location of a part of a thing with a name, drawn or written."""
    if index >= (drawn := level._drawn.get(field, 0)):
        return (field, index - drawn, *more)
    number = more[-1] if isinstance(more[-1], int) else 0
    return mark_of(level.map or "", *getattr(level, field)[index].places[number])


def _check_needs(level: LevelFields) -> Iterator[Issue]:
    known = [thing.name for kind in NEEDED for thing in kind.of(level) if thing.name is not None]
    others = {thing.name: kind for kind in NAMED if not kind.need.met for thing in kind.of(level)}
    told: list[tuple[str | tuple[str, ...], Route]] = [(level.exit_needs, ("exit_needs",))]
    for index, door in enumerate(level.doors):
        told += [(door.needs, ("doors", index, "needs")), (door.unless, ("doors", index, "unless"))]
    for names, route in told:
        for number, name in enumerate(as_names(names)):
            if name not in known:
                where = route if isinstance(names, str) else (*route, number)
                yield _unknown_name(level, name, where, known, others.get(name))


def _unknown_name(
    level: LevelFields, name: str, route: Route, known: list[str], other: Kind | None
) -> Issue:
    if other is not None:
        message = f"`{name}` is {other.one}, which can be neither held, switched on nor covered"
        help_text = f"name {listed([kind.one for kind in NEEDED], 'or')}"
        return Issue("BR321", route, message, help_text)
    for character, entry in level.legend.items():
        if name in [getattr(entry, each) for each in DRAWN_NAMES]:
            message = f"the map does not show `{character}`, the {entry.kind} `{name}`"
            return Issue("BR321", route, message, f"draw `{character}` in a cell")
    # Comparing with very many names would take long.
    guess = did_you_mean(name, known) if len(known) <= 200 else ""
    shown = ", ".join(known[:8]) + (", …" if len(known) > 8 else "")
    none = f"the level has {listed([f'no {kind.plural}' for kind in NEEDED])}"
    none = "name a target: `targets: [{…, name: pad}]`" if level.targets else none
    nouns = listed([kind.noun for kind in NEEDED], "or")
    help_text = f"known names: {shown}" if known else none
    return Issue("BR321", route, f"there is no {nouns} `{name}`{guess}", help_text)


# -- what lies in cells, doors -------------------------------------------------------------


def _check_places(level: LevelFields, blocked: IsBlocked) -> Iterator[Issue]:
    """Check where what doors and exits can need lies."""
    exits = set(level.exits)
    entered = {warp.at for warp in level.warps if warp.when == "enter"}
    seen: dict[Cell, tuple[str, int, str]] = {}
    for what, called, cell, part in _lying(level):
        field, number, other = seen.setdefault(cell, (*part[:2], called))
        ground = (
            "a blocked cell"
            if blocked(cell)
            else "an exit"
            if cell in exits
            else "a warp that acts on entering"
            if cell in entered
            else None
        )
        if not is_inside(level, cell):
            yield off_the_grid(level, f"the {what}", cell, _place(level, *part))
        elif ground is not None:
            message = f"the {called} {show_cell(cell)} is on {ground}"
            yield Issue("BR318", _place(level, *part), message, f"move the {what}")
        elif (field, number) != part[:2]:
            message = f"the {called} {show_cell(cell)} is on the cell of the {other}"
            nouns = listed([kind.noun for kind in NEEDED], "or")
            help_text = f"move one of them: a cell holds one {nouns}"
            yield Issue("BR319", _place(level, *part), message, help_text)
    for index, item in enumerate(level.items):
        yield from _check_item(level, item, index)


def _lying(level: LevelFields) -> Iterator[tuple[str, str, Cell, Part]]:
    """Yield what lies where: its noun, what it is called, its cell, and which part says so."""
    for kind in NEEDED:
        for index, thing in enumerate(kind.of(level)):
            called = kind.noun if thing.name is None else f"{kind.noun} `{thing.name}`"
            if thing.at is not None:
                yield kind.noun, called, thing.at, (kind.field, index, "at")
            for number, cell in enumerate(getattr(thing, "one_of", None) or ()):
                yield kind.noun, called, cell, (kind.field, index, "one_of", number)


def _check_item(level: LevelFields, item: Item, index: int) -> Iterator[Issue]:
    route = ("items", index - level._drawn.get("items", 0))
    if item.at is not None and item.one_of is not None:
        message = f"the item `{item.name}` has both `at` and `one_of`"
        yield Issue("BR206", route, message, "remove one of them")
    elif item.at is None and item.one_of is None:
        message = f"the item `{item.name}` has no place"
        yield Issue("BR202", route, message, "add `at: [x, y]`, or `one_of` with several cells")
    listed: set[Cell] = set()
    for number, cell in enumerate(item.one_of or ()):
        if cell in listed:
            yield Issue("BR305", (*route, "one_of", number), f"{show_cell(cell)} is listed twice")
        listed.add(cell)


def _check_door(level: LevelFields, index: int) -> Iterator[Issue]:
    door, route = level.doors[index], ("doors", index)
    last = sides_of(door)[-1]
    if not is_inside(level, door.at):
        yield off_the_grid(level, "the cell", door.at, (*route, "at"))
    elif not is_inside(level, last):
        yield off_the_grid(level, "the last cell of the door", last, (*route, "length"))


# -- boxes ---------------------------------------------------------------------------------


MAX_BOXED = 1 << 14
"""The most cells of a level with boxes."""


def _check_boxes(level: LevelFields, blocked: IsBlocked) -> Iterator[Issue]:
    if (cells := level.size[0] * level.size[1]) > MAX_BOXED:
        message = f"the level has {cells:,} cells; with boxes the limit is {MAX_BOXED:,}"
        yield Issue("BR205", ("boxes",), message, "use a smaller level")
        return
    sent = {cell for warp in level.warps for cell in level.targets_of(warp)}
    seen: set[Cell] = set()
    for index, box in enumerate(level.boxes):
        ground = (
            "a blocked cell"
            if blocked(box.at)
            else "a start"
            if box.at in level.starts
            else "a cell to which a warp leads"
            if box.at in sent
            else None
        )
        where = _place(level, "boxes", index, "at")
        if not is_inside(level, box.at):
            yield off_the_grid(level, "the box", box.at, where)
        elif ground is not None:
            yield Issue(
                "BR318", where, f"the box {show_cell(box.at)} is on {ground}", "move the box"
            )
        elif box.at in seen:
            message = f"{show_cell(box.at)} already has a box"
            yield Issue("BR319", where, message, "keep one box per cell")
        seen.add(box.at)
    if level.ends_covered and seen.issuperset(target.at for target in level.targets):
        message = "all targets are covered at the beginning, which ends the episode"
        where = _place(level, "targets", 0, "at")
        yield Issue("BR327", where, message, "move a box, or add a target or an exit")


# -- robots --------------------------------------------------------------------------------


def _check_robots(level: LevelFields) -> Iterator[Issue]:
    if len(level.robots) == 1:
        help_text = "name a second one, or give `start` and `exit` to the level instead"
        yield Issue("BR328", ("robots",), "`robots` has only one robot", help_text)
    if level.boxes:
        message = "several robots cannot push boxes: `robots` cannot be combined with `boxes`"
        yield Issue("BR206", Key(("robots",)), message, "remove one of them")
    waiting = [robot for robot in level.robots if robot.start is None]
    is_given = level.map is not None or "start" in level.model_fields_set
    given = level.common_starts if is_given else ()
    if len(waiting) != len(given) and level.robots[1:]:
        what = "each robot has a `start`"
        if waiting:
            what = f"{len(waiting)} of the robots have no `start`"
        message = f"{what}, and the level gives {len(given)} more"
        help_text = "give one start for each robot that has none"
        yield Issue("BR328", ("map",) if level.map is not None else ("robots",), message, help_text)
    names = [robot.name for robot in level.robots]
    for index, item in enumerate(level.items):
        if item.robot is not None and item.robot not in names:
            message = f"there is no robot `{item.robot}`{did_you_mean(item.robot, names)}"
            where = ("items", index - level._drawn.get("items", 0), "robot")
            yield Issue("BR321", where, message, f"known names: {', '.join(names)}")


def _check_one_robot(level: LevelFields) -> Iterator[Issue]:
    for index, item in enumerate(level.items):
        if item.robot is not None:
            where = ("items", index - level._drawn.get("items", 0), "robot")
            message = f"there is no robot `{item.robot}`: the level has one, without a name"
            yield Issue("BR321", Key(where), message, "remove `robot`, or list `robots`")


# -- movers --------------------------------------------------------------------------------


def _cells_of_movers(level: LevelFields) -> int:
    return sum(
        len(mover.path or ()) + (mover.within.size[0] * mover.within.size[1] if mover.within else 0)
        for mover in level.movers
    )


def _check_mover(
    level: LevelFields, mover: Mover, route: Route, blocked: IsBlocked
) -> Iterator[Issue]:
    if mover.path is None and mover.within is None:
        help_text = "add `path` with the cells that it walks, or `within` with a rectangle"
        yield Issue("BR202", route, "the mover has neither `path` nor `within`", help_text)
    elif mover.path is not None and mover.within is not None:
        yield Issue("BR206", route, "the mover has both `path` and `within`", "remove one of them")
    elif mover.path is not None:
        yield from _check_path(level, mover, route, blocked)
    else:
        yield from _check_region(level, mover, route, blocked)


def _check_path(
    level: LevelFields, mover: Mover, route: Route, blocked: IsBlocked
) -> Iterator[Issue]:
    path = mover.path or ()
    if mover.start is not None:
        message = "`start` cannot be combined with `path`, which begins with its first cell"
        yield Issue("BR206", Key((*route, "start")), message, "remove `start`")
    for number, cell in enumerate(path):
        where = (*route, "path", number)
        if not is_inside(level, cell):
            yield off_the_grid(level, "the path's cell", cell, where)
        elif blocked(cell):
            message = f"the path's cell {show_cell(cell)} is blocked"
            yield Issue("BR323", where, message, "lead the path around it")
    is_whole = True
    for number, (one, two) in enumerate(pairwise(path), 1):
        if _distance(one, two) > 1:
            is_whole = False
            message = f"{show_cell(two)} is no neighbour of {show_cell(one)}"
            help_text = "list every cell of the path: a mover goes at most one cell a step"
            yield Issue("BR323", (*route, "path", number), message, help_text)
    if is_whole and not mover.back and _distance(path[-1], path[0]) > 1:
        ends = f"its last cell {show_cell(path[-1])} is no neighbour of its first, "
        message = f"the path is not a loop: {ends}{show_cell(path[0])}"
        help_text = "add the cells of the way back, or walk there and back with `back: true`"
        yield Issue("BR323", (*route, "path", len(path) - 1), message, help_text)


def _distance(one: Cell, two: Cell) -> int:
    return abs(one[0] - two[0]) + abs(one[1] - two[1])


def _check_region(
    level: LevelFields, mover: Mover, route: Route, blocked: IsBlocked
) -> Iterator[Issue]:
    assert mover.within is not None
    (left, top), (width, height) = mover.within.at, mover.within.size
    last = (left + width - 1, top + height - 1)
    if mover.back:
        message = "`back` cannot be combined with `within`, where the mover walks at random"
        yield Issue("BR206", Key((*route, "back")), message, "remove `back`")
    if not is_inside(level, mover.within.at):
        yield off_the_grid(level, "the cell", mover.within.at, (*route, "within", "at"))
    elif not is_inside(level, last):
        yield off_the_grid(level, "the last cell of the rectangle", last, (*route, "within"))
    else:
        cells = mover.phases
        if (inside := next(filter(blocked, cells), None)) is not None:
            message = f"the mover's rectangle contains the blocked cell {show_cell(inside)}"
            yield Issue("BR324", (*route, "within"), message, "make it smaller, or move it")
        if mover.start is not None and mover.start not in cells:
            message = f"the mover's start {show_cell(mover.start)} is outside its rectangle"
            help_text = f"the rectangle goes from {show_cell(cells[0])} to {show_cell(cells[-1])}"
            yield Issue("BR324", (*route, "start"), message, help_text)


def _check_random_maze(level: LevelFields) -> Iterator[Issue]:
    help_text = "give the maze a seed"
    if level.doors:
        message = "doors need a maze with a seed: in a random one, walls may stand in their place"
        yield Issue("BR325", Key(("doors",)), message, help_text)
    for index, mover in enumerate(level.movers):
        if mover.path is not None:
            message = "a path needs a maze with a seed: in a random one, walls may cut it off"
            yield Issue("BR325", ("movers", index, "path"), message, help_text)
            break
