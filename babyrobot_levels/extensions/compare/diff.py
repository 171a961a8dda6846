"""The difference of two levels: sizes, ends, cells, walls, rules, transitions and returns."""

from collections.abc import Hashable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.compare import LevelLike
from babyrobot_levels.analysis.metrics import metrics
from babyrobot_levels.analysis.shown import WIDTH
from babyrobot_levels.extensions.compare.changes import (
    NO_CHANGES,
    Change,
    Changes,
    thing_changes,
    transition_changes,
)
from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.cells import SkidRule, Warp, as_skid
from babyrobot_levels.language.fields import Role, as_cells, fields_with
from babyrobot_levels.language.kinds import LISTED, LOOKS, THINGS, Kind
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.mdp.compiler.terrain import build_terrain
from babyrobot_levels.mdp.gridworld import GridWorld, world_of
from babyrobot_levels.mdp.ground import RULES, build_ground
from babyrobot_levels.mdp.tables import Ints
from babyrobot_levels.registry.later import Shown
from babyrobot_levels.render.words.phrases import number, with_limit

LIMIT = 10
"""How many changes of each kind are listed by default."""

_RULES = ("skid", "wind", "rewards", "hit", "heading", "team")


@dataclass(frozen=True, repr=False)
class Difference(Shown, public=True):
    """What changed from one level to another.

    Attributes:
        same_game: whether the two levels define the same MDP: their digests are equal.
        digests: the digests of both.
        game: the size, the starts, the exits and the rules (rewards, skid, wind, random mazes,
            hit, heading, team, and what exits need) that differ, each under its name.
        cells: the cells with other properties: `{}` is a plain one.
        walls: the sides between free cells that differ: `"open"`, `"wall"`, or `{"pass": p}`.
        transitions: the states and actions that have other outcomes.
        best_return: the optimal expected return, before and after, with each level's own discount;
            None where it is undefined.
        random_return: the same for going in a random direction that is open.
        beside: what differs but is not part of the MDP: texts, looks, limits.
        things: the things with a state that differ, are new, or are gone.
        levels: the levels, before and after; None in what earlier versions pickled.

    Cells, walls and transitions are those that both levels have, counted from the top-left corner;
    transitions also only of configurations that both have. There, things that only one of the
    levels has, or with other numbers of places, are as at the beginning, and what becomes of them
    is not compared.
    """

    same_game: bool
    digests: tuple[str, str]
    game: tuple[Change, ...]
    cells: Changes
    walls: Changes
    transitions: Changes
    best_return: tuple[float | None, float | None]
    random_return: tuple[float | None, float | None]
    beside: tuple[Change, ...]
    things: Changes = NO_CHANGES
    levels: tuple[GridWorld, GridWorld] | None = field(default=None, kw_only=True, compare=False)

    def __repr__(self) -> str:
        counts = {
            "things": self.things,
            "cells": self.cells,
            "walls": self.walls,
            "transitions": self.transitions,
        }
        numbers = [f"{name}={changes.count}" for name, changes in counts.items() if changes.total]
        names = [change.name for change in (*self.game, *self.beside)]
        return (
            f"<Difference same_game={self.same_game} {' '.join(numbers)} "
            f"fields={names} best_return={self.best_return[0]}->{self.best_return[1]}>"
        )

    def _html(self) -> str:
        from babyrobot_levels.render.notebook.html import facts

        verdict = "the same MDP" if self.same_game else "another MDP"
        counts = (self.things, self.cells, self.walls, self.transitions)
        names = ("Things", "Cells", "Walls", "Transitions")
        rows = [
            ("Game", verdict),
            ("Fields", _listed(change.name or "" for change in (*self.game, *self.beside))),
            *(
                (name, f"{changes.count:,} of {changes.total:,} differ")
                for name, changes in zip(names, counts, strict=True)
                if changes.total
            ),
            (self.named("Best return"), " → ".join(map(number, self.best_return))),
            (self.named("Random return"), " → ".join(map(number, self.random_return))),
        ]
        return "".join(_both(self)) + facts(rows)

    def named(self, returns: str) -> str:
        """Return what returns are called: those without a limit, if a level has one."""
        limits = [level.max_steps for level in self.levels or ()]
        return with_limit(returns, None, next(filter(None, limits), None))

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {
            "same_game": self.same_game,
            "digests": list(self.digests),
            "game": [change.to_dict() for change in self.game],
            **({"things": self.things.to_dict()} if self.things.total else {}),
            "cells": self.cells.to_dict(),
            "walls": self.walls.to_dict(),
            "transitions": self.transitions.to_dict(),
            "best_return": list(self.best_return),
            "random_return": list(self.random_return),
            "beside": [change.to_dict() for change in self.beside],
        }


