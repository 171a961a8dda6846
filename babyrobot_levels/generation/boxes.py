"""Boxes and targets in a maze, such that the robot can push a box onto each target.

Boxes begin on the targets, and a robot pulls them away at random. Backwards in time, its pulls are
pushes, which cover all targets.
"""

import random
from collections.abc import Collection

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.mdp.grid import BIT, Grid
from babyrobot_levels.mdp.mazes.lattice import below

PULLS = 20
"""So many pulls are drawn for each box."""

Near = list[list[int | None]]
"""For each cell the next ones to the north, east, south and west, None behind a wall."""


def pulled(
    grid: Grid, start: int, count: int, rng: random.Random
) -> tuple[list[int], list[int]] | None:
    """Return the cells of boxes and of targets, none of them common; None if there is no room.

    Args:
        grid: walls and cells.
        start: where the robot starts, and so no box does.
        count: how many boxes there are.
        rng: what is drawn is drawn from here.
    """
    near: Near = [
        [grid.neighbour(cell, side) if bits & BIT[side] else None for side in SIDES]
        for cell, bits in enumerate(grid.open_bits)
    ]
    free = [cell for cell in range(len(near)) if cell != start]
    if len(free) <= count:
        return None
    targets = sorted(free.pop(below(rng, len(free))) for _ in range(count))
    boxes, robot, found = {*targets}, free[below(rng, len(free))], None
    for _ in range(PULLS * count):
        reached = _reached(near, robot, boxes)
        pulls = [
            (box, to, beyond)
            for box in sorted(boxes)
            for side, to in enumerate(near[box])
            if to is not None
            and to in reached
            and (beyond := near[to][side]) is not None
            and beyond not in boxes
        ]
        if not pulls:
            break
        box, to, robot = pulls[below(rng, len(pulls))]
        boxes = boxes - {box} | {to}
        if boxes.isdisjoint(targets) and start in _reached(near, robot, boxes):
            found = sorted(boxes)
    return None if found is None else (found, targets)


def _reached(near: Near, robot: int, boxes: Collection[int]) -> set[int]:
    """Return the cells to which the robot gets without moving a box."""
    seen, waiting = {robot}, [robot]
    for cell in waiting:
        for other in near[cell]:
            if other is not None and other not in seen and other not in boxes:
                seen.add(other)
                waiting.append(other)
    return seen
