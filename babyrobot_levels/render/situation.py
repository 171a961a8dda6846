"""What is where in a picture, what its cells do to the robot, and the pose of the robot."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.cells import shifts
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.things import Mover
from babyrobot_levels.mdp.actions import DELTAS, MOVES, Action
from babyrobot_levels.mdp.ground import build_ground

if TYPE_CHECKING:
    from babyrobot_levels.mdp.configurations import Configuration
    from babyrobot_levels.mdp.gridworld import GridWorld

STRENGTHS = 3
"""How many strengths a picture tells apart."""


class End(NamedTuple):
    """How a cell that is no exit ends the episode.

    Attributes:
        is_good: whether it pays; without exits and ends that pay, whether none costs less.
        costs: whether it costs more than a step.
        strength: 1 to 3: its reward beside the largest one of such ends.
    """

    is_good: bool
    costs: bool
    strength: int


@dataclass(frozen=True, slots=True)
class Effects:
    """What the cells that are unlike plain ones do.

    Attributes:
        ends: the cells other than exits that end the episode.
        pays: the cells that pay more than a step, and more than 0, with a strength from 1 to 3.
            These are rewards of areas, and of warps.
        costs: the cells that cost more than a step, likewise.
        skids: the cells out of which the robot may skid, puddles left out: 1 for a chance below
            1/4, 2 for one below 1/2, else 3.
        winds: how far the wind pushes, east and south, in the cells where it does.
    """

    ends: dict[Cell, End] = field(default_factory=dict)
    pays: dict[Cell, int] = field(default_factory=dict)
    costs: dict[Cell, int] = field(default_factory=dict)
    skids: dict[Cell, int] = field(default_factory=dict)
    winds: dict[Cell, tuple[int, int]] = field(default_factory=dict)

    @property
    def good_ends(self) -> frozenset[Cell]:
        """The cells other than exits in which episodes end well."""
        return frozenset(cell for cell, end in self.ends.items() if end.is_good)

    def at(self, cell: Cell) -> Effects:
        """Return what one of the cells does, as if it were the cell (0, 0)."""
        parts = {
            part.name: {(0, 0): told[cell]} if cell in (told := getattr(self, part.name)) else {}
            for part in fields(self)
        }
        return Effects(**parts)


def effects_of(level: GridWorld) -> Effects:
    """Return what the cells of a level do.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    if not (level.areas or level.warps or level.wind is not None or level.skid is not None):
        return Effects()
    ground, blocked = build_ground(level), level.grid().blocked_cells
    width, height = level.size
    free = [(x, y) for y in range(height) for x in range(width) if not blocked[y * width + x]]

    def told(values: Sequence[float], cells: Iterable[Cell]) -> dict[Cell, float]:
        return {cell: values[cell[1] * width + cell[0]] for cell in cells}

    # Nobody stays there.
    gone = {warp.at for warp in level.warps if warp.when == "enter"}
    gone.update(level.exits)
    ends = [cell for cell in free if ground.ends[cell[1] * width + cell[0]] and cell not in gone]
    gone.update(ends)
    puddles = {puddle.at for puddle in level.puddles}
    left = [cell for cell in free if cell not in gone]
    plain = [cell for cell in left if cell not in puddles]
    paid = told(ground.reward, plain)
    step = _usual(paid.values(), level.rewards.step)
    paid |= {warp.at: warp.reward for warp in level.warps if warp.reward is not None}
    if isinstance(level.rewards.exit, str):
        paid |= told(ground.reward, level.exits)
    pays, costs = _strengths(paid, step)
    skids = told(ground.skid, plain)
    south, east = shifts(level.wind, width, height)
    return Effects(
        ends=_ends(told(ground.reward, ends), step, level),
        pays=pays,
        costs=costs,
        skids={cell: int(1 + 4 * min(skid, 0.5)) for cell, skid in skids.items() if skid},
        winds={(x, y): (east[y], south[x]) for x, y in left if east[y] or south[x]},
    )


def _usual(rewards: Iterable[float], step: float) -> float:
    """Return the reward of a plain cell: that of a step, if there is any such cell."""
    counts = Counter(rewards)
    return step if step in counts or not counts else counts.most_common(1)[0][0]


def _ends(rewards: Mapping[Cell, float], step: float, level: GridWorld) -> dict[Cell, End]:
    best = max(rewards.values(), default=0.0)
    least = math.inf if level.exits or best > 0 else best
    most = max(map(abs, rewards.values()), default=0.0)
    return {
        cell: End(
            is_good=reward > 0 or reward >= least,
            costs=reward < min(step, 0.0),
            strength=_strength(abs(reward), most),
        )
        for cell, reward in rewards.items()
    }


def _strengths(
    rewards: Mapping[Cell, float], step: float
) -> tuple[dict[Cell, int], dict[Cell, int]]:
    """Return the cells that pay and those that cost, with their strengths."""
    most = max((abs(reward - step) for reward in rewards.values()), default=0.0)
    pays, costs = {}, {}
    for cell, reward in rewards.items():
        strength = _strength(abs(reward - step), most)
        if reward > max(step, 0.0):
            pays[cell] = strength
        elif reward < step:
            costs[cell] = strength
    return pays, costs


