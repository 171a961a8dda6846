"""A grid of MiniGrid after a reset, and the task in it, apart from the package."""

from __future__ import annotations

from dataclasses import dataclass

from babyrobot_levels.language import drawing as d

Cell = tuple[int, int]

LAVA = "~"
"""The mark of a cell with lava; walls, goals and free cells have those of a drawing."""


@dataclass(frozen=True, slots=True)
class Object:
    """An object on the grid that is neither wall, lava, goal nor floor.

    Attributes:
        kind: `door`, `key`, `ball`, `box`, or `obstacle` for a ball that moves.
        color: its colour in MiniGrid.
        at: its cell.
        state: of a door, `open`, `closed` or `locked`; of a key, `boxed` if a box hides it.
    """

    kind: str
    color: str
    at: Cell
    state: str = ""


@dataclass(frozen=True, slots=True)
class Task:
    """What ends an episode.

    Attributes:
        goals: the cells at which it succeeds.
        fails: the cells at which it fails; one that is a goal as well fails before `first`.
        first: the cells that the robot has to come to before a goal counts.
        shown: the cells whose objects are kept for being looked at.
        beside: whether it is enough to come next to a goal, so that its door may stay locked.
        note: how this differs from the task in MiniGrid; empty if it does not.
    """

    goals: tuple[Cell, ...]
    fails: tuple[Cell, ...] = ()
    first: tuple[Cell, ...] = ()
    shown: tuple[Cell, ...] = ()
    beside: bool = False
    note: str = ""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A grid after a reset.

    Attributes:
        rows: the cells row by row: `BLOCKED`, `PLAIN`, `EXIT` for a goal, or `LAVA`.
        objects: the objects, row by row.
        agents: the cells of the agent; an environment has one.
        heading: where it looks: N, E, S or W.
        task: the task; None if it is to reach a goal.
        floor: whether there is floor in colours.
    """

    rows: tuple[str, ...]
    objects: tuple[Object, ...]
    agents: tuple[Cell, ...]
    heading: str
    task: Task | None = None
    floor: bool = False

    @property
    def drawn_goals(self) -> tuple[Cell, ...]:
        """The cells with a goal, row by row."""
        return tuple(
            (x, y)
            for y, row in enumerate(self.rows)
            for x, mark in enumerate(row)
            if mark == d.EXIT
        )
