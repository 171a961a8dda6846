"""What must hold between the fields of a level: its geometry, checked without any table."""

from collections.abc import Callable, Iterator

from babyrobot_levels.language.cells import (
    RECTANGULAR,
    Opening,
    RandomReward,
    Traits,
    Warp,
    sides_of,
)
from babyrobot_levels.language.fields import LevelFields, as_cells
from babyrobot_levels.language.geometry import (
    Cell,
    Route,
    blocked_cells,
    is_inside,
    off_the_grid,
    painted,
    show_cell,
)
from babyrobot_levels.language.metric_names import NEEDS, THINGS
from babyrobot_levels.text.diagnostics import Issue, Key
from babyrobot_levels.text.words import did_you_mean


def _cells_of(level: LevelFields, field: str) -> list[tuple[Cell, Route]]:
    """Return the cells of `start` or `exit`, each with its route."""
    own: list[tuple[Cell, Route]] = [
        (cell, ("robots", index, field))
        for index, robot in enumerate(level.robots)
        if (cell := getattr(robot, field)) is not None
    ]
    if field == "start" and len(own) == len(level.robots) > 0:
        return own
    return [*_common(level, field), *own]


def _common(level: LevelFields, field: str) -> list[tuple[Cell, Route]]:
    """Return the cells of `start` or `exit` that are not those of one robot."""
    cells = level.common_starts if field == "start" else level.common_exits
    if field == "exit" and level.exit_one_of is not None:
        return [(cell, ("exit_one_of", index)) for index, cell in enumerate(cells)]
    if isinstance(getattr(level, field)[0], tuple):
        return [(cell, (field, index)) for index, cell in enumerate(cells)]
    return [(cell, (field,)) for cell in cells]


def check_ends(level: LevelFields, blocked: Callable[[Cell], bool]) -> Iterator[Issue]:
    """Yield the errors of starts and exits. `blocked` tells whether a cell is blocked."""
    warps = reversed([*enumerate(level.warps)])
    left = {warp.at: number for number, warp in warps if warp.when == "enter"}
    exits = frozenset(level.exits)
    ends = painted(level, ((area, area.ends) for area in level.areas if area.ends is not None))
    for field in ("start", "exit"):
        seen: set[Cell] = set()
        for cell, route in _cells_of(level, field):
            if not is_inside(level, cell):
                yield off_the_grid(level, f"the {field}", cell, route)
            elif blocked(cell):
                code = "BR302" if field == "start" else "BR304"
                given = route[0] in level.model_fields_set
                what = field if given else f"default {field}"
                yield Issue(
                    code,
                    route if given else _blocking(level, cell),
                    f"the {what} {show_cell(cell)} is on a blocked cell",
                    f"move the {field}, or unblock the cell",
                )
            elif cell in seen:
                if not level.robots or (field == "start" and level.team.meet != "pass"):
                    told = "move one, or use `team: {meet: pass}`" if level.robots else "remove one"
                    yield Issue("BR305", route, f"{show_cell(cell)} is listed twice", told)
            elif field == "start" and cell in (_exits_from(level, cell) if level.robots else exits):
                yield Issue(
                    "BR303",
                    _given(level, route, ("exit",)),
                    _start_is_exit(level, cell),
                    "move one of them"
                    if level.exit_one_of is not None
                    else "move one of them, or use `exit: none` for a level without an exit",
                )
            elif field == "start" and cell in left:
                yield Issue(
                    "BR309",
                    _given(level, route, ("warps", left[cell], "at")),
                    f"the start {show_cell(cell)} is on a warp that acts on entering",
                    "move the start, or use `when: leave` for the warp",
                )
            elif field == "start" and ends(cell):
                yield Issue(
                    "BR316",
                    route,
                    f"the start {show_cell(cell)} is on an area that ends the episode",
                    "move the start, or remove `ends` from the area",
                )
            seen.add(cell)


def _exits_from(level: LevelFields, start: Cell) -> tuple[Cell, ...]:
    """Return the exits of those of several robots who begin in a cell."""
    return tuple(
        cell for robot, at in level.team_starts if at == start for cell in level.exits_of(robot)
    )


def _given(level: LevelFields, route: Route, otherwise: Route) -> Route:
    """Return the route of a start or an exit, or another where the file leaves it out."""
    if level.map is not None:
        return ("map",)
    return route if route[0] in level.model_fields_set else otherwise


