"""The steps that are possible in a level, and the straightest of its shortest paths."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.cells import PuddleTypes
from babyrobot_levels.mdp.graph import MANY, Graph, Rows, Successors, counts, differs, distances
from babyrobot_levels.mdp.grid import ALL_SIDES, BIT, Grid

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.mdp.tables import Ints

Layer = dict[tuple[int, int], tuple[int, int]]
"""By pose: the fewest turns on a way there, and the place of the pose before it. A pose is a state
and the direction of the last step that led to another cell: `dx + 2 * width * dy`, 0 for none."""

MANY_POSES = 64
"""From so many on, poses of a large level take their steps together."""


@dataclass(frozen=True, slots=True)
class PossibleSteps:
    """The steps that are possible in a level, with whatever probability.

    Attributes:
        successors: for each state, the other states to which one step can lead.
        reached: for each state the fewest steps from a start, -1 where none leads there.
        to_exit: for each state the fewest steps to an exit, -1 where none can be reached.
    """

    successors: Successors
    reached: Sequence[int]
    to_exit: Sequence[int]


def possible_steps(level: GridWorld) -> PossibleSteps:
    """Return the steps that are possible in a level."""
    if not _only_walls_matter(level):
        # Skidding, wind, warps and cells that end the episode are in the tables.
        from babyrobot_levels.mdp.states import reach_of

        reach = reach_of(level, level.compile())
        return PossibleSteps(reach.successors, reach.steps, reach.to_exit)
    grid, width = level.grid(), level.size[0]
    starts, exits = ([y * width + x for x, y in cells] for cells in (level.starts, level.exits))
    if len(grid.open_bits) >= MANY:
        ways, going_on = steps_through(grid, glass=True), np.ones(len(grid.open_bits), bool)
        going_on[exits] = False
        on = going_on[ways.source]
        graph = Graph(ways.size, ways.source[on], ways.target[on])
        reached, left = graph.distances(starts), ways.distances(exits)
        return PossibleSteps(graph.successors, counts(reached), counts(left))
    successors = neighbours(grid)
    for cell, side in sorted(grid.glass):
        other = grid.neighbour(cell, side)
        assert other is not None, "there is no glass in the outer wall"
        successors[cell].append(other)
    to_exit = distances(exits, successors)
    for cell in exits:
        successors[cell] = []
    return PossibleSteps(successors, distances(starts, successors), to_exit)


def _only_walls_matter(level: GridWorld) -> bool:
    """Return whether the robot can go through each side that walls leave open, and only there."""
    return not (
        level.has_things
        or level.warps
        or level.wind
        or level.areas
        or level.skid is not None
        or level.puddle_types != PuddleTypes()
    )


def neighbours(grid: Grid) -> list[list[int]]:
    """Return for each cell the neighbours that no wall separates from it; glass is a wall."""
    to_sides = {"N": -grid.width, "E": 1, "S": grid.width, "W": -1}
    steps = [
        [step for side, step in to_sides.items() if bits & BIT[side]]
        for bits in range(ALL_SIDES + 1)
    ]
    return [[cell + step for step in steps[bits]] for cell, bits in enumerate(grid.open_bits)]


def steps_through(grid: Grid, *, glass: bool = False) -> Graph:
    """Return the same as a graph, of a large grid; with `glass`, also where glass lets through."""
    source, side = grid.open.reshape(-1, len(SIDES)).nonzero()
    target = source + np.array([-grid.width, 1, grid.width, -1])[side]
    if glass and grid.glass:
        panes = [(cell, grid.neighbour(cell, side)) for cell, side in sorted(grid.glass)]
        source, target = np.concatenate([[source, target], np.array(panes, np.intp).T], axis=1)
        order = np.argsort(source, kind="stable")
        source, target = source[order], target[order]
    return Graph(len(grid.open_bits), source.astype(np.int32), target.astype(np.int32))


class Poses(NamedTuple):
    """A layer of many poses, as arrays."""

    states: Ints
    headings: Ints
    turns: Ints
    before: Ints

    def few(self) -> Layer:
        """Return the same layer."""
        state, heading, turns, before = (values.tolist() for values in self)
        poses = zip(state, heading, strict=True)
        return dict(zip(poses, zip(turns, before, strict=True), strict=True))


def straightest_path(
    steps: PossibleSteps, starts: Sequence[int], size: tuple[int, int]
) -> tuple[list[int], int]:
    """Return the states of a shortest path to an exit, and how often it turns.

    Of all shortest paths from states at the same distance it is one with the fewest turns. A turn
    is a step in another direction (dx, dy) than the step before it; waiting for movers is not one.
    """
    layer: Layer | Poses = {(start, 0): (0, 0) for start in starts}
    # By steps: the states, and of which place in the list before each comes.
    trail: list[tuple[Any, Any]] = [(starts, [0] * len(starts))]
    for left in range(steps.to_exit[starts[0]] - 1, -1, -1):
        if isinstance(steps.successors, Rows) and len(trail[-1][0]) >= MANY_POSES:
            layer = _step_of_many(steps, layer, left, size)
            trail.append((layer.states, layer.before))
        else:
            layer = _step_of_few(steps, layer, left, size)
            trail.append(([state for state, _ in layer], [at for _, at in layer.values()]))
    turns = [count for count, _ in (layer if isinstance(layer, dict) else layer.few()).values()]
    place, states = turns.index(min(turns)), []
    for found, before in reversed(trail):
        states.append(int(found[place]))
        place = before[place]
    return states[::-1], min(turns)


def _step_of_few(
    steps: PossibleSteps, layer: Layer | Poses, left: int, size: tuple[int, int]
) -> Layer:
    """Return the poses after a step, from which `left` steps lead to an exit."""
    width, cells = size[0], size[0] * size[1]
    successors, to_exit = steps.successors, steps.to_exit
    few = layer if isinstance(layer, dict) else layer.few()
    found: Layer = {}
    for place, ((state, heading), (turns, _)) in enumerate(few.items()):
        cell = state % cells
        for other in successors[state]:
            if to_exit[other] == left:
                there = other % cells
                direction = there - cell + (there // width - cell // width) * width or heading
                count = turns + (heading != 0 and direction != heading)
                known = found.get((other, direction))
                if known is None or count < known[0]:
                    found[other, direction] = (count, place)
    return found


def _step_of_many(
    steps: PossibleSteps, layer: Layer | Poses, left: int, size: tuple[int, int]
) -> Poses:
    """Return the same in the same order, computed together."""
    assert isinstance(steps.successors, Rows), "small graphs have few poses"
    width, cells = size[0], size[0] * size[1]
    if isinstance(layer, dict):
        layer = Poses(*np.array([(*pose, *known) for pose, known in layer.items()]).T)
    before, other = steps.successors.of(layer.states)
    # An array of Python's or NumPy's: not copied.
    nearer = np.asarray(steps.to_exit)[other] == left
    before, other = before[nearer], other[nearer].astype(np.int64)
    cell, there, heading = layer.states[before] % cells, other % cells, layer.headings[before]
    direction = there - cell + (there // width - cell // width) * width
    direction = np.where(direction == 0, heading, direction)
    turns = layer.turns[before] + ((heading != 0) & (direction != heading))
    key = other * (4 * cells) + direction
    order = np.lexsort((turns, key))
    first = differs(key[order]).nonzero()[0]
    best = order[first][np.argsort(np.minimum.reduceat(order, first))]
    return Poses(other[best], direction[best], turns[best], before[best])


def connected_components(successors: Successors, cells: Iterable[int]) -> int:
    """Return how many connected components some cells make, steps leading both ways."""
    count = 0
    left = dict.fromkeys(cells)
    while left:
        count += 1
        waiting = [left.popitem()[0]]
        while waiting:
            for other in successors[waiting.pop()]:
                if other in left:
                    del left[other]
                    waiting.append(other)
    return count
