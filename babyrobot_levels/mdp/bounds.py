"""How large the tables may be, and whether the fields show that they are. Needs no NumPy."""

from __future__ import annotations

from math import prod

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.configurations import Things
from babyrobot_levels.text.diagnostics import Issue, Key
from babyrobot_levels.text.errors import UnplayableError

MAX_STATES = 2_000_000
"""The most states of a level with things; without, its size has a limit."""

MAX_OUTCOMES = 64
"""The most outcomes of one state and action of a level with things."""

MAX_WIDE_STATES = 5_000_000
"""The most states times the outcomes of the longest row: the tables keep that room."""

WAYS = 5
"""The most cells to which a mover in a rectangle may go in a step."""

BRANCHES = 4
"""The most ends of a move by chance, before warps and movers."""


def surely_fits(level: LevelFields) -> bool:
    """Return whether the fields alone show that the tables of a level are within the bounds.

    Then it can be compiled, unless doors or paths are cut by walls.
    """
    states, outcomes = level.size[0] * level.size[1], most_outcomes(level)
    if level.has_things:
        states *= prod(Things(level).radices)
        if states > MAX_STATES or outcomes > MAX_OUTCOMES:
            return False
    return states * outcomes <= MAX_WIDE_STATES


def most_outcomes(level: LevelFields) -> int:
    """Return how many outcomes of an action there are at most, by the fields alone."""
    by_chance = (
        level.skid is not None
        or level.puddles
        or any(area.skid is not None for area in level.areas)
        or any(wall.pass_ for wall in level.walls)
    )
    lost = any(isinstance(warp.to, str) for warp in level.warps)
    wanderers = sum(mover.within is not None for mover in level.movers)
    shares = (BRANCHES if by_chance else 1) * (len(level.starts) if lost else 1)
    return shares * prod([WAYS] * wanderers)


def too_large(level: LevelFields, states: int, width: int) -> UnplayableError:
    """Return the error of tables that need too much room."""
    message = (
        f"the tables are too large: {states:,} states, and {width} outcomes of an action; "
        f"together at most {MAX_WIDE_STATES:,} are allowed"
    )
    if not level.has_things:
        help_text = "use fewer starts, let warps lead to a cell, or use a smaller level"
        return UnplayableError([Issue("BR404", Key(("start",)), message, help_text)])
    help_text = "use fewer things that walk or skid at random, or a smaller level"
    field = "movers" if level.movers else field_of(level, "items")
    return UnplayableError([Issue("BR404", Key((field,)), message, help_text)])


def field_of(level: LevelFields, field: str) -> str:
    """Return the field that gives items or switches: `legend` where they are drawn."""
    return "legend" if level._drawn.get(field) else field
