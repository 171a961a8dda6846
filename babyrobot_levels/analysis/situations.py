"""States and configurations of levels with things, in words and as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import Mdp


def situation(level: GridWorld, number: int) -> dict[str, Any]:
    """Return what each thing of a level is in a configuration, by name.

    Items are `"held"`, `"lies"` in their only place, or the cell of those in which they may lie;
    switches are `"on"` or `"off"`; movers and a drawn exit are the cells in which they are.
    """
    things, values = level.things(), level.compile().configurations[number].tolist()
    states = [thing.states[value] for thing, value in zip(things, values, strict=True)]
    told = [state if isinstance(state, str) else list(state) for state in states]
    return dict(zip(things.names, told, strict=True))


def situation_words(things: Mapping[str, Any]) -> str:
    """Return a situation in words, without what goes without saying: "key held, bat at [2, 4]"."""
    met = [kind.need.met for kind in NEEDED if kind.need is not None]
    states = [f"{name} {value}" for name, value in things.items() if value in met]
    return ", ".join([*states, *_places(things)])


def _places(things: Mapping[str, Any]) -> list[str]:
    return [
        f"{name} at [{place[0]}, {place[1]}]"
        for name, place in things.items()
        if isinstance(place, list)
    ]


def told(level: GridWorld, mdp: Mdp, state: int) -> str:
    """Return a state in words, with all that distinguishes it from others.

    Args:
        level: the level.
        mdp: its tables, or those of a robot that turns.
        state: the number of the state in these tables.
    """
    x, y = mdp.cell(state)
    number = mdp.configuration(state)
    heading = f" looking {SIDES[mdp.heading(state)]}" if mdp.headings > 1 else ""
    condition = level.things().condition(mdp.configurations[number].tolist())
    text = f"[{x}, {y}]{heading}{condition and ' ' + condition}"
    return ", ".join([text, *_places(situation(level, number))])
