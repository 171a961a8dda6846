"""Which configurations occur: a search over cells, layers and movers together.

A layer is a choice of the values of all things but the movers. Within a layer the robot walks among
the cells; by changing one it comes to another layer.
"""

from __future__ import annotations

from array import array
from collections import deque
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.compiler.movers import Crowd
from babyrobot_levels.mdp.compiler.outcomes import (
    BOUNCED,
    Arrivals,
    Pay,
    chance_branches,
    ended,
    plain_branches,
)
from babyrobot_levels.mdp.compiler.terrain import (
    Air,
    Terrain,
    Warps,
    build_air,
    build_moves,
    build_terrain,
    build_warps,
)
from babyrobot_levels.mdp.configurations import MAX_STATES, Things, Values
from babyrobot_levels.mdp.graph import Graph, differs, expanded
from babyrobot_levels.mdp.grid import Grid, grid_with_doors
from babyrobot_levels.mdp.tables import Flags, Floats, Ints, parts_of
from babyrobot_levels.text import budget

LARGE = 50_000
"""From so many cells on, it is worth while to look first whether the level is too large."""

MANY, MORE, BATCH = 64, 512, 1 << 12
"""From so many pairs on, among movers and without, steps are taken together; so many at a time."""

Ways = tuple[Ints, Ints, Floats]
"""Steps of movers; see `Crowd.steps`."""

FEW_MOVERS = 16
"""Among more movers, steps are always taken together."""

PAIR = 500
"""The steps of work to take a step from a pair of joint state and cell."""

REACHED, ON = 1, 2
"""What the search notes of a pair: an episode can be there; and it can go on from there."""


class TooManyStates(Exception):
    """The level has more states than `MAX_STATES`, or than the budget allows."""


@dataclass(frozen=True, eq=False)
class Ground:
    """What the robot's moves come to, whatever it takes or meets, while some doors are closed.

    Attributes:
        grid: the grid with walls at closed doors.
        air: the moves on it.
        terrain: the terrain, in which no cell is an exit.
        warps: the warps.
        first: `[cells * actions + 1]`: where the branches of each cell and action begin.
        probability: how likely each branch is, by cell and action.
        next_cell: where the branch ends.
        arrives: whether the robot arrives there: on another cell than before, or by a warp.
        pay: its reward, whatever the robot takes or meets.
        bounced: whether a wall of glass does not let it through, for which there is a reward.
        follow: the cells at which a robot may arrive from each cell, one after the other.
        begin: `[cells + 1]`: where those of each cell begin in `follow`.
    """

    grid: Grid
    air: Air
    terrain: Terrain
    warps: Warps
    first: Ints
    probability: Floats
    next_cell: Ints
    arrives: Flags
    pay: Pay
    bounced: Flags
    follow: array[int]
    begin: array[int]


class Change(NamedTuple):
    """What an arrival changes: the value of the thing in a column. `reward` is that of an item."""

    column: int
    value: int
    reward: float | None


class Changes:
    """What arriving at cells changes, by the values of all things but the movers."""

    def __init__(self, level: LevelFields, things: Things):
        # The column of each thing that arrivals change, and for each of its values cell and change.
        self._things = [
            (
                column,
                [
                    (cell[1] * level.size[0] + cell[0], Change(column, after, thing.reward))
                    if cell is not None and after != value
                    else None
                    for value, (cell, after) in enumerate(
                        zip(thing.cells, thing.after, strict=True)
                    )
                ],
            )
            for column, thing in enumerate(things)
            if thing.after
        ]

    def at(self, values: Values) -> dict[int, Change]:
        """Return what changes at the cells at which something does."""
        found = (changes[values[column]] for column, changes in self._things)
        return dict(each for each in found if each is not None)


