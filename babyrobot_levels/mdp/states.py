"""States in words, and configurations by what is held and on."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import numpy as np

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.mdp.configurations import Things
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.text.words import did_you_mean, listed

MAX_LISTED = 10
"""How many sets of held things an error lists."""


def initial_configuration(level: GridWorld) -> int:
    """Return the number of the first configuration in which an episode can begin.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    mdp = level.compile()
    return mdp.configuration(int((mdp.start > 0).argmax()))


def configuration_with(level: GridWorld, names: Iterable[str]) -> int:
    """Return the first configuration in which exactly some items are held and switches are on.

    If there is one in which all movers stand as at reset, it is the first of those. Configurations
    in which an episode can go on come before those in which it is over.

    Args:
        level: the level.
        names: the names of the items and switches; none for "nothing is held or on".

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: a name is not that of an item or switch, or no episode comes to this.
    """
    wanted, things, mdp = frozenset(names), level.things(), level.compile()
    known = (*things.needed,)
    for name in sorted(wanted.difference(known)):
        if not known:
            raise ValueError(f"the level has no {name!r}: it has no items and no switches")
        hint = did_you_mean(name, known) or f"; it has {listed(known)}"
        raise ValueError(f"the level has no item or switch {name!r}{hint}")
    over = np.all(mdp.is_terminal.reshape(mdp.num_configurations, -1), axis=1)
    begins = things.begins()[things.static :]
    met_with = cache(lambda *static: things.met(static))
    found: dict[frozenset[str], tuple[bool, bool, int]] = {}
    for number, values in enumerate(mdp.configurations.tolist()):
        movers = zip(values[things.static :], begins, strict=True)
        key = bool(over[number]), not all(at in first for at, first in movers), number
        met = met_with(*values[: things.static])
        found[met] = min(found.get(met, key), key)
    if wanted not in found:
        # In the order of the level, and fewer before more.
        sets = sorted([name in met for name in known] for met in found)
        texts = [
            ",".join(name for name, is_met in zip(known, each, strict=True) if is_met) or "nothing"
            for each in sorted(sets, key=sum)
        ]
        more = ["…"] if len(texts) > MAX_LISTED else []
        raise ValueError(
            f"in no episode exactly {listed(sorted(wanted)) or 'nothing'} is held or on; possible "
            f"are: {'; '.join(texts[:MAX_LISTED] + more)}"
        )
    return found[wanted][2]


def state_text(things: Things, mdp: Mdp, state: int) -> str:
    """Return a state as words: its cell, and what is held and on: `[3, 1] while key is held`.

    Args:
        things: the things of the level.
        mdp: its tables, or those of a robot that turns.
        state: the number of the state in these tables.
    """
    x, y = mdp.cell(state)
    heading = f" looking {SIDES[mdp.heading(state)]}" if mdp.headings > 1 else ""
    condition = things.condition(mdp.configurations[mdp.configuration(state)].tolist())
    return f"[{x}, {y}]{heading}{condition and ' ' + condition}"
