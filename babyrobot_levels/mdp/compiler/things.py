"""The tables of a level with things: its layers and movers joined with what moves come to.

A row, a pair of state and action, has a branch for each end of the robot's move and each step of
the movers; branches are expanded in parts, merged and sorted as those of other levels are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.compiler.layers import (
    MAX_STATES,
    ON,
    Ground,
    Layer,
    Layers,
    TooManyStates,
)
from babyrobot_levels.mdp.compiler.movers import MAX_OUTCOMES, TooManyWays
from babyrobot_levels.mdp.compiler.obstructions import obstructions
from babyrobot_levels.mdp.compiler.outcomes import Flags, Floats, Ints
from babyrobot_levels.mdp.configurations import Things
from babyrobot_levels.mdp.grid import Grid
from babyrobot_levels.mdp.placement import placement_issues
from babyrobot_levels.mdp.tables import FREE, REFUSED, Mdp
from babyrobot_levels.text.diagnostics import Issue
from babyrobot_levels.text.errors import UnplayableError

PART = 1 << 17
"""How many branches, about, are expanded at a time."""


def compile_things(level: LevelFields, grid: Grid) -> Mdp:
    """Compile a level with things.

    Raises:
        UnplayableError: doors or paths are cut by walls; there are more than `MAX_STATES` states,
            or a row has more than `MAX_OUTCOMES` outcomes.
    """
    issues = placement_issues(level, grid) if level.stands_on_grid else []
    if issues:
        raise UnplayableError(issues)
    things = Things(level)
    try:
        layers = Layers(level, grid, things)
    except TooManyStates:
        raise _too_many_states(level, things) from None
    except TooManyWays as error:
        count = sum(mover.within is not None for mover in level.movers)
        what = f"{count} movers that walk at random have {error.ways:,} ways to go"
        raise _too_many_outcomes(what) from None
    return _Compiler(level, layers).tables()


def _too_many_states(level: LevelFields, things: Things) -> UnplayableError:
    """Return the error that names what costs most."""
    costs: list[tuple[int, str, tuple[str | int, ...]]] = []
    if level.exit_one_of is not None:
        count = len(level.exit_one_of)
        costs.append((count, f"`exit_one_of` with {count} cells", ("exit_one_of",)))
    factor = prod(len(item.places) + 1 for item in level.items)
    items = f"{len(level.items)} item{'s' * (len(level.items) != 1)}"
    costs.append((factor, items, ("items",)))
    switches = f"{len(level.switches)} switch{'es' * (len(level.switches) != 1)}"
    costs.append((2 ** len(level.switches), switches, ("switches",)))
    radices = things.radices[things.static :]
    if len(radices) > 1:
        costs.append((prod(radices), f"{len(radices)} movers", ("movers",)))
    elif radices:
        costs.append((radices[0], f"the mover `{things.names[-1]}`", ("movers", 0)))
    costs = sorted((cost for cost in costs if cost[0] > 1), key=lambda cost: -cost[0])
    width, height = level.size
    told = ", ".join(f"{what} ({_times(factor)})" for factor, what, _ in costs[:3])
    message = (
        f"the level has more than {MAX_STATES:,} states: {width * height:,} cells, "
        f"times what things can be; most of it from {told}"
    )
    help_text = "use fewer of them, or a smaller level"
    return UnplayableError(
        [Issue("BR404", costs[0][2] if costs else ("size",), message, help_text)]
    )


def _times(factor: int) -> str:
    return (
        f"up to {factor:,} values" if factor < 10**9 else f"up to 10^{len(str(factor)) - 1} values"
    )


def _too_many_outcomes(what: str) -> UnplayableError:
    message = f"an action has more than {MAX_OUTCOMES} outcomes: {what}"
    help_text = "use fewer movers, or let them walk a path"
    return UnplayableError([Issue("BR405", ("movers",), message, help_text)])


class _Compiler:
    def __init__(self, level: LevelFields, layers: Layers):
        self.level, self.layers = level, layers
        self.size = layers.size
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

    def tables(self) -> Mdp:
        """Return the tables."""
        count = len(self.configurations) * self.size
        over = np.ones(count, bool)
        intended = np.repeat(np.arange(count, dtype=np.int32)[:, None], NUM_ACTIONS, axis=1)
        obstruction = np.full((count, NUM_ACTIONS), FREE, np.int8)
        parts: list[_Outcomes] = []
        for ground, members in self._groups():
            hindered, targets = obstructions(ground.moves, ground.terrain, ground.warps)
            for layer in members:
                joints, cells = self._on(layer)
                states = self.number[layer.number, joints] * self.size + cells
                over[states] = False
                obstruction[states] = hindered[cells]
                target = targets[cells]
                there = (states - cells)[:, None] + target
                intended[states] = np.where(target == self.size, count, there)
            parts += self._outcomes(ground, members)
        action_mask = (obstruction != REFUSED).astype(np.int8)
        action_mask[over, 1:] = 0
        start = np.zeros(count)
        starts = self.layers.starts
        for number, joint, cell in starts:
            start[self.number[number, joint] * self.size + cell] += 1.0 / len(starts)
        return Mdp(
            width=self.layers.grid.width,
            height=self.layers.grid.height,
            start=start,
            is_terminal=over,
            action_mask=action_mask,
            intended_next_state=intended,
            obstruction=obstruction,
            configurations=self.configurations,
            **_wide(parts, over),
        ).freeze()

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
        return np.divmod(on.nonzero()[0], self.size)

    def _outcomes(self, ground: Ground, members: list[Layer]) -> Iterator[_Outcomes]:
        """Yield the outcomes in layers that have the same ground and exits, in parts."""
        shape = len(members), self.size
        after = np.empty(shape, np.int64)
        taken = np.full(shape, np.nan)
        pairs: list[tuple[Ints, Ints, Ints]] = []
        for index, layer in enumerate(members):
            after[index] = layer.number
            for at, (values, reward) in layer.arrivals.items():
                following = self.layers.find(values)
                # What nobody arrives at is never looked up.
                after[index, at] = layer.number if following is None else following.number
                taken[index, at] = np.nan if reward is None else reward
            joints, cells = self._on(layer)
            pairs.append((np.full(cells.size, index), joints, cells))
        numbers = np.array([layer.number for layer in members])
        place, joint, cell = (np.concatenate(column) for column in zip(*pairs, strict=True))
        if not cell.size:
            return
        sizes = np.diff(ground.first[::NUM_ACTIONS])[cell]
        if self.level.movers:
            sizes = sizes * np.array([len(each) for each in self.layers.steps(members[0])])[joint]
        bounds = np.cumsum(sizes)
        cuts = np.searchsorted(bounds, np.arange(PART, int(bounds[-1]), PART)).tolist()
        is_exit = np.zeros(self.size, bool)
        is_exit[list(members[0].exits)] = True
        for begin, end in pairwise(sorted({0, *cuts, cell.size})):
            part = slice(begin, end)
            ends = self._ends(ground, joint[part], cell[part])
            where = place[part][ends.pair], ends.next_cell
            own = numbers[place[part]][ends.pair]
            arrives = ground.arrives[ends.branch]
            layer_after = np.where(arrives, after[where], own)
            item = np.where(arrives, taken[where], np.nan)
            leaves = self.is_open[layer_after] & is_exit[ends.next_cell]
            configuration = self.number[own, joint[part][ends.pair]]
            state = configuration * self.size + cell[part][ends.pair]
            yield _merged(
                state * NUM_ACTIONS + ends.action,
                ends.probability,
                self.number[layer_after, ends.joint] * self.size + ends.next_cell,
                self._rewards(ground, ends, item, leaves),
                leaves | ground.terrain.ends[ends.next_cell] | (ends.hit & self.level.hit.ends),
            )

    def _ends(self, ground: Ground, joint: Ints, cell: Ints) -> _Ends:
        """Return the ends of steps from some pairs of joint state and cell."""
        first = ground.first
        rows = (cell[:, None] * NUM_ACTIONS + np.arange(NUM_ACTIONS)).ravel()
        row, branch = _expanded(first[rows], first[rows + 1])
        pair, action = np.divmod(row, NUM_ACTIONS)
        probability = ground.branches.probability[branch]
        next_cell = ground.next_cell[branch]
        if not self.level.movers:
            nobody = np.zeros(pair.size, bool)
            return _Ends(pair, action, branch, probability, next_cell, joint[pair], nobody)
        begin, following, chance = self.layers.crowd.steps(ground.grid)
        before = joint[pair]
        each, step = _expanded(begin[before], begin[before + 1])
        pair, action, branch, before = pair[each], action[each], branch[each], before[each]
        probability, next_cell = probability[each] * chance[step], next_cell[each]
        after = following[step]
        cells, here = self.layers.crowd.cells, cell[pair]
        hit = np.zeros(pair.size, bool)
        for mover in range(cells.shape[1]):
            was, now = cells[before, mover], cells[after, mover]
            swapped = (now == here) & (was == next_cell) & (here != next_cell)
            hit |= (now == next_cell) | swapped
        return _Ends(pair, action, branch, probability, next_cell, after, hit)

    def _rewards(self, ground: Ground, ends: _Ends, item: Floats, leaves: Flags) -> Floats:
        """Return the rewards: of each end the first that applies."""
        rewards = self.level.rewards
        warp = ground.warp[ends.branch]
        reward = ground.plain[ends.branch]
        reward = np.where(np.isnan(item), reward, item)
        reward = np.where(leaves, rewards.exit, reward)
        reward = np.where(np.isnan(warp), reward, warp)
        reward = np.where(ends.hit, self.level.hit.reward, reward)
        return reward + np.where(ground.branches.bounced[ends.branch], rewards.bounce, 0.0)


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


@dataclass(frozen=True, slots=True)
class _Outcomes:
    """Distinct outcomes, sorted by row, next state, reward and whether they end the episode."""

    row: Ints
    probability: Floats
    next_state: Ints
    reward: Floats
    terminal: Flags


def _expanded(first: Ints, last: Ints) -> tuple[Ints, Ints]:
    """Return all numbers of some ranges, and before them, of which range each is."""
    count = last - first
    which = np.repeat(np.arange(count.size), count)
    begin = np.cumsum(count) - count
    return which, np.arange(which.size) + (first - begin)[which]


def _merged(
    row: Ints, probability: Floats, next_state: Ints, reward: Floats, terminal: Flags
) -> _Outcomes:
    """Return the outcomes sorted, those that are alike as one."""
    order = np.lexsort((terminal, reward, next_state, row))
    row, next_state, reward, terminal = (
        row[order],
        next_state[order],
        reward[order],
        terminal[order],
    )
    is_new = np.ones(row.size, bool)
    is_new[1:] = (
        (row[1:] != row[:-1])
        | (next_state[1:] != next_state[:-1])
        | (reward[1:] != reward[:-1])
        | (terminal[1:] != terminal[:-1])
    )
    first = is_new.nonzero()[0]
    total = np.add.reduceat(probability[order], first)
    return _Outcomes(row[first], total, next_state[first], reward[first], terminal[first])


def _wide(parts: list[_Outcomes], over: Flags) -> dict[str, Any]:
    """Return the tables with the outcomes in their rows; where it is over, states lead back."""
    slots, width = [], 1
    for part in parts:
        begins = np.ones(part.row.size, bool)
        begins[1:] = part.row[1:] != part.row[:-1]
        first = begins.nonzero()[0]
        length = np.diff(np.append(first, part.row.size))
        slots.append(np.arange(part.row.size) - np.repeat(first, length))
        width = max(width, int(length.max()))
    if width > MAX_OUTCOMES:
        raise _too_many_outcomes("skids and movers together")
    states = over.size
    tables: dict[str, NDArray[Any]] = {
        "probability": np.zeros((states * NUM_ACTIONS, width)),
        "next_state": np.zeros((states * NUM_ACTIONS, width), np.int32),
        "reward": np.zeros((states * NUM_ACTIONS, width)),
        "terminal": np.zeros((states * NUM_ACTIONS, width), bool),
    }
    for part, slot in zip(parts, slots, strict=True):
        for name, table in tables.items():
            table[part.row, slot] = getattr(part, name)
    shaped = {name: table.reshape(states, NUM_ACTIONS, width) for name, table in tables.items()}
    ended = over.nonzero()[0]
    shaped["probability"][ended, :, 0] = 1.0
    shaped["next_state"][ended, :, 0] = ended[:, None]
    shaped["terminal"][ended, :, 0] = True
    return shaped
