"""Things, whose state changes during an episode: items, doors, switches, boxes, movers."""

import math
from typing import Annotated, Any, Literal

from pydantic import Field

from babyrobot_levels.language.base import Cell, Cells, Flag, Model, Number, Slug, Text, form, forms
from babyrobot_levels.language.cells import Opening, Rectangle, RewardLike, Rewards, Traits
from babyrobot_levels.language.looks import Color

SHAPES = ("key", "coin", "gem", "star", "box")

Shape = Literal["key", "coin", "gem", "star", "box"]

Places = Annotated[tuple[Cell, ...], Field(min_length=2)]
"""Cells of which one is drawn at each reset."""

NameOrNames = Annotated[
    Annotated[Slug, form("name")] | Annotated[tuple[Slug, ...], form("names")],
    forms(
        "a name, or a list of names",
        lambda value: "names" if isinstance(value, list | tuple) else "name",
    ),
]


def as_names(value: Any) -> tuple[str, ...]:
    """Return one name or several as a tuple."""
    return (value,) if isinstance(value, str) else tuple(value)


class Item(Model):
    """Something to take: by coming to stand where it lies. It is kept to the end."""

    name: Slug
    """The name, unique among all things of the level."""
    at: Cell | None = None
    """Where it lies."""
    one_of: Places | None = None
    """Cells of which one is drawn uniformly at each reset: it lies there."""
    reward: Number | None = None
    """The reward of the step that takes it, which replaces that of the cell."""
    robot: Slug | None = None
    """Of several robots the only one that can take it, by its name."""
    shape: Shape | None = None
    """Its picture; by default its name if that is a shape, else `star`."""
    color: Color | None = None
    """The colour, if it is not the theme's."""
    label: Text | None = None
    """A text to show on it."""

    @property
    def places(self) -> tuple[tuple[int, int], ...]:
        """The cells in which it may lie."""
        return self.one_of or (() if self.at is None else (self.at,))

    @property
    def picture(self) -> str:
        """Its shape, also where none is given."""
        return self.shape or (self.name if self.name in SHAPES else "star")


class Door(Opening):
    """A door: a wall while it is closed, and nothing while it is open."""

    needs: NameOrNames = ()
    """The items and switches that open it: all must be held, or on."""
    unless: NameOrNames = ()
    """The items and switches that close it: while any of them is held, or on."""
    color: Color | None = None
    """The door's colour, if it is not the theme's."""
    width: Annotated[Number, Field(ge=0, le=100)] | None = None
    """The door's width in pixels, if it is not the theme's."""

    @property
    def keys(self) -> tuple[str, ...]:
        """The names in `needs`."""
        return as_names(self.needs)

    @property
    def locks(self) -> tuple[str, ...]:
        """The names in `unless`."""
        return as_names(self.unless)


class Switch(Model):
    """A switch, which flips whenever the robot arrives there."""

    name: Slug
    """The name, unique among all things of the level."""
    at: Cell
    """The cell."""
    once: Flag = False
    """Whether it flips only the first time."""
    on: Flag = False
    """Whether it is on at the beginning."""
    color: Color | None = None
    """The colour, if it is not the theme's."""
    label: Text | None = None
    """A text to show on it."""

    @property
    def places(self) -> tuple[tuple[int, int], ...]:
        """The cells in which it may lie: its own."""
        return (self.at,)

    @property
    def picture(self) -> str:
        """How it is drawn."""
        return "switch"


MAX_BOXED_STATES = 5_000_000
"""The most states of a level with boxes."""


class Box(Model):
    """A box, which the robot pushes; all boxes are alike."""

    at: Cell
    """The cell in which it stands at the beginning."""

    @property
    def places(self) -> tuple[tuple[int, int], ...]:
        """The cells in which it may begin: its own."""
        return (self.at,)


class Target(Model):
    """A cell to push a box to, or of several robots one: covered while one of them stands there."""

    at: Cell
    """The cell."""
    name: Slug | None = None
    """The name, unique among all things of the level, by which doors and exits need it."""
    color: Color | None = None
    """The colour, if it is not the theme's."""
    label: Text | None = None
    """A text to show on it."""

    @property
    def places(self) -> tuple[tuple[int, int], ...]:
        """The cells in which it may lie: its own."""
        return (self.at,)

    @property
    def picture(self) -> str:
        """How it is drawn."""
        return "target"


