"""The tables of a level with things: its layers and movers joined with what moves come to.

A row, a pair of state and action, has a branch for each end of the robot's move and each step of
the movers; branches are expanded in parts, merged and sorted as those of other levels are.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from math import log10, prod

import numpy as np

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.kinds import KIND
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.compiler.assembly import assembled
from babyrobot_levels.mdp.compiler.boxes import Boxes
from babyrobot_levels.mdp.compiler.joint import JointTables, exceed
from babyrobot_levels.mdp.compiler.layers import ON, Ground, Layer, Layers, TooManyStates, Ways
from babyrobot_levels.mdp.compiler.movers import TooManyWays
from babyrobot_levels.mdp.compiler.outcomes import Outcomes, Room, draw, exit_reward, merged
from babyrobot_levels.mdp.compiler.robots import Robots
from babyrobot_levels.mdp.compiler.terrain import build_warps, obstructions
from babyrobot_levels.mdp.configurations import (
    MAX_OUTCOMES,
    MAX_WIDE_STATES,
    Things,
    check_room,
    field_of,
    most_columns,
    most_outcomes,
    most_states,
    too_many_outcomes,
)
from babyrobot_levels.mdp.graph import expanded
from babyrobot_levels.mdp.grid import Grid, check_placement
from babyrobot_levels.mdp.tables import FREE, Flags, Floats, Ints, Mdp, parts_of
from babyrobot_levels.text import budget
from babyrobot_levels.text.diagnostics import Issue, Key
from babyrobot_levels.text.errors import UnplayableError

PART = 1 << 17
"""How many branches, about, are expanded at a time."""

BRANCH = 50
"""The steps of work to expand one."""

PLAYED = "they are played without tables by `brl.TeamEnv`, `brl.parallel_env`, `brl.team_returns`"
"""What can be done with several robots all the same."""

SMALL = 1 << 18
"""Up to so many states, tables are made when a level is checked: most will be asked for."""


def compile_things(level: LevelFields, grid: Grid, inert: Collection[str] = ()) -> Mdp:
    """Compile a level with things; arriving at those of some names changes nothing.

    Raises:
        UnplayableError: doors or paths are cut by walls; there are more states than allowed,
            or a row has more than `MAX_OUTCOMES` outcomes.
        OverBudgetError: it takes more than the budget at hand.
    """
    return _compiler(level, Things(level, inert), grid).tables()


def checked_things(level: LevelFields, grid: Grid) -> Mdp | None:
    """Check that a level with things can be compiled; see `checked_mdp`.

    Where there are many states it is enough to count them, unless rows may be too long. Several
    robots need no tables.
    """
    if level.robots:
        stepper(level, grid)
        return None
    compiler = _compiler(level, Things(level), grid)
    states, outcomes = compiler.num_states, most_outcomes(level)
    if states > SMALL and outcomes <= MAX_OUTCOMES and states * outcomes <= MAX_WIDE_STATES:
        return None
    return compiler.tables()


def stepper(level: LevelFields, grid: Grid) -> Robots:
    """Return what steps several robots without tables.

    Raises:
        UnplayableError: doors or paths are cut by walls; there are too many starts or movers.
    """
    things = Things(level)
    check_placement(level, grid)
    with _refused(level, things):
        return Robots(level, grid, things)


def _compiler(level: LevelFields, things: Things, grid: Grid) -> _Compiler | Boxes | JointTables:
    check_placement(level, grid)
    with _refused(level, things):
        if level.robots:
            robots = Robots(level, grid, things)
            if budget.entries() < MAX_WIDE_STATES and exceed(robots):
                # That more may be done elsewhere is of no use.
                (issue,) = _too_many_states(level, things).issues
                raise budget.OverBudgetError(issue.message, issue.help)
            return JointTables(robots)
        if level.boxes:
            return Boxes(level, grid, things)
        return _Compiler(level, Layers(level, grid, things))


@contextmanager
def _refused(level: LevelFields, things: Things) -> Iterator[None]:
    """Say in a sentence what is too much."""
    try:
        yield
    except TooManyStates:
        if (most := budget.entries()) < most_states(level):
            budget.refuse(f"has more than {most:,} states, which are too many here")
        raise _too_many_states(level, things) from None
    except TooManyWays as error:
        raise too_many_outcomes(level, error.ways) from None


def _too_many_states(level: LevelFields, things: Things) -> UnplayableError:
    """Return the error that names what costs most."""
    costs: list[tuple[int, str, str]] = []
    for kind in dict.fromkeys(things.kinds):
        radices = things.radices[things.of_kind(kind)]
        factor, record = prod(radices), KIND[kind]
        if kind == "exit":
            costs.append((factor, f"{factor} exits to draw from", record.by_lot))
        else:
            what = _counted(len(radices), record.noun, record.plural)
            costs.append((factor, what, field_of(level, record.field)))
    costs = sorted((cost for cost in costs if cost[0] > 1), key=lambda cost: -cost[0])
    told = ", ".join(f"{what} ({_up_to(factor)})" for factor, what, _ in costs[:3])
    most = f"the level has more than {most_states(level):,} states"
    if level.robots:
        rows, actions = NUM_ACTIONS * MAX_WIDE_STATES, NUM_ACTIONS ** len(level.robots)
        most = f"the tables would have more than {rows:,} outcomes of {actions} joint actions"
    cells = level.size[0] * level.size[1]
    message = f"{most}: {cells:,} cells, times the combinations of {told}"
    if level.robots:
        message += f"; {PLAYED}"
    help_text = "use fewer of them, fewer cells for them, or a smaller level"
    return UnplayableError([Issue("BR404", Key((costs[0][2],)), message, help_text)])


def _counted(count: int, one: str, several: str) -> str:
    return f"{count} {one if count == 1 else several}"


def _up_to(factor: int) -> str:
    return f"up to {factor:,}" if factor < 10**9 else f"up to 10^{int(log10(factor))}"


class _Compiler:
    def __init__(self, level: LevelFields, layers: Layers):
        self.level, self.layers = level, layers
        self.size, self.actions = layers.size, 1 + level.moves
        crowd = layers.crowd
        static = np.array([layer.values for layer in layers.layers], np.int64)
        static = static.reshape(len(layers.layers), layers.things.static)
        occurs = np.array([np.frombuffer(layer.occurs, bool) for layer in layers.layers])
        layer, joint = occurs.nonzero()
        values = np.concatenate([static[layer], crowd.values[joint]], axis=1)
        order = np.lexsort(values.T[::-1]) if values.shape[1] else np.arange(len(values))
        self.configurations = values[order].astype(np.int16)
        # The number of the configuration of each layer and joint state.
        self.number = np.full(occurs.shape, -1, np.int64)
        self.number[layer[order], joint[order]] = np.arange(order.size)
        self.is_open = np.array([layer.is_open for layer in layers.layers])

    @property
    def num_states(self) -> int:
        """How many states the tables have."""
        return len(self.configurations) * self.size

    def tables(self) -> Mdp:
        """Return the tables."""
        count = len(self.configurations) * self.size
        check_room(self.level, count, 1)
        over = np.ones(count, bool)
        intended = np.repeat(np.arange(count, dtype=np.int32)[:, None], self.actions, axis=1)
        obstruction = np.full((count, self.actions), FREE, np.int8)
        room = Room(count, self.actions, most_columns(self.level, count))
        for ground, members in self._groups():
            hindered, targets = obstructions(ground.air, ground.terrain, ground.warps)
            for layer in members:
                joints, cells = self._on(layer)
                for part in parts_of(cells.size):
                    cell = cells[part]
                    states = self.number[layer.number, joints[part]] * self.size + cell
                    over[states] = False
                    obstruction[states] = hindered[cell]
                    target = targets[cell]
                    there = (states - cell)[:, None] + target
                    intended[states] = np.where(target < 0, count - 1 - target, there)
            for outcomes in self._outcomes(ground, members):
                check_room(self.level, count, outcomes.width)
                room.put(outcomes)
        start = np.zeros(count)
        total = sum(weight for *_, weight in self.layers.starts)
        for number, joint, at, weight in self.layers.starts:
            start[self.number[number, joint] * self.size + at] += weight / total
        return assembled(
            self.layers.grid,
            start=start,
            over=over,
            intended=intended,
            obstruction=obstruction,
            tables=room.tables(),
            configurations=self.configurations,
            drawn=build_warps(self.level, self.layers.grid).drawn,
        )

    def _groups(self) -> Iterator[tuple[Ground, list[Layer]]]:
        """Yield layers with the same ground and exits together."""
        groups: dict[tuple[int, tuple[int, ...]], list[Layer]] = {}
        for layer in self.layers.layers:
            key = id(self.layers.ground(layer)), layer.exits
            groups.setdefault(key, []).append(layer)
        for members in groups.values():
            yield self.layers.ground(members[0]), members

    def _on(self, layer: Layer) -> tuple[Ints, Ints]:
        """Return joint state and cell of the pairs from which an episode goes on."""
        on = np.frombuffer(layer.found, np.uint8) == ON
        joint, cell = np.divmod(on.nonzero()[0], self.size)
        return joint.astype(np.int32), cell.astype(np.int32)

    def _outcomes(self, ground: Ground, members: list[Layer]) -> Iterator[Outcomes]:
        """Yield the outcomes in layers that have the same ground and exits, in parts."""
        shape = len(members), self.size
        after = np.empty(shape, np.int64)
        taken = np.full(shape, np.nan)
        pairs: list[tuple[Ints, Ints, Ints]] = []
        for index, layer in enumerate(members):
            after[index] = layer.number
            for at, following in layer.leads.items():
                after[index, at] = following.number
                reward = layer.arrivals[at].reward
                taken[index, at] = np.nan if reward is None else reward
            joints, cells = self._on(layer)
            pairs.append((np.full(cells.size, index, np.int32), joints, cells))
        numbers = np.array([layer.number for layer in members])
        place, joint, cell = (np.concatenate(column) for column in zip(*pairs, strict=True))
        pairs.clear()
        if not cell.size:
            return
        sizes = np.diff(ground.first[:: self.actions])[cell]
        ways = self.layers.ways(members[0]) if self.level.movers else None
        if ways is not None:
            sizes = sizes * np.diff(ways[0])[joint]
        bounds = np.cumsum(sizes)
        budget.spend(BRANCH * int(bounds[-1]))
        cuts = np.searchsorted(bounds, np.arange(PART, int(bounds[-1]), PART)).tolist()
        is_exit = np.zeros(self.size, bool)
        is_exit[list(members[0].exits)] = True
        for begin, end in pairwise(sorted({0, *cuts, cell.size})):
            part = slice(begin, end)
            ends = self._ends(ground, ways, joint[part], cell[part])
            where = place[part][ends.pair], ends.next_cell
            own = numbers[place[part]][ends.pair]
            arrives = ground.arrives[ends.branch]
            layer_after = np.where(arrives, after[where], own)
            item = np.where(arrives, taken[where], np.nan)
            leaves = self.is_open[layer_after] & is_exit[ends.next_cell]
            configuration = self.number[own, joint[part][ends.pair]]
            state = configuration * self.size + cell[part][ends.pair]
            which, share, paid = self._rewards(ground, ends, item, leaves)
            following = self.number[layer_after, ends.joint] * self.size + ends.next_cell
            over = leaves | ground.terrain.ends[ends.next_cell] | (ends.hit & self.level.hit.ends)
            yield merged(
                (state * self.actions + ends.action)[which],
                ends.probability[which] * share,
                following[which],
                paid,
                over[which],
            )

    def _ends(self, ground: Ground, ways: Ways | None, joint: Ints, cell: Ints) -> _Ends:
        """Return the ends of steps from some pairs of joint state and cell."""
        first = ground.first
        rows = (cell[:, None] * self.actions + np.arange(self.actions)).ravel()
        row, branch = expanded(first[rows], first[rows + 1])
        pair, action = np.divmod(row, self.actions)
        probability = ground.probability[branch]
        next_cell = ground.next_cell[branch]
        if ways is None:
            nobody = np.zeros(pair.size, bool)
            return _Ends(pair, action, branch, probability, next_cell, joint[pair], nobody)
        begin, following, chance = ways
        before = joint[pair]
        each, step = expanded(begin[before], begin[before + 1])
        pair, action, branch, before = pair[each], action[each], branch[each], before[each]
        probability, next_cell = probability[each] * chance[step], next_cell[each]
        after = following[step]
        hit = self.layers.crowd.crowded.hits(before, cell[pair], after, next_cell)
        return _Ends(pair, action, branch, probability, next_cell, after, hit)

    def _rewards(
        self, ground: Ground, ends: _Ends, item: Floats, leaves: Flags
    ) -> tuple[Ints | slice, Floats | float, Floats]:
        """Draw the rewards of ends: of those of the ground and those of things the first."""
        pay = ground.pay.of(ends.branch)
        pay.add(
            {
                "item": (~np.isnan(item), item),
                "exit": (leaves, exit_reward(self.level.rewards, ground.terrain, ends.next_cell)),
                "hit": (ends.hit, self.level.hit.reward),
            }
        )
        which, chance, reward = draw(pay, self.level.rewards, ground.terrain, ends.next_cell)
        bounced = ground.bounced[ends.branch[which]]
        return which, chance, reward + np.where(bounced, self.level.rewards.bounce, 0.0)


@dataclass(frozen=True, slots=True)
class _Ends:
    """Ends of steps; all arrays have one length.

    Attributes:
        pair: the number of the pair of joint state and cell.
        action: the action.
        branch: the number of the branch of the ground.
        probability: how likely it is.
        next_cell: the cell of the robot after it.
        joint: the joint state of the movers after it.
        hit: whether a mover hits the robot.
    """

    pair: Ints
    action: Ints
    branch: Ints
    probability: Floats
    next_cell: Ints
    joint: Ints
    hit: Flags
