"""A level with its walls, its exact tables and its digest: all that pictures and solvers need."""

from __future__ import annotations

import operator
import os
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeVar

from babyrobot_levels import mdp
from babyrobot_levels.language.cells import Maze
from babyrobot_levels.language.documents import check_document, error_in_mapping, level_from_mapping
from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.language.validation import Checked
from babyrobot_levels.mdp.actions import NUM_MOVES
from babyrobot_levels.mdp.grid import (
    Grid,
    build_grid,
    check_placement,
    grid_with_doors,
    placement_issues,
)
from babyrobot_levels.mdp.numeric import is_numeric
from babyrobot_levels.text import budget
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError, UnplayableError

if TYPE_CHECKING:
    from babyrobot_levels.language.suite_list import AnySuite
    from babyrobot_levels.mdp.configurations import Configuration, Things
    from babyrobot_levels.mdp.tables import Mdp, Numbering


class GridWorld(LevelSpec):
    """A valid level that knows what it comes to."""

    @classmethod
    def from_fields(
        cls, fields: Mapping[str, Any], *, name: str | None = None, folder: Path | None = None
    ) -> Self:
        """Return the level that a mapping of the language's fields gives.

        Args:
            fields: the fields. NumPy's numbers and arrays, tuples and models are taken too.
            name: the level's name, if the mapping gives none.
            folder: where `themes/` may stand.

        Raises:
            LevelError: the mapping is not a valid level. The diagnostics point into the mapping
                as it would be written in a file.
        """
        level = level_from_mapping(fields, cls, name=name, folder=folder)
        is_fixed = level.stands_on_grid and not level.has_random_maze
        if is_fixed and (issues := placement_issues(level, level.grid())):
            raise error_in_mapping(fields, issues)
        return level

    def __getstate__(self) -> dict[Any, Any]:
        """Return what is pickled: the fields. What is compiled from them can be made again."""
        state = super().__getstate__()
        fields = type(self).model_fields
        return {**state, "__dict__": {k: v for k, v in state["__dict__"].items() if k in fields}}

    def grid(self) -> Grid:
        """Return walls and cells after the maze. The grid is made once and shared.

        Doors are open in it; see `grid_at`.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        return self._grid

    def compile(self) -> Mdp:
        """Return the exact tables. They are made once, shared, and read-only.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        mdp = self._mdp
        budget.check_tables(mdp.num_states, mdp.probability.shape[2], mdp.num_actions)
        return mdp

    def numbering(self) -> Numbering:
        """Return how states are numbered: the tables, or what steps robots that have too many.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        return self._numbering

    def things(self) -> Things:
        """Return the things whose state changes during an episode, and what their values mean."""
        return self._things

    def configuration(self, number: int) -> Configuration:
        """Return what is where in a configuration of the tables, by its number.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
            IndexError: there is no such configuration.
        """
        configurations = self.numbering().configurations
        try:
            return self.things().at(configurations[number].tolist())
        except IndexError:
            message = f"there is no configuration {number}: there are {len(configurations)}"
            raise IndexError(message) from None

    def grid_at(self, configuration: int) -> Grid:
        """Return walls and cells in a configuration: with a wall at each closed door.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
            IndexError: there is no such configuration.
        """
        if not self.doors:
            return self.grid()
        return grid_with_doors(self, self.grid(), self.configuration(configuration).doors)

    @property
    def digest(self) -> str:
        """`sha256:…` of the compiled level: the same for equivalent MDPs, however written.

        It is computed once.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        return self._digest

    @cached_property
    def _grid(self) -> Grid:
        return build_grid(self)

    @cached_property
    def _things(self) -> Things:
        from babyrobot_levels.mdp.configurations import Things

        # A copy, as they keep it: in a circle, large tables would outlive their level for long.
        return Things(self.model_copy())

    @cached_property
    def _mdp(self) -> Mdp:
        from babyrobot_levels.mdp.compiler import compile_mdp

        return compile_mdp(self, self.grid())

    @cached_property
    def _numbering(self) -> Numbering:
        if not self.robots or "_mdp" in vars(self):
            return self.compile()
        from babyrobot_levels.mdp.compiler.joint import exceed
        from babyrobot_levels.mdp.compiler.things import stepper

        robots = stepper(self, self.grid())
        try:
            return robots if exceed(robots) else self.compile()
        except UnplayableError:
            return robots

    @cached_property
    def _digest(self) -> str:
        from babyrobot_levels.mdp.tables import digest

        return digest(self, self.grid(), self.compile())

    def with_maze_seed(self, seed: int) -> Self:
        """Return the level with the maze that grows from `seed`.

        Raises:
            LevelError: the level has no maze, or the seed is not an integer.
        """
        if self.maze is None:
            raise LevelError(message="the level has no maze, so it takes no seed")
        if isinstance(seed, bool) or not hasattr(seed, "__index__"):
            raise LevelError(message=f"the seed of a maze must be an integer, not {seed!r}")
        fields = {**self.maze.model_dump(exclude_unset=True), "seed": operator.index(seed)}
        return changed(self, maze=Maze.model_validate(fields))

    def draw(self) -> str:
        """Return the level as the language's ASCII drawing, which a `map` may contain.

        A drawing shows size, starts, exits, walls, puddles and blocked cells, and the characters
        of the level's legend. A cell shows one thing: a start or an exit hides a puddle.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        from babyrobot_levels.language.drawing import compose
        from babyrobot_levels.mdp.drawn import drawing_of

        return compose(drawing_of(self, self.grid()))

    def replace(self, **fields: Any) -> Self:
        """Return a level with other values for some fields; None removes a field.

        Raises:
            LevelError: the level would not be valid.
        """
        data = {**self.to_dict(), **fields}
        given = {name: value for name, value in data.items() if value is not None}
        name = self.name if "name" not in fields else None
        other = self.from_fields(given, name=name, folder=self._folder)
        other._origin = self._origin
        return other

    def resolve(self) -> Self:
        """Return the same level with its maze written out as walls, without `maze` and `openings`.

        A level without a maze is returned as it is.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        from babyrobot_levels.mdp.drawn import resolved_fields

        if self.maze is None:
            return self
        return self.replace(**resolved_fields(self, self.grid()))


