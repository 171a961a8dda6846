"""The tables of a level with several robots: a search over their joint states.

Each robot has its own ground: what its moves come to if it were alone, with its start and its
exits. A step of all takes a branch of each; then meetings are settled, things change, and movers
move. A joint state is a configuration, which tells where all robots but the first are, and the
cell of the first.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action
from babyrobot_levels.mdp.compiler.assembly import assembled
from babyrobot_levels.mdp.compiler.layers import Ground, TooManyStates, Ways, build_layer_ground
from babyrobot_levels.mdp.compiler.meetings import hindered, meetings
from babyrobot_levels.mdp.compiler.movers import Crowd
from babyrobot_levels.mdp.compiler.outcomes import RANKS, Pay, draw, exit_reward
from babyrobot_levels.mdp.compiler.terrain import obstructions
from babyrobot_levels.mdp.configurations import MAX_STATES, MAX_WIDE_STATES, Things, Values
from babyrobot_levels.mdp.graph import differs, expanded
from babyrobot_levels.mdp.grid import Grid, grid_with_doors
from babyrobot_levels.mdp.tables import FREE, GLASS, REFUSED, Flags, Floats, Ints, Mdp
from babyrobot_levels.text import budget
from babyrobot_levels.text.diagnostics import Issue, Key
from babyrobot_levels.text.errors import UnplayableError

PART = 1 << 17
"""How many branches, about, are expanded at a time."""

BRANCH = 100
"""The steps of work to expand one."""


@dataclass(frozen=True, eq=False)
class _Scene:
    """What does not depend on where robots and movers are, while some doors are closed.

    Attributes:
        grounds: what the moves of each robot come to.
        is_exit: whether each cell is an exit of each robot, `[robots, cells]`.
        ways: where a step takes the movers; see `Crowd.steps`.
    """

    grounds: list[Ground]
    is_exit: Flags
    ways: Ways

    @cached_property
    def obstructions(self) -> list[tuple[NDArray[np.int8], NDArray[np.int32]]]:
        """What hinders each action of each robot, and where it leads without chance."""
        return [obstructions(each.air, each.terrain, each.warps) for each in self.grounds]

    @cached_property
    def most_branches(self) -> int:
        """How many branches an action of all robots has at most."""
        moves = prod(int(np.diff(ground.first).max(initial=1)) for ground in self.grounds)
        return moves * int(np.diff(self.ways[0]).max(initial=1))


@dataclass(frozen=True, eq=False)
class _Part:
    """What a step from some joint states comes to; numbers are those of `Robots.keys`.

    `obstruction` and `intended` (the cell of the first robot) are over states and actions, the
    other arrays over the outcomes; `shares` is `[outcomes, robots]`.
    """

    states: Ints
    obstruction: NDArray[np.int8]
    intended: Ints
    row: Ints
    probability: Floats
    following: Ints
    shares: Floats
    terminal: Flags


@dataclass(slots=True)
class _Ends:
    """Ends of steps of all robots: arrays over the ends, and `[robots, ends]`.

    Attributes:
        pair: the number of the state among those of the part.
        action: the joint action.
        probability: how likely it is.
        here: the cell of each robot before the step.
        there: its cell after it.
        arrives: whether it arrives there.
        away: whether it had arrived at its exit before, and so takes no part.
        met: whether it meets another robot, or is hindered by one.
        pay: what the step pays each robot.
        added: what comes in addition.
        values: the values of all things but the movers, `[ends, things]`.
        joint: the joint state of the movers.
        hit: whether a mover hits the robot.
    """

    pair: Ints
    action: Ints
    probability: Floats
    here: Ints
    there: Ints
    arrives: Flags
    away: Flags
    met: Flags
    pay: list[Pay]
    added: Floats
    values: NDArray[np.int16]
    joint: Ints
    hit: Flags


class Robots:
    """All joint states that episodes can come to, in a level with several robots.

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
        self.count = len(level.robots)
        self.actions = NUM_ACTIONS**self.count
        self._most = int(min(MAX_STATES, budget.entries()))
        draws = prod(len(thing.begins) for thing in things)
        if draws * self.size > self._most:
            raise TooManyStates
        try:
            self.crowd = Crowd(level, grid, self._most // self.size)
        except OverflowError:
            raise TooManyStates from None
        radices = (*things.radices[: things.static], len(self.crowd), self.size)
        if prod(radices) >= 1 << 62:
            raise TooManyStates
        self._radices = np.array(radices, np.int64)
        strides = [prod(radices[n + 1 :]) for n in range(len(radices))]
        self._strides = np.array(strides, np.int64)
        self._columns = things.of_kind("robot")
        self._targets = things.of_kind("target")
        self._target_cells = [
            -1 if (cell := thing.cells[0]) is None else self._number_of(cell)
            for thing in things
            if thing.kind == "target"
        ]
        self._needs = [things.needed[name] for name in level.exit_keys]
        self._changes = [(column, thing) for column, thing in enumerate(things) if thing.after]
        self._scenes: dict[tuple[tuple[bool, ...], int], _Scene] = {}
        self._has_exit = np.array([bool(level.exits_of(robot)) for robot in level.robots])
        self.parts: list[_Part] = []
        self.weights: list[int] = []
        self.starts = self._begin()
        self.keys = self._search()

    def _number_of(self, cell: Cell) -> int:
        return cell[1] * self.grid.width + cell[0]

    # -- joint states ----------------------------------------------------------------------

    def _encoded(self, values: NDArray[Any], joint: Ints, cell: Ints) -> Ints:
        """Return the numbers of joint states: those of things, then movers, then the first cell."""
        static = values.astype(np.int64) @ self._strides[:-2]
        numbers: Ints = static + joint * self._strides[-2] + cell
        return numbers

    def _decoded(self, states: Ints) -> tuple[NDArray[np.int16], Ints, Ints]:
        """Return the values of things but movers, the joint state of movers, and the first cell."""
        columns = states[:, None] // self._strides % self._radices
        return columns[:, :-2].astype(np.int16), columns[:, -2], columns[:, -1]

    def _begin(self) -> Ints:
        """Return the states in which episodes begin, and note their weights."""
        first = self._number_of(self.level.starts[0])
        rows, joints = [], []
        for drawn in self.things.draws():
            values = [*drawn]
            for robot, start in self.level.team_starts:
                for column, thing in self._changes:
                    may = thing.at_start and self._may_take(thing.entry, robot.name)
                    if may and thing.cells[values[column]] == start:
                        values[column] = thing.after[values[column]]
            rows.append(values[: self.things.static])
            joints.append(self.crowd.joint(values[self.things.static :]))
            self.weights.append(self.things.weight_of(drawn))
        cells = np.full(len(rows), first)
        return self._encoded(np.array(rows), np.array(joints), cells)

    @staticmethod
    def _may_take(entry: Any, robot: str) -> bool:
        return getattr(entry, "robot", None) in (None, robot)

    def _scene(self, values: Values) -> _Scene:
        """Return what does not depend on where all are, by the values of some state."""
        drawn = values[0] if self.level.exit_one_of is not None else 0
        closed = self.things.closed(self.things.met(values)) if self.level.doors else ()
        if (closed, drawn) not in self._scenes:
            self._scenes[closed, drawn] = self._build_scene(closed, values)
        return self._scenes[closed, drawn]

    def _build_scene(self, closed: tuple[bool, ...], values: Values) -> _Scene:
        level, grounds = self.level, []
        is_exit = np.zeros((self.count, self.size), bool)
        for number, (robot, start) in enumerate(level.team_starts):
            exits = self.things.common_exits(values) if robot.exit is None else (robot.exit,)
            alone = level.model_copy(
                update={"robots": (), "start": start, "exit": exits or "none", "exit_one_of": None}
            )
            grounds.append(build_layer_ground(alone, self.grid, closed, exits))
            is_exit[number, [self._number_of(cell) for cell in exits]] = True
        return _Scene(grounds, is_exit, self.crowd.steps(grid_with_doors(level, self.grid, closed)))

    # -- search ----------------------------------------------------------------------------

    def _search(self) -> Ints:
        """Take all steps, part by part; return the numbers of all states, in rising order."""
        known = np.unique(self.starts)
        waiting, ended, outcomes = known, known[:0], 0
        most = NUM_ACTIONS * min(MAX_WIDE_STATES, budget.entries())
        while waiting.size:
            found = []
            for scene, states in self._groups(waiting):
                size = max(1, PART // (self.actions * scene.most_branches))
                for at in range(0, states.size, size):
                    part = self._step(scene, states[at : at + size])
                    self.parts.append(part)
                    outcomes += part.row.size
                    if outcomes > most:
                        raise TooManyStates
                    found.append(np.unique(part.following[~part.terminal]))
                    ended = np.union1d(ended, part.following[part.terminal])
            waiting = np.setdiff1d(np.concatenate(found), known)
            known = np.union1d(known, waiting)
            # The tables have a row for each cell of each configuration, and each joint action.
            configurations = np.unique(known // self.size).size
            if known.size > self._most or configurations * self.size * self.actions > most:
                raise TooManyStates
        return np.union1d(known, ended)

    def _groups(self, states: Ints) -> Iterator[tuple[_Scene, Ints]]:
        """Yield the states with the same doors closed and exits drawn together."""
        values, _, _ = self._decoded(states)
        first = self._columns.start
        alike, which = np.unique(values[:, :first], axis=0, return_inverse=True)
        scenes: dict[int, tuple[_Scene, list[int]]] = {}
        for number, row in enumerate(alike.tolist()):
            scene = self._scene(row)
            scenes.setdefault(id(scene), (scene, []))[1].append(number)
        for scene, numbers in scenes.values():
            yield scene, states[np.isin(which.ravel(), numbers)]

    def _step(self, scene: _Scene, states: Ints) -> _Part:
        """Take all steps of all robots from some states."""
        values, joint, first_cell = self._decoded(states)
        robots = values[:, self._columns].astype(np.int64).T
        away = np.stack([robots[0] == 1, *(row >= self.size for row in robots[1:])])
        cell = np.stack([first_cell, *(row % self.size for row in robots[1:])])
        ends = self._moved(scene, cell, away, values, joint)
        self._settle_meetings(scene, ends)
        self._change_things(ends)
        self._move_movers(scene, ends)
        leaves, over = self._arrivals(scene, ends)
        which, chance, shares = self._shares(scene, ends, leaves)
        gone = (ends.away | leaves).astype(np.int16)
        ends.values[:, self._columns.start] = gone[0]
        for number in range(1, self.count):
            column = self._columns.start + number
            ends.values[:, column] = ends.there[number] + self.size * gone[number]
        obstruction, intended = self._hindrances(scene, cell, away)
        return self._merged(
            states,
            obstruction,
            intended,
            (states[ends.pair] * self.actions + ends.action)[which],
            ends.probability[which] * chance,
            self._encoded(ends.values, ends.joint, ends.there[0])[which],
            shares,
            over[which],
        )

    def _taken(self, action: Ints) -> Ints:
        """Return the action of each robot in joint actions, `[robots, …]`."""
        powers = NUM_ACTIONS ** np.arange(self.count - 1, -1, -1)
        taken: Ints = action // powers[:, None] % NUM_ACTIONS
        return taken

    def _moved(
        self, scene: _Scene, cell: Ints, away: Flags, values: NDArray[np.int16], joint: Ints
    ) -> _Ends:
        """Return where steps take all robots, if they did not see each other."""
        count = cell.shape[1]
        pair = np.repeat(np.arange(count), self.actions)
        action = np.tile(np.arange(self.actions), count)
        taken, probability = self._taken(action), np.ones(pair.size)
        each: Ints = np.arange(pair.size)
        branches: list[Ints] = []
        for ground, at, own, gone in zip(scene.grounds, cell, taken, away, strict=True):
            row = at[pair] * NUM_ACTIONS + np.where(gone[pair], int(Action.STAY), own)
            more, branch = expanded(ground.first[row[each]], ground.first[row[each] + 1])
            each, branches = each[more], [*(known[more] for known in branches), branch]
            probability = probability[more] * ground.probability[branch]
        budget.spend(BRANCH * each.size)
        pair = pair[each]
        here, gone = cell[:, pair], away[:, pair]
        grounds = [*zip(scene.grounds, branches, strict=True)]
        there = np.stack([ground.next_cell[branch] for ground, branch in grounds])
        bounced = np.stack([ground.bounced[branch] for ground, branch in grounds]) & ~gone
        return _Ends(
            pair=pair,
            action=action[each],
            probability=probability,
            here=here,
            there=np.where(gone, here, there),
            arrives=np.stack([ground.arrives[branch] for ground, branch in grounds]) & ~gone,
            away=gone,
            met=np.zeros(here.shape, bool),
            pay=[ground.pay.of(branch) for ground, branch in grounds],
            added=np.where(bounced, self.level.rewards.bounce, 0.0),
            values=values[pair],
            joint=joint[pair],
            hit=np.zeros(here.shape, bool),
        )

    def _present(self, ends: _Ends) -> Flags:
        """Return which robots are in the level, `[robots, ends]`."""
        stays = self.level.team.arrived == "stay"
        return np.ones_like(ends.away) if stays else ~ends.away

    def _settle_meetings(self, scene: _Scene, ends: _Ends) -> None:
        """Keep those who are hindered where they are, or note who collides."""
        meet = self.level.team.meet
        if meet == "pass":
            return
        present = self._present(ends)
        if meet == "end":
            ends.met = meetings(ends.here, ends.there, present) & ~ends.away
            return
        ends.met = stays = hindered(ends.here, ends.there, present, meet == "order")
        ends.there = np.where(stays, ends.here, ends.there)
        ends.arrives &= ~stays
        ends.added[stays] = 0.0
        for ground, pay, at, kept in zip(scene.grounds, ends.pay, ends.here, stays, strict=True):
            pay.reward[kept] = ground.terrain.reward[at[kept]]
            pay.rank[kept] = RANKS["step"]

    def _change_things(self, ends: _Ends) -> None:
        """Let robots take items and flip switches, one after the other, and cover targets."""
        before = ends.values[:, self._targets].sum(axis=1)
        for number, robot in enumerate(self.level.robots):
            item = np.full(ends.pair.size, np.nan)
            for column, thing in self._changes:
                if not self._may_take(thing.entry, robot.name):
                    continue
                value = ends.values[:, column]
                cells = [-1 if cell is None else self._number_of(cell) for cell in thing.cells]
                after = np.array(thing.after, np.int16)[value]
                here = np.array(cells)[value] == ends.there[number]
                flips = ends.arrives[number] & here & (after != value)
                ends.values[flips, column] = after[flips]
                if thing.reward is not None:
                    item[flips] = thing.reward
            ends.pay[number].add({"item": (~np.isnan(item), item)})
        present = self._present(ends)
        for number, target in enumerate(self._target_cells):
            covered = (present & (ends.there == target)).any(axis=0)
            ends.values[:, self._targets.start + number] = covered
        rewards = self.level.rewards
        if rewards.covered or rewards.uncovered:
            now = ends.values[:, self._targets].sum(axis=1)
            added = np.where(now > before, rewards.covered or 0.0, 0.0)
            ends.added += added + np.where(now < before, rewards.uncovered or 0.0, 0.0)

    def _move_movers(self, scene: _Scene, ends: _Ends) -> None:
        """Let the movers move, and note whom they hit."""
        if not self.level.movers:
            return
        first, following, chance = scene.ways
        before = ends.joint
        each, step = expanded(first[before], first[before + 1])
        before = before[each]
        ends.pair, ends.action = ends.pair[each], ends.action[each]
        ends.probability = ends.probability[each] * chance[step]
        for name in ("here", "there", "arrives", "away", "met", "added"):
            setattr(ends, name, getattr(ends, name)[:, each])
        ends.pay = [pay.of(each) for pay in ends.pay]
        ends.values, ends.joint = ends.values[each], following[step]
        ends.hit = ~ends.away
        for number in range(self.count):
            ends.hit[number] &= self.crowd.crowded.hits(
                before, ends.here[number], ends.joint, ends.there[number]
            )

    def _arrivals(self, scene: _Scene, ends: _Ends) -> tuple[Flags, Flags]:
        """Return who arrives at an open exit, `[robots, ends]`, and whether the episode is over."""
        level, on_the_way = self.level, ~ends.away
        is_open = np.ones(ends.pair.size, bool)
        for column, value in self._needs:
            is_open &= ends.values[:, column] == value
        numbers = np.arange(self.count)[:, None]
        leaves = on_the_way & is_open & scene.is_exit[numbers, ends.there]
        over: Flags = np.any(on_the_way & scene.grounds[0].terrain.ends[ends.there], axis=0)
        if level.hit.ends:
            over |= ends.hit.any(axis=0)
        if level.team.meet == "end":
            over |= ends.met.any(axis=0)
        if level.ends_covered:
            over |= np.all(ends.values[:, self._targets], axis=1)
        if level.team.ends == "first":
            over |= leaves.any(axis=0)
        elif self._has_exit.any():
            over |= (ends.away | leaves)[self._has_exit].all(axis=0)
        return leaves, over

    def _shares(self, scene: _Scene, ends: _Ends, leaves: Flags) -> tuple[Ints, Floats, Floats]:
        """Draw what each robot gets: which ends, how likely, and the shares, `[draws, robots]`."""
        level = self.level
        solved: Flags = np.zeros(ends.pair.size, bool)
        if level.ends_covered:
            solved = np.all(ends.values[:, self._targets], axis=1)
        end, chances = np.arange(ends.pair.size), np.ones(ends.pair.size)
        shares = np.empty((end.size, self.count))
        for number, pay in enumerate(ends.pay):
            terrain, there, away = (
                scene.grounds[number].terrain,
                ends.there[number],
                ends.away[number],
            )
            applies: dict[str, tuple[Flags, Floats | float]] = {
                "exit": (leaves[number] | solved, exit_reward(level.rewards, terrain, there)),
                "hit": (ends.hit[number], level.hit.reward),
            }
            if level.rewards.meet is not None:
                applies["meet"] = ends.met[number], level.rewards.meet
            pay.add(applies)
            # What is away gets nothing, which is no reward of a cell.
            pay.rank[away] = 0
            which, chance, reward = draw(pay.of(end), level.rewards, terrain, there[end])
            end, chances, shares = end[which], chances[which] * chance, shares[which]
            shares[:, number] = np.where(away[end], 0.0, reward + ends.added[number, end])
        return end, chances, shares

    def _hindrances(self, scene: _Scene, cell: Ints, away: Flags) -> tuple[NDArray[np.int8], Ints]:
        """Return what hinders each joint action, and where it leads the first robot."""
        taken = self._taken(np.arange(self.actions))
        found = np.full((cell.shape[1], self.actions), FREE, np.int8)
        for (each, _), at, own in zip(scene.obstructions, cell, taken, strict=True):
            found[each[at][:, own] == GLASS] = GLASS
        for (each, _), at, gone, own in zip(scene.obstructions, cell, away, taken, strict=True):
            refused = np.where(gone[:, None], own != Action.STAY, each[at][:, own] == REFUSED)
            found[refused] = REFUSED
        leads = scene.obstructions[0][1][cell[0]][:, taken[0]]
        return found, np.where(away[0][:, None], cell[0][:, None], leads)

    @staticmethod
    def _merged(
        states: Ints,
        obstruction: NDArray[np.int8],
        intended: Ints,
        row: Ints,
        probability: Floats,
        following: Ints,
        shares: Floats,
        terminal: Flags,
    ) -> _Part:
        """Return a part with the outcomes that are alike as one."""
        order = np.lexsort((*shares.T, terminal, following, row))
        row, following, terminal = row[order], following[order], terminal[order]
        shares = shares[order]
        is_new = differs(row) | differs(following) | differs(terminal)
        for share in shares.T:
            is_new |= differs(share)
        first = np.flatnonzero(is_new)
        return _Part(
            states=states,
            obstruction=obstruction,
            intended=intended,
            row=row[first],
            probability=np.add.reduceat(probability[order], first),
            following=following[first],
            shares=shares[first],
            terminal=terminal[first],
        )

    # -- tables ----------------------------------------------------------------------------

    @cached_property
    def _numbering(self) -> tuple[NDArray[np.int16], Ints, Ints]:
        """Return the configurations, the places of `keys` without cells, and their numbers."""
        places = np.unique(self.keys // self.size)
        values, joint, _ = self._decoded(places * self.size)
        rows = np.concatenate([values, self.crowd.values[joint]], axis=1)
        order = np.lexsort(rows.T[::-1])
        number = np.empty(order.size, np.int64)
        number[order] = np.arange(order.size)
        return rows[order].astype(np.int16), places, number

    @property
    def num_states(self) -> int:
        """How many states the tables have."""
        return len(self._numbering[0]) * self.size

    def _states(self, keys: Ints) -> Ints:
        """Return the numbers that joint states have in the tables."""
        _, places, number = self._numbering
        states: Ints = number[np.searchsorted(places, keys // self.size)] * self.size
        return states + keys % self.size

    def tables(self) -> Mdp:
        """Return the tables.

        Raises:
            UnplayableError: they need more room than those of any level may.
            OverBudgetError: they need more than they may here.
        """
        count, width = self.num_states, 1
        for part in self.parts:
            width = max(width, int(np.unique(part.row, return_counts=True)[1].max(initial=1)))
        self._check_room(count, width)
        shape = count, self.actions, width
        probability, reward = np.zeros(shape), np.zeros(shape)
        next_state, terminal = np.zeros(shape, np.int32), np.zeros(shape, bool)
        shares = np.zeros((*shape, self.count))
        over = np.ones(count, bool)
        obstruction = np.full((count, self.actions), FREE, np.int8)
        intended = np.repeat(np.arange(count, dtype=np.int32)[:, None], self.actions, axis=1)
        for part in self.parts:
            states = self._states(part.states)
            over[states] = False
            obstruction[states] = part.obstruction
            there = (states - states % self.size)[:, None] + part.intended
            intended[states] = np.where(part.intended < 0, count - 1 - part.intended, there)
            state, action = np.divmod(part.row, self.actions)
            row = self._states(state) * self.actions + action
            following, total = self._states(part.following), part.shares.sum(axis=1)
            order = np.lexsort((*part.shares.T[::-1], part.terminal, total, following, row))
            row = row[order]
            begin = np.flatnonzero(differs(row))
            slot = np.arange(row.size) - np.repeat(begin, np.diff(np.append(begin, row.size)))
            place = row * width + slot
            probability.reshape(-1)[place] = part.probability[order]
            next_state.reshape(-1)[place] = following[order]
            reward.reshape(-1)[place] = total[order]
            terminal.reshape(-1)[place] = part.terminal[order]
            shares.reshape(-1, self.count)[place] = part.shares[order]
        start = np.zeros(count)
        weights = np.array(self.weights) / sum(self.weights)
        np.add.at(start, self._states(self.starts), weights)
        return assembled(
            self.grid,
            start=start,
            over=over,
            intended=intended,
            obstruction=obstruction,
            tables={
                "probability": probability,
                "next_state": next_state,
                "reward": reward,
                "terminal": terminal,
            },
            configurations=self._numbering[0],
            drawn=self._scene(self._decoded(self.starts[:1])[0][0]).grounds[0].warps.drawn,
            shares=shares,
        )

    def _check_room(self, states: int, width: int) -> None:
        """Check that the tables do not need too much room."""
        rows = states * self.actions // NUM_ACTIONS
        if rows * width <= MAX_WIDE_STATES:
            budget.check_tables(states, width, self.actions)
            return
        message = (
            f"the tables are too large: {states:,} joint states, {self.actions} joint actions, "
            f"and {width} outcomes of one; "
            f"together at most {NUM_ACTIONS * MAX_WIDE_STATES:,} are allowed"
        )
        help_text = "use fewer robots, a smaller level, or less that happens by chance"
        raise UnplayableError([Issue("BR404", Key(("robots",)), message, help_text)])
