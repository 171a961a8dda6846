"""A level with its walls, its exact tables and its digest: all that pictures and solvers need."""

from __future__ import annotations

import operator
from functools import cached_property
from typing import TYPE_CHECKING, Self

from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.language.walls import Maze
from babyrobot_levels.mdp.grid import Grid, build_grid
from babyrobot_levels.text.errors import LevelError

if TYPE_CHECKING:
    from babyrobot_levels.mdp.configurations import Configuration, Things
    from babyrobot_levels.mdp.tables import Mdp


class GridWorld(LevelSpec):
    """A valid level that knows what it comes to."""

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
        return self._mdp

    def things(self) -> Things:
        """Return the things whose state changes during an episode, and what their values mean."""
        return self._things

    def configuration(self, number: int) -> Configuration:
        """Return what is where in a configuration of the tables, by its number.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
            IndexError: there is no such configuration.
        """
        return self.things().at(self.compile().configurations[number].tolist())

    def grid_at(self, configuration: int) -> Grid:
        """Return walls and cells in a configuration: with a wall at each closed door.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
            IndexError: there is no such configuration.
        """
        if not self.doors:
            return self.grid()
        from babyrobot_levels.mdp.doors import grid_with_doors

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

        return Things(self)

    @cached_property
    def _mdp(self) -> Mdp:
        from babyrobot_levels.mdp.compiler import compile_mdp

        return compile_mdp(self, self.grid())

    @cached_property
    def _digest(self) -> str:
        from babyrobot_levels.mdp.digest import digest

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
        maze = Maze.model_validate(fields)
        other = self.model_copy(update={"maze": maze})
        for name in ("_grid", "_things", "_mdp", "_digest"):
            other.__dict__.pop(name, None)
        return other

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