def _strength(amount: float, most: float) -> int:
    share = STRENGTHS * amount / most if most else math.inf
    # Beyond floating point, all are alike.
    return min(STRENGTHS, 1 + int(share)) if math.isfinite(share) else STRENGTHS


# -- what is where ---------------------------------------------------------------------------------


class RobotPlace(NamedTuple):
    """What a state means in a picture: the number of the configuration, and the robot's cell."""

    configuration: int
    x: int
    y: int

    @property
    def cell(self) -> Cell:
        """The robot's cell."""
        return self.x, self.y


def place_of(level: GridWorld, state: int) -> RobotPlace:
    """Return the configuration and the cell of a state, `configuration * cells + y * width + x`.

    This is the numbering of `level.compile()`; of a robot that turns, the heading is given apart.

    Raises:
        ValueError: the level has no such state.
    """
    width, height = level.size
    configuration, cell = divmod(state, width * height)
    count = level.numbering().num_configurations if configuration and level.has_things else 1
    if not 0 <= configuration < count:
        raise ValueError(f"state {state} is not on the level")
    y, x = divmod(cell, width)
    return RobotPlace(configuration, x, y)


class GoodEnds:
    """Tells which steps end an episode well, and without a hit.

    Those do that lead to an open exit or a good end, or cover the last target.

    Args:
        level: the level; a maze needs a seed.
    """

    def __init__(self, level: GridWorld) -> None:
        self._level = level
        self._cells = effects_of(level).good_ends
        self._exits = frozenset(level.exits)

    def are_reached(self, state: int, next_state: int) -> bool:
        """Return whether a step from one state to another one ends the episode well."""
        level, after = self._level, place_of(self._level, next_state)
        if not level.has_things:
            return after.cell in self._cells or after.cell in self._exits
        now = level.configuration(after.configuration)
        is_end = after.cell in self._cells or (now.exit_is_open and after.cell in now.exits)
        if not (is_end or now.is_solved):
            return False
        before = place_of(level, state)
        movers = zip(level.configuration(before.configuration).movers, now.movers, strict=True)
        swapped = after.cell, before.cell
        return all(mover != swapped and mover[1] != after.cell for mover in movers)


@dataclass(frozen=True, slots=True)
class Situation:
    """What is where.

    Attributes:
        exits: the cells that are exits, or of which one is.
        is_locked: whether the exits need something that is not held, or not on.
        items: for each item, the cells in which it lies, or in one of which; none while held.
        on: for each thing of `Things.fixed`, whether it is on, or covered.
        boxes: the cells in which boxes stand.
        robots: for each of several robots but the first, the cell in which it is, or left.
        arrived: for each of several robots, whether it has arrived at its exit.
        movers: for each mover, the cell in which it stands.
        looks: for each mover, the way to the next cell of its path, `(dx, dy)`; `(0, 0)` for one
            that stays, or walks at random.
        doors: for each door, whether it is closed.
        is_overview: whether it is the level as a whole, in which several places are possible.
    """

    exits: tuple[Cell, ...]
    is_locked: bool
    items: tuple[tuple[Cell, ...], ...]
    on: tuple[bool, ...]
    boxes: tuple[Cell, ...]
    movers: tuple[Cell, ...]
    looks: tuple[Cell, ...]
    doors: tuple[bool, ...]
    robots: tuple[Cell, ...] = ()
    arrived: tuple[bool, ...] = ()
    is_overview: bool = False

    @property
    def figures(self) -> tuple[Cell, ...]:
        """The cells of movers, and of the robots but the first."""
        return *self.movers, *self.robots

    @property
    def ways(self) -> tuple[Cell, ...]:
        """Where figures look."""
        return *self.looks, *[(0, 0)] * len(self.robots)

    @property
    def standing(self) -> tuple[object, ...]:
        """Everything but movers: situations in which it is the same have the same pieces."""
        situation = self.exits, self.is_locked, self.items, self.on, self.boxes, self.doors
        return *situation, self.is_overview

    @property
    def lying(self) -> frozenset[Cell]:
        """The cells in which items lie, or may lie, and boxes stand."""
        return frozenset(cell for cells in self.items for cell in cells).union(self.boxes)


def situation_of(level: GridWorld, configuration: int | None) -> Situation:
    """Return what is where in a configuration; None for the level as a whole.

    The level as a whole shows everything where it begins, and all places of which one is drawn.

    Raises:
        ValueError: the level has no such configuration.
    """
    if not level.has_things:
        if configuration:
            raise ValueError("the level has no things, and so a single configuration")
        return Situation(level.exits, False, (), (), (), (), (), ())
    if configuration is None:
        return _overview(level)
    count = level.numbering().num_configurations
    if not 0 <= configuration < count:
        raise ValueError(f"configuration {configuration} is not one of the level's {count}")
    return situation_at(level, level.configuration(configuration))


