"""Warps, wind, and the rewards of steps."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field

from babyrobot_levels.language.base import MAX_SIZE, Cell, Integer, Model, Number, form, forms

_Strengths = Annotated[
    tuple[Annotated[Integer, Field(ge=0, le=MAX_SIZE)], ...], Field(max_length=MAX_SIZE)
]


class Warp(Model):
    """A cell that moves the robot to another cell."""

    at: Cell
    """The cell."""
    to: Annotated[
        Annotated[Cell, form("cell")] | Annotated[Literal["start"], form("word")],
        forms(lambda value: "word" if isinstance(value, str) else "cell"),
    ]
    """The target: a cell, or `start`."""
    when: Literal["enter", "leave"] = "enter"
    """When it acts: as the robot enters the cell, or as it leaves it."""
    reward: Number | None = None
    """The reward of the step, which replaces any other."""


class Wind(Model):
    """Columns and rows that push. The strengths are cells per move."""

    north: _Strengths | None = None
    """For each column, how far a move is pushed to the north."""
    east: _Strengths | None = None
    """For each row, how far a move is pushed to the east."""
    south: _Strengths | None = None
    """For each column, how far a move is pushed to the south."""
    west: _Strengths | None = None
    """For each row, how far a move is pushed to the west."""


class Told(NamedTuple):
    """How the rules in words tell a reward: the sample drawn beside it, and what it is for."""

    sample: str
    text: str


class Rewards(Model):
    """The rewards of a step."""

    step: Number = -1.0
    """A step onto a plain cell."""
    exit: Number = 0.0
    """A step onto an exit."""
    bump: Annotated[Number | None, Told("wall", "bumping into a wall")] = None
    """A move into a wall."""
    bounce: Number = -1.0
    """Added when the robot bounces off a glass wall."""
    stay: Annotated[Number | None, Told("ground", "staying")] = None
    """The action `stay`, instead of the reward of the cell."""
    closer: Annotated[Number | None, Told("ground", "a step closer to the exit")] = None
    """A step that brings the robot closer to the nearest exit, by Euclidean distance."""
    farther: Annotated[Number | None, Told("ground", "a step away from the exit")] = None
    """A step that takes the robot farther from the nearest exit, by Euclidean distance."""


PRECEDENCE = ("hit", "warp", "exit", "item", "stay", "bump", "closer", "farther", "step")
"""What a step may pay: the first of these that applies.

`hit`, `warp` and `item` are the rewards that a mover, a warp or an item has of its own. `step` is
that of the cell: of its puddle, its area, or the level. The others are entries of `rewards`.
"""

ADDED = ("bounce",)
"""The rewards that come in addition."""


def shifts(wind: Wind | None, width: int, height: int) -> tuple[list[int], list[int]]:
    """Return the net push: for each column how far south, for each row how far east (in cells)."""

    def strengths(values: Any, count: int) -> list[int]:
        return list(values) if values is not None else [0] * count

    wind = wind or Wind()
    north, south = strengths(wind.north, width), strengths(wind.south, width)
    west, east = strengths(wind.west, height), strengths(wind.east, height)
    return (
        [down - up for up, down in zip(north, south, strict=True)],
        [right - left for left, right in zip(west, east, strict=True)],
    )