@dataclass(eq=False)
class Layer:
    """A layer, and what the search found in it.

    Attributes:
        number: its number, in the order in which layers were found.
        values: the values of all things but the movers.
        exits: the numbers of the cells that are exits.
        is_open: whether an exit ends the episode.
        over: for each cell, whether the episode is over there.
        found: for each joint state of the movers and each cell, `REACHED`, `ON` or 0.
        occurs: for each joint state, whether it occurs.
        waiting: the pairs from which the search has not gone on yet.
        leads: the layers to which arriving at a cell was found to lead.
    """

    level: LevelFields
    things: Things
    changes: Changes
    number: int
    values: Values
    exits: tuple[int, ...]
    is_open: bool
    over: bytes
    found: bytearray
    occurs: bytearray
    waiting: list[int] = field(default_factory=list)
    leads: dict[int, Layer] = field(default_factory=dict)

    # The search notes many layers, and walks through few of a level that is too large.

    @cached_property
    def closed(self) -> tuple[bool, ...]:
        """For each door, whether it is closed."""
        return self.things.closed(self.things.met(self.values)) if self.level.doors else ()

    @cached_property
    def arrivals(self) -> dict[int, Change]:
        """What changes at the cells at which something does."""
        return self.changes.at(self.values)

    def after(self, change: Change) -> Values:
        """Return the values after a change."""
        column = change.column
        return (*self.values[:column], change.value, *self.values[column + 1 :])


