"""Rules about walls and openings, drawn, listed, or made by a maze."""

from collections.abc import Iterator

from babyrobot_levels.language.cells import GLASS_PASS, Opening, Wall, sides_of
from babyrobot_levels.language.geometry import blocked_cells
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs, count_drawn, side_mark
from babyrobot_levels.linter.fixes import append, removal
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.mdp.grid import build_grid
from babyrobot_levels.text.diagnostics import Fix, Key

Side = tuple[str, int, int]
"""The eastern (`E`) or southern (`S`) side of the cell (x, y)."""


@rule("BR506")
def wall_without_effect(context: LintContext) -> Iterator[Finding]:
    """Entry of `walls` that adds no wall.

    ## What it does

    Checks for entries of `walls` whose walls all exist without them: as part of the maze, of an
    earlier entry, or of the outer wall, or because both sides of them are blocked. Beside a
    drawing, it checks for entries that change no property of the drawn walls. Entries that set a
    colour, a width or `fit` change the picture and are not reported. Walls that an opening
    removes are reported by [`opening-undoes-wall`](opening-undoes-wall.md).

    ## Why is this bad?

    The entry looks as if it had an effect. Usually it was meant for another cell or another side.

    ## Example

    ```yaml
    version: 1
    walls:
      - {at: [0, 0], side: E}
      - {at: [1, 0], side: W}
    ```

    Use instead:

    ```yaml
    version: 1
    walls:
      - {at: [0, 0], side: E}
    ```

    ## Fix safety

    The fix removes the entry. It is safe: neither the MDP nor the picture changes.
    """
    if "walls" not in context.data or _are_separate(context.level):
        return
    drawn = count_drawn(context.level, "walls")
    for number in context.barriers.idle_walls:
        wall = context.level.walls[number]
        (x, y), route = wall.at, ("walls", number - drawn)
        yield Finding(
            route,
            f"the wall on side {wall.side} of [{x}, {y}] has no effect",
            "remove it: the wall exists without it, or the robot cannot get there",
            fix=removal(context.document, "remove the wall", route),
        )


def _are_separate(level: Level) -> bool:
    """Return whether all walls obviously matter: inner walls that do not overlap, and no others."""
    if level.maze is not None or level.map is not None or level.openings or level.blocked:
        return False
    width, height = level.size
    sides: set[tuple[bool, int, int]] = set()
    count = 0
    for wall in level.walls:
        is_vertical = wall.side in ("E", "W")
        for x, y in sides_of(wall):
            across = x + (wall.side == "E") if is_vertical else y + (wall.side == "S")
            if not 0 < across < (width if is_vertical else height):
                return False
            sides.add((is_vertical, across, y if is_vertical else x))
            count += 1
    return len(sides) == count


@rule("BR507")
def opening_without_effect(context: LintContext) -> Iterator[Finding]:
    """Opening that removes no wall.

    ## What it does

    Checks for entries of `openings` on sides without a wall, and for those whose walls are all
    removed by other openings.

    ## Why is this bad?

    The entry looks as if it opened a path. Usually it was meant for another cell or another side.

    ## Example

    ```yaml
    version: 1
    openings:
      - {at: [1, 1], side: E}
    ```

    Use instead:

    ```yaml
    version: 1
    ```

    ## Fix safety

    The fix removes the entry. It is safe: neither the MDP nor the picture changes.
    """
    if not context.level.openings:
        return
    for number in context.barriers.idle_openings:
        opening = context.level.openings[number]
        (x, y), route = opening.at, ("openings", number)
        yield Finding(
            route,
            f"the opening on side {opening.side} of [{x}, {y}] removes no wall",
            "remove it: there is no wall, or another opening removes it",
            fix=removal(context.document, "remove the opening", route),
        )


@rule("BR513")
def opening_undoes_wall(context: LintContext) -> Iterator[Finding]:
    """Opening that removes a wall of the same file.

    ## What it does

    Checks for entries of `openings` that remove all or part of a wall that is drawn or listed under
    `walls`, except where doors stand in all of the opening.

    ## Why is this bad?

    The two entries contradict each other. Usually one of them has the wrong cell or side. If not,
    a wall with a gap is clearer as two walls.

    ## Example

    ```yaml
    version: 1
    walls:
      - {at: [0, 0], side: E}
    openings:
      - {at: [1, 0], side: W}
    ```

    Use instead:

    ```yaml
    version: 1
    walls:
      - {at: [0, 1], side: E}
    ```

    ## Fix safety

    If nothing is left of the wall, the fix removes its entry, and the opening as well if it removes
    nothing else. It is safe: neither the MDP nor the picture changes. There is no fix if a part of
    the wall is left.
    """
    level = context.level
    if not level.openings or not level.walls:
        return
    drawn = count_drawn(level, "walls")
    doors = {side for door in level.doors for side in _sides(door)}
    for undoing in context.barriers.undoings:
        route, wall = ("openings", undoing.opening), ("walls", undoing.wall - drawn)
        if undoing.opening in context.barriers.idle_openings:
            continue
        if {*_sides(level.openings[undoing.opening])} <= doors:
            continue
        fix = None
        if undoing.wall < drawn:
            what = "a drawn wall"
        else:
            line = context.document.span(wall).start.line
            what = f"{'the' if undoing.wholly else 'a part of the'} wall on line {line}"
            if undoing.wholly:
                routes = [wall, route] if undoing.idle else [wall]
                fix = removal(context.document, "remove what cancels out", *routes)
        yield Finding(
            route,
            f"the opening removes {what}",
            "remove one of the two, or write a wall with a gap as two walls",
            fix=fix,
        )


