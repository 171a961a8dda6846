"""What makes one cell unlike another: puddles, areas, blocked cells, skidding."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any, Literal

from pydantic import Field

from babyrobot_levels.language.base import (
    Cell,
    Flag,
    Model,
    Number,
    Probability,
    Size,
    Text,
    form,
    forms,
)
from babyrobot_levels.language.looks import Color


class SkidRule(StrEnum):
    """Where a robot goes that skids.

    `open`: to one of the other directions that are open, evenly; a refused move does not skid.
    `sides`: to the left or right of where it was going (Frozen Lake).
    `others`: to any of the three other directions.
    """

    OPEN = "open"
    SIDES = "sides"
    OTHERS = "others"


class Skid(Model):
    """How often a move goes astray, and where to."""

    probability: Probability
    """The probability of a move going astray."""
    to: Literal["open", "sides", "others"] = "open"
    """Where a move goes that goes astray: to the other open directions, sideways, or anywhere."""


def _skid_form(value: Any) -> str:
    return "mapping" if isinstance(value, dict | Skid) else "number"


SkidLike = Annotated[
    Annotated[Probability, form("number")] | Annotated[Skid, form("mapping")], forms(_skid_form)
]
"""A probability, or a `Skid`."""


def as_skid(value: float | Skid) -> Skid:
    """Return a skid that was written as a number as the mapping that it stands for."""
    return value if isinstance(value, Skid) else Skid(probability=value)


class Rectangle(Model):
    """A rectangle of cells."""

    at: Cell
    """The top-left cell."""
    size: Size = (1, 1)
    """Width and height in cells."""


class Traits(Model):
    """What the cells of an area have in common."""

    color: Color | None = None
    """The colour of the ground."""
    reward: Number | None = None
    """The reward for entering a cell of the area."""
    skid: SkidLike | None = None
    """How slippery the cells are."""
    ends: Flag | None = None
    """Whether entering a cell of the area ends the episode."""
    label: Text | None = None
    """A text to show on the area."""


class Area(Traits, Rectangle):
    """A rectangle with properties. Later areas win over earlier ones, property by property."""


class Puddle(Model):
    """A wet cell: slippery and costly."""

    at: Cell
    """The cell."""
    size: Literal["small", "large"] = "small"
    """How large it is; `puddle_types` says what that means."""


class PuddleType(Model):
    """What a size of puddle means."""

    reward: Number
    """The reward for stepping into it."""
    skid: SkidLike
    """How slippery it is."""


class SmallPuddle(PuddleType):
    """A small puddle, by default."""

    reward: Number = -2.0
    """The reward for stepping into it."""
    skid: SkidLike = 0.4
    """How slippery it is."""


class LargePuddle(PuddleType):
    """A large puddle, by default."""

    reward: Number = -4.0
    """The reward for stepping into it."""
    skid: SkidLike = 0.6
    """How slippery it is."""


class PuddleTypes(Model):
    """What the two sizes of puddles mean in this level."""

    small: SmallPuddle = Field(default_factory=SmallPuddle)
    """Small puddles."""
    large: LargePuddle = Field(default_factory=LargePuddle)
    """Large puddles."""