def diff(
    before: LevelLike, after: LevelLike, *, limit: int | None = LIMIT, maze_seed: int = 0
) -> Difference:
    """Return what changed from one level to another.

    Args:
        before: a name, a path, a share code, a mapping or a `Level`.
        after: another one.
        limit: how many things, cells, walls and transitions are listed; None for all of them.
            They are counted in any case.
        maze_seed: of levels with random mazes, the mazes of this seed are compared.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
    """
    given = (world_of(before), world_of(after))
    one, two = (
        level.with_maze_seed(maze_seed) if level.has_random_maze else level for level in given
    )
    rules = tuple(_rule_changes(*given))
    measured = (metrics(one), metrics(two))
    return Difference(
        same_game=one.digest == two.digest and not any(change.name == "maze" for change in rules),
        digests=(one.digest, two.digest),
        game=(*_shape_changes(one, two), *rules),
        cells=cell_changes(one, two, limit),
        walls=wall_changes(one, two, limit),
        transitions=transition_changes(one, two, _common_cells(one, two), limit),
        best_return=(measured[0].best_return, measured[1].best_return),
        random_return=(measured[0].random_return, measured[1].random_return),
        beside=tuple(_changes_beside(*given)),
        things=thing_changes(*given, limit),
        levels=(one, two),
    )


# -- fields of the MDP ---------------------------------------------------------------------


def _shape_changes(before: GridWorld, after: GridWorld) -> Iterator[Change]:
    if before.size != after.size:
        yield Change(list(before.size), list(after.size), name="size")
    one, two = _starts_and_exits(before), _starts_and_exits(after)
    for name, cells in one.items():
        if cells != two[name]:
            yield Change(plain(cells), plain(two[name]), name=name)


def _starts_and_exits(level: GridWorld) -> dict[str, list[tuple[int, int]]]:
    drawn = level.exit_one_of
    return {
        "start": sorted(level.starts),
        "exit": sorted(level.exits) if drawn is None else [],
        "exit_one_of": list(drawn or ()),
    }


def _rule_changes(before: GridWorld, after: GridWorld) -> Iterator[Change]:
    if before.has_random_maze or after.has_random_maze:
        one, two = (_whole(level.maze) for level in (before, after))
        if one != two:
            yield Change(one, two, name="maze")
    for name in _RULES:
        yield from _field_changes(name, _whole(getattr(before, name)), _whole(getattr(after, name)))
    for name in ("start_weights", "exit_weights"):
        yield from _field_changes(name, plain(getattr(before, name)), plain(getattr(after, name)))
    yield from _field_changes("exit_needs", sorted(before.exit_keys), sorted(after.exit_keys))


