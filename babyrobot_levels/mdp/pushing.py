"""Where boxes can be pushed to, if there is only one: whatever the others do, not farther."""

from collections.abc import Iterable

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.mdp.grid import BIT
from babyrobot_levels.mdp.gridworld import GridWorld


def pushed_to(level: GridWorld, cells: Iterable[int]) -> frozenset[int]:
    """Return the cells from which a box can be pushed to some cells, these included.

    All doors count as open, and the robot as able to come to each side of the box. So a box in
    another cell can reach none of them, in no episode.

    Args:
        level: the level; a maze needs a seed.
        cells: the numbers of cells, `y * width + x`.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    grid, width = level.grid(), level.size[0]
    sent = {cell for warp in level.warps for cell in level.targets_of(warp)}
    barred = {y * width + x for x, y in sent}
    found, waiting = {*cells}, [*cells]
    while waiting:
        cell = waiting.pop()
        for side in SIDES:
            # The box comes from this side, and the robot stood one cell farther.
            box = grid.neighbour(cell, side)
            if box is None or box in found or not grid.open_bits[cell] & BIT[side]:
                continue
            robot = grid.neighbour(box, side)
            is_open = grid.open_bits[box] & BIT[side] or (box, side) in grid.glass
            if robot is not None and is_open and cell not in barred:
                found.add(box)
                waiting.append(box)
    return frozenset(found)


def lost_cells(level: GridWorld) -> frozenset[int]:
    """Return the cells from which a box can reach no target; none without targets.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    if not level.targets:
        return frozenset()
    width = level.size[0]
    saved = pushed_to(level, [y * width + x for x, y in (target.at for target in level.targets)])
    free = (cell for cell, blocked in enumerate(level.grid().blocked_cells) if not blocked)
    return frozenset(free) - saved
