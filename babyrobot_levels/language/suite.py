"""The fields of a suite file that grows mazes: a family of levels, stated instead of listed."""

from collections.abc import Iterator, Mapping
from functools import cache
from math import comb
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from babyrobot_levels.language.base import Integer, Model, Number, Slug, Text, form, forms
from babyrobot_levels.language.cells import Algorithm, Rewards
from babyrobot_levels.language.expectations import SuiteExpect
from babyrobot_levels.language.fields import whole_version
from babyrobot_levels.language.looks import ThemeLike
from babyrobot_levels.language.metric_names import NEEDS, THINGS
from babyrobot_levels.language.ranges import (
    Counts,
    Numbers,
    PuddleCounts,
    Shares,
    Sizes,
    bounds,
    empty_ranges,
)
from babyrobot_levels.language.things import MAX_BOXED_STATES, Hit
from babyrobot_levels.text.diagnostics import Issue, Key
from babyrobot_levels.text.errors import InvalidDocument

MAX_COUNT = 10**9
MAX_DRAWN = 256
"""Levels whose start is the farthest cell are drawn as a `map`, which must fit into a file."""

Place = Literal["corner", "random", "farthest"]
Share = Annotated[Number, Field(gt=0, le=1)]


class SuiteMaze(Model):
    """How the mazes of a suite are grown; each level has a seed of its own."""

    algorithm: Annotated[
        Annotated[Algorithm, form("word")]
        | Annotated[Annotated[tuple[Algorithm, ...], Field(min_length=1)], form("words")],
        forms(
            "an algorithm, or a list of them",
            lambda value: "words" if isinstance(value, list | tuple) else "word",
        ),
    ] = "depth-first"
    """The algorithm, or several, one of which is drawn for each level."""
    loops: Shares = 0.0
    """The share of dead ends that are opened, or a range of shares."""


class SuiteTexts(Model):
    """What every suite says about itself."""

    BEGINNING: ClassVar[str] = "a suite begins with `version: 1` and `kind: suite`"

    version: Annotated[Literal[1], BeforeValidator(whole_version), WithJsonSchema({"const": 1})]
    """The version of the language: 1."""
    kind: Literal["suite"]
    """What the file is: `suite`."""
    name: Slug | None = None
    """The name by which code loads the suite; the file's name by default."""
    title: Text | None = None
    """A title."""
    description: Text | None = None
    """A description."""
    author: Text | None = None
    """The author."""
    license: Text | None = None
    """The licence under which the suite may be used."""
    source: Text | None = None
    """Where the idea is from: a citation."""
    tags: tuple[Slug, ...] = ()
    """Keywords for finding the suite."""


