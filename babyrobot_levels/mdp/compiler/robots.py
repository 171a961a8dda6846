"""Several robots: what a step of all of them comes to, from any of their joint states.

Each robot has its own ground: what its moves come to if it were alone, with its start and its
exits. A step of all takes a branch of each; then meetings are settled, things change, and movers
move. A joint state is a configuration, which tells where all robots but the first are, and the
cell of the first. Tables are made of these steps in `joint`; where they would be too large,
environments take them one by one.
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
from babyrobot_levels.mdp.compiler.layers import Ground, TooManyStates, Ways, build_layer_ground
from babyrobot_levels.mdp.compiler.meetings import hindered, meetings
from babyrobot_levels.mdp.compiler.movers import Crowd
from babyrobot_levels.mdp.compiler.outcomes import RANKS, Pay, draw, exit_reward
from babyrobot_levels.mdp.compiler.terrain import obstructions
from babyrobot_levels.mdp.configurations import MAX_STATES, Things, Values
from babyrobot_levels.mdp.graph import differs, expanded
from babyrobot_levels.mdp.grid import Grid, grid_with_doors
from babyrobot_levels.mdp.tables import (
    FREE,
    GLASS,
    REFUSED,
    Flags,
    Floats,
    Ints,
    Numbering,
    ToldOutcome,
    events,
)
from babyrobot_levels.text import budget
from babyrobot_levels.text.diagnostics import Issue, Key
from babyrobot_levels.text.errors import UnplayableError

PART = 1 << 17
"""How many branches, about, are expanded at a time."""

MAX_CELLS = 16_383
"""The most cells of a level with several robots: values of things are small numbers."""

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
class Part:
    """What a step from some joint states comes to; these are numbered as `Robots` does.

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

    @property
    def total(self) -> Floats:
        """What all robots get together, of each outcome."""
        total: Floats = self.shares.sum(axis=1)
        return total

    def order(self, row: Ints, following: Ints) -> Ints:
        """Return the order of outcomes in tables, by what numbers of rows and states are there."""
        return np.lexsort((*self.shares.T[::-1], self.terminal, self.total, following, row))


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


class Configurations:
    """The values of things in all configurations, which are computed when they are asked for."""

    def __init__(self, robots: Robots) -> None:
        self._robots = robots

    def __getitem__(self, numbers: Any) -> NDArray[np.int16]:
        """Return the values in configurations, int16 `[…, things]`."""
        cells = np.asarray(numbers, np.int64) * self._robots.cells
        values, joint, _ = self._robots.decoded(cells.ravel())
        rows = np.hstack([values, self._robots.crowd.values[joint]]).astype(np.int16)
        return rows.reshape(*cells.shape, -1)