class Layers:
    """All layers of a level that episodes can come to.

    Attributes:
        layers: the layers.
        crowd: the movers.
        count: how many configurations there are.

    Raises:
        TooManyStates: there are more states than the bound.
    """

    def __init__(self, level: LevelFields, grid: Grid, things: Things):
        self.level, self.grid, self.things = level, grid, things
        self.size = grid.width * grid.height
        self._most = int(min(MAX_STATES, budget.entries())) // self.size
        self._check_draws()
        try:
            self.crowd = Crowd(level, grid, self._most)
        except OverflowError:
            raise TooManyStates from None
        self.layers: list[Layer] = []
        self.count = 0
        self._numbers: dict[Values, int] = {}
        places = [level.exits] if level.exit_one_of is None else [[c] for c in level.exit_one_of]
        self._exits = [tuple(y * grid.width + x for x, y in cells) for cells in places]
        self._changes = Changes(level, things)
        self._exit_needs = [things.needed[name] for name in level.exit_keys]
        self._grounds: dict[tuple[tuple[bool, ...], tuple[int, ...]], Ground] = {}
        self._overs: dict[tuple[tuple[int, ...], bool], bytes] = {}
        self._ways: dict[tuple[bool, ...], Ways] = {}
        self._steps: dict[tuple[bool, ...], list[list[int]]] = {}
        terrain = build_terrain(level, grid)
        self._ends = terrain.ends.tobytes()
        if self.size > LARGE and not level.movers:
            self._check_first_items(terrain)
        self._stands = self.crowd.crowded.stands.tobytes()
        self._cells = self.crowd.cells.tolist() if len(level.movers) <= FEW_MOVERS else []
        self.starts = self._begin()
        self._search()

    def _check_draws(self) -> None:
        """Refuse at once what cannot be within the bound: more draws, or a change of anything."""
        draws = prod(len(thing.begins) for thing in self.things)
        if draws > self._most or (self._most < 2 and max(self.things.radices, default=1) > 1):
            raise TooManyStates

    def _check_first_items(self, terrain: Terrain) -> None:
        """Refuse, before all branches are built, a level with too many things within reach.

        Each thing that changes by arrivals, to which moves lead, without glass and warps, gives a
        configuration of its own.
        """
        x, y = self.level.starts[0]
        values = self.things.taken_at_start(next(self.things.draws()), (x, y))
        layer = self.layer(values[: self.things.static])
        if not layer.arrivals:
            return
        grid = grid_with_doors(self.level, self.grid, layer.closed)
        landing = build_moves(self.level, grid).landing.T
        start, changing = y * grid.width + x, [*layer.arrivals]
        goes_on = (terrain.skid < 1) & (np.frombuffer(layer.over, np.uint8) == 0)
        goes_on[changing] = False
        goes_on[start] = True
        warped = np.zeros(self.size, bool)
        warped[[warp.at[1] * grid.width + warp.at[0] for warp in self.level.warps]] = True
        leads = goes_on[:, None] & ~warped[landing]
        source = np.repeat(np.arange(self.size, dtype=np.int32), leads.sum(axis=1))
        steps = Graph(self.size, source, landing[leads]).distances([start])
        if (steps[changing] > 0).sum() + 1 > self._most:
            raise TooManyStates

    # -- layers ----------------------------------------------------------------------------

    def layer(self, values: Values) -> Layer:
        """Return the layer of some values."""
        number = self._numbers.get(values)
        if number is not None:
            return self.layers[number]
        exits = self._exits[values[0] if self.level.exit_one_of is not None else 0]
        is_open = all(values[column] == value for column, value in self._exit_needs)
        over = self._overs.get((exits, is_open))
        if over is None:
            marked = bytearray(self._ends)
            for cell in exits if is_open else ():
                marked[cell] = 1
            over = self._overs[exits, is_open] = bytes(marked)
        joints = len(self.crowd)
        if (len(self.layers) + 1) * joints > 4 * self._most:
            raise TooManyStates
        layer = Layer(
            level=self.level,
            things=self.things,
            changes=self._changes,
            number=len(self.layers),
            values=values,
            exits=exits,
            is_open=is_open,
            over=over,
            found=bytearray(joints * self.size),
            occurs=bytearray(joints),
        )
        self._numbers[values] = layer.number
        self.layers.append(layer)
        return layer

    def _led(self, layer: Layer, cell: int) -> Layer:
        """Return the layer to which arriving at a cell leads, where something changes."""
        other = layer.leads.get(cell)
        if other is None:
            other = layer.leads[cell] = self.layer(layer.after(layer.arrivals[cell]))
        return other

    def ground(self, layer: Layer) -> Ground:
        """Return what moves come to in a layer."""
        # Exits only matter to the rewards for coming closer.
        shaped = self.level.rewards.closer is not None or self.level.rewards.farther is not None
        key = layer.closed, layer.exits if shaped else ()
        if key not in self._grounds:
            width = self.grid.width
            exits = tuple((cell % width, cell // width) for cell in layer.exits)
            self._grounds[key] = build_layer_ground(self.level, self.grid, layer.closed, exits)
        return self._grounds[key]

    def ways(self, layer: Layer) -> Ways:
        """Return where a step takes the movers; see `Crowd.steps`."""
        if layer.closed not in self._ways:
            self._ways[layer.closed] = self.crowd.steps(self.ground(layer).grid)
        return self._ways[layer.closed]

    def steps(self, layer: Layer) -> list[list[int]]:
        """Return for each joint state of the movers those to which it leads."""
        if layer.closed not in self._steps:
            first, following, _ = self.ways(layer)
            bounds, targets = first.tolist(), following.tolist()
            self._steps[layer.closed] = [
                targets[bounds[joint] : bounds[joint + 1]] for joint in range(len(self.crowd))
            ]
        return self._steps[layer.closed]

    # -- search ----------------------------------------------------------------------------

    def _begin(self) -> list[tuple[int, int, int, int]]:
        """Return layer, joint state, cell and weight of each start, and mark them."""
        starts = []
        for values, (x, y), weight in self.things.beginnings():
            layer = self.layer(values[: self.things.static])
            joint = self.crowd.joint(values[self.things.static :])
            cell = y * self.grid.width + x
            self._note(layer, joint, cell, ON)
            starts.append((layer.number, joint, cell, weight))
        return starts

    def _note(self, layer: Layer, joint: int, cell: int, what: int) -> None:
        """Note that an episode can come to a pair."""
        layer.found[joint * self.size + cell] = what
        if not layer.occurs[joint]:
            layer.occurs[joint] = 1
            self.count += 1
            if self.count > self._most:
                raise TooManyStates
        if what == ON:
            layer.waiting.append(joint * self.size + cell)

    def _search(self) -> None:
        # Layers that were found first come first: from them most others are found.
        waiting = deque(layer for layer in self.layers if layer.waiting)
        while waiting:
            layer = waiting.popleft()
            touched = self._walk_among(layer) if self.level.movers else self._walk(layer)
            waiting += [other for other in touched if other.waiting]

    def _walk(self, layer: Layer) -> list[Layer]:
        """Walk through a layer of a level without movers; return the layers that it leads to."""
        ground = self.ground(layer)
        follow, begin = ground.follow, ground.begin
        found, over, arrivals, stack = layer.found, layer.over, layer.arrivals, layer.waiting
        touched: dict[int, Layer] = {}
        while stack:
            if len(stack) >= MORE:
                touched |= self._walk_together(layer, stack)
                continue
            cell = stack.pop()
            budget.spend(PAIR)
            for target in follow[begin[cell] : begin[cell + 1]]:
                if target in arrivals:
                    other = self._led(layer, target)
                    if not other.found[target]:
                        self._note(other, 0, target, REACHED if other.over[target] else ON)
                        touched[other.number] = other
                elif not found[target]:
                    if over[target]:
                        found[target] = REACHED
                    else:
                        found[target] = ON
                        stack.append(target)
        return [*touched.values()]

    def _walk_among(self, layer: Layer) -> list[Layer]:
        """Walk through a layer among movers; return the layers that it leads to."""
        ground, steps, size = self.ground(layer), self.steps(layer), self.size
        follow, begin, stack = ground.follow, ground.begin, layer.waiting
        hit_ends, stands, cells = self.level.hit.ends, self._stands, self._cells
        many = MANY if cells else 1
        touched: dict[int, Layer] = {}
        while stack:
            if len(stack) >= many:
                touched |= self._walk_together(layer, stack)
                continue
            joint, cell = divmod(stack.pop(), size)
            budget.spend(PAIR * len(steps[joint]))
            for number, target in enumerate((cell, *follow[begin[cell] : begin[cell + 1]])):
                other = layer
                if number and target in layer.arrivals:
                    other = self._led(layer, target)
                found = other.found
                for after in steps[joint]:
                    if found[after * size + target] == ON:
                        continue
                    ends = other.over[target] or (
                        hit_ends
                        and (
                            stands[after * size + target]
                            or (target != cell and _swaps(cells[joint], cells[after], cell, target))
                        )
                    )
                    if not ends:
                        self._note(other, after, target, ON)
                        if other is not layer:
                            touched[other.number] = other
                    elif not found[after * size + target]:
                        self._note(other, after, target, REACHED)
        return [*touched.values()]

    def _walk_together(self, layer: Layer, stack: list[int]) -> dict[int, Layer]:
        """Take a step from the last pairs of a layer; return other layers that it leads to."""
        pairs = np.array(stack[-BATCH:])
        del stack[-BATCH:]
        budget.spend(PAIR * MANY)
        ground, (first, following, _) = self.ground(layer), self.ways(layer)
        joint, cell = np.divmod(pairs, self.size)
        begin = np.frombuffer(ground.begin, np.intc)
        source, edge = expanded(begin[cell], begin[cell + 1])
        target = np.concatenate([cell, np.frombuffer(ground.follow, np.intc)[edge]])
        source = np.concatenate([np.arange(cell.size), source])
        each, step = expanded(first[joint[source]], first[joint[source] + 1])
        budget.spend(20 * each.size)
        arrives, target, source = each >= cell.size, target[each], source[each]
        before, here, after = joint[source], cell[source], following[step]
        hit = np.zeros(each.size, bool)
        if self.level.hit.ends:
            hit = self.crowd.crowded.hits(before, here, after, target)
        changing = np.zeros(self.size, bool)
        changing[[*layer.arrivals]] = True
        changes = arrives & changing[target]
        self._note_all(layer, after[~changes], target[~changes], hit[~changes])
        touched = {}
        for at in np.unique(target[changes]).tolist():
            other, where = self._led(layer, at), changes & (target == at)
            if self._note_all(other, after[where], target[where], hit[where]):
                touched[other.number] = other
        return touched

    def _note_all(self, layer: Layer, joint: Ints, cell: Ints, hit: Flags) -> bool:
        """Note that an episode can come to many pairs; return whether it goes on from new ones."""
        found, occurs = np.frombuffer(layer.found, np.uint8), np.frombuffer(layer.occurs, np.uint8)
        known = occurs.sum()
        occurs[joint] = 1
        self.count += int(occurs.sum() - known)
        if self.count > self._most:
            raise TooManyStates
        pair, ends = joint * self.size + cell, hit | np.frombuffer(layer.over, bool)[cell]
        new = pair[~ends]
        new = distinct(new[found[new] != ON])
        found[new] = ON
        ended = pair[ends]
        found[ended[found[ended] == 0]] = REACHED
        layer.waiting += new.tolist()
        return new.size > 0


def distinct(numbers: Ints) -> Ints:
    """Return the numbers in rising order, each once: `np.unique` takes ten times as long."""
    ordered = np.sort(numbers)
    return ordered[differs(ordered)]


def _swaps(before: list[int], after: list[int], cell: int, target: int) -> bool:
    """Tell whether a mover goes from the robot's next cell to the robot's cell."""
    return any(one == target and two == cell for one, two in zip(before, after, strict=True))


def build_layer_ground(
    level: LevelFields, open_grid: Grid, closed: tuple[bool, ...], exits: tuple[Cell, ...]
) -> Ground:
    """Return what moves come to while some doors are closed.

    Args:
        level: the level.
        open_grid: its grid, with all doors open.
        closed: for each door, whether it is closed.
        exits: the exits, to which robots come closer.
    """
    grid = grid_with_doors(level, open_grid, closed)
    count, actions = grid.width * grid.height, 1 + level.moves
    painted = build_terrain(level, grid, exits)
    terrain = replace(painted, exit=np.zeros(count, bool), over=painted.ends)
    air, warps = build_air(level, grid), build_warps(level, grid)
    arrivals = Arrivals(level.rewards, terrain, warps, air.given.here, actions)
    kinds = (np.intc, np.intc, np.intc, float, np.int32, bool, float, np.int8, bool)
    columns = [bytearray() for _ in kinds]
    for part in parts_of(count):
        rows, chances = chance_branches(air, terrain, warps, part)
        plain = plain_branches(air.given, terrain, warps, part).select(~rows.ravel())
        branches, next_cell = ended(plain.joined(chances), arrivals)
        order = np.argsort(branches.row, kind="stable")
        branches, next_cell = branches.select(order), next_cell[order]
        cell = branches.row // actions
        arrives = arrivals.is_sent(branches) | (next_cell != cell)
        ways = arrives & ~terrain.over[cell]
        leads, where = np.divmod(distinct(cell[ways] * count + next_cell[ways]), count)
        pay = arrivals.pay(branches, next_cell)
        values: tuple[NDArray[Any], ...] = (
            where,
            np.bincount(leads - part.start, minlength=part.stop - part.start),
            np.bincount(
                branches.row - part.start * actions, minlength=(part.stop - part.start) * actions
            ),
            branches.probability,
            next_cell,
            arrives,
            pay.reward,
            pay.rank,
            branches.happened & BOUNCED,
        )
        # Bytes grow where they are: arrays put together would be there twice.
        for column, kind, more in zip(columns, kinds, values, strict=True):
            column += more.astype(kind).tobytes()
    follow, led, length, probability, next_cells, arrive, reward, rank, bounced = (
        np.frombuffer(column, kind) for column, kind in zip(columns, kinds, strict=True)
    )
    return Ground(
        grid=grid,
        air=air,
        terrain=terrain,
        warps=warps,
        first=_begins(length),
        probability=probability,
        next_cell=next_cells,
        arrives=arrive,
        pay=Pay(reward, rank),
        bounced=bounced,
        follow=array("i", follow.tobytes()),
        begin=array("i", _begins(led).tobytes()),
    )


def _begins(lengths: Ints) -> NDArray[np.intc]:
    """Return where each of some runs begins that follow each other, and where the last ends."""
    begins = np.zeros(lengths.size + 1, np.intc)
    np.cumsum(lengths, out=begins[1:])
    return begins
