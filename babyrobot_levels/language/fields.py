"""The fields of a level file: their types, their defaults, and what each means.

Each is valid by itself; `LevelSpec` adds what only the whole level shows.
"""

from collections.abc import Iterator
from enum import Enum, auto
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, PrivateAttr, StringConstraints, WithJsonSchema

from babyrobot_levels.language.base import (
    Cell,
    Cells,
    Integer,
    Model,
    Number,
    Side,
    Size,
    Slug,
    Text,
    cell_or_cells,
    form,
    forms,
)
from babyrobot_levels.language.cells import (
    Area,
    Maze,
    Opening,
    Puddle,
    PuddleTypes,
    Rectangle,
    Rewards,
    SkidLike,
    Wall,
    Warp,
    Weights,
    Wind,
)
from babyrobot_levels.language.drawing import RESERVED
from babyrobot_levels.language.expectations import Expect
from babyrobot_levels.language.kinds import THINGS
from babyrobot_levels.language.looks import Display, ThemeLike
from babyrobot_levels.language.things import (
    Box,
    Door,
    Hit,
    Item,
    LegendEntry,
    Mover,
    NameOrNames,
    Places,
    Switch,
    Target,
    Team,
    TeamRobot,
    as_names,
)

_LEGEND_CHARACTERS = [chr(code) for code in range(33, 127) if chr(code) not in RESERVED]
_LEGEND_KEY = "^[" + "".join(f"\\{c}" if c in "[]\\^" else c for c in _LEGEND_CHARACTERS) + "]$"
LegendKey = Annotated[str, StringConstraints(pattern=_LEGEND_KEY)]

CellOrCells = Annotated[
    Annotated[Cell, form("cell")] | Annotated[Cells, form("cells")],
    forms("a cell `[x, y]`, or a list of cells", cell_or_cells),
]


def _exit_form(value: Any) -> str:
    return "word" if isinstance(value, str) else cell_or_cells(value)


def whole_version(value: Any) -> Any:
    """Take `1.0` for 1, and not `true`."""
    # `Literal[1]` would take `true` for 1, and not take 1.0.
    if isinstance(value, bool):
        return str(value).lower()
    return 1 if value == 1 else value


class Role(Enum):
    """What a field is for. Each field has one, from which lists of fields are derived."""

    FORMAT = auto()
    """How the file is to be read."""
    TEXT = auto()
    """For people, and for finding the level."""
    GEOMETRY = auto()
    """Where cells, walls, starts and exits are."""
    DYNAMICS = auto()
    """What a step does."""
    REWARD = auto()
    """What it pays."""
    LIMIT = auto()
    """How far an episode, or a return, looks ahead."""
    LOOK = auto()
    """How the level is shown."""
    EXPECTATION = auto()
    """What its author says of it, to be held to that."""


def _whole_moves(value: Any) -> Any:
    """Take `8.0` for 8."""
    return int(value) if value in (4, 8) else value


Moves = Annotated[Literal[4, 8], BeforeValidator(_whole_moves), WithJsonSchema({"enum": [4, 8]})]

MAX_ROBOTS = 4
"""The most robots of a level: with each, tables grow by five times the cells."""

DRAWN: Literal["drawn"] = "drawn"
"""Marks the fields that a drawing gives, which therefore cannot be given beside one."""