class Robots(Numbering):
    """Several robots, which step from any joint state; states are numbered by what they are.

    Args:
        level: the level, whose doors and paths were checked.
        grid: its grid, with all doors open.
        things: its things.

    Attributes:
        begins: the states in which episodes begin, each as often as it is drawn by `weights`.
        drawn: sets of cells of which warps lead to one, as in `Mdp`.

    Raises:
        TooManyStates: there are more starts or places of movers than states may be, or more states
            than numbers.
        TooManyWays: movers have more ways to go than an action may have outcomes.
        UnplayableError: there are too many cells.
    """

    def __init__(self, level: LevelFields, grid: Grid, things: Things):
        self.level, self.grid, self.things = level, grid, things
        self.width, self.height = grid.width, grid.height
        most = int(min(MAX_STATES, budget.entries()))
        draws = prod(len(thing.begins) for thing in things)
        if self.cells > MAX_CELLS:
            message = f"robots have {MAX_CELLS:,} cells at most, and the level has {self.cells:,}"
            raise UnplayableError(
                [Issue("BR404", Key(("robots",)), message, "use a smaller level")]
            )
        if draws * self.cells > most:
            raise TooManyStates
        try:
            self.crowd = Crowd(level, grid, most // self.cells)
        except OverflowError:
            raise TooManyStates from None
        radices = (*things.radices[: things.static], len(self.crowd), self.cells)
        self._count = prod(radices[:-1])
        if prod(radices) >= 1 << 62:
            raise TooManyStates
        self.configurations = Configurations(self)
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
        self.weights: list[int] = []
        self.begins = self._begin()
        values, _, _ = self.decoded(self.begins[:1])
        # Sets of cells of which warps lead to one, as in `Mdp`.
        self.drawn: Ints = self._scene(values[0]).grounds[0].warps.drawn

    def _number_of(self, cell: Cell) -> int:
        return cell[1] * self.grid.width + cell[0]

    # -- joint states ----------------------------------------------------------------------

    def _encoded(self, values: NDArray[Any], joint: Ints, cell: Ints) -> Ints:
        """Return the numbers of joint states: things, then movers, then the first cell."""
        static = values.astype(np.int64) @ self._strides[:-2]
        numbers: Ints = static + joint * self._strides[-2] + cell
        return numbers

    def decoded(self, states: Ints) -> tuple[NDArray[np.int16], Ints, Ints]:
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
        is_exit = np.zeros((self.num_robots, self.cells), bool)
        for number, (robot, start) in enumerate(level.team_starts):
            exits = self.things.common_exits(values) if robot.exit is None else (robot.exit,)
            alone = level.model_copy(
                update={"robots": (), "start": start, "exit": exits or "none", "exit_one_of": None}
            )
            grounds.append(build_layer_ground(alone, self.grid, closed, exits))
            is_exit[number, [self._number_of(cell) for cell in exits]] = True
        return _Scene(grounds, is_exit, self.crowd.steps(grid_with_doors(level, self.grid, closed)))

    @property
    def num_configurations(self) -> int:
        """How many configurations have numbers, whether they occur or not."""
        return self._count

    @property
    def num_actions(self) -> int:
        """The number of joint actions."""
        return int(NUM_ACTIONS**self.num_robots)

    @property
    def num_robots(self) -> int:
        """The number of robots."""
        return len(self.level.robots)

    @property
    def starts(self) -> Ints:
        """The states in which episodes begin: with weights, each as often as it is drawn."""
        states, which = np.unique(self.begins, return_inverse=True)
        counts = np.bincount(which, self.weights).astype(np.int64)
        return np.repeat(states, counts // np.gcd.reduce(counts))

    # -- steps -----------------------------------------------------------------------------

    def steps(self, states: Ints, actions: Ints | None = None) -> Iterator[Part]:
        """Yield, in parts, what steps from some states come to.

        Args:
            states: the numbers of joint states.
            actions: the joint actions that are taken; by default, all.
        """
        taken = np.arange(self.num_actions) if actions is None else actions
        for scene, members in self._groups(states):
            size = max(1, PART // (taken.size * scene.most_branches))
            for at in range(0, members.size, size):
                yield self._step(scene, members[at : at + size], taken)

    def mask(self, state: int) -> NDArray[np.int8]:
        """Return which joint actions nothing refuses in a state, int8 `[actions]`."""
        (scene, states), *_ = self._groups(np.array([state]))
        cell, away = self.places(states)
        (found,), _ = self._hindrances(scene, cell, away, np.arange(self.num_actions))
        mask: NDArray[np.int8] = (found != REFUSED).astype(np.int8)
        return mask

    def outcomes(self, state: int, action: int) -> tuple[list[ToldOutcome], Floats]:
        """Return what a joint action can lead to, and what robots get, `[outcomes, robots]`."""
        (part,) = self.steps(np.array([state]), np.array([action]))
        order = part.order(part.row, part.following)
        before, after = np.full_like(order, state), part.following[order]
        lead = part.intended[0]
        intended = np.where(lead < 0, self.num_states - 1 - lead, lead)
        was, now = (each // self.cells % len(self.crowd) for each in (before, after))
        columns = (
            part.probability[order],
            after,
            part.total[order],
            part.terminal[order],
            events(self, intended, part.obstruction[0], after),
            self.crowd.crowded.hits(was, before % self.cells, now, after % self.cells),
        )
        told = [*zip(*(column.tolist() for column in columns), strict=True)]
        return told, part.shares[order]

    def _groups(self, states: Ints) -> Iterator[tuple[_Scene, Ints]]:
        """Yield the states with the same doors closed and exits drawn together."""
        values, _, _ = self.decoded(states)
        first = self._columns.start
        alike, which = np.unique(values[:, :first], axis=0, return_inverse=True)
        scenes: dict[int, tuple[_Scene, list[int]]] = {}
        for number, row in enumerate(alike.tolist()):
            scene = self._scene(row)
            scenes.setdefault(id(scene), (scene, []))[1].append(number)
        for scene, numbers in scenes.values():
            yield scene, states[np.isin(which.ravel(), numbers)]

    def _step(self, scene: _Scene, states: Ints, actions: Ints) -> Part:
        """Take some steps of all robots from some states."""
        values, joint, _ = self.decoded(states)
        cell, away = self.places(states)
        ends = self._moved(scene, cell, away, values, joint, actions)
        self._settle_meetings(scene, ends)
        self._change_things(ends)
        self._move_movers(scene, ends)
        leaves, over = self._arrivals(scene, ends)
        which, chance, shares = self._shares(scene, ends, leaves)
        gone = (ends.away | leaves).astype(np.int16)
        ends.values[:, self._columns.start] = gone[0]
        for number in range(1, self.num_robots):
            column = self._columns.start + number
            ends.values[:, column] = ends.there[number] + self.cells * gone[number]
        obstruction, intended = self._hindrances(scene, cell, away, actions)
        return self._merged(
            states,
            obstruction,
            intended,
            (states[ends.pair] * self.num_actions + ends.action)[which],
            ends.probability[which] * chance,
            self._encoded(ends.values, ends.joint, ends.there[0])[which],
            shares,
            over[which],
        )

    def places(self, states: Ints) -> tuple[Ints, Flags]:
        """Return the cell of each robot, and whether it has arrived, `[robots, states]`."""
        values, _, first_cell = self.decoded(states)
        robots = values[:, self._columns].astype(np.int64).T
        away = np.stack([robots[0] == 1, *(row >= self.cells for row in robots[1:])])
        return np.stack([first_cell, *(row % self.cells for row in robots[1:])]), away

    def _taken(self, action: Ints) -> Ints:
        """Return the action of each robot in joint actions, `[robots, …]`."""
        return np.moveaxis(self.robot_actions(action), -1, 0)

    def _moved(
        self,
        scene: _Scene,
        cell: Ints,
        away: Flags,
        values: NDArray[np.int16],
        joint: Ints,
        actions: Ints,
    ) -> _Ends:
        """Return where steps take all robots, if they did not see each other."""
        count = cell.shape[1]
        pair = np.repeat(np.arange(count), actions.size)
        action = np.tile(actions, count)
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
        for number in range(self.num_robots):
            ends.hit[number] &= self.crowd.crowded.hits(
                before, ends.here[number], ends.joint, ends.there[number]
            )

    def _arrivals(self, scene: _Scene, ends: _Ends) -> tuple[Flags, Flags]:
        """Return who arrives at an open exit, `[robots, ends]`, and whether the episode is over."""
        level, on_the_way = self.level, ~ends.away
        is_open = np.ones(ends.pair.size, bool)
        for column, value in self._needs:
            is_open &= ends.values[:, column] == value
        numbers = np.arange(self.num_robots)[:, None]
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
        shares = np.empty((end.size, self.num_robots))
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

    def _hindrances(
        self, scene: _Scene, cell: Ints, away: Flags, actions: Ints
    ) -> tuple[NDArray[np.int8], Ints]:
        """Return what hinders some joint actions, and where they lead the first robot."""
        taken = self._taken(actions)
        found = np.full((cell.shape[1], actions.size), FREE, np.int8)
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
    ) -> Part:
        """Return a part with the outcomes that are alike as one."""
        order = np.lexsort((*shares.T, terminal, following, row))
        row, following, terminal = row[order], following[order], terminal[order]
        shares = shares[order]
        is_new = differs(row) | differs(following) | differs(terminal)
        for share in shares.T:
            is_new |= differs(share)
        first = np.flatnonzero(is_new)
        return Part(
            states=states,
            obstruction=obstruction,
            intended=intended,
            row=row[first],
            probability=np.add.reduceat(probability[order], first),
            following=following[first],
            shares=shares[first],
            terminal=terminal[first],
        )
