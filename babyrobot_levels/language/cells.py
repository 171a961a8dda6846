"""What a step meets: walls and mazes, puddles, areas, skids, warps and wind, and what it pays."""

from enum import StrEnum
from fractions import Fraction
from functools import cache
from operator import mul
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field

from babyrobot_levels.language.base import (
    MAX_SIZE,
    Cell,
    Cells,
    Flag,
    Integer,
    Model,
    Number,
    Probability,
    Side,
    Size,
    Text,
    cell_or_cells,
    form,
    forms,
)
from babyrobot_levels.language.looks import Color

# -- walls -------------------------------------------------------------------------------------

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
            "an integer or `random`", lambda value: "word" if isinstance(value, str) else "number"
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


# -- cells -------------------------------------------------------------------------------------


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


SkidLike = Annotated[
    Annotated[Probability, form("number")] | Annotated[Skid, form("mapping")],
    forms(
        "a number from 0 to 1, or a mapping",
        lambda value: "mapping" if isinstance(value, dict | Skid) else "number",
    ),
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


Weights = tuple[Annotated[Integer, Field(ge=1, le=100)], ...]
"""How often each of several is drawn, compared with the others; none for all alike.

They are whole numbers, so that a draw from a list in which each stands so often is exact.
"""


class RandomReward(Model):
    """A reward that is drawn each time that it is paid."""

    values: Annotated[tuple[Number, ...], Field(min_length=2, max_length=16)]
    """What it may be."""
    weights: Weights = ()
    """How often each of the values is drawn; by default all are alike."""

    @property
    def weights_of_values(self) -> tuple[int, ...]:
        """How often each of the values is drawn, also where no weights are given."""
        return self.weights or (1,) * len(self.values)

    @property
    def chances(self) -> tuple[tuple[float, float], ...]:
        """The values, each with its probability."""
        weights = self.weights_of_values
        total = sum(weights)
        return tuple(
            (value, weight / total) for value, weight in zip(self.values, weights, strict=True)
        )

    @property
    def mean(self) -> float:
        """Its expected value; by fractions, since sums of large values overflow."""
        weights = self.weights_of_values
        return float(sum(map(mul, map(Fraction, self.values), weights)) / sum(weights))


RewardLike = Annotated[
    Annotated[Number, form("number")] | Annotated[RandomReward, form("mapping")],
    forms(
        "a number, or a mapping",
        lambda value: "mapping" if isinstance(value, dict | RandomReward) else "number",
    ),
]
"""A number, or a `RandomReward`."""


def mean_of(reward: float | RandomReward) -> float:
    """Return a reward, or the expected value of one that is drawn."""
    return reward.mean if isinstance(reward, RandomReward) else reward


class Traits(Model):
    """What the cells of an area have in common."""

    color: Color | None = None
    """The colour of the ground."""
    reward: RewardLike | None = None
    """The reward for entering its cells: a number, or `{values: [-1, 5], weights: [3, 1]}`."""
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

    small: SmallPuddle = Field(default_factory=cache(SmallPuddle.model_construct))
    """Small puddles."""
    large: LargePuddle = Field(default_factory=cache(LargePuddle.model_construct))
    """Large puddles."""


_Strengths = Annotated[
    tuple[Annotated[Integer, Field(ge=0, le=MAX_SIZE)], ...], Field(max_length=MAX_SIZE)
]


class Warp(Model):
    """A cell that moves the robot to another cell."""

    at: Cell
    """The cell."""
    to: Annotated[
        Annotated[Cell, form("cell")]
        | Annotated[Cells, form("cells")]
        | Annotated[Literal["start"], form("word")],
        forms(
            "a cell `[x, y]`, a list of cells, or `start`",
            lambda value: "word" if isinstance(value, str) else cell_or_cells(value),
        ),
    ]
    """The target: a cell, one of several, or `start`."""
    weights: Weights = ()
    """How often each of several cells is the target; by default all are alike."""
    probability: Annotated[Probability, Field(gt=0)] = 1.0
    """The probability with which it acts."""
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
    varies: Flag = False
    """Whether, where it pushes, it is a cell weaker, as given or a cell stronger, evenly."""
    probability: Annotated[Probability, Field(gt=0)] = 1.0
    """The probability with which it blows in a step."""


class Told(NamedTuple):
    """How the rules in words tell a reward: the sample drawn beside it, and what it is for."""

    sample: str
    text: str


class Rewards(Model):
    """The rewards of a step."""

    step: Number = -1.0
    """A step onto a plain cell."""
    exit: Annotated[
        Annotated[Number, form("number")] | Annotated[Literal["cell"], form("word")],
        forms("a number or `cell`", lambda value: "word" if isinstance(value, str) else "number"),
    ] = 0.0
    """A step onto an exit, or that covers the last target; `cell` is the reward of its cell."""
    bump: Annotated[Number | None, Told("wall", "bumping into a wall")] = None
    """A move into a wall."""
    bounce: Number = -1.0
    """Added when the robot bounces off a glass wall."""
    stay: Annotated[Number | None, Told("ground", "staying")] = None
    """The action `stay`, instead of the reward of the cell."""
    meet: Annotated[Number | None, Told("ground", "meeting another robot")] = None
    """A move that another robot hinders, or a collision."""
    closer: Annotated[Number | None, Told("ground", "a step closer to the exit")] = None
    """A step that brings the robot closer to the nearest exit, by Euclidean distance."""
    farther: Annotated[Number | None, Told("ground", "a step away from the exit")] = None
    """A step that takes the robot farther from the nearest exit, by Euclidean distance."""
    push: Annotated[Number | None, Told("ground", "pushing a box")] = None
    """Added when the robot pushes a box."""
    covered: Annotated[Number | None, Told("ground", "covering a target")] = None
    """Added when more targets are covered than before."""
    uncovered: Annotated[Number | None, Told("ground", "uncovering a target")] = None
    """Added when fewer targets are covered than before."""


PRECEDENCE = ("hit", "meet", "warp", "exit", "item", "stay", "bump", "closer", "farther", "step")
"""What a step may pay: the first of these that applies.

`hit`, `warp` and `item` are the rewards that a mover, a warp or an item has of its own. `step` is
that of the cell: of its puddle, its area, or the level. The others are entries of `rewards`.
"""

ADDED = ("bounce", "push", "covered", "uncovered")
"""The rewards that come in addition."""


def gusts(wind: Wind | None) -> tuple[tuple[float, int | None], ...]:
    """Return the winds of a step, that as given first: how likely, and how many cells stronger.

    None stands for no wind.
    """
    chance, strengths = (1.0, (0,)) if wind is None else (wind.probability, _VARYING[wind.varies])
    calm = ((1.0 - chance, None),) if chance < 1 else ()
    return (*((chance / len(strengths), stronger) for stronger in strengths), *calm)


_VARYING = {False: (0,), True: (0, -1, 1)}


def shifts(
    wind: Wind | None, width: int, height: int, stronger: int | None = 0
) -> tuple[list[int], list[int]]:
    """Return the net push: for each column how far south, for each row how far east (in cells).

    Args:
        wind: the wind.
        width: the number of columns.
        height: the number of rows.
        stronger: by how many cells it pushes farther, where it pushes; None for no wind.
    """

    def strengths(values: Any, count: int) -> list[int]:
        return list(values) if values is not None and stronger is not None else [0] * count

    def push(forth: int, back: int) -> int:
        net = forth - back
        return net + (stronger or 0) * ((net > 0) - (net < 0))

    wind = wind or Wind()
    north, south = strengths(wind.north, width), strengths(wind.south, width)
    west, east = strengths(wind.west, height), strengths(wind.east, height)
    return [*map(push, south, north)], [*map(push, east, west)]
