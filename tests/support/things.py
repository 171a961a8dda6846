"""Random levels with things for hypothesis, with looks and names of all kinds."""

from __future__ import annotations

from random import Random

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn
from oracles.random_things import random_level

from babyrobot_levels.language.kinds import LISTED, THINGS
from support.worlds import World, optional

FIELDS = (
    *(kind.field for kind in THINGS),
    *("hit", "exit_one_of", "exit_weights", "exit_needs", "heading", "team"),
)
"""The fields of things."""


@st.composite
def thing_worlds(draw: DrawFn) -> World:
    """Random levels with things as mappings, at most 5 cells wide and 4 high."""
    world = random_level(Random(draw(st.integers(0, 10**6))))
    for kind in LISTED:
        for entry in world.get(kind.field, []):
            assert kind.model is not None
            entry |= draw(optional(kind.model, looks=True))
    return world
