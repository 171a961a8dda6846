"""The metrics of a level, each worked out when it is asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from babyrobot_levels.analysis.walks import Walks, neighbours, parts, straightest, walks_of
from babyrobot_levels.library.catalogue import load

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Evaluation, Solution
    from babyrobot_levels.library.level import Level

SHAPE = ("cells", "dead_ends", "corridors", "junctions", "loops")
WAYS = ("reachable", "path_length", "turns")
WORTH = ("best_return", "best_steps", "random_return", "random_steps", "wet_share", "difficulty")


def metrics(level: Any) -> Metrics:
    """Return the metrics of a level.

    Args:
        level: a name, a path, a mapping or a `Level`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
    """
    found = Metrics(load(level))
    found.level.grid()
    return found


@dataclass(frozen=True, eq=False, repr=False)
class Metrics:
    """What a level is like, in numbers. Each is worked out when it is first asked for.

    - Its shape: `cells`, `dead_ends`, `corridors`, `junctions`, `loops`. A wall of glass is a wall.
    - Its ways: `reachable`, `path_length`, `path`, `turns`.
    - What it is worth: `best_return`, `best_steps`, `random_return`, `random_steps`, `wet_share`,
      `difficulty`. Only for these the level is solved. Where something cannot be told it is None:
      a total without a value, episodes that are too long (`brl.NoTotalError`, `brl.TooLongError`).

    Attributes:
        level: the level.
    """

    level: Level

    def to_dict(self, *, solve: bool = True) -> dict[str, Any]:
        """Return all numbers by their names.

        Args:
            solve: whether to add those for which the level must be solved.
        """
        return {name: getattr(self, name) for name in SHAPE + WAYS + (WORTH if solve else ())}

    def __repr__(self) -> str:
        told = ", ".join(f"{name}={value!r}" for name, value in self.to_dict(solve=False).items())
        return f"<Metrics {told}>"

    # -- its shape -------------------------------------------------------------------------

    @cached_property
    def cells(self) -> int:
        """The number of cells that are not blocked."""
        return self.level.grid().blocked_cells.count(0)

    @cached_property
    def dead_ends(self) -> int:
        """The number of cells with exactly one open side, starts and exits included."""
        return self._cells_with(1)

    @cached_property
    def corridors(self) -> int:
        """The number of cells with exactly two open sides."""
        return self._cells_with(2)

    @cached_property
    def junctions(self) -> int:
        """The number of cells with three or four open sides."""
        return self._cells_with(3) + self._cells_with(4)

    @cached_property
    def loops(self) -> int:
        """The number of loops that are independent of one another: 0 for a perfect maze.

        They are the pairs of neighbours with nothing between them, minus the cells, plus the parts
        of the grid that do not hang together.
        """
        grid = self.level.grid()
        free = [cell for cell, blocked in enumerate(grid.blocked_cells) if not blocked]
        sides = sum(number * self._cells_with(number) for number in range(1, 5))
        return sides // 2 - len(free) + parts(neighbours(grid), free)

    def _cells_with(self, number: int) -> int:
        bits = self.level.grid().open_bits
        return sum(bits.count(sides) for sides in range(1, 16) if sides.bit_count() == number)

    # -- its ways --------------------------------------------------------------------------

    @cached_property
    def reachable(self) -> float:
        """The share of the cells to which the robot can come, starts included."""
        return sum(steps >= 0 for steps in self._walks.reached) / self.cells

    @cached_property
    def path_length(self) -> int | None:
        """The number of steps of a shortest walk from start to exit, the nearest one.

        Each step is one that can happen, with whatever probability: through glass, too. Of several
        starts, the farthest counts. None if from some start no exit can be reached.
        """
        return max(self._lengths) if self._lengths else None

    @cached_property
    def path(self) -> tuple[tuple[int, int], ...]:
        """The cells `(x, y)` of such a walk, both ends included; empty if there is none.

        Of all that are as short it is one with the fewest turns, always the same.
        """
        return tuple((cell % self._width, cell // self._width) for cell in self._straightest[0])

    @cached_property
    def turns(self) -> int | None:
        """How often `path` turns: where a step goes another way (dx, dy) than the one before it."""
        return self._straightest[1]

    @cached_property
    def _walks(self) -> Walks:
        return walks_of(self.level)

    @cached_property
    def _lengths(self) -> list[int]:
        """The steps of a shortest walk from each start; empty if one of them has none."""
        lengths = [self._walks.to_exit[start] for start in self._starts]
        return lengths if min(lengths) >= 0 else []

    @cached_property
    def _straightest(self) -> tuple[list[int], int | None]:
        if self.path_length is None:
            return [], None
        start = self._starts[self._lengths.index(self.path_length)]
        return straightest(self._walks, start, self._width)

    @property
    def _width(self) -> int:
        return self.level.size[0]

    @property
    def _starts(self) -> list[int]:
        return [y * self._width + x for x, y in self.level.starts]

    # -- what it is worth ------------------------------------------------------------------

    @cached_property
    def best_return(self) -> float | None:
        """The expected return of the best policy, as `brl.solve` has it."""
        return None if self._best is None else self._best.expected_return

    @cached_property
    def best_steps(self) -> float | None:
        """The number of steps that the best policy is expected to take; inf for ever."""
        return None if self._best is None else self._best.expected_steps

    @cached_property
    def random_return(self) -> float | None:
        """The expected return of the policy `"random"`, as `brl.evaluate` has it."""
        return None if self._random is None else self._random.expected_return

    @cached_property
    def random_steps(self) -> float | None:
        """The number of steps that the policy `"random"` is expected to take; inf for ever."""
        return None if self._random is None else self._random.expected_steps

    @cached_property
    def wet_share(self) -> float | None:
        """The share of puddles among the cells of the best policy's way, both ends included.

        It is the way from each start on which nothing goes astray, until the episode is over or a
        cell comes again.
        """
        if self._best is None:
            return None
        wet = {y * self._width + x for x, y in (puddle.at for puddle in self.level.puddles)}
        cells = [cell for start in self._starts for cell in self._best_way(start)]
        return sum(cell in wet for cell in cells) / len(cells)

    @cached_property
    def difficulty(self) -> float | None:
        """How hard it is to find an exit, and to keep to the way there: 0 at the least.

        It is `log2(R / L) + log2(B / L)`. L is the number of steps of a shortest walk, on average
        over the starts. R and B are the steps that the random and the best policy take on average
        until they reach an exit, beginning anew each time that an episode ends elsewhere: expected
        steps by probability of reaching an exit. So the first part counts how often the way doubles
        for a robot that knows nothing, the second how often for one that knows the level, by
        skidding, bouncing, and ways around what costs.

        It is inf if the random policy may be caught for ever. It is None if from some start no exit
        can be reached, if the best policy may not go to one, and if episodes are too long to tell.
        """
        if not self._lengths:
            return None
        least = sum(self._lengths) / len(self._lengths)
        best, at_random = _steps_to_exit(self._best), _steps_to_exit(self._random)
        if best is None or at_random is None or math.isinf(best):
            return None
        return math.log2(at_random / least) + math.log2(best / least)

    @cached_property
    def _best(self) -> Solution | None:
        from babyrobot_levels.analysis.solver.errors import NoTotalError, TooLongError
        from babyrobot_levels.analysis.solver.optimum import solve

        try:
            return solve(self.level)
        except (NoTotalError, TooLongError):
            return None

    @cached_property
    def _random(self) -> Evaluation | None:
        from babyrobot_levels.analysis.solver.errors import NoTotalError, TooLongError
        from babyrobot_levels.analysis.solver.evaluation import evaluate

        try:
            return evaluate(self.level, "random")
        except (NoTotalError, TooLongError):
            return None

    def _best_way(self, start: int) -> list[int]:
        """Return the cells to which the best policy leads from a start if nothing goes astray."""
        assert self._best is not None
        mdp, policy = self.level.compile(), self._best.policy.ravel()
        cells: dict[int, None] = {}
        cell = start
        # The number of states stands for the starts, one of which has come already.
        while cell < mdp.num_states and cell not in cells:
            cells[cell] = None
            if policy[cell] < 0:
                break
            cell = int(mdp.target[cell, policy[cell] + self._best.first_action])
        return list(cells)


def _steps_to_exit(found: Evaluation | None) -> float | None:
    """Return the steps until an exit is reached, episodes beginning anew; None if it never is."""
    if found is None or not found.exit_probability > 0:
        return None
    return found.expected_steps / found.exit_probability
