"""What cells show, by the names that views and planes share: ground, doors and things."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.mdp.compiler.terrain import Terrain
from babyrobot_levels.mdp.grid import door_sides
from babyrobot_levels.mdp.tables import Flags

if TYPE_CHECKING:
    from babyrobot_levels.language.geometry import Cell
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.mdp.configurations import Configuration


def ground_of(level: Level, terrain: Terrain) -> dict[str, Flags]:
    """Return where the ground is what a name says, bool `[height, width]` each.

    The names are `blocked`, `ends` (an area that ends the episode), `puddle-small`, `puddle-large`
    and `warp`.

    Args:
        level: the level; a maze needs a seed.
        terrain: what its cells do.
    """
    blocked = level.grid().blocked
    found = {"blocked": blocked, "ends": terrain.ends.reshape(blocked.shape) & ~blocked}
    for name in ("puddle-small", "puddle-large", "warp"):
        found[name] = np.zeros(blocked.shape, np.bool_)
    for puddle in level.puddles:
        found[f"puddle-{puddle.size}"][puddle.at[1], puddle.at[0]] = True
    for warp in level.warps:
        found["warp"][warp.at[1], warp.at[0]] = True
    return found


def closed_doors(level: Level, closed: Sequence[bool]) -> Flags:
    """Return on which sides of cells a closed door is, bool `[height, width, 4]`.

    Args:
        level: the level.
        closed: for each door, whether it is closed.
    """
    width, height = level.size
    found = np.zeros((height, width, len(SIDES)), np.bool_)
    for cell, side, index in door_sides(level, level.grid()):
        if closed[index]:
            found[cell // width, cell % width, SIDES.index(side)] = True
    return found


def placed(level: Level, now: Configuration) -> Iterator[tuple[str, Cell]]:
    """Yield the names and cells of exits, things that stay or lie in cells, and movers.

    Exits are `exit`, or `exit-locked` while their needs are not met; items are named by their
    pictures; others by their kinds, with `-off` or `-on`.
    """
    exits = "exit" if now.exit_is_open else "exit-locked"
    yield from ((exits, cell) for cell in now.exits)
    for item, place in zip(level.items, now.items, strict=True):
        if place is not None:
            yield item.picture, place
    for thing, value in zip(level.things(), now.values, strict=True):
        cell = thing.cells[value]
        if thing.met == "on" and cell is not None:
            yield f"{thing.kind}-{thing.states[value]}", cell
    yield from (("mover", cell) for cell in now.movers)


def held_pictures(level: Level, now: Configuration) -> set[str]:
    """Return the pictures of the items that are held."""
    return {item.picture for item in level.items if item.name in now.held}


def squashed(values: ArrayLike) -> NDArray[np.float64]:
    """Return rewards as values from 0 to 1, the same in all levels: `0.5 + 0.5 * r / (1 + |r|)`."""
    rewards = np.asarray(values, np.float64)
    return np.asarray(0.5 + 0.5 * rewards / (1 + np.abs(rewards)))
