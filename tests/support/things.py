"""Random levels with things for hypothesis, with looks and names of all kinds."""

from __future__ import annotations

from random import Random
from typing import Any

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn
from oracles.random_things import random_level

from support.worlds import COLORS, World

FIELDS = ("items", "doors", "switches", "movers", "hit", "exit_one_of", "exit_needs", "heading")
"""The fields of things."""

LOOKS: dict[str, dict[str, st.SearchStrategy[Any]]] = {
    "items": {
        "color": st.sampled_from([*COLORS, None]),
        "label": st.sampled_from(["", "a: b", None]),
        "shape": st.sampled_from(["key", "coin", "gem", "star", "box", None]),
    },
    "switches": {"color": st.sampled_from([*COLORS, None]), "label": st.sampled_from(["", "on"])},
    "movers": {"color": st.sampled_from([*COLORS, None]), "label": st.sampled_from(["", "yes"])},
    "doors": {"color": st.sampled_from([*COLORS, None]), "width": st.sampled_from([0, 7.5, None])},
}


@st.composite
def thing_worlds(draw: DrawFn) -> World:
    """Random levels with things as mappings, at most 5 cells wide and 4 high."""
    world = random_level(Random(draw(st.integers(0, 10**6))))
    for field, looks in LOOKS.items():
        for entry in world.get(field, []):
            entry |= draw(st.fixed_dictionaries({}, optional=looks))
    return world