def _blocking(level: LevelFields, cell: Cell) -> Route:
    """Return the route of the rectangle that blocks a cell."""
    for index, rectangle in enumerate(level.blocked):
        (x, y), (columns, rows) = rectangle.at, rectangle.size
        if x <= cell[0] < x + columns and y <= cell[1] < y + rows:
            return ("blocked", index)
    return ("blocked",)


def _start_is_exit(level: LevelFields, cell: Cell) -> str:
    if level.exit_one_of is not None:
        return f"the start {show_cell(cell)} is also one of the exits that may be drawn"
    start, exit_ = ("start" in level.model_fields_set, "exit" in level.model_fields_set)
    if start and not exit_:
        default = "the default exit is the bottom-right cell"
        return f"the start {show_cell(cell)} is also the exit: {default}"
    if exit_ and not start:
        return f"the exit {show_cell(cell)} is also the start: the default start is [0, 0]"
    if not start:
        return f"start and exit are both {show_cell(cell)} by default"
    return f"the start {show_cell(cell)} is also an exit"


MAX_COVERED = 1 << 24
"""The most cells that all rectangles, walls and openings may cover together."""

MAX_PROBLEMS = 200
"""At most so many errors are reported per file."""


def issues_of(level: LevelFields) -> list[Issue]:
    """Return the errors between the fields of a level, each of which is valid by itself."""
    if too_much := _check_covered(level):
        return too_much
    issues: list[Issue] = []
    for check in (_check_rectangles, _check_maze, _check_sides, _check_wind, _check_moves):
        _collect(issues, check(level))
    blocked = blocked_cells(level)
    for check_cells in (check_ends, _check_puddles, _check_warps, _check_weights):
        _collect(issues, check_cells(level, blocked))
    if level.has_things or level.exit_keys:
        # Most levels have none.
        from babyrobot_levels.language.thing_checks import check_things

        _collect(issues, check_things(level, blocked))
    _collect(issues, _check_expectations(level))
    return issues


def _collect(issues: list[Issue], found: Iterator[Issue]) -> None:
    for issue in found:
        if len(issues) >= MAX_PROBLEMS:
            return
        issues.append(issue)


def _check_covered(level: LevelFields) -> list[Issue]:
    cells = sum(area.size[0] * area.size[1] for area in (*level.areas, *level.blocked))
    cells += sum(opening.length for opening in (*level.walls, *level.openings, *level.doors))
    if cells <= MAX_COVERED:
        return []
    field = "areas" if level.areas else "blocked" if level.blocked else "walls"
    what = (
        "areas, blocked cells, walls and doors" if level.doors else "areas, blocked cells and walls"
    )
    return [
        Issue(
            "BR205",
            (field,),
            f"{what} cover {cells:,} cells, each counted; the limit is {MAX_COVERED:,}",
        )
    ]


def _check_rectangles(level: LevelFields) -> Iterator[Issue]:
    for field in ("areas", "blocked"):
        for index, rectangle in level.written(field):
            (x, y), (columns, rows) = rectangle.at, rectangle.size
            first, last = (x, y), (x + columns - 1, y + rows - 1)
            if not is_inside(level, first):
                yield off_the_grid(level, "the cell", first, (field, index, "at"))
            elif not is_inside(level, last):
                yield off_the_grid(level, "the last cell of the rectangle", last, (field, index))


def _check_maze(level: LevelFields) -> Iterator[Issue]:
    if level.maze is not None and level.maze.algorithm in RECTANGULAR and level.blocked:
        yield Issue(
            "BR317",
            ("maze", "algorithm"),
            f"`{level.maze.algorithm}` cannot grow a maze around blocked cells",
            "use another algorithm, such as `wilson` or `kruskal`, or remove the blocked cells",
        )


def _check_sides(level: LevelFields) -> Iterator[Issue]:
    for field in ("walls", "openings"):
        for index, entry in level.written(field):
            yield from _check_side(level, field, index, entry)