def _field_changes(name: str, before: Any, after: Any) -> Iterator[Change]:
    """Yield what differs between two values; of mappings, field by field."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in dict.fromkeys((*before, *after)):
            yield from _field_changes(f"{name}.{key}", before.get(key), after.get(key))
    elif before != after:
        yield Change(before, after, name=name)


def _whole(value: Any) -> Any:
    """Return a model as plain data with all its fields, also those that were not given."""
    return plain(value.model_dump(by_alias=True)) if hasattr(value, "model_dump") else plain(value)


# -- fields that are not part of the MDP ---------------------------------------------------


def _changes_beside(before: GridWorld, after: GridWorld) -> Iterator[Change]:
    for name in fields_with(Role.TEXT, Role.LIMIT, Role.EXPECTATION):
        yield from _field_changes(name, plain(getattr(before, name)), plain(getattr(after, name)))
    names = (before.theme, after.theme)
    if isinstance(names[0], str) and isinstance(names[1], str) and names[0] != names[1]:
        yield Change(*names, name="theme")
    else:
        themes = (_whole(level.resolved_theme) for level in (before, after))
        yield from _field_changes("theme", *themes)
    yield from _field_changes("display", _whole(before.display), _whole(after.display))
    for kind in sorted(LISTED, key=lambda kind: kind in THINGS):
        one, two = (_looks(level, kind) for level in (before, after))
        if one != two:
            yield Change(one, two, name=f"{kind.field}.looks")


MAX_LISTED = 12
"""How many fields that differ are named in a notebook."""


def _looks(level: GridWorld, kind: Kind) -> list[dict[str, Any]]:
    """Return the entries of a kind that have looks of their own, reduced to place and looks."""
    places = ("name",) if kind.has_name else ("at", "size", "side", "length")
    looks = [name for name in kind.properties if name in LOOKS]
    return [
        {key: value for key, value in entry.items() if key in (*places, *looks)}
        for entry in map(_whole, kind.of(level))
        if any(entry[look] not in (None, False) for look in looks)
    ]


# -- cells ---------------------------------------------------------------------------------

_PUDDLE_SIZES = {"small": 1, "large": 2}

BLOCKED, WET, REWARD, RANDOM, SKID, RULE, ENDS, WARP = range(8)
"""The columns of the table of properties."""


def _common_cells(before: GridWorld, after: GridWorld) -> tuple[Ints, Ints]:
    """Return the numbers, in each of the levels, of the cells that both have, row by row."""
    width, height = (min(pair) for pair in zip(before.size, after.size, strict=True))
    y, x = np.mgrid[:height, :width]
    return (y * before.size[0] + x).ravel(), (y * after.size[0] + x).ravel()


def cell_changes(before: GridWorld, after: GridWorld, limit: int | None) -> Changes:
    """Return the cells with other properties: blocked, wet, slippery, costly, ending, warping."""
    cells = _common_cells(before, after)
    known = _Known()
    tables = [
        _properties(level, where, known)
        for level, where in zip((before, after), cells, strict=True)
    ]
    # What is not given is nan, and equal to itself.
    equal = (tables[0] == tables[1]) | (np.isnan(tables[0]) & np.isnan(tables[1]))
    width = min(before.size[0], after.size[0])

    def describe(place: int) -> Change:
        one, two = (_cell_data(table[place], known) for table in tables)
        return Change(one, two, (place % width, place // width))

    return Changes.of(np.flatnonzero(~equal.all(axis=1)).tolist(), len(cells[0]), describe, limit)


class _Known:
    """Plain data with numbers from 0; equal data have the same."""

    def __init__(self) -> None:
        self.data: list[dict[str, Any]] = []
        self._numbers: dict[Hashable, int] = {}

    def number(self, data: dict[str, Any]) -> int:
        """Return the number of data, a new one for new data."""
        number = self._numbers.setdefault(_frozen(data), len(self.data))
        if number == len(self.data):
            self.data.append(data)
        return number


def _frozen(value: Any) -> Hashable:
    """Return what is equal, and has the same hash, for plain data that are equal."""
    if isinstance(value, dict):
        return frozenset((key, _frozen(each)) for key, each in value.items())
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


def _properties(level: GridWorld, cells: Ints, known: _Known) -> NDArray[np.float64]:
    """Return what is special about each cell, `[cells, properties]`; nan for nothing special.

    Warps, and rewards that are drawn, are told by their numbers in `known`.
    """
    grid = level.grid()
    terrain = build_terrain(level, grid)
    table = np.full((terrain.reward.size, 8), np.nan)
    skid = as_skid(level.skid if level.skid is not None else 0.0)
    rule = RULES.index(SkidRule(skid.to))
    is_usual = (terrain.skid == skid.probability) & ((terrain.rule == rule) | (terrain.skid == 0))
    free = np.frombuffer(grid.blocked_cells, np.uint8) == 0
    table[~free, BLOCKED] = 1
    for puddle in level.puddles:
        table[_number(puddle.at, level), WET] = _PUDDLE_SIZES[puddle.size]
    own = free & (terrain.reward != level.rewards.step)
    table[own, REWARD] = terrain.reward[own]
    for cell, reward in build_ground(level).random.items():
        if free[cell]:
            table[cell, RANDOM] = known.number(plain(reward))
    own = free & ~is_usual
    table[own, SKID], table[own, RULE] = terrain.skid[own], terrain.rule[own]
    table[free & terrain.over & ~terrain.exit, ENDS] = 1
    for warp in level.warps:
        table[_number(warp.at, level), WARP] = known.number(_warp_data(warp))
    return table[cells]


def _cell_data(row: NDArray[np.float64], known: _Known) -> dict[str, Any]:
    """Return a row of the table of properties as plain data."""
    given = {column: value for column, value in enumerate(row.tolist()) if value == value}
    data: dict[str, Any] = {}
    if BLOCKED in given:
        data["blocked"] = True
    if WET in given:
        data["puddle"] = [*_PUDDLE_SIZES][int(given[WET]) - 1]
    if REWARD in given:
        data["reward"] = given[REWARD]
    if RANDOM in given:
        data["reward"] = known.data[int(given[RANDOM])]
    if SKID in given:
        data["skid"] = {"probability": given[SKID], "to": RULES[int(given[RULE])].value}
    if ENDS in given:
        data["ends"] = True
    if WARP in given:
        data["warp"] = known.data[int(given[WARP])]
    return data


def _warp_data(warp: Warp) -> dict[str, Any]:
    """Return where a warp leads, when it acts, and what else it was given."""
    to = warp.to if isinstance(warp.to, str) else as_cells(warp.to)
    data = {"to": plain(to[0] if len(to) == 1 else to), "when": warp.when}
    if warp.probability < 1:
        data["probability"] = warp.probability
    if len({*warp.weights}) > 1:
        data["weights"] = [*warp.weights]
    if warp.reward is not None:
        data["reward"] = warp.reward
    return data


def _number(cell: tuple[int, int], level: GridWorld) -> int:
    return cell[1] * level.size[0] + cell[0]


# -- walls ---------------------------------------------------------------------------------


def wall_changes(before: GridWorld, after: GridWorld, limit: int | None) -> Changes:
    """Return the sides between free cells that were opened, closed, or made of glass."""
    cells = _common_cells(before, after)
    width = min(before.size[0], after.size[0])
    height = len(cells[0]) // width
    states = [_sides(level, where) for level, where in zip((before, after), cells, strict=True)]
    blocked = [level.grid().blocked.ravel() for level in (before, after)]
    free = ~(blocked[0][cells[0]] | blocked[1][cells[1]]).reshape(height, width)
    between = np.zeros((height, width, 2), np.bool_)
    between[:, :-1, 0] = free[:, :-1] & free[:, 1:]
    between[:-1, :, 1] = free[:-1] & free[1:]
    differing = np.argwhere(between.reshape(-1, 2) & (states[0] != states[1])).tolist()

    def describe(place: list[int]) -> Change:
        cell, side = place
        one, two = (_side_data(float(state[cell, side])) for state in states)
        return Change(one, two, (cell % width, cell // width), "ES"[side])

    return Changes.of(differing, int(between.sum()), describe, limit)


def _sides(level: GridWorld, cells: Ints) -> NDArray[np.float64]:
    """Return how each cell's sides E and S are, `[cells, 2]`: 2 open, 0 a wall, else glass."""
    grid = level.grid()
    east, south = SIDES.index("E"), SIDES.index("S")
    states = np.where(grid.open, 2.0, 0.0).reshape(-1, len(SIDES))
    for (cell, side), probability in grid.glass.items():
        states[cell, SIDES.index(side)] = probability
    return states[cells][:, [east, south]]


