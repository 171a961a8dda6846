"""What one can do to a level by drawing: each gesture is one change, and one step to undo.

They come from a browser, so they are checked like any input. Cells are `[x, y]`; a side of a cell
is N, E, S or W, as in level files.
"""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter

from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.kinds import NEEDED

Coordinate = Annotated[int, Field(ge=0, lt=MAX_SIZE, strict=True)]
Cell = tuple[Coordinate, Coordinate]
Cells = Annotated[list[Cell], Field(min_length=1, max_length=MAX_SIZE * MAX_SIZE)]
Count = Annotated[int, Field(ge=1, le=MAX_SIZE, strict=True)]
Shift = Annotated[int, Field(ge=-MAX_SIZE, le=MAX_SIZE, strict=True)]
Side = Literal["N", "E", "S", "W"]
Route = Annotated[list[str | int], Field(min_length=1, max_length=8)]


GROUND = ("small", "large", "blocked", "area", "erase")
"""The brushes that paint the ground: puddles of two sizes, or nothing, among them."""

BRUSHES = (*GROUND, "start", "exit", "box", *(kind.name for kind in NEEDED))


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Walls(_Model):
    """Build or remove walls along a straight run of sides."""

    do: Literal["walls"]
    at: Cell
    side: Side
    length: Count = 1
    """Sides of the run: to the east on N and S, to the south on E and W."""
    to: Literal["none", "wall", "glass", "door"]
    """What the sides become."""
    pass_: Annotated[float, Field(alias="pass", ge=0, le=1)] = 0.5
    """The probability of getting through glass."""


def _known_brush(name: str) -> str:
    if name not in BRUSHES:
        raise ValueError(f"must be one of {', '.join(BRUSHES)}")
    return name


class Paint(_Model):
    """Put something into cells, or take everything out of them."""

    do: Literal["paint"]
    brush: Annotated[str, AfterValidator(_known_brush)]
    cells: Cells
    """In the order in which they were painted. Of `start` and `exit`, several are several."""
    add: bool = False
    """Whether the starts or exits that are there stay."""
    rectangle: bool = False
    """Whether the cells are the first and the last corner of a rectangle, which is filled."""
    fields: dict[str, Any] = {}
    """Further fields of an area or a thing."""


class Fill(_Model):
    """Paint a cell and all cells that are like it and can be reached without passing walls."""

    do: Literal["fill"]
    brush: Literal["small", "large", "blocked", "area", "erase"]
    at: Cell
    fields: dict[str, Any] = {}


class Warp(_Model):
    """Add a warp from a cell to another one."""

    do: Literal["warp"]
    at: Cell
    to: Cell


class Path(_Model):
    """Add a mover: a guard that walks through cells, or a wanderer."""

    do: Literal["path"]
    cells: Cells
    """In turn; those between two of a row or a column may be left out. Where the last one is no
    neighbour of the first, the guard walks there and back."""
    rectangle: bool = False
    """Whether the cells are the first and the last corner of a rectangle, in which it wanders."""


class Robot(_Model):
    """Add a robot, or give one an exit of its own; a level with one robot then has several."""

    do: Literal["robot"]
    at: Cell
    """Where it begins: if a robot does already, it is that one."""
    to: Cell | None = None
    """Its own exit."""


class Move(_Model):
    """Move what stands at a route, such as a start, an item, or the target of a warp."""

    do: Literal["move"]
    route: Route
    from_: Annotated[Cell, Field(alias="from")]
    """The cell by which it was taken: of a rectangle, any."""
    to: Cell


class Remove(_Model):
    """Remove an entry or a field."""

    do: Literal["remove"]
    route: Route


class Set(_Model):
    """Give a field or an entry another value; None removes it."""

    do: Literal["set"]
    route: Route
    value: Any


class Resize(_Model):
    """Give the level another size."""

    do: Literal["resize"]
    size: tuple[Count, Count]
    shift: tuple[Shift, Shift] = (0, 0)
    """How far everything moves to the east and south: what is added at the left and the top."""


class Wind(_Model):
    """Set the strength of the wind in one column (`N`, `S`) or row (`E`, `W`)."""

    do: Literal["wind"]
    side: Side
    """Where the wind blows to."""
    index: Coordinate
    """The number of the column or row."""
    strength: Annotated[int, Field(ge=0, le=MAX_SIZE, strict=True)]


class Stamp(_Model):
    """Put the region that was copied last to another place."""

    do: Literal["stamp"]
    at: Cell
    """Its first cell there. What lies off the grid is left out."""
    mirror: Literal["", "x", "y", "xy"] = ""
    """The axes along which it is mirrored: `x` swaps west and east."""


class Resolve(_Model):
    """Write the maze out as walls."""

    do: Literal["resolve"]


class Fix(_Model):
    """Apply the fix of a finding."""

    do: Literal["fix"]
    code: str
    line: int
    column: int


Gesture = (
    Walls
    | Paint
    | Fill
    | Warp
    | Path
    | Robot
    | Move
    | Remove
    | Set
    | Resize
    | Wind
    | Stamp
    | Resolve
    | Fix
)

gesture_of: TypeAdapter[Gesture] = TypeAdapter(Annotated[Gesture, Field(discriminator="do")])
"""Checks plain data as a gesture."""
