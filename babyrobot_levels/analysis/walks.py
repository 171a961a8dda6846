"""Ways through a level: which steps are possible, and the shortest walks that they make."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from babyrobot_levels.language.cells import PuddleTypes
from babyrobot_levels.mdp.graph import Successors, distances
from babyrobot_levels.mdp.grid import ALL_SIDES, BIT

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.mdp.grid import Grid

Pose = tuple[int, tuple[int, int] | None]
"""A cell, and the way (dx, dy) by which the robot came there."""


@dataclass(frozen=True, slots=True)
class Walks:
    """The steps that are possible in a level, with whatever probability.

    Attributes:
        ahead: for each cell, the other cells to which one step can lead.
        reached: for each cell the fewest steps from a start, -1 where none leads there.
        to_exit: for each cell the fewest steps to an exit, -1 where none can be reached.
    """

    ahead: Successors
    reached: Sequence[int]
    to_exit: Sequence[int]


def walks_of(level: Level) -> Walks:
    """Return the steps that are possible in a level."""
    if not _only_walls_matter(level):
        # Skidding, wind, warps and cells that end the episode are in the tables.
        from babyrobot_levels.mdp.reachability import reach_of

        reach = reach_of(level, level.compile())
        return Walks(reach.successors, reach.steps, reach.to_exit)
    grid, width = level.grid(), level.size[0]
    beside = neighbours(grid)
    for cell, side in sorted(grid.glass):
        other = grid.neighbour(cell, side)
        assert other is not None, "there is no glass in the outer wall"
        beside[cell].append(other)
    starts, exits = ([y * width + x for x, y in cells] for cells in (level.starts, level.exits))
    to_exit = distances(exits, beside)
    for cell in exits:
        beside[cell] = []
    return Walks(beside, distances(starts, beside), to_exit)


def _only_walls_matter(level: Level) -> bool:
    """Tell whether the robot can go through each side that a wall leaves open, and only there."""
    return not (
        level.warps
        or level.wind
        or level.areas
        or level.skid is not None
        or level.puddle_types != PuddleTypes()
    )


def neighbours(grid: Grid) -> list[list[int]]:
    """Return for each cell the neighbours that nothing separates from it; glass does."""
    to_sides = {"N": -grid.width, "E": 1, "S": grid.width, "W": -1}
    steps = [
        [step for side, step in to_sides.items() if bits & BIT[side]]
        for bits in range(ALL_SIDES + 1)
    ]
    return [[cell + step for step in steps[bits]] for cell, bits in enumerate(grid.open_bits)]


def straightest(walks: Walks, start: int, width: int) -> tuple[list[int], int]:
    """Return the cells of a shortest walk from a cell to an exit, and how often it turns.

    Of all shortest walks it is one with the fewest turns. A turn is where a step goes another way
    (dx, dy) than the one before it.
    """
    # Where the walk stands, and which way it came there: so far the turns, and where it was before.
    layers: list[dict[Pose, tuple[int, Pose]]] = [{(start, None): (0, (start, None))}]
    for left in range(walks.to_exit[start] - 1, -1, -1):
        found: dict[Pose, tuple[int, Pose]] = {}
        for pose, (turns, _) in layers[-1].items():
            cell, heading = pose
            y, x = divmod(cell, width)
            for other in walks.ahead[cell]:
                if walks.to_exit[other] == left:
                    way = (other % width - x, other // width - y)
                    count = turns + (heading is not None and way != heading)
                    if (other, way) not in found or count < found[other, way][0]:
                        found[other, way] = (count, pose)
        layers.append(found)
    pose = min(layers[-1], key=lambda last: layers[-1][last][0])
    turns = layers[-1][pose][0]
    cells = []
    for layer in reversed(layers):
        cells.append(pose[0])
        pose = layer[pose][1]
    return cells[::-1], turns


def parts(ahead: Successors, cells: Iterable[int]) -> int:
    """Return how many parts some cells make that do not hang together, steps leading both ways."""
    count = 0
    left = dict.fromkeys(cells)
    while left:
        count += 1
        waiting = [left.popitem()[0]]
        while waiting:
            for other in ahead[waiting.pop()]:
                if other in left:
                    del left[other]
                    waiting.append(other)
    return count