WorldT = TypeVar("WorldT", bound=GridWorld)


def changed(level: WorldT, **fields: Any) -> WorldT:
    """Return a level with other values for fields, not validated.

    Of what affects the grid, these may be the maze and its openings.
    """
    other = level.model_copy(update=fields)
    grid = () if fields.keys().isdisjoint({"maze", "openings"}) else ("_grid",)
    for name in ("_things", "_mdp", "_numbering", "_digest", *grid):
        other.__dict__.pop(name, None)
    return other


def check_world(
    document: Document, model: type[WorldT], path: Path | None = None
) -> Checked[WorldT] | Checked[AnySuite]:
    """Check a level or a suite, whichever the document says it is, without what a suite lists.

    Args:
        document: the document.
        model: the class of the level.
        path: the file that it is from: it gives the name, and themes beside it.
    """
    checked = check_document(document, model, path)
    return playable(checked, document) if isinstance(checked.value, GridWorld) else checked


def playable(checked: Checked[WorldT], document: Document) -> Checked[WorldT]:
    """Refuse a level that cannot be played, where its fields leave that open by compiling it.

    Without NumPy that is not tried; what takes too long is found out when it is compiled. Several
    robots are played without tables where these would be too large.
    """
    level = checked.value
    budget.begin()
    if level is None or level.has_random_maze:
        return checked
    # What most levels need not import.
    from babyrobot_levels.mdp.configurations import surely_fits

    try:
        if is_numeric() and not surely_fits(level):
            from babyrobot_levels.mdp.compiler import checked_mdp

            with budget.within(budget.CHECKED):
                mdp = checked_mdp(level, level.grid())
            if mdp is not None:
                vars(level)["_mdp"] = mdp
        elif level.stands_on_grid:
            check_placement(level, level.grid())
    except budget.OverBudgetError:
        pass
    except UnplayableError as error:
        found = sorted(map(document.diagnostic, error.issues), key=lambda at: (at.line, at.column))
        return Checked(None, found)
    return checked


def check_one_robot(level: LevelSpec, what: str) -> None:
    """Check that a level has one robot, where several are not known.

    Args:
        level: the level.
        what: what is only for levels with one robot, in the plural.

    Raises:
        LevelError: it has several.
    """
    if level.robots:
        raise LevelError(
            message=f"the level has {len(level.robots)} robots, and {what} are only for levels "
            "with one; `brl.solve`, `brl.TeamEnv`, `brl.parallel_env` and `brl.TextTeam` take "
            "several"
        )


def check_four_moves(level: LevelSpec, what: str) -> None:
    """Check that the robot of a level has four moves, where diagonal ones are not known.

    Args:
        level: the level.
        what: what is only for levels with four moves, in the plural.

    Raises:
        LevelError: it has eight.
    """
    if level.moves > NUM_MOVES:
        raise LevelError(
            message=f"the level has `moves: {level.moves}`, and {what} are only for levels with "
            "four moves; `brl.solve`, `level.make` and pages take eight"
        )


LevelLike = str | os.PathLike[str] | Mapping[str, Any] | GridWorld
"""What `babyrobot_levels.load` takes: a name, a path, a share code, a mapping, or a level."""


def world_of(level: LevelLike) -> GridWorld:
    """Return a level that may be given by its name, as the public `load` does.

    This is the one place where an earlier room asks the library for a level.
    """
    if isinstance(level, GridWorld):
        return level
    found: GridWorld = mdp.public("load")(level)
    return found