@rule("BR516", needs=Needs.LEVEL)
def glass_without_pass(context: LintContext) -> Iterator[Finding]:
    """Drawn glass wall without an explicit `pass`.

    ## What it does

    Checks for glass walls in a drawing (`- -` and `:`) whose probability of letting the robot
    through is not set. An entry of `walls` beside the drawing sets their `pass`; the default is
    0.5.

    ## Why is this bad?

    The difficulty of the level depends on a number that is not in its file.

    ## Example

    ```yaml
    version: 1
    map: |
      +---+---+---+
      | S :     E |
      +---+---+---+
    ```

    Use instead:

    ```yaml
    version: 1
    map: |
      +---+---+---+
      | S :     E |
      +---+---+---+
    walls:
      - {at: [0, 0], side: E, pass: 0.5}
    ```

    ## Fix safety

    The fix adds an entry of `walls` with `pass: 0.5` for each such wall. It is safe: 0.5 is the
    default.
    """
    level = context.level
    drawn = count_drawn(level, "walls")
    glass = [wall for wall in level.walls[:drawn] if wall.pass_ > 0]
    if not glass:
        return
    known = {
        side
        for entry in (*level.walls[drawn:], *level.openings)
        if not isinstance(entry, Wall) or "pass_" in entry.model_fields_set
        for side in _sides(entry)
    }
    blocked = blocked_cells(level)
    for side, x, y in {each for wall in glass for each in _sides(wall)}:
        # Beside a blocked cell, glass behaves like any other wall.
        if blocked((x, y)) or blocked((x + (side == "E"), y + (side == "S"))):
            known.add((side, x, y))
    if unknown := [part for wall in glass for part in _parts(wall, known)]:
        entries = [_entry(part) for part in unknown]
        edit = append(context.document, "walls", entries, ("map", "legend", "maze"))
        count = len(unknown)
        yield Finding(
            side_mark(level, *unknown[0].at, unknown[0].side),
            f"{'a glass wall has' if count == 1 else f'{count} glass walls have'} no `pass`; the "
            f"default is {GLASS_PASS:g}",
            f"set it explicitly: `walls: [{entries[0]}]`",
            fix=None if edit is None else Fix("add `walls` with the default `pass`", (edit,)),
        )


def _sides(entry: Opening) -> list[Side]:
    """Return the sides of cells that a wall or an opening covers."""
    if entry.side in ("S", "E"):
        return [(entry.side, x, y) for x, y in sides_of(entry)]
    if entry.side == "N":
        return [("S", x, y - 1) for x, y in sides_of(entry)]
    return [("E", x - 1, y) for x, y in sides_of(entry)]


def _parts(wall: Wall, known: set[Side]) -> list[Opening]:
    """Return the wall if none of its sides is known, otherwise its unknown sides."""
    unknown = [(side, x, y) for side, x, y in _sides(wall) if (side, x, y) not in known]
    if len(unknown) == wall.length:
        return [wall]
    return [Opening.model_validate({"at": (x, y), "side": side}) for side, x, y in unknown]


def _entry(wall: Opening) -> str:
    x, y = wall.at
    length = f"length: {wall.length}, " if wall.length > 1 else ""
    return f"{{at: [{x}, {y}], side: {wall.side}, {length}pass: {GLASS_PASS:g}}}"


@rule("BR526")
def loops_without_effect(context: LintContext) -> Iterator[Finding]:
    """Maze whose `loops` opens no dead end.

    ## What it does

    Checks for mazes that would be the same without `loops`. The field is the share of dead ends
    that are opened. It has no effect if this comes to less than half a dead end, or if no dead end
    has a wall that can be removed.

    ## Why is this bad?

    The maze was meant to have several paths, and has only one.

    ## Example

    ```yaml
    version: 1
    size: [5, 5]
    maze: {seed: 2, loops: 0.01}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [5, 5]
    maze: {seed: 2, loops: 0.5}
    ```

    ## Fix safety

    The fix removes `loops`. It is safe: the maze stays the same.
    """
    level, maze = context.level, context.level.maze
    if maze is None or not maze.loops:
        return
    grid = context.bare_grid
    # A maze without loops is a tree: it has fewer passages than cells.
    if int.from_bytes(grid.open_bits).bit_count() // 2 >= grid.blocked_cells.count(0):
        return
    bare = {"walls": (), "openings": (), "maze": maze.model_copy(update={"loops": 0.0})}
    if build_grid(level.model_copy(update=bare)).wall_bits == grid.wall_bits:
        yield Finding(
            Key(("maze", "loops")),
            f"`loops: {maze.loops:g}` opens no dead end of the maze",
            "increase it, or remove it: it is the share of dead ends that are opened",
            fix=removal(context.document, "remove `loops`", ("maze", "loops")),
        )