class SuiteFields(SuiteTexts):
    """A suite of mazes, version 1: what all of them have, and what is drawn for each."""

    seed: Annotated[Integer, Field(ge=0, le=2**53)] = 0
    """What all levels are drawn from: another seed, another suite."""
    count: Annotated[Integer, Field(ge=1, le=MAX_COUNT)]
    """How many levels there are."""
    splits: dict[Slug, Share] = Field(default_factory=dict)
    """The parts of the suite and their shares, which add up to 1. No maze is in two of them."""
    size: Sizes = (8, 5)
    """Width and height in cells, or a range of sizes."""
    maze: SuiteMaze = Field(default_factory=cache(SuiteMaze.model_construct))
    """How the mazes are grown."""
    start: Place = "corner"
    """Where the robot starts: in the top-left `corner`, on a `random` cell, or `farthest` off."""
    exit: Place = "corner"
    """Where the exit is: in the bottom-right `corner`, a `random` dead end, or `farthest` off."""
    puddles: PuddleCounts = 0
    """How many puddles there are, or a range. Cells and kinds are drawn."""
    wind: PuddleCounts = 0
    """How many rows and columns have wind, or a range. Each pushes one cell to one side."""
    keys: PuddleCounts = 0
    """How many keys lie in the maze, or a range. Each is needed on the way to the exit."""
    doors: PuddleCounts | None = None
    """How many doors there are, or a range; by default one for each key."""
    coins: PuddleCounts = 0
    """How many coins there are, or a range."""
    guards: PuddleCounts = 0
    """How many guards walk up and down, or a range."""
    boxes: PuddleCounts = 0
    """How many boxes there are, or a range, each with a target. Levels with boxes have no exit."""
    hit: Hit | None = None
    """What it means to meet a guard; by default the end, at a cost above any way to the exit."""
    detour: Counts | None = None
    """How many steps more the shortest way has than with open doors, without guards and wind."""
    path_length: Counts | None = None
    """The length of the shortest path from start to exit, in steps, with all doors open."""
    dead_ends: Counts | None = None
    """How many cells have exactly one open side."""
    difficulty: Numbers | None = None
    """How hard the levels are, by the metric of that name."""
    expect: SuiteExpect | None = None
    """What must be true of all levels, as in level files; by default, `success: 1` is."""
    rewards: Rewards = Field(default_factory=cache(Rewards.model_construct))
    """The rewards of a step, in all levels."""
    discount: Annotated[Number, Field(gt=0, le=1)] = 1.0
    """The discount factor that solvers use by default."""
    max_steps: Annotated[Integer, Field(ge=1, le=2**53)] | None = None
    """Episodes are truncated after this many steps. No shortest path is longer."""
    theme: ThemeLike = "default"
    """Colours and widths of all levels: a theme's name or a mapping."""

    @model_validator(mode="after")
    def _complete(self) -> Self:
        """Check what only the whole suite shows."""
        errors = [*empty_ranges(self), *empty_ranges(self.maze)]
        if issues := [*(errors or _misfits(self)), *_faulty_splits(self)]:
            raise InvalidDocument(issues)
        return self

    @property
    def algorithms(self) -> tuple[str, ...]:
        """The algorithms as a tuple, also when there is one."""
        given: Any = self.maze.algorithm
        return (given,) if isinstance(given, str) else given

    @property
    def largest(self) -> tuple[int, int]:
        """The largest width and height."""
        most: tuple[int, int] = bounds(self.size)[1]
        return most


def _misfits(suite: SuiteFields) -> Iterator[Issue]:
    """Yield what does not fit into levels of these sizes."""
    (width, height), largest = bounds(suite.size)
    cells = width * height
    if cells <= 2:
        message = f"a level of {cells} cell{'s' * (cells - 1)} is too small to play"
        yield Issue("BR205", ("size",), message, "use at least three cells")
    elif bounds(suite.puddles)[1] > cells - 2:
        message = f"the smallest level has only {cells - 2} cells besides start and exit"
        yield Issue("BR205", ("puddles",), message)
    if bounds(suite.wind)[1] > width + height:
        message = f"the smallest level has only {width + height} rows and columns"
        yield Issue("BR205", ("wind",), message)
    yield from _too_many_things(suite, cells)
    if bounds(suite.boxes)[1]:
        yield from _with_boxes(suite)
    if suite.expect is not None:
        yield from suite.expect.faulty_ranges()
        may_have = any(
            bounds(getattr(suite, name))[1] for name in ("keys", "coins", "guards", "boxes")
        )
        for name in suite.expect.stated if not may_have else ():
            if name in (*THINGS, *NEEDS):
                message = f"only levels with things have `{name}`, and these have none"
                yield Issue("BR326", Key(("expect", name)), message, f"remove `{name}`")
    if suite.start == "farthest" and max(largest) > MAX_DRAWN:
        message = (
            f"levels with `start: farthest` are drawn as a map, at most {MAX_DRAWN} cells wide "
            "and high"
        )
        yield Issue("BR205", ("start",), message, "use `exit: farthest` instead")


MOST_THINGS = {"keys": 8, "doors": 32, "coins": 10, "guards": 4, "boxes": 8}
"""The most of each kind in a level."""


