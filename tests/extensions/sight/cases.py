"""Random levels with sights, and both solvers of them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from fractions import Fraction
from functools import cache
from random import Random
from typing import Any

from extensions.sight.by_fractions import Beliefs, Place
from oracles.random_things import random_level
from oracles.things_reference import Reference, TurningReference

import babyrobot_levels as brl
from babyrobot_levels.envs.arguments import checked_observation
from babyrobot_levels.envs.observations import make_observer
from babyrobot_levels.envs.observations.base import Extent

ACTIONS = {"all": range(5), "moves": range(1, 5), "turns": range(3)}

Fields = dict[str, Any]


def blind(level: brl.Level, state: int) -> Hashable:
    """Show nothing."""
    return 0


def parity(level: brl.Level, state: int) -> Hashable:
    """Show whether the robot is in a dark cell of a chess board."""
    width, height = level.size
    return (state % width + state % (width * height) // width) % 2


def walls(level: brl.Level, state: int) -> Hashable:
    """Show which sides of the robot's cell are open."""
    width, height = level.size
    grid, cell = level.grid_at(state // (width * height)), state % (width * height)
    return tuple(grid.open[cell // width, cell % width].tolist())


SIGHTS: list[dict[str, Any]] = [
    {"sight": "view", "view_radius": 1},
    {"sight": "view", "view_radius": 1, "reward": True},
    {"sight": "view", "view_radius": 1, "mask": False},
    {"sight": "view", "view_radius": 2, "actions": "turns"},
    {"sight": "view", "see_through": True, "view_radius": 1, "actions": "moves"},
    {"sight": "position"},
    {"sight": ("walls", "vector"), "mask": False},
    {"sight": blind},
    {"sight": blind, "reward": True},
    {"sight": parity},
    {"sight": walls, "actions": "moves"},
]


def sight_of(seed: int) -> dict[str, Any]:
    """Return the sight of a case, as `solve_sight` takes it."""
    return SIGHTS[seed % len(SIGHTS)]


def levels_of(seed: int) -> list[Fields]:
    """Return the levels of a case: mostly one, else two."""
    random = Random(f"sight {seed}")
    count = random.choice((1, 1, 2))
    return [random_level(random, things=random.random() < 0.6) for _ in range(count)]


def slow_solver(
    levels: Sequence[Fields], options: dict[str, Any], discount: Fraction = Fraction(1)
) -> Beliefs:
    """Return the slow solver of levels, each equally likely, and a sight."""
    given = dict(options)
    sight, actions = given.pop("sight"), given.pop("actions", "all")
    mask, hears = given.pop("mask", True), given.pop("reward", False)
    loaded, turns = [brl.load(fields) for fields in levels], actions == "turns"
    plain = [Reference(fields) for fields in levels]
    tables: list[Reference | TurningReference] = [*plain]
    if turns:
        pairs = zip(plain, loaded, strict=True)
        tables = [TurningReference(each, level.heading) for each, level in pairs]
    seen: Callable[[Place], Hashable]
    if callable(sight):
        sensor: Callable[[brl.Level, int], Hashable] = sight

        def seen(place: Place) -> Hashable:
            return sensor(loaded[place[0]], place[1])

    else:
        extent = Extent.of(loaded, turns=turns)
        chosen = checked_observation(observation=sight, **given)
        observers = [make_observer(level, chosen, extent) for level in loaded]

        def seen(place: Place) -> Hashable:
            number, state = place
            allowed = frozenset(tables[number].allowed(state)) if mask else None
            return repr(observed(observers[number].at(state)())), allowed

    shares = [Fraction(1, len(levels))] * len(levels)
    return Beliefs(tables, ACTIONS[actions], cache(seen), discount, hears, shares)


def observed(observation: Any) -> Any:
    """Return an observation as plain data."""
    if isinstance(observation, dict):
        return {name: observed(each) for name, each in observation.items()}
    return observation.tolist() if hasattr(observation, "tolist") else observation
