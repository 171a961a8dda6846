"""Warps, wind, and the rewards of steps."""

from __future__ import annotations

from typing import Annotated, Any, Literal

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


class Rewards(Model):
    """The rewards of a step."""

    step: Number = -1.0
    """A step onto a plain cell."""
    exit: Number = 0.0
    """A step onto an exit."""
    bump: Number | None = None
    """A move into a wall."""
    bounce: Number = -1.0
    """Added when the robot bounces off a glass wall."""
    stay: Number | None = None
    """The action `stay`, instead of the reward of the cell."""
    closer: Number | None = None
    """A step that brings the robot closer to the nearest exit, by Euclidean distance."""
    farther: Number | None = None
    """A step that takes the robot farther from the nearest exit, by Euclidean distance."""


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
