"""What is where in a picture, of a configuration or the level as a whole; the robot's pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.actions import DELTAS, Action
from babyrobot_levels.render.effects import effects_of

if TYPE_CHECKING:
    from babyrobot_levels.language.things import Mover
    from babyrobot_levels.mdp.gridworld import GridWorld


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
    count = level.compile().num_configurations if configuration and level.has_things else 1
    if not 0 <= configuration < count:
        raise ValueError(f"state {state} is not on the level")
    y, x = divmod(cell, width)
    return RobotPlace(configuration, x, y)


class GoodEnds:
    """Tells which steps end an episode well: at an open exit or a good end, and without a hit.

    Args:
        level: the level; a maze needs a seed.
    """

    def __init__(self, level: GridWorld) -> None:
        self._level = level
        self._cells = effects_of(level).good_ends

    def are_reached(self, state: int, next_state: int) -> bool:
        """Return whether a step from one state to another one ends the episode well."""
        level, after = self._level, place_of(self._level, next_state)
        if not level.has_things:
            return after.cell in self._cells or after.cell in level.exits
        now = level.configuration(after.configuration)
        if after.cell not in self._cells and not (now.exit_is_open and after.cell in now.exits):
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
        on: for each switch, whether it is on.
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
    movers: tuple[Cell, ...]
    looks: tuple[Cell, ...]
    doors: tuple[bool, ...]
    is_overview: bool = False

    @property
    def standing(self) -> tuple[object, ...]:
        """Everything but movers: situations in which it is the same have the same pieces."""
        return self.exits, self.is_locked, self.items, self.on, self.doors, self.is_overview

    @property
    def lying(self) -> frozenset[Cell]:
        """The cells in which items lie, or may lie."""
        return frozenset(cell for cells in self.items for cell in cells)


def situation_of(level: GridWorld, configuration: int | None) -> Situation:
    """Return what is where in a configuration; None for the level as a whole.

    The level as a whole shows everything where it begins, and all places of which one is drawn.

    Raises:
        ValueError: the level has no such configuration.
    """
    if not level.has_things:
        if configuration:
            raise ValueError("the level has no things, and so a single configuration")
        return Situation(level.exits, False, (), (), (), (), ())
    if configuration is None:
        return _overview(level)
    count = level.compile().num_configurations
    if not 0 <= configuration < count:
        raise ValueError(f"configuration {configuration} is not one of the level's {count}")
    found = level.configuration(configuration)
    return Situation(
        exits=found.exits,
        is_locked=not found.exit_is_open,
        items=tuple(() if cell is None else (cell,) for cell in found.items),
        on=found.on,
        movers=found.movers,
        looks=_looks(level, found.values[level.things().static :]),
        doors=found.doors,
    )


def _overview(level: GridWorld) -> Situation:
    met = frozenset(switch.name for switch in level.switches if switch.on)
    return Situation(
        exits=level.exits,
        is_locked=not met.issuperset(level.exit_keys),
        items=tuple(item.places for item in level.items),
        on=tuple(switch.on for switch in level.switches),
        movers=tuple(_first_cell(mover) for mover in level.movers),
        looks=_looks(level, [0] * len(level.movers)),
        doors=level.things().closed(met),
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


_FACINGS = {move: action for action, move in DELTAS.items()}

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
    in the direction of its action. At a good end it cheers, facing the viewer.

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
    facing = _FACINGS.get((x - before_x, y - before_y), Action(action))
    return Pose(facing, Mood.SLIP if skidded else Mood.CALM)