def _check_side(level: LevelFields, field: str, index: int, entry: Opening) -> Iterator[Issue]:
    what = "wall" if field == "walls" else "opening"
    route = (field, index)
    cells = sides_of(entry)
    if not is_inside(level, entry.at):
        yield off_the_grid(level, "the cell", entry.at, (*route, "at"))
        return
    if not is_inside(level, cells[-1]):
        yield off_the_grid(level, f"the last cell of the {what}", cells[-1], (*route, "length"))
        return
    (x, y), (width, height) = entry.at, level.size
    outer = {"N": y == 0, "W": x == 0, "S": y == height - 1, "E": x == width - 1}[entry.side]
    if outer and field == "openings":
        yield Issue(
            "BR310",
            (*route, "side"),
            f"side {entry.side} of {show_cell(entry.at)} is part of the outer wall, "
            "which cannot be opened",
        )
    elif outer and getattr(entry, "pass_", 0) > 0:
        yield Issue(
            "BR311",
            (*route, "pass"),
            f"side {entry.side} of {show_cell(entry.at)} is part of the outer wall, "
            "so `pass` has no effect",
            "remove `pass`",
        )


_FOUR_MOVES = {
    "boxes": "boxes are pushed by four moves",
    "robots": "several robots have four moves each",
    "heading": "a robot that turns has four moves",
}
"""The fields that are for robots that do not move diagonally, and why."""


def _check_moves(level: LevelFields) -> Iterator[Issue]:
    """Yield the fields that levels with diagonal moves do not have."""
    for field, why in _FOUR_MOVES.items():
        # Data of a whole level have its defaults, too.
        is_usual = getattr(level, field) == LevelFields.model_fields[field].get_default()
        if level.moves > 4 and not is_usual:
            message = f"`moves: {level.moves}` does not go with `{field}`: {why}"
            yield Issue("BR330", ("moves",), message, f"remove `moves`, or `{field}`")


def _check_puddles(level: LevelFields, blocked: Callable[[Cell], bool]) -> Iterator[Issue]:
    seen: set[Cell] = set()
    for index, puddle in enumerate(level.puddles):
        route = ("puddles", index, "at")
        if not is_inside(level, puddle.at):
            yield off_the_grid(level, "the puddle", puddle.at, route)
        elif blocked(puddle.at):
            yield Issue("BR306", route, f"the puddle {show_cell(puddle.at)} is on a blocked cell")
        elif puddle.at in seen:
            yield Issue(
                "BR307",
                route,
                f"{show_cell(puddle.at)} already has a puddle",
                "keep one puddle per cell",
            )
        seen.add(puddle.at)


def _check_warps(level: LevelFields, blocked: Callable[[Cell], bool]) -> Iterator[Issue]:
    exits = set(level.exits)
    seen: set[Cell] = set()
    entered: dict[Cell, list[Cell]] = {}
    for index, warp in enumerate(level.warps):
        at_is_good = True
        for route, cell in _cells_of_warp(index, warp):
            if not is_inside(level, cell):
                yield off_the_grid(level, "the warp's cell", cell, route)
            elif blocked(cell):
                yield Issue("BR308", route, f"the warp's cell {show_cell(cell)} is blocked")
            else:
                continue
            at_is_good = False
        if warp.at in seen:
            yield Issue("BR307", ("warps", index, "at"), f"{show_cell(warp.at)} already has a warp")
        elif warp.at in exits:
            yield Issue(
                "BR308",
                ("warps", index, "at"),
                f"the warp {show_cell(warp.at)} is on an exit, where the episode ends",
            )
        elif at_is_good and warp.when == "enter" and not isinstance(warp.to, str):
            entered[warp.at] = [*level.targets_of(warp)]
        seen.add(warp.at)
    yield from _check_circles(level, entered)


def _cells_of_warp(index: int, warp: Warp) -> Iterator[tuple[Route, Cell]]:
    """Yield the cells that a warp names, each with its route."""
    yield ("warps", index, "at"), warp.at
    if isinstance(warp.to, str):
        return
    several = isinstance(warp.to[0], tuple)
    for number, cell in enumerate(as_cells(warp.to)):
        yield ("warps", index, "to", *[number] * several), cell


def _check_circles(level: LevelFields, entered: dict[Cell, list[Cell]]) -> Iterator[Issue]:
    """Yield the warps that form a cycle, which might never end."""
    index_of = {warp.at: index for index, warp in enumerate(level.warps)}
    done: set[Cell] = set()
    for first in entered:
        # The cells on the way here, each with those that are still to be tried from it.
        path: dict[Cell, Iterator[Cell]] = (
            {first: iter(entered[first])} if first not in done else {}
        )
        while path:
            at = next(reversed(path))
            cell = next(path[at], None)
            if cell is None:
                done.add(at)
                del path[at]
            elif cell in path:
                circle = [*path][[*path].index(cell) :]
                path_text = " to ".join(show_cell(step) for step in [*circle[:8], cell])
                yield Issue(
                    "BR308",
                    ("warps", index_of[cell], "to"),
                    f"the warps form a cycle: {path_text}",
                    "change the target of one of them, for example to a cell beside the other",
                )
            elif cell in entered and cell not in done:
                path[cell] = iter(entered[cell])


