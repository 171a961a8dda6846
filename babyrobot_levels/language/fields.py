"""The fields of a level file: their types, their defaults, and what each means.

Each is valid by itself; `LevelSpec` adds what only the whole level shows.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    Field,
    PrivateAttr,
    StringConstraints,
    WithJsonSchema,
)

from babyrobot_levels.language.base import (
    Cell,
    Cells,
    Integer,
    Model,
    Number,
    Size,
    Slug,
    Text,
    cell_or_cells,
    form,
    forms,
)
from babyrobot_levels.language.cells import Area, Puddle, PuddleTypes, Rectangle, SkidLike, Traits
from babyrobot_levels.language.drawing import RESERVED
from babyrobot_levels.language.looks import Display, ThemeLike
from babyrobot_levels.language.moves import Rewards, Warp, Wind
from babyrobot_levels.language.walls import Maze, Opening, Wall

_LEGEND_CHARACTERS = [chr(code) for code in range(33, 127) if chr(code) not in RESERVED]
_LEGEND_KEY = "^[" + "".join(f"\\{c}" if c in "[]\\^" else c for c in _LEGEND_CHARACTERS) + "]$"
LegendKey = Annotated[str, StringConstraints(pattern=_LEGEND_KEY)]

CellOrCells = Annotated[
    Annotated[Cell, form("cell")] | Annotated[Cells, form("cells")], forms(cell_or_cells)
]


def _exit_form(value: Any) -> str:
    return "word" if isinstance(value, str) else cell_or_cells(value)


def whole_version(value: Any) -> Any:
    """Take `1.0` for 1, and not `true`."""
    # `Literal[1]` would take `true` for 1, and not take 1.0.
    if isinstance(value, bool):
        return str(value).lower()
    return 1 if value == 1 else value


class LevelFields(Model):
    """A level, version 1 of the language: every field, validated, and frozen."""

    version: Annotated[Literal[1], BeforeValidator(whole_version), WithJsonSchema({"const": 1})]
    """The version of the language: 1."""
    name: Slug | None = None
    """What code loads the level by; the file's name, if it is left out."""
    title: Text | None = None
    """A title, for people."""
    description: Text | None = None
    """What the level is about."""
    author: Text | None = None
    """Who made it."""
    license: Text | None = None
    """Under which licence it may be used."""
    source: Text | None = None
    """Whose world this is: a citation."""
    tags: tuple[Slug, ...] = ()
    """Words to search by."""
    size: Size = (3, 3)
    """Width and height in cells."""
    map: Text | None = None
    """The level as a drawing, in the place of size, start, exit, walls, puddles and blocked."""
    legend: dict[LegendKey, Traits] = Field(default_factory=dict)
    """What the further characters of the drawing mean."""
    start: CellOrCells = (0, 0)
    """Where the robot starts; of several cells, one is drawn evenly at each reset."""
    exit: Annotated[
        Annotated[Literal["none"], form("word")]
        | Annotated[Cell, form("cell")]
        | Annotated[Cells, form("cells")],
        forms(_exit_form),
    ] = "none"
    """Where the episode ends: a cell, several, or `none`; the bottom-right cell if left out."""
    maze: Maze | None = None
    """A maze grown from a seed."""
    walls: tuple[Wall, ...] = ()
    """Walls that are added."""
    openings: tuple[Opening, ...] = ()
    """Walls that are taken away, after the maze and the walls."""
    puddles: tuple[Puddle, ...] = ()
    """Wet cells: slippery and costly."""
    puddle_types: PuddleTypes = Field(default_factory=PuddleTypes)
    """What small and large puddles mean."""
    areas: tuple[Area, ...] = ()
    """Rectangles with properties; later ones win."""
    blocked: tuple[Rectangle, ...] = ()
    """Cells that do not exist."""
    warps: tuple[Warp, ...] = ()
    """Cells that send the robot elsewhere."""
    wind: Wind | None = None
    """Columns and rows that push."""
    skid: SkidLike | None = None
    """How slippery every cell is."""
    rewards: Rewards = Field(default_factory=Rewards)
    """What a step is worth."""
    discount: Annotated[Number, Field(gt=0, le=1)] = 1.0
    """What solving assumes when it is not told otherwise."""
    max_steps: Annotated[Integer, Field(ge=1, le=2**53)] | None = None
    """The episode is truncated after this many steps."""
    theme: ThemeLike = "default"
    """Colours and widths: a theme's name or a mapping."""
    display: Display = Field(default_factory=Display)
    """What is shown beside the level itself."""

    _drawn: dict[str, int] = PrivateAttr(default_factory=dict)

    def written(self, field: str) -> Iterator[tuple[int, Any]]:
        """Yield the entries of a list that the file gives, with their numbers there.

        What a drawing says comes before them in the field, and is left out.
        """
        return enumerate(getattr(self, field)[self._drawn.get(field, 0) :])

    @property
    def starts(self) -> tuple[tuple[int, int], ...]:
        """The starts as a tuple of cells, also when there is one."""
        return _as_cells(self.start)

    @property
    def exits(self) -> tuple[tuple[int, int], ...]:
        """The exits as a tuple of cells, empty for `none`."""
        return () if self.exit == "none" else _as_cells(self.exit)


def _as_cells(value: Any) -> tuple[tuple[int, int], ...]:
    return value if isinstance(value[0], tuple) else (value,)
