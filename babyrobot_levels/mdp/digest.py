"""The digest: a fingerprint of the MDP that a level compiles to, the same on every platform."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.configurations import Things
from babyrobot_levels.mdp.doors import grid_with_doors
from babyrobot_levels.mdp.grid import Grid
from babyrobot_levels.mdp.tables import Mdp

DIGEST_VERSION = 1
PART = 1 << 15
"""How many states are hashed at a time."""

_HEADER = f"babyrobot-levels game {DIGEST_VERSION}\n".encode("ascii")


def digest(level: LevelFields, grid: Grid, mdp: Mdp) -> str:
    """Return `sha256:` and 64 hex digits over the compiled level.

    The bytes are, all little-endian: the header with the version of this layout; width and
    height; the open sides and the blocked cells, a byte each; the walls of glass (cell, side,
    probability), sorted; the probability of each start; where the episode is over; and of each
    state and action the number of outcomes, then of all outcomes that can happen the
    probabilities, next states, rewards and terminal flags. With things there follow the word
    `things`, their number and that of configurations, the configurations, and the open sides in
    each of them. Names are no part of it.
    """
    hashed = hashlib.sha256(_HEADER)
    for part in _parts(level, grid, mdp):
        hashed.update(part if isinstance(part, bytes) else part.tobytes())
    return f"sha256:{hashed.hexdigest()}"


def _parts(level: LevelFields, grid: Grid, mdp: Mdp) -> Iterator[bytes | NDArray[Any]]:
    """Yield what is hashed, part by part: copies of large tables take much room."""
    sides = "NESW"
    glass = sorted((cell, sides.index(side), p) for (cell, side), p in grid.glass.items())
    yield np.array([grid.width, grid.height], "<u4")
    yield grid.open_bits
    yield grid.blocked_cells
    yield np.array([len(glass)], "<u4")
    yield np.array([(cell, side) for cell, side, _ in glass], "<u4")
    yield np.array([probability for _, _, probability in glass], "<f8")
    yield mdp.start.astype("<f8")
    yield mdp.is_terminal.astype("u1")
    parts = [slice(at, at + PART) for at in range(0, mdp.num_states, PART)]
    for part in parts:
        yield (mdp.probability[part] > 0).sum(axis=2).astype("<u4")
    for table, kind in (
        (mdp.probability, "<f8"),
        (mdp.next_state, "<u4"),
        (mdp.reward, "<f8"),
        (mdp.terminal, "u1"),
    ):
        for part in parts:
            yield table[part][mdp.probability[part] > 0].astype(kind)
    if level.has_things:
        yield from _things(level, grid, mdp)


def _things(level: LevelFields, grid: Grid, mdp: Mdp) -> Iterator[bytes | NDArray[Any]]:
    things = Things(level)
    yield b"things\n"
    yield np.array([len(things), mdp.num_configurations], "<u4")
    yield mdp.configurations.astype("<i2")
    sides: dict[tuple[bool, ...], bytes] = {}
    for values in mdp.configurations.tolist():
        closed = things.closed(things.met(values))
        if closed not in sides:
            sides[closed] = grid_with_doors(level, grid, closed).open_bits
        yield sides[closed]
