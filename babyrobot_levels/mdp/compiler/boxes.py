"""The tables of a level with boxes: a search over configurations and cells, many pairs at a time.

What a move comes to depends on the boxes around the robot. So each pair of configuration and cell
is a state of its own in `Moves`, and the branches of other levels follow from these.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.things import MAX_BOXED_STATES
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.compiler.assembly import assembled
from babyrobot_levels.mdp.compiler.layers import TooManyStates, distinct
from babyrobot_levels.mdp.compiler.movers import Crowd
from babyrobot_levels.mdp.compiler.outcomes import (
    BOUNCED,
    PUSHED,
    WAY,
    Arrivals,
    Branches,
    Room,
    chance_branches,
    draw,
    ended,
    exit_reward,
    merged,
    plain_branches,
)
from babyrobot_levels.mdp.compiler.terrain import build_warps, obstructions
from babyrobot_levels.mdp.compiler.yards import Yard, build_yard, stands_on
from babyrobot_levels.mdp.configurations import Things, check_room, most_columns
from babyrobot_levels.mdp.graph import expanded
from babyrobot_levels.mdp.grid import Grid, grid_with_doors
from babyrobot_levels.mdp.tables import FREE, Flags, Floats, Ints, Mdp
from babyrobot_levels.text import budget

BATCH = 1 << 14
"""From so many pairs at most, steps are taken together."""

PAIR = 250
"""The steps of work to take the steps from a pair."""

REACHED, ON = 1, 2
"""What is noted of a pair: an episode can be there; and it can go on from there."""


@dataclass(frozen=True, eq=False)
class _Change:
    """What arrivals change of a thing: for each value its cell, or -1, and the value after it."""

    column: int
    cell: Ints
    after: Ints
    reward: float


@dataclass(frozen=True, eq=False)
class _Part:
    """What a step from some pairs comes to.

    The first arrays are over the pairs, the others over the ends of steps. A pair is numbered
    `(layer * joint states + joint state) * cells + cell`.
    """

    pairs: Ints
    obstruction: NDArray[np.int8]
    intended: NDArray[np.int32]
    row: Ints
    probability: Floats
    following: Ints
    reward: Floats
    terminal: Flags


class Boxes:
    """All pairs of configuration and cell that episodes can come to, in a level with boxes.

    A layer is a choice of the values of all things but the movers.

    Args:
        level: the level, whose doors and paths were checked.
        grid: its grid, with all doors open.
        things: its things.

    Raises:
        TooManyStates: there are more states than the bound.
    """

    def __init__(self, level: LevelFields, grid: Grid, things: Things):
        self.level, self.grid, self.things = level, grid, things
        self.size = grid.width * grid.height
        self._most = int(min(MAX_BOXED_STATES, budget.entries())) // self.size
        draws = prod(len(thing.begins) for thing in things)
        if draws > self._most:
            raise TooManyStates
        try:
            self.crowd = Crowd(level, grid, self._most)
        except OverflowError:
            raise TooManyStates from None
        self.joints = len(self.crowd)
        self.delta = np.array([-grid.width, 1, grid.width, -1], np.int32)
        self._boxes, self._targets = things.of_kind("box"), things.of_kind("target")
        cells = (thing.cells[0] for thing in things if thing.kind == "target")
        self._target_cells = [-1 if cell is None else self._number_of(cell) for cell in cells]
        self._needs = [things.needed[name] for name in level.exit_keys]
        self._changes = [*self._changing()]
        self._yards: dict[tuple[tuple[bool, ...], int], int] = {}
        self.yards: list[Yard] = []
        radices = things.radices[: things.static]
        # The values of a layer are digits of its key, which may be longer than a word.
        kind: Any = np.int64 if prod(radices) < 1 << 62 else object
        self._strides = np.array([prod(radices[n + 1 :]) for n in range(len(radices))], kind)
        self._keys, self._numbers = np.zeros(0, kind), np.zeros(0, np.int64)
        self.count = self.occurring = 0
        self.values = np.zeros((0, things.static), np.int16)
        self.yard, self.is_open, self.is_solved = (np.zeros(0, kind) for kind in (int, bool, bool))
        self.found = np.zeros((0, self.size), np.uint8)
        self.parts: list[_Part] = []
        self.weights: list[int] = []
        self.starts = self._begin()
        self._search()

    def _number_of(self, cell: tuple[int, int]) -> int:
        return cell[1] * self.grid.width + cell[0]

    def _changing(self) -> Iterator[_Change]:
        for column, thing in enumerate(self.things):
            if thing.after:
                cells = [-1 if cell is None else self._number_of(cell) for cell in thing.cells]
                reward = np.nan if thing.reward is None else thing.reward
                yield _Change(column, np.array(cells), np.array(thing.after), reward)

    # -- layers ----------------------------------------------------------------------------

    def layers(self, rows: NDArray[np.int16]) -> Ints:
        """Return the numbers of the layers with some values, `[rows, things]`."""
        keys, first, which = np.unique(rows @ self._strides, return_index=True, return_inverse=True)
        place = np.searchsorted(self._keys, keys)
        is_new = np.ones(keys.size, bool)
        there = place < self._keys.size
        is_new[there] = self._keys[place[there]] != keys[there]
        new, before = place[is_new], self.count
        if new.size:
            self._add(rows[first[is_new]])
            self._keys = np.insert(self._keys, new, keys[is_new])
            self._numbers = np.insert(self._numbers, new, np.arange(before, self.count))
            # Each is behind the new ones before it.
            place += np.cumsum(is_new) - is_new
        found: Ints = self._numbers[place][which.ravel()]
        return found

    def _add(self, rows: NDArray[np.int16]) -> None:
        """Add layers with new values."""
        count = self.count + len(rows)
        if count * self.joints > 4 * self._most:
            raise TooManyStates
        if count > len(self.values):
            room = 2 * count
            for name in ("values", "yard", "is_open", "is_solved"):
                old = getattr(self, name)
                grown = np.zeros((room, *old.shape[1:]), old.dtype)
                grown[: len(old)] = old
                setattr(self, name, grown)
            found = np.zeros((room * self.joints, self.size), np.uint8)
            found[: len(self.found)] = self.found
            self.found = found
        new = slice(self.count, count)
        self.values[new] = rows
        is_open = np.ones(len(rows), bool)
        for column, value in self._needs:
            is_open &= rows[:, column] == value
        self.is_open[new] = is_open
        if self.level.ends_covered:
            self.is_solved[new] = rows[:, self._targets].all(axis=1)
        self.yard[new] = self._yards_of(rows)
        self.count = count

    def _yards_of(self, rows: NDArray[np.int16]) -> Ints | int:
        """Return the number of the yard of each of some layers."""
        if not self.level.doors and self.level.exit_one_of is None:
            return self._yard((), 0)
        drawn = rows[:, 0] if self.level.exit_one_of is not None else np.zeros(len(rows), int)
        numbers = [
            self._yard(self.things.closed(self.things.met(values)), exit_)
            for values, exit_ in zip(rows.tolist(), drawn.tolist(), strict=True)
        ]
        return np.array(numbers)

    def _yard(self, closed: tuple[bool, ...], drawn: int) -> int:
        """Return the number of the yard with some doors closed, and an exit drawn."""
        if (closed, drawn) not in self._yards:
            self._yards[closed, drawn] = len(self.yards)
            self.yards.append(self._build_yard(closed, drawn))
        return self._yards[closed, drawn]

    def _build_yard(self, closed: tuple[bool, ...], drawn: int) -> Yard:
        level, grid = self.level, grid_with_doors(self.level, self.grid, closed)
        exits = level.exits if level.exit_one_of is None else (level.exit_one_of[drawn],)
        return build_yard(level, grid, exits, self.crowd.steps(grid))

    # -- search ----------------------------------------------------------------------------

    def _begin(self) -> Ints:
        """Return the pairs in which episodes begin, and note their weights."""
        rows, joints, cells = [], [], []
        for values, cell, weight in self.things.beginnings():
            rows.append(values[: self.things.static])
            joints.append(self.crowd.joint(values[self.things.static :]))
            cells.append(self._number_of(cell))
            self.weights.append(weight)
        layers = self.layers(np.array(rows, np.int16).reshape(len(rows), -1))
        pairs: Ints = (layers * self.joints + np.array(joints)) * self.size + np.array(cells)
        return pairs

    def _search(self) -> None:
        waiting = self._note(self.starts, ON)
        while waiting.size:
            batch, waiting = waiting[-BATCH:], waiting[:-BATCH]
            budget.spend(PAIR * batch.size)
            yards = self.yard[batch // (self.joints * self.size)]
            for number in np.unique(yards).tolist():
                part = self._step(self.yards[number], batch[yards == number])
                self.parts.append(part)
                self._note(part.following[part.terminal], REACHED)
                waiting = np.concatenate([waiting, self._note(part.following[~part.terminal], ON)])

    def _note(self, pairs: Ints, what: int) -> Ints:
        """Note that an episode can come to pairs; return those that were not known as such."""
        found = self.found.reshape(-1)
        new = distinct(pairs[found[pairs] < what])
        occupied = distinct(new // self.size)
        self.occurring += int((~self.found[occupied].any(axis=1)).sum())
        if self.occurring > self._most:
            raise TooManyStates
        found[new] = what
        return new

    def _step(self, yard: Yard, pairs: Ints) -> _Part:
        """Take all steps from some pairs."""
        place, cell = np.divmod(pairs, self.size)
        layer, joint = np.divmod(place, self.joints)
        cell = cell.astype(np.int32)
        boxes = self.values[layer, self._boxes].astype(np.int32, order="F")
        air = yard.air(cell, boxes)
        terrain, warps = yard.left_from(cell)
        arrivals = Arrivals(self.level.rewards, terrain, warps, cell, NUM_ACTIONS)
        every = slice(0, cell.size)
        rows, chances = chance_branches(air, terrain, warps, every)
        branches = plain_branches(air.given, terrain, warps, every)
        if chances.row.size:
            branches = branches.select(~rows.ravel()).joined(chances)
        branches, next_cell = ended(branches, arrivals)
        pair = branches.row // NUM_ACTIONS
        arrives = arrivals.is_sent(branches) | (next_cell != cell[pair])
        after, item = self._after(layer[pair], cell[pair], branches, next_cell, arrives)
        pay = arrivals.pay(branches, next_cell)
        added = self._added(branches, layer[pair], after)
        row = pairs[pair] * NUM_ACTIONS + branches.row % NUM_ACTIONS
        probability = branches.probability
        leaves = self.is_open[after] & yard.is_exit[next_cell]
        over, solved = leaves | yard.terrain.ends[next_cell], self.is_solved[after]
        next_joint, hit = np.zeros(pair.size, np.int64), np.zeros(pair.size, bool)
        if self.level.movers:
            first, following, chance = yard.ways
            before = joint[pair]
            each, step = expanded(first[before], first[before + 1])
            row, probability = row[each], probability[each] * chance[step]
            next_cell, after, next_joint = next_cell[each], after[each], following[step]
            hit = self.crowd.crowded.hits(before[each], cell[pair[each]], next_joint, next_cell)
            pay, added, item = pay.of(each), added[each], item[each]
            leaves, over, solved = leaves[each], over[each], solved[each]
        pay.add(
            {
                "item": (~np.isnan(item), item),
                "exit": (leaves | solved, exit_reward(self.level.rewards, terrain, next_cell)),
                "hit": (hit, self.level.hit.reward),
            }
        )
        which, share, reward = draw(pay, self.level.rewards, terrain, next_cell)
        following = (after * self.joints + next_joint) * self.size + next_cell
        obstruction, intended = obstructions(air, terrain, warps)
        return _Part(
            pairs=pairs,
            obstruction=obstruction,
            intended=intended,
            row=row[which],
            probability=probability[which] * share,
            following=following[which],
            reward=reward + added[which],
            terminal=(over | solved | (hit & self.level.hit.ends))[which],
        )

    def _after(
        self, layer: Ints, cell: Ints, branches: Branches, next_cell: Ints, arrives: Flags
    ) -> tuple[Ints, Floats]:
        """Return the layers after branches, and the rewards of items that are taken, else nan."""
        pushed = (branches.happened & PUSHED) != 0
        changed, item = pushed.copy(), np.full(pushed.size, np.nan)
        flips: list[tuple[_Change, Flags]] = []
        for change in self._changes:
            value = self.values[layer, change.column]
            flips.append(
                (
                    change,
                    arrives & (change.cell[value] == next_cell) & (change.after[value] != value),
                )
            )
            changed |= flips[-1][1]
            item[flips[-1][1]] = change.reward
        which = np.flatnonzero(changed)
        after = layer.copy()
        if not which.size:
            return after, item
        rows = self.values[layer[which]]
        for change, flipped in flips:
            there = flipped[which]
            rows[there, change.column] = change.after[rows[there, change.column]]
        delta = self.delta[branches.happened[which] // WAY]
        ahead = np.where(pushed[which], cell[which] + delta, -1)[:, None]
        boxes = rows[:, self._boxes]
        boxes = np.sort(np.where(boxes == ahead, ahead + delta[:, None], boxes), axis=1)
        rows[:, self._boxes] = boxes
        for number, target in enumerate(self._target_cells):
            rows[:, self._targets.start + number] = stands_on(boxes, target)
        after[which] = self.layers(rows)
        return after, item

    def _added(self, branches: Branches, before: Ints, after: Ints) -> Floats:
        """Return the rewards of branches that come in addition."""
        rewards = self.level.rewards
        added = np.where((branches.happened & BOUNCED) != 0, rewards.bounce, 0.0)
        if rewards.push:
            added += np.where((branches.happened & PUSHED) != 0, rewards.push, 0.0)
        if rewards.covered or rewards.uncovered:
            changed = np.flatnonzero(before != after)
            was, now = (
                self.values[layers[changed], self._targets].sum(axis=1)
                for layers in (before, after)
            )
            added[changed] += np.where(now > was, rewards.covered or 0.0, 0.0)
            added[changed] += np.where(now < was, rewards.uncovered or 0.0, 0.0)
        return added

    # -- tables ----------------------------------------------------------------------------

    @property
    def num_states(self) -> int:
        """How many states the tables have."""
        return self.occurring * self.size

    def tables(self) -> Mdp:
        """Return the tables.

        Raises:
            UnplayableError: they need more room than those of any level may.
            OverBudgetError: they need more than they may here.
        """
        count = self.num_states
        check_room(self.level, count, 1)
        occurring = np.flatnonzero(self.found[: self.count * self.joints].any(axis=1))
        layer, joint = np.divmod(occurring, self.joints)
        values = np.concatenate([self.values[layer], self.crowd.values[joint]], axis=1)
        order = np.lexsort(values.T[::-1])
        number = np.full(self.count * self.joints, -1, np.int64)
        number[occurring[order]] = np.arange(order.size)

        def state(pairs: Ints) -> Ints:
            place, cell = np.divmod(pairs, self.size)
            found: Ints = number[place] * self.size + cell
            return found

        over = np.ones(count, bool)
        intended = np.repeat(np.arange(count, dtype=np.int32)[:, None], NUM_ACTIONS, axis=1)
        obstruction = np.full((count, NUM_ACTIONS), FREE, np.int8)
        room = Room(count, NUM_ACTIONS, most_columns(self.level, count))
        for part in self.parts:
            states = state(part.pairs)
            over[states] = False
            obstruction[states] = part.obstruction
            there = (states - part.pairs % self.size)[:, None] + part.intended
            intended[states] = np.where(part.intended < 0, count - 1 - part.intended, there)
            pair, action = np.divmod(part.row, NUM_ACTIONS)
            outcomes = merged(
                state(pair) * NUM_ACTIONS + action,
                part.probability,
                state(part.following),
                part.reward,
                part.terminal,
            )
            check_room(self.level, count, outcomes.width)
            room.put(outcomes)
        start = np.zeros(count)
        np.add.at(start, state(self.starts), np.array(self.weights) / sum(self.weights))
        return assembled(
            self.grid,
            start=start,
            over=over,
            intended=intended,
            obstruction=obstruction,
            tables=room.tables(),
            configurations=values[order].astype(np.int16),
            drawn=build_warps(self.level, self.grid).drawn,
        )
