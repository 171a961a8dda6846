"""The difference of two levels: sizes, ends, cells, walls, rules, transitions and returns."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from babyrobot_levels.analysis.diff.changes import Change, Changes
from babyrobot_levels.analysis.diff.common import cell_changes, transition_changes, wall_changes
from babyrobot_levels.analysis.metrics import metrics
from babyrobot_levels.analysis.transition_tables import LevelLike
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level

LIMIT = 10
"""How many changes of each kind are told, if nothing else is asked for."""

_RULES = ("skid", "wind", "rewards")


@dataclass(frozen=True)
class Difference:
    """What changed from one level to another.

    Attributes:
        same_game: whether the two are the same game: their digests are equal.
        digests: the digests of both.
        game: the size, the starts, the exits and the rules (rewards, skid, wind, random mazes)
            that differ, each under its name.
        cells: the cells with other properties: `{}` is a plain one.
        walls: the sides between free cells that differ: `"open"`, `"wall"`, or `{"pass": p}`.
        transitions: the states and actions that have other outcomes.
        best_return: what the best policy earns, before and after, with each level's own discount;
            None where that has no value.
        random_return: the same for going in a random direction that is open.
        beside: what differs but is not part of the game: texts, looks, limits.

    Cells, walls and transitions are those that both levels have, counted from the top-left corner.
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

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {
            "same_game": self.same_game,
            "digests": list(self.digests),
            "game": [change.to_dict() for change in self.game],
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
        limit: how many cells, walls and transitions are told; None for all of them. They are
            counted in any case.
        maze_seed: of levels with random mazes, the mazes of this seed are compared.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
    """
    given = (load(before), load(after))
    one, two = (
        level.with_maze_seed(maze_seed) if level.has_random_maze else level for level in given
    )
    rules = tuple(_rule_changes(*given))
    grows_otherwise = any(change.name == "maze" for change in rules)
    worth = (metrics(one), metrics(two))
    return Difference(
        same_game=one.digest == two.digest and not grows_otherwise,
        digests=(one.digest, two.digest),
        game=(*_shape_changes(one, two), *rules),
        cells=cell_changes(one, two, limit),
        walls=wall_changes(one, two, limit),
        transitions=transition_changes(one, two, limit),
        best_return=(worth[0].best_return, worth[1].best_return),
        random_return=(worth[0].random_return, worth[1].random_return),
        beside=tuple(_changes_beside(*given)),
    )


# -- the game ------------------------------------------------------------------------------


def _shape_changes(before: Level, after: Level) -> Iterator[Change]:
    if before.size != after.size:
        yield Change(list(before.size), list(after.size), name="size")
    for name, cells in (("start", "starts"), ("exit", "exits")):
        one, two = (sorted(getattr(level, cells)) for level in (before, after))
        if one != two:
            yield Change(plain(one), plain(two), name=name)


def _rule_changes(before: Level, after: Level) -> Iterator[Change]:
    if before.has_random_maze or after.has_random_maze:
        one, two = (_whole(level.maze) for level in (before, after))
        if one != two:
            yield Change(one, two, name="maze")
    for name in _RULES:
        yield from _field_changes(name, _whole(getattr(before, name)), _whole(getattr(after, name)))


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


# -- beside the game -----------------------------------------------------------------------


def _changes_beside(before: Level, after: Level) -> Iterator[Change]:
    for name in fields_with(Role.TEXT, Role.LIMIT):
        yield from _field_changes(name, plain(getattr(before, name)), plain(getattr(after, name)))
    names = (before.theme, after.theme)
    if isinstance(names[0], str) and isinstance(names[1], str) and names[0] != names[1]:
        yield Change(*names, name="theme")
    else:
        themes = (_whole(level.resolved_theme) for level in (before, after))
        yield from _field_changes("theme", *themes)
    yield from _field_changes("display", _whole(before.display), _whole(after.display))
    for name, looks in (("areas", ("color", "label")), ("walls", ("color", "width", "fit"))):
        one, two = (_looks(level, name, looks) for level in (before, after))
        if one != two:
            yield Change(one, two, name=f"{name}.looks")


def _looks(level: Level, name: str, looks: tuple[str, ...]) -> list[dict[str, Any]]:
    """Return the entries of a list that have looks of their own, without what is the game's."""
    places = ("at", "size", "side", "length")
    entries = (_whole(entry) for entry in getattr(level, name))
    return [
        {key: value for key, value in entry.items() if key in (*places, *looks)}
        for entry in entries
        if any(entry[look] not in (None, False) for look in looks)
    ]
