"""What happens when several robots want one cell, or to change places."""

from itertools import permutations

import numpy as np

from babyrobot_levels.mdp.tables import Flags, Ints


def meetings(here: Ints, there: Ints, present: Flags) -> Flags:
    """Return which robots meet another: they come to stand in one cell, or change places.

    Args:
        here: the cell of each robot before a step, `[robots, steps]`.
        there: the cell of each one after it.
        present: which of them are in the level.

    Returns:
        Flags `[robots, steps]`.
    """
    met = np.zeros(there.shape, bool)
    for one, other in permutations(range(len(here)), 2):
        met[one] |= present[one] & present[other] & _meets(here, there, one, other)
    return met


def hindered(here: Ints, wanted: Ints, present: Flags, in_order: bool) -> Flags:
    """Return which robots stay since another hinders them.

    Those who want one cell, or to change places, stay; so does who wants the cell of one that
    stays. In order, the first of those who want one cell goes.

    Args:
        here: the cell of each robot before a step, `[robots, steps]`.
        wanted: the cell to which each of them would go.
        present: which of them are in the level.
        in_order: whether those who come first in the list go first.

    Returns:
        Flags `[robots, steps]`.
    """
    stays = np.zeros(wanted.shape, bool)
    there = wanted.copy()
    while True:
        moving = (there != here) & present
        more = np.zeros(wanted.shape, bool)
        for one, other in permutations(range(len(here)), 2):
            meet = moving[one] & present[other] & _meets(here, there, one, other)
            if in_order and one < other:
                meet &= ~moving[other]
            more[one] |= meet
        if not more.any():
            return stays
        stays |= more
        there = np.where(stays, here, wanted)


def _meets(here: Ints, there: Ints, one: int, other: int) -> Flags:
    """Return in which steps a robot comes to stand with another, or changes places with it."""
    swaps = (there[one] == here[other]) & (there[other] == here[one])
    meets: Flags = (there[one] == there[other]) | (swaps & (there[one] != here[one]))
    return meets