class TeamRobot(Model):
    """One of several robots, which all move at once."""

    name: Slug
    """The name, unique among all things of the level."""
    start: Cell | None = None
    """Where it begins; by default the next of the level's starts that no robot before it has."""
    exit: Cell | None = None
    """An exit of its own; by default it leaves by those of the level."""
    color: Color | None = None
    """The colour, by default one that those who are colour-blind tell from the others."""


class Team(Model):
    """What several robots mean to each other."""

    meet: Literal["block", "order", "pass", "end"] = "block"
    """When robots meet: they stay, the first in order goes, they pass, or the episode ends."""
    arrived: Literal["leave", "stay"] = "leave"
    """Whether a robot that has arrived leaves the level, or stays at its exit, in the way."""
    ends: Literal["all", "first"] = "all"
    """Whether the episode ends when all robots have arrived, or the first."""


class Mover(Model):
    """A guard that walks a path, or a wanderer that walks at random in a rectangle."""

    name: Slug | None = None
    """The name, unique among all things of the level."""
    path: Cells | None = None
    """The cells that it walks in turn, one a step; consecutive ones are neighbours or equal."""
    back: Flag = False
    """Whether it walks the path there and back; otherwise the path is a loop."""
    within: Rectangle | None = None
    """The rectangle in which it walks at random."""
    start: Cell | None = None
    """Where it begins in its rectangle; by default a cell is drawn uniformly at each reset."""
    color: Color | None = None
    """The colour, if it is not the theme's."""
    label: Text | None = None
    """A text to show on it."""

    @property
    def picture(self) -> str:
        """How it is drawn, and what it is called."""
        return "guard" if self.within is None else "wanderer"

    @property
    def phases(self) -> tuple[tuple[int, int], ...]:
        """The cells that its numbers stand for: those of its path in turn, or of its rectangle."""
        if self.within is not None:
            (left, top), (width, height) = self.within.at, self.within.size
            return tuple(
                (x, y) for y in range(top, top + height) for x in range(left, left + width)
            )
        path = self.path or ()
        return (*path, *path[-2:0:-1]) if self.back else path


class Hit(Model):
    """What it means to meet a mover."""

    reward: Number = -1.0
    """The reward of the step."""
    ends: Flag = True
    """Whether the episode ends."""


HIT_STEPS = 2
"""A hit costs as much as so many steps for each cell: more than a way with detours and waiting."""


def hit_reward(rewards: Rewards, size: tuple[int, int]) -> float:
    """Return a reward that is worse than any way to the exit: a round number, by the size alone."""
    step = max(abs(rewards.step), abs(rewards.closer or 0), abs(rewards.farther or 0))
    worth = 0.0 if isinstance(rewards.exit, str) else abs(rewards.exit)
    cost = HIT_STEPS * size[0] * size[1] * step + worth or 1.0
    power = 10.0 ** math.floor(math.log10(cost))
    return -next(digit * power for digit in (1, 2, 5, 10) if digit * power >= cost)


DRAWN_NAMES = ("item", "switch", "target")
"""The fields of `DrawnThing` with names; each is the name of a kind."""


class DrawnThing(Model):
    """An item, a switch or a target of a drawing."""

    item: Slug | None = None
    """The name of an item; drawn in several cells, it lies in one of them."""
    switch: Slug | None = None
    """The name of a switch."""
    target: Slug | None = None
    """The name of a target."""
    shape: Shape | None = None
    """The item's picture; by default its name if that is a shape, else `star`."""
    once: Flag = False
    """Whether the switch flips only the first time."""
    on: Flag = False
    """Whether the switch is on at the beginning."""


class LegendEntry(Traits, DrawnThing):
    """The meaning of a character: an area of one cell, an item, a switch or a target."""

    color: Color | None = None
    """The colour of the ground, the item, the switch or the target."""
    reward: RewardLike | None = None
    """The reward for entering the cell, or of the step that takes the item: that is a number."""
    label: Text | None = None
    """A text to show on it."""

    @property
    def kind(self) -> str:
        """The name of the kind that the character stands for."""
        return next((name for name in DRAWN_NAMES if getattr(self, name) is not None), "area")
