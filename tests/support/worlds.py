"""Random levels and drawings for hypothesis, valid by construction."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import Model
from babyrobot_levels.language.cells import (
    Area,
    LargePuddle,
    Puddle,
    Rewards,
    SmallPuddle,
    Wall,
    Warp,
    Wind,
)
from babyrobot_levels.language.fields import LevelFields, Role, fields_with
from babyrobot_levels.language.validation import parse as parse_text
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.drawn import resolved_fields
from babyrobot_levels.text.source import SourceFile
from support.values import fields_of

World = dict[str, Any]
Cell = tuple[int, int]

LEGEND: World = {"~": {"reward": -3, "color": "gold"}, "x": {"ends": True}, "9": {"skid": 0.25}}


def level_of(world: World) -> Level:
    """Return the level that the mapping says, which must be valid."""
    level: Level = Level.from_fields(world)
    return level


def with_walls_for_maze(world: World) -> World:
    """Return the same level with entries of walls for its maze, before the others."""
    if "maze" not in world:
        return world
    bare = level_of({name: world[name] for name in world if name not in ("walls", "openings")})
    maze = resolved_fields(bare, bare.grid())["walls"] or []
    rest = {name: value for name, value in world.items() if name != "maze"}
    return {**rest, "walls": [*maze, *world.get("walls", [])]}


def level(**fields: Any) -> Any:
    """Return the level with these fields, which must be valid."""
    return Level.from_fields({"version": 1, **fields})


def level_of_text(text: str) -> Level:
    """Return the level that the text says, which must be valid."""
    level, diagnostics = parse_text(SourceFile("level.yaml", text), Level)
    assert level is not None, "\n".join(map(str, diagnostics))
    return level


def optional(model: type[Model], *without: str, looks: bool = False) -> SearchStrategy[World]:
    """Return strategies for some of the fields of a model: those of `values`."""
    fields = fields_of(model, looks)
    return st.fixed_dictionaries(
        {}, optional={name: st.sampled_from(fields[name]) for name in fields if name not in without}
    )


def sometimes(draw: DrawFn, share: int = 2) -> bool:
    """Return True once in `share` times; examples shrink towards False."""
    return draw(st.integers(0, share - 1)) == share - 1


@st.composite
def rectangles(draw: DrawFn, width: int, height: int, most: int = 8) -> World:
    x, y = draw(st.integers(0, width - 1)), draw(st.integers(0, height - 1))
    entry: World = {"at": [x, y]}
    if draw(st.booleans()):
        columns = draw(st.integers(1, min(most, width - x)))
        entry["size"] = [columns, draw(st.integers(1, min(most, height - y)))]
    return entry


def inside(entry: World) -> set[Cell]:
    """Return the cells of a rectangle."""
    (x, y), (columns, rows) = entry["at"], entry.get("size", (1, 1))
    return {(x + i, y + j) for i in range(columns) for j in range(rows)}


@st.composite
def sides(draw: DrawFn, width: int, height: int, inner: bool) -> World | None:
    """Draw a place of walls; None where `inner` is asked for and the side is an outer one."""
    x, y = draw(st.integers(0, width - 1)), draw(st.integers(0, height - 1))
    side = draw(st.sampled_from(["N", "E", "S", "W"]))
    if inner and {"N": y == 0, "W": x == 0, "S": y == height - 1, "E": x == width - 1}[side]:
        return None
    entry: World = {"at": [x, y], "side": side}
    if draw(st.booleans()):
        most = width - x if side in "NS" else height - y
        entry["length"] = draw(st.integers(1, most))
    return entry


def starts_of(world: World) -> list[Cell]:
    """Return the starts as a list of cells, also when there is one."""
    starts = world["start"] if isinstance(world["start"][0], list) else [world["start"]]
    return [(x, y) for x, y in starts]


def add_walls(draw: DrawFn, world: World, width: int, height: int) -> None:
    if sometimes(draw, 3):
        world["maze"] = {"seed": draw(st.integers(-9, 99))}
    walls = [
        wall
        for wall in draw(st.lists(sides(width, height, inner=True), max_size=10))
        if wall is not None
    ]
    walls = [wall | draw(optional(Wall)) for wall in walls]
    if sometimes(draw, 4):
        outer = draw(sides(width, height, inner=False))
        walls += [outer | draw(optional(Wall, looks=True))] if outer else []
    if walls:
        world["walls"] = walls
    openings = draw(st.lists(sides(width, height, inner=True), max_size=4))
    if any(openings):
        world["openings"] = [opening for opening in openings if opening is not None]


def add_cells(draw: DrawFn, world: World, width: int, height: int, free: list[Cell]) -> None:
    if sometimes(draw):
        cells = draw(st.lists(st.sampled_from(free), max_size=4, unique=True))
        world["puddles"] = [{"at": list(cell)} | draw(optional(Puddle)) for cell in cells]
    if sometimes(draw):
        kinds = {"small": optional(SmallPuddle), "large": optional(LargePuddle)}
        world["puddle_types"] = draw(st.fixed_dictionaries(kinds))
    if sometimes(draw):
        areas = [
            draw(rectangles(width, height))
            | draw(optional(Area))
            | draw(optional(Area, looks=True))
            for _ in range(draw(st.integers(1, 3)))
        ]
        for area in areas:
            if sometimes(draw, 4):
                values = draw(st.lists(st.sampled_from([-2, 0, 0.5, 3]), min_size=2, max_size=3))
                area["reward"] = {"values": values}
            if area.get("ends") and inside(area) & set(starts_of(world)):
                area["ends"] = False
        world["areas"] = areas


def add_warps(draw: DrawFn, world: World, free: list[Cell], exits: list[Cell]) -> None:
    starts = starts_of(world)
    places = [cell for cell in free if cell not in exits]
    taken: dict[Cell, Any] = {}
    warps = []
    for cell in draw(st.lists(st.sampled_from(places), max_size=4, unique=True)):
        when = draw(st.sampled_from(["enter", "leave", None]))
        goal: Any = draw(st.sampled_from(["start", *free]))
        if when != "leave":
            chain = goal
            while chain in taken and chain != cell:
                chain = taken[chain]
            if cell in starts or chain == cell:
                continue
            taken[cell] = goal
        warp: World = {"at": list(cell), "to": list(goal) if goal != "start" else goal}
        warp |= {"when": when} if when else {}
        if goal != "start" and sometimes(draw, 3):
            others = [to for to in free if to not in taken]
            warp["to"] = [warp["to"], *([list(draw(st.sampled_from(others)))] if others else [])]
            warp["weights"] = [draw(st.sampled_from([1, 2, 5])) for _ in warp["to"]]
        warps.append(warp | draw(optional(Warp, "when")))
    world["warps"] = warps


def add_wind(draw: DrawFn, world: World, width: int, height: int) -> None:
    world["wind"] = {
        side: draw(st.lists(st.integers(0, 3), min_size=count, max_size=count))
        for side, count in zip(
            ("north", "east", "south", "west"), (width, height, width, height), strict=True
        )
        if draw(st.booleans())
    } | draw(optional(Wind))


@st.composite
def worlds(draw: DrawFn, largest: int = 8) -> World:
    """Random levels as mappings, with all that the language has, except drawings and loops."""
    width, height = draw(st.integers(1, largest)), draw(st.integers(1, largest))
    world: World = {"version": 1, "size": [width, height]}
    cells = [(x, y) for y in range(height) for x in range(width)]
    blocked: list[World] = []
    taken: set[Cell] = set()
    for _ in range(draw(st.integers(0, 2))):
        entry = draw(rectangles(width, height, most=3))
        if len(taken | inside(entry)) < len(cells):
            blocked.append(entry)
            taken |= inside(entry)
    if blocked:
        world["blocked"] = blocked
    free = [cell for cell in cells if cell not in taken]
    starts = draw(st.lists(st.sampled_from(free), min_size=1, max_size=3, unique=True))
    rest = [cell for cell in free if cell not in starts]
    exits = draw(st.lists(st.sampled_from(rest), max_size=2, unique=True)) if rest else []
    world["start"] = [list(c) for c in starts] if len(starts) > 1 else list(starts[0])
    if len(starts) > 1 and sometimes(draw, 3):
        world["start_weights"] = [draw(st.sampled_from([1, 2, 5])) for _ in starts]
    world["exit"] = "none" if not exits else [list(c) for c in exits]
    if len(exits) == 1 and draw(st.booleans()):
        world["exit"] = list(exits[0])
    add_walls(draw, world, width, height)
    add_cells(draw, world, width, height, free)
    if sometimes(draw):
        add_warps(draw, world, free, exits)
    if sometimes(draw, 3):
        add_wind(draw, world, width, height)
    if sometimes(draw):
        world["rewards"] = draw(optional(Rewards))
    others = {*fields_of(LevelFields)} - {*fields_with(Role.DYNAMICS, Role.REWARD)}
    return world | draw(optional(LevelFields, *others, "heading"))


@st.composite
def drawings(
    draw: DrawFn, largest: int = 8, cells: str = " SEoO#~x9", marks: str = " |:"
) -> d.Drawing:
    """Random drawings with at least one start."""
    width, height = draw(st.integers(1, largest)), draw(st.integers(1, largest))

    def rows(marks: str, columns: int, count: int) -> SearchStrategy[list[str]]:
        row = st.text(st.sampled_from(marks), min_size=columns, max_size=columns)
        return st.lists(row, min_size=count, max_size=count)

    shown = draw(rows(cells, width, height))
    if not any("S" in row for row in shown):
        x, y = draw(st.integers(0, width - 1)), draw(st.integers(0, height - 1))
        shown[y] = shown[y][:x] + "S" + shown[y][x + 1 :]
    east, south = draw(rows(marks, width - 1, height)), draw(rows(marks, width, height - 1))
    return d.Drawing(tuple(shown), tuple(east), tuple(south))


AWKWARD = (
    "yes",
    "no",
    "null",
    "~",
    "010",
    "1e3",
    "0x1F",
    ".inf",
    "12:30:00",
    "true",
    "a: b",
    "a #b",
    "#a",
    "- a",
    "? a",
    "it's",
    'say "hi"',
    "back\\slash",
    "[a, b]",
    "{a}",
    "*a",
    "&a",
    "!a",
    "%a",
    "@a",
    "`a`",
    "a:",
    ":a",
    "a\nb",
    "a\nb\n",
    "a\n\nb\n\n",
    "\na",
    " a\n b",
    "a\n  b \n",
    "  leading",
    "trailing ",
    "tab\tinside",
    "bell\x07",
    "nul\x00",
    "next\x85line",
    "para\u2029graph",
    "\ufeffbom",
    "Größe",
    "迷路",
    "🤖",
    "\xa0hard blank",
    "",
    " ",
    "\n",
    "---",
    "...",
    "--- a\n...\n",
    "a\r\nb",
    "x" * 300,
)

texts = st.sampled_from(AWKWARD) | st.text(max_size=30).filter(
    lambda text: not any("\ud800" <= character <= "\udfff" for character in text)
)


@st.composite
def decorated_worlds(draw: DrawFn) -> World:
    """Random levels with all that does not touch the game: texts, looks, limits."""
    optional: dict[Any, SearchStrategy[Any]] = {
        **dict.fromkeys(("title", "description", "author", "license", "source"), texts),
        "name": st.sampled_from(["a", "first-maze", "4x4", "2"]),
        "tags": st.lists(st.sampled_from(["maze", "on", "1", "yes", "null"]), max_size=3),
        "discount": st.sampled_from([1.0, 0.9, 1, 1e-9]),
        "max_steps": st.sampled_from([1, 100, 2**53]),
        "theme": st.sampled_from(
            [
                "green",
                {"colors": {"base": "red", "walls": "#abcdef"}, "widths": {"padding": 0.5}},
                {"widths": {"walls": 3}},
                {},
            ]
        ),
        "display": st.sampled_from(
            [
                {"compass": True, "side_panel": 120},
                {"bottom_panel": {"width": 40, "color": "red"}, "robot": {"speed": 2.5}},
                {"side_panel": "none", "robot": {"show": False}},
                {},
            ]
        ),
    }
    return draw(worlds(4)) | draw(st.fixed_dictionaries({}, optional=optional))