def situation_at(level: GridWorld, found: Configuration) -> Situation:
    """Return what is where in a configuration of a level with things."""
    return Situation(
        exits=found.exits,
        is_locked=not found.exit_is_open,
        items=tuple(() if cell is None else (cell,) for cell in found.items),
        on=found.on,
        boxes=found.boxes,
        movers=found.movers,
        looks=_looks(level, found.values[level.things().static :]),
        doors=found.doors,
        robots=found.robots,
        arrived=found.arrived,
    )


def _overview(level: GridWorld) -> Situation:
    things = level.things()
    on = tuple(things[column].begins[0] == things[column].is_met for column in things.fixed)
    met = frozenset(
        things.names[column] for column, is_on in zip(things.fixed, on, strict=True) if is_on
    )
    return Situation(
        exits=level.exits,
        is_locked=not met.issuperset(level.exit_keys),
        items=tuple(item.places for item in level.items),
        on=on,
        boxes=tuple(box.at for box in level.boxes),
        movers=tuple(_first_cell(mover) for mover in level.movers),
        looks=_looks(level, [0] * len(level.movers)),
        doors=things.closed(met),
        robots=level.starts[1:] if level.robots and level.display.robot.show else (),
        arrived=(False,) * len(level.robots),
        is_overview=True,
    )


def _looks(level: GridWorld, phases: Sequence[int]) -> tuple[Cell, ...]:
    """Return where movers look, by the phases of those that walk a path."""
    return tuple(look_of(mover, phase) for mover, phase in zip(level.movers, phases, strict=True))


def look_of(mover: Mover, phase: int) -> Cell:
    """Return the way of a mover to the next cell of its path; `(0, 0)` for one without a path."""
    if mover.within is not None:
        return 0, 0
    cells = mover.phases
    (x, y), (to_x, to_y) = cells[phase], cells[(phase + 1) % len(cells)]
    return to_x - x, to_y - y


def _first_cell(mover: Mover) -> Cell:
    """Return where a mover begins; of one that is drawn, the middle of its rectangle."""
    if mover.within is None:
        return mover.phases[0]
    if mover.start is not None:
        return mover.start
    (left, top), (width, height) = mover.within.at, mover.within.size
    return left + (width - 1) // 2, top + (height - 1) // 2


# -- the robot's pose ------------------------------------------------------------------------------


class Mood(StrEnum):
    """What has just happened to the robot."""

    CALM = "calm"
    SLIP = "slip"
    CHEER = "cheer"


@dataclass(frozen=True, slots=True)
class Pose:
    """A pose of the robot.

    Attributes:
        facing: where it looks; `STAY` is at the viewer.
        mood: what has just happened to it.
        phase: the part of a move from cell to cell that is done, 0 to 1. The robot bobs while it
            moves; at 0 and 1 it stands.
        heading: of a robot that turns, the direction of its next move, 0 N, 1 E, 2 S, 3 W; None
            for one that does not turn.
    """

    facing: Action = Action.STAY
    mood: Mood = Mood.CALM
    phase: float = 0.0
    heading: int | None = None

    def turned(self, heading: int | None) -> Pose:
        """Return the pose of a robot that turns, which looks where it is heading.

        None gives the pose of one that does not turn: this one.
        """
        if heading is None:
            return self
        facing = self.facing if self.mood is Mood.CHEER else Action(heading + Action.NORTH)
        return replace(self, facing=facing, heading=heading)


_FACINGS = {DELTAS[action]: action for action in MOVES}

STANDING = Pose()
"""The pose before the first step."""


def pose_of(
    previous_cell: int,
    cell: int,
    action: int,
    width: int,
    *,
    skidded: bool = False,
    ends_well: bool = False,
) -> Pose:
    """Return the pose after a step.

    The robot looks in the direction of its move. If it stayed, or came from farther away, it looks
    in the direction of its action; of a diagonal one, to the east or west. At a good end it
    cheers, facing the viewer.

    Args:
        previous_cell: the number of the cell before the step, `y * width + x`.
        cell: that of the cell after the step.
        action: the action, a `brl.Action`.
        width: the number of columns of the level.
        skidded: whether the robot skidded to another cell than the action leads to.
        ends_well: whether the step ends the episode well; see `GoodEnds`.
    """
    if ends_well:
        return Pose(mood=Mood.CHEER)
    before_y, before_x = divmod(previous_cell, width)
    y, x = divmod(cell, width)
    facing = _FACINGS.get((x - before_x, y - before_y), _side_of(Action(action)))
    return Pose(facing, Mood.SLIP if skidded else Mood.CALM)


def _side_of(action: Action) -> Action:
    """Return where a robot looks that takes an action: there are no pictures from the corners."""
    if action <= Action.WEST:
        return action
    return Action.EAST if DELTAS[action][0] > 0 else Action.WEST