def _check_weights(level: LevelFields, blocked: Callable[[Cell], bool]) -> Iterator[Issue]:
    """Yield lists of weights that do not fit what is drawn."""
    given: list[tuple[Route, tuple[float, ...], int, str]] = [
        (("start_weights",), level.start_weights, len(level.starts), "start"),
        (("exit_weights",), level.exit_weights, len(level.exit_one_of or ()), "cell"),
    ]
    for index, warp in enumerate(level.warps):
        count = 0 if isinstance(warp.to, str) else len(as_cells(warp.to))
        given.append((("warps", index, "weights"), warp.weights, count, "target"))
    traits: list[tuple[Route, Traits]] = [
        *((("areas", number), area) for number, area in level.written("areas")),
        *((("legend", mark), entry) for mark, entry in level.legend.items()),
    ]
    for route, each in traits:
        if isinstance(each.reward, RandomReward):
            route, count = (*route, "reward", "weights"), len(each.reward.values)
            given.append((route, each.reward.weights, count, "value"))
    for route, weights, count, what in given:
        if weights and route == ("start_weights",) and level.robots:
            message = "of several robots each has a start of its own, and none is drawn"
            yield Issue("BR329", route, message, "remove `start_weights`")
        elif weights and not count:
            lists = {"start": "start", "cell": "exit_one_of", "target": "to"}[what]
            message = f"`{route[-1]}` is given, but `{lists}` has no list of cells"
            yield Issue("BR329", route, message, f"remove `{route[-1]}`, or list the cells")
        elif weights and len(weights) != count:
            message = (
                f"`{route[-1]}` gives {len(weights)} weight{'s' * (len(weights) != 1)} "
                f"for {count} {what}{'s' * (count != 1)}"
            )
            yield Issue("BR329", route, message, f"give one for each {what}")


def _check_wind(level: LevelFields) -> Iterator[Issue]:
    if level.wind is None:
        return
    for side in ("north", "east", "south", "west"):
        strengths = getattr(level.wind, side)
        vertical = side in ("north", "south")
        count = level.size[0] if vertical else level.size[1]
        if strengths is not None and len(strengths) != count:
            line = "column" if vertical else "row"
            fitting = [*strengths, *([0] * count)][:count]
            yield Issue(
                "BR315",
                ("wind", side),
                f"`{side}` gives {len(strengths)} strength{'s' * (len(strengths) != 1)} "
                f"for {count} {line}{'s' * (count != 1)}",
                f"give one for each {line}" + f", such as `{fitting}`" * (count <= 16),
            )


RANDOM_MAZE = "nothing can be said of a maze that is not drawn yet (`seed: random`)"


def _check_expectations(level: LevelFields) -> Iterator[Issue]:
    """Yield what cannot be true of any level, or not of one like this, without its tables."""
    if level.expect is None:
        return
    if level.maze is not None and level.maze.seed == "random":
        help_text = "give the maze a seed, or remove `expect`"
        yield Issue("BR326", Key(("expect",)), RANDOM_MAZE, help_text)
        return
    for name, value in level.expect.stated.items():
        route = ("expect", name)
        if name in (*THINGS, *NEEDS) and not level.has_things:
            message = f"only levels with things have `{name}`, and this one has none"
            yield Issue("BR326", Key(route), message, f"remove `{name}`")
        elif name == "needs":
            yield from _unknown_needs(level, value)
    yield from level.expect.faulty_ranges()


def _unknown_needs(level: LevelFields, names: tuple[str, ...]) -> Iterator[Issue]:
    known = [*(item.name for item in level.items), *(switch.name for switch in level.switches)]
    known += [target.name for target in level.targets if target.name is not None]
    for number, name in enumerate(names):
        if name not in known:
            message = f"there is no item, switch or target `{name}`{did_you_mean(name, known)}"
            yield Issue("BR326", ("expect", "needs", number), message)