def _side_data(state: float) -> Any:
    return "open" if state == 2 else {"pass": state} if state else "wall"


# -- in notebooks --------------------------------------------------------------------------


def _both(result: Difference) -> Iterator[str]:
    """Yield the pictures of both levels, in which changed cells and walls are marked."""
    from babyrobot_levels.render.notebook.html import is_too_large, picture_of, strip
    from babyrobot_levels.render.page import bare
    from babyrobot_levels.render.scene.build import build_scene
    from babyrobot_levels.render.scene.layout import layout_of
    from babyrobot_levels.render.scene.marks import MarkedSide, marked

    if result.levels is None or any(map(is_too_large, result.levels)):
        return

    cells = {change.cell for change in cell_changes(*result.levels, None).first if change.cell}
    walls = wall_changes(*result.levels, None).first
    pictures = []
    for index, level in enumerate(map(bare, result.levels)):
        own = {cell for change in result.game for cell in _ends(change, index)}
        sides = [
            MarkedSide(change.cell, change.name, (change.before, change.after)[index] != "open")
            for change in walls
            if change.cell and change.name
        ]
        scene = marked(build_scene(level), layout_of(level), sorted(cells | own), sides)
        pictures.append((picture_of(scene, WIDTH), ("before", "after")[index]))
    yield strip(pictures)
    if walls:
        yield "<p>Walls that differ are marked; where there is none, by dots.</p>"


def _ends(change: Change, number: int) -> Iterator[tuple[int, int]]:
    """Yield the starts or exits that only one of the levels has."""
    if change.name in ("start", "exit"):
        both = (change.before, change.after)
        others = {*map(tuple, both[1 - number])}
        yield from (tuple(cell) for cell in both[number] if tuple(cell) not in others)


def _listed(names: Iterable[str]) -> str:
    unique = list(dict.fromkeys(names))
    more = [f"and {len(unique) - MAX_LISTED} more"] if len(unique) > MAX_LISTED else []
    return ", ".join(unique[:MAX_LISTED] + more)