def _too_many_things(suite: SuiteFields, cells: int) -> Iterator[Issue]:
    for name, most in MOST_THINGS.items():
        if (bounds(getattr(suite, name))[1] or 0) > most:
            yield Issue("BR205", (name,), f"a level has at most {most} {name}")
    least_keys, most_keys = bounds(suite.keys)
    if suite.doors is not None:
        fewest, most = bounds(suite.doors)
        if most and not least_keys:
            message = "doors need keys, and a level may have none"
            yield Issue("BR205", ("doors",), message, "ask for at least one key")
        elif fewest < most_keys:
            message = f"{fewest} doors are too few for {most_keys} keys, each of which opens one"
            yield Issue("BR205", ("doors",), message)
    elif suite.detour is not None and not (
        most_keys or bounds(suite.guards)[1] or bounds(suite.wind)[1]
    ):
        yield Issue("BR205", ("detour",), "without keys, guards and wind no way is a detour")
    if suite.hit is not None and not bounds(suite.guards)[1]:
        yield Issue("BR205", ("hit",), "without guards nothing hits the robot")
    needed = most_keys + bounds(suite.coins)[1] + bounds(suite.puddles)[1]
    if needed > cells - 2 and bounds(suite.puddles)[1] <= cells - 2:
        message = f"the smallest level has only {cells - 2} cells besides start and exit"
        yield Issue("BR205", ("keys" if most_keys else "coins",), message)


def _with_boxes(suite: SuiteFields) -> Iterator[Issue]:
    """Yield what levels with boxes do not have, or have too much of."""
    for name in ("puddles", "wind", "keys", "coins", "guards"):
        if bounds(getattr(suite, name))[1]:
            yield Issue("BR205", (name,), f"levels with boxes are made without {name}")
    if suite.exit != "corner":
        yield Issue("BR205", ("exit",), "levels with boxes have no exit")
    if suite.start == "farthest":
        yield Issue("BR205", ("start",), "levels with boxes have no exit to be far from")
    least, most = bounds(suite.boxes)
    if not least:
        message = "there must be a box at least, or none in any level"
        yield Issue("BR205", ("boxes",), message, f"use `1..{most}`")
    cells = suite.largest[0] * suite.largest[1]
    if (states := cells * comb(cells, most)) > MAX_BOXED_STATES:
        message = f"{most} boxes in {cells} cells have {states:,} states, and"
        message += f" {MAX_BOXED_STATES:,} are allowed"
        yield Issue("BR205", ("boxes",), message, "use fewer boxes, or a smaller size")


def impossible(suite: SuiteFields) -> Iterator[Issue]:
    """Yield what no level of these sizes can have."""
    cells = suite.largest[0] * suite.largest[1]
    if suite.path_length is not None:
        least, most = bounds(suite.path_length)
        route = ("path_length",)
        if least > cells - 1:
            message = f"a shortest path in {cells} cells has at most {cells - 1} steps"
            yield Issue("BR205", route, message)
        if most is not None and most < 2:
            yield Issue("BR205", route, "the path from start to exit has at least two steps")
        if suite.max_steps is not None and least > suite.max_steps:
            message = f"a path of {least} steps exceeds `max_steps` ({suite.max_steps})"
            yield Issue("BR205", route, message)
    if suite.dead_ends is not None and bounds(suite.dead_ends)[0] > cells:
        yield Issue(
            "BR205", ("dead_ends",), f"a level of {cells} cells cannot have so many dead ends"
        )


def wrong_shares(splits: Mapping[str, float]) -> Iterator[Issue]:
    """Yield an error if the shares of splits do not add up to 1."""
    total = sum(splits.values())
    if splits and abs(total - 1) > 1e-9:
        yield Issue("BR205", ("splits",), f"the shares add up to {total:g} instead of 1")


def _faulty_splits(suite: SuiteFields) -> Iterator[Issue]:
    if (wrong := [*wrong_shares(suite.splits)]) or not suite.splits:
        yield from wrong
        return
    for name, part in split_ranges(suite).items():
        if not part:
            message = f"`{name}` gets none of the {suite.count} levels"
            yield Issue("BR205", ("splits", name), message, "use more levels, or a larger share")


def split_ranges(suite: SuiteFields) -> dict[str, range]:
    """Return the numbers of the levels of each split: one after the other, in their order."""
    parts: dict[str, range] = {}
    first, total = 0, 0.0
    for name, share in suite.splits.items():
        total += share
        is_last = len(parts) == len(suite.splits) - 1
        end = suite.count if is_last else min(suite.count, int(total * suite.count + 0.5))
        parts[name] = range(first, end)
        first = end
    return parts
