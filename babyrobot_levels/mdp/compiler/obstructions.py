"""What obstructs each action, and where it leads without chance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action
from babyrobot_levels.mdp.compiler.moves import Moves, Warps
from babyrobot_levels.mdp.compiler.terrain import Terrain
from babyrobot_levels.mdp.tables import FREE, GLASS, REFUSED


def obstructions(
    moves: Moves, terrain: Terrain, warps: Warps
) -> tuple[NDArray[np.int8], NDArray[np.int32]]:
    """Return what hinders each action, and where it leads without chance."""
    states = np.arange(terrain.over.size)
    obstruction = np.full((states.size, NUM_ACTIONS), FREE, np.int8)
    target = np.empty((states.size, NUM_ACTIONS), np.int32)
    target[:, Action.STAY] = states
    glass = moves.glass > 0
    moves_on = ~warps.leaves & ~terrain.over
    obstruction[:, 1:][(moves_on & moves.refused).T] = REFUSED
    obstruction[:, 1:][(moves_on & glass).T] = GLASS
    goals = warps.arrive[np.where(glass, moves.through, moves.landing)]
    target[:, 1:] = np.where(warps.leaves, warps.leave_to, goals).T
    target[terrain.over] = states[terrain.over, None]
    return obstruction, target
