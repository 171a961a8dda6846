"""What makes a level hard: what its exits need, and in which order it can be had."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from babyrobot_levels.mdp.compiler.things import compile_things
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.states import Reach, reach_of
from babyrobot_levels.mdp.tables import Mdp

Needs = Mapping[str, frozenset[str]]
"""By the names of things that are needed: those of them that are needed to have it."""


def without_effect(level: GridWorld, names: Collection[str]) -> GridWorld:
    """Return a level in which some items cannot be taken, and some switches do not flip.

    Raises:
        LevelError: its tables would be too large.
    """
    other = level.model_copy()
    vars(other).pop("_digest", None)
    vars(other)["_mdp"] = compile_things(level, level.grid(), inert=names)
    return other


def needs_of(level: GridWorld) -> Needs:
    """Return the items and switches without whose effect some start has no path to an exit.

    From each start there is a path with them. Of these things, one is needed to have another, to
    hold or to flip it, if without its effect the other can be had from no start.

    Raises:
        LevelError: without the effect of one, the tables are too large.
    """
    doors = (name for door in level.doors for name in (*door.keys, *door.locks))
    had: dict[str, set[str]] = {}
    for name in sorted({*level.exit_keys, *doors}):
        mdp = without_effect(level, {name}).compile()
        reach = reach_of(level, mdp)
        if any(reach.to_exit[start] < 0 for start in np.flatnonzero(mdp.start).tolist()):
            had[name] = _had(level, mdp, reach)
    return {
        name: frozenset(other for other in had if other != name and name not in had[other])
        for name in had
    }


def _had(level: GridWorld, mdp: Mdp, reach: Reach) -> set[str]:
    """Return the names of the items and switches that can be held or flipped."""
    things, occurs = level.things(), np.array(reach.steps).reshape(-1, mdp.cells) >= 0
    values = mdp.configurations[occurs.any(axis=1)]
    return {
        name
        for name, (column, _) in things.needed.items()
        if not np.isin(values[:, column], things[column].begins).all()
    }


def longest_chain(needs: Needs) -> int:
    """Return how many things at most must be had one after the other.

    Whoever has a thing has had before what is needed for it: needs never go round in a circle.
    """
    length: dict[str, int] = {}
    # What needs more comes later: whatever a thing needs is needed by what needs the thing.
    for name in sorted(needs, key=lambda name: len(needs[name])):
        length[name] = 1 + max((length[other] for other in needs[name]), default=0)
    return max(length.values(), default=0)