class LevelFields(Model):
    """A level, version 1 of the language: every field, validated, and frozen."""

    version: Annotated[
        Literal[1], BeforeValidator(whole_version), WithJsonSchema({"const": 1}), Role.FORMAT
    ]
    """The version of the language: 1."""
    name: Annotated[Slug | None, Role.TEXT] = None
    """The name by which code loads the level; the file's name by default."""
    title: Annotated[Text | None, Role.TEXT] = None
    """A title."""
    description: Annotated[Text | None, Role.TEXT] = None
    """A description."""
    author: Annotated[Text | None, Role.TEXT] = None
    """The author."""
    license: Annotated[Text | None, Role.TEXT] = None
    """The licence under which the level may be used."""
    source: Annotated[Text | None, Role.TEXT] = None
    """The publication that the level is from: a citation."""
    tags: Annotated[tuple[Slug, ...], Role.TEXT] = ()
    """Keywords for finding the level."""
    size: Annotated[Size, Role.GEOMETRY, DRAWN] = (3, 3)
    """Width and height in cells."""
    map: Annotated[Text | None, Role.GEOMETRY] = None
    """The level as a drawing, which replaces size, start, exit, puddles and blocked."""
    legend: Annotated[dict[LegendKey, LegendEntry], Role.GEOMETRY] = Field(default_factory=dict)
    """The meaning of further characters of the drawing."""
    start: Annotated[CellOrCells, Role.GEOMETRY, DRAWN] = (0, 0)
    """The start; of several cells, one is drawn at each reset."""
    start_weights: Annotated[Weights, Role.DYNAMICS] = ()
    """How often each start is drawn, compared with the others; by default all are alike."""
    heading: Annotated[Side, Role.DYNAMICS] = "E"
    """Where the robot looks at the start; for `actions="turns"`."""
    exit: Annotated[
        Annotated[Literal["none"], form("word")]
        | Annotated[Cell, form("cell")]
        | Annotated[Cells, form("cells")],
        forms("a cell `[x, y]`, a list of cells, or `none`", _exit_form),
        Role.GEOMETRY,
        DRAWN,
    ] = "none"
    """The exit: a cell, several, or `none`; by default bottom right, or `none` with targets."""
    exit_one_of: Annotated[Places | None, Role.GEOMETRY] = None
    """Cells of which one is drawn at each reset: it is the exit of that episode."""
    exit_weights: Annotated[Weights, Role.DYNAMICS] = ()
    """How often each cell of `exit_one_of` is drawn; by default all are alike."""
    exit_needs: Annotated[NameOrNames, Role.DYNAMICS] = ()
    """The items, switches and targets without which the exits are plain cells."""
    maze: Annotated[Maze | None, Role.GEOMETRY] = None
    """A maze grown from a seed."""
    walls: Annotated[tuple[Wall, ...], Role.GEOMETRY] = ()
    """Walls that are added."""
    openings: Annotated[tuple[Opening, ...], Role.GEOMETRY] = ()
    """Walls that are removed, after the maze and the walls."""
    doors: Annotated[tuple[Door, ...], Role.DYNAMICS] = ()
    """Walls that open, or close, by what the robot holds, has switched on, and has covered."""
    items: Annotated[tuple[Item, ...], Role.DYNAMICS] = ()
    """Things that the robot takes."""
    switches: Annotated[tuple[Switch, ...], Role.DYNAMICS] = ()
    """Cells that flip between off and on as the robot arrives there."""
    boxes: Annotated[tuple[Box, ...], Role.DYNAMICS] = ()
    """Boxes that the robot pushes."""
    targets: Annotated[tuple[Target, ...], Role.DYNAMICS] = ()
    """Cells to push boxes to. Without an exit, the episode ends when all are covered."""
    robots: Annotated[tuple[TeamRobot, ...], Field(max_length=MAX_ROBOTS), Role.DYNAMICS] = ()
    """Several robots, which all move at once; without it there is one."""
    team: Annotated[Team, Role.DYNAMICS] = Field(default_factory=cache(Team.model_construct))
    """What several robots mean to each other."""
    movers: Annotated[tuple[Mover, ...], Role.DYNAMICS] = ()
    """What moves by itself: guards on a path, wanderers in a rectangle."""
    hit: Annotated[Hit, Role.DYNAMICS] = Field(default_factory=cache(Hit.model_construct))
    """What it means to meet a mover."""
    moves: Annotated[Moves, Role.DYNAMICS] = 4
    """How many ways the robot moves: 4, or 8 with the diagonals, as the king in chess."""
    puddles: Annotated[tuple[Puddle, ...], Role.DYNAMICS, DRAWN] = ()
    """Cells that are costly to enter and slippery to leave."""
    puddle_types: Annotated[PuddleTypes, Role.DYNAMICS] = Field(
        default_factory=cache(PuddleTypes.model_construct)
    )
    """Rewards and skids of small and large puddles."""
    areas: Annotated[tuple[Area, ...], Role.DYNAMICS] = ()
    """Rectangles of cells with properties; later ones take precedence."""
    blocked: Annotated[tuple[Rectangle, ...], Role.GEOMETRY, DRAWN] = ()
    """Cells that do not exist, as rectangles."""
    warps: Annotated[tuple[Warp, ...], Role.DYNAMICS] = ()
    """Cells that move the robot to another cell."""
    wind: Annotated[Wind | None, Role.DYNAMICS] = None
    """Wind that pushes the robot in some columns and rows."""
    skid: Annotated[SkidLike | None, Role.DYNAMICS] = None
    """The probability with which the robot skids, on every cell."""
    rewards: Annotated[Rewards, Role.REWARD] = Field(default_factory=cache(Rewards.model_construct))
    """The rewards of a step."""
    discount: Annotated[Number, Field(gt=0, le=1), Role.LIMIT] = 1.0
    """The discount factor that solvers use by default."""
    max_steps: Annotated[Annotated[Integer, Field(ge=1, le=2**53)] | None, Role.LIMIT] = None
    """The time limit: episodes are truncated after this many steps."""
    theme: Annotated[ThemeLike, Role.LOOK] = "default"
    """Colours and widths: the name of a theme, or a mapping."""
    display: Annotated[Display, Role.LOOK] = Field(default_factory=cache(Display.model_construct))
    """What pictures show besides the level itself."""
    expect: Annotated[Expect | None, Role.EXPECTATION] = None
    """What must be true of the level, which is checked: its metrics, as figures or ranges."""

    _drawn: dict[str, int] = PrivateAttr(default_factory=dict)

    def written(self, field: str) -> Iterator[tuple[int, Any]]:
        """Yield the entries of a list that the file gives, with their numbers there.

        Those that a drawing gives come before them in the field, and are left out.
        """
        return enumerate(getattr(self, field)[self._drawn.get(field, 0) :])

    @property
    def starts(self) -> tuple[tuple[int, int], ...]:
        """The starts as a tuple of cells: one or several, or that of each of several robots."""
        if not self.robots:
            return self.common_starts
        return tuple(start for _, start in self.team_starts)

    @property
    def team_starts(self) -> tuple[tuple[TeamRobot, tuple[int, int]], ...]:
        """Several robots, each with its start."""
        given = self.common_starts
        left = iter(given)
        return tuple((robot, robot.start or next(left, given[0])) for robot in self.robots)

    @property
    def common_starts(self) -> tuple[tuple[int, int], ...]:
        """The starts but those that are given with one of several robots."""
        return as_cells(self.start)

    @property
    def exits(self) -> tuple[tuple[int, int], ...]:
        """The cells that are exits, or may be drawn as the exit; empty for `none`.

        Those that only one of several robots may leave by come last.
        """
        own = (robot.exit for robot in self.robots if robot.exit is not None)
        return tuple(dict.fromkeys((*self.common_exits, *own)))

    @property
    def common_exits(self) -> tuple[tuple[int, int], ...]:
        """The exits but those that only one of several robots may leave by."""
        if self.exit_one_of is not None:
            return self.exit_one_of
        return () if self.exit == "none" else as_cells(self.exit)

    def exits_of(self, robot: TeamRobot) -> tuple[tuple[int, int], ...]:
        """Return the exits by which one of several robots may leave."""
        return self.common_exits if robot.exit is None else (robot.exit,)

    @property
    def weights_of_starts(self) -> tuple[int, ...]:
        """How often each start is drawn, compared with the others."""
        return self.start_weights or (1,) * len(self.starts)

    @property
    def weights_of_exits(self) -> tuple[int, ...]:
        """How often each cell of `exit_one_of` is drawn, compared with the others."""
        return self.exit_weights or (1,) * len(self.exit_one_of or ())

    def targets_of(self, warp: Warp) -> tuple[tuple[int, int], ...]:
        """Return the cells to which a warp may lead."""
        return self.starts if isinstance(warp.to, str) else as_cells(warp.to)

    def leads_of(self, warp: Warp) -> tuple[tuple[tuple[int, int], int], ...]:
        """Return the cells to which a warp may lead, each with its weight."""
        cells = self.targets_of(warp)
        weights = self.weights_of_starts if isinstance(warp.to, str) else warp.weights
        return tuple(zip(cells, weights or (1,) * len(cells), strict=True))

    @property
    def has_things(self) -> bool:
        """Whether the level has anything whose state changes during an episode."""
        return self.exit_one_of is not None or any(kind.of(self) for kind in THINGS)

    @property
    def ends_covered(self) -> bool:
        """Whether the episode ends when all targets are covered: there is no exit."""
        return bool(self.targets) and not self.exits

    @property
    def has_goal(self) -> bool:
        """Whether an episode can end by what there is to do: at an exit, or all targets covered."""
        return bool(self.exits or self.targets)

    @property
    def stands_on_grid(self) -> bool:
        """Whether the level has doors or paths, which walls must not cut."""
        return bool(self.doors or any(mover.path for mover in self.movers))

    @property
    def exit_keys(self) -> tuple[str, ...]:
        """The names in `exit_needs`."""
        return as_names(self.exit_needs)


def as_cells(value: Any) -> tuple[tuple[int, int], ...]:
    """Return a cell, or several, as a tuple of cells."""
    return value if isinstance(value[0], tuple) else (value,)


@cache
def fields_with(*marks: Role | Literal["drawn"]) -> tuple[str, ...]:
    """Return the fields, in order, that have one of some roles; `DRAWN` are those of a drawing."""
    return tuple(
        name
        for name, info in LevelFields.model_fields.items()
        if any(mark in info.metadata for mark in marks)
    )
