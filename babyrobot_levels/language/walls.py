"""Walls, openings, and the maze that they begin with."""

from typing import Annotated, Literal

from pydantic import Field

from babyrobot_levels.language.base import (
    MAX_SIZE,
    Cell,
    Flag,
    Integer,
    Model,
    Number,
    Probability,
    Side,
    form,
    forms,
)
from babyrobot_levels.language.looks import Color

Algorithm = Literal[
    "depth-first",
    "wilson",
    "aldous-broder",
    "kruskal",
    "prim",
    "growing-tree",
    "hunt-and-kill",
    "recursive-division",
    "binary-tree",
    "sidewinder",
    "eller",
]

GLASS_PASS = 0.5
"""The `pass` of a drawn wall of glass without an entry in `walls`."""

RECTANGULAR = frozenset({"recursive-division", "binary-tree", "sidewinder", "eller"})
"""The algorithms that need the whole rectangle: no cell of it may be blocked."""


class Maze(Model):
    """A maze grown from a seed: the same seed always gives the same maze."""

    seed: Annotated[
        Annotated[Integer, form("number")] | Annotated[Literal["random"], form("word")],
        forms(
            "an integer or `random`",
            lambda value: "word" if isinstance(value, str) else "number",
        ),
    ]
    """The seed, or `random` for another maze at each reset."""
    algorithm: Algorithm = "depth-first"
    """How the maze is grown."""
    loops: Probability = 0.0
    """The share of dead ends that are opened."""


class Opening(Model):
    """A wall that is removed."""

    at: Cell
    """The cell."""
    side: Side
    """The side of the cell: N, E, S or W."""
    length: Annotated[Integer, Field(ge=1, le=MAX_SIZE)] = 1
    """Its length in cells: to the east on N and S, to the south on E and W."""


class Wall(Opening):
    """A wall that is added."""

    pass_: Annotated[Probability, Field(alias="pass")] = 0.0
    """The probability of getting through: above 0 it is a wall of glass."""
    color: Color | None = None
    """The wall's colour, if it is not the theme's."""
    width: Annotated[Number, Field(ge=0, le=100)] | None = None
    """The wall's width in pixels, if it is not the theme's."""
    fit: Flag = False
    """Whether the wall is shortened so as not to stick out into its neighbours."""


def sides_of(opening: Opening) -> list[tuple[int, int]]:
    """Return the cells `(x, y)` at whose `side` the wall or opening stands, one for its length."""
    x, y = opening.at
    if opening.side in ("N", "S"):
        return [(x + step, y) for step in range(opening.length)]
    return [(x, y + step) for step in range(opening.length)]
