"""The metrics of a level, each computed when it is first read."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from babyrobot_levels.analysis import hardness
from babyrobot_levels.analysis.paths import (
    PossibleSteps,
    connected_components,
    neighbours,
    possible_steps,
    steps_through,
    straightest_path,
)
from babyrobot_levels.analysis.solver.evaluation import evaluation_of
from babyrobot_levels.analysis.solver.model import largest_reward, too_large_to_add_up
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import (
    EpisodeTooLongError,
    Evaluation,
    Solution,
    TooLargeError,
    UndefinedReturnError,
)
from babyrobot_levels.language import kinds
from babyrobot_levels.language.metric_names import (
    BOXES,
    MISTAKES,
    NEEDS,
    PATHS,
    PUSHES,
    SHAPE,
    SOLVED,
    THINGS,
)
from babyrobot_levels.mdp.graph import MANY
from babyrobot_levels.mdp.gridworld import GridWorld, changed, world_of
from babyrobot_levels.mdp.tables import Flags
from babyrobot_levels.registry.later import Shown, later
from babyrobot_levels.render.words.phrases import number
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.words import no_item

_MOST_BELIEFS = 1000
"""So many beliefs are explored for what sight is worth: about as much work as `lint` may do."""


def metrics(level: Any) -> Metrics:
    """Return the metrics of a level.

    Args:
        level: a name, a path, a mapping or a `Level`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
    """
    found = Metrics(world_of(level))
    found.level.grid()
    return found


@dataclass(frozen=True, eq=False, repr=False)
class Metrics(Shown, public=True):
    """The metrics of a level. Each is computed when it is first read.

    - Shape: `cells`, `dead_ends`, `corridors`, `junctions`, `loops`. A wall of glass is a wall.
    - Paths: `states`, `reachable`, `path_length`, `path`, `turns`.
    - Things, only of levels that have some: `items`, `doors`, `switches`, `movers`,
      `configurations`, `detour`.
    - Boxes, only of levels with boxes or targets: `boxes`, `targets`, and `pushes`, for which the
      level is solved.
    - Returns: `best_return`, `best_steps`, `random_return`, `random_steps`, `success`,
      `wet_share`, `difficulty`. Only for these the level is solved. None stands for an undefined
      return and for episodes that are too long (`brl.UndefinedReturnError`,
      `brl.EpisodeTooLongError`).
    - Mistakes: `irreversible`, `decisions`, `fragility`. None as well if the optimal return is
      infinite.
    - What sight is worth: `sight_cost`, which `to_dict` leaves out, as it takes a search.
    - What is needed, only of levels with things: `needs`, `dependencies`, `distractors`. For these,
      the level is compiled, and for the last one solved, once more for each thing.

    Attributes:
        level: the level.
    """

    level: GridWorld

    if not TYPE_CHECKING:
        __getitem__ = no_item

    _html = later("babyrobot_levels.analysis.notebooks:metrics_html")

    def to_dict(self, *, solve: bool = True) -> dict[str, Any]:
        """Return all numbers by their names, those about things for levels that have some.

        Args:
            solve: whether to include those for which the level must be solved, or compiled more
                than once.
        """
        things, needs = (THINGS, NEEDS) if self.level.has_things else ((), ())
        boxes, pushes = (BOXES, PUSHES) if self.level.boxes or self.level.targets else ((), ())
        names = SHAPE + PATHS + things + boxes + (pushes + SOLVED + needs if solve else ())
        return {name: getattr(self, name) for name in names}

    def why_none(self, name: str) -> str:
        """Return why a metric has no value, in words.

        Args:
            name: the name of a metric that is None.
        """
        if name in (*PATHS, "detour", "success", "difficulty", "needs", "dependencies"):
            if not self.level.has_goal:
                return "there is no exit"
            if self.path_length is None and name != "success":
                return "from a start, no path to an exit is known"
        if name in ("needs", "dependencies"):
            return "without the effect of a thing, there would be too many states"
        if name == "sight_cost" and self._seen is not None:
            least, most = self._seen.cost
            return f"it is between {number(least)} and {number(most)}"
        if name in (*MISTAKES, "distractors") and self.best_return is not None:
            if not math.isfinite(self.best_return):
                return "the optimal return is infinite"
            return "after a mistake, returns are undefined, or episodes too long to compute"
        if name == "difficulty" and (self.success is not None or self.best_return == math.inf):
            return "the best policy does not go to an exit"
        if name == "success" and self.best_return == math.inf:
            return "the optimal return is infinite"
        if name == "pushes" and self.solution is not None:
            return "the optimal policy may never end"
        return too_large_to_add_up(largest_reward(self.level.compile())) or (
            "undefined, or episodes are too long to compute"
        )

    def __repr__(self) -> str:
        numbers = (f"{name}={value!r}" for name, value in self.to_dict(solve=False).items())
        return f"<Metrics {', '.join(numbers)}>"

    # -- shape -----------------------------------------------------------------------------

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
        """The number of independent loops: 0 for a perfect maze.

        It is the number of open sides between neighbours, minus the cells, plus the connected
        components of the grid.
        """
        grid = self.level.grid()
        sides = sum(number * self._cells_with(number) for number in range(1, 5))
        if len(grid.open_bits) >= MANY:
            # Blocked cells are components of their own.
            return sides // 2 - len(grid.open_bits) + steps_through(grid).components()
        free = [cell for cell, blocked in enumerate(grid.blocked_cells) if not blocked]
        return sides // 2 - len(free) + connected_components(neighbours(grid), free)

    def _cells_with(self, number: int) -> int:
        bits = self.level.grid().open_bits
        return sum(bits.count(sides) for sides in range(1, 16) if sides.bit_count() == number)

    # -- paths -----------------------------------------------------------------------------

    @cached_property
    def states(self) -> int:
        """The number of states that can occur: in which episodes begin, go on, or end."""
        return int((np.array(self._steps.reached) >= 0).sum())

    @cached_property
    def reachable(self) -> float:
        """The share of the cells that the robot can reach, starts included."""
        reached = np.array(self._steps.reached).reshape(-1, self._cells) >= 0
        return int(reached.any(axis=0).sum()) / self.cells

    @cached_property
    def path_length(self) -> int | None:
        """The number of steps of a shortest path from the start to the nearest exit.

        Each step is one that can happen, with whatever probability: through glass, too. Of several
        starts, the farthest counts. None if from some start no exit can be reached. With things it
        is a path on which the robot takes what doors and exits need.
        """
        return max(self._lengths) if self._lengths else None

    @cached_property
    def path(self) -> tuple[tuple[int, int], ...]:
        """The cells `(x, y)` of such a path, both ends included; empty if there is none.

        Of all shortest paths it is one with the fewest turns, always the same.
        """
        cells, width = self._cells, self.level.size[0]
        at = (state % cells for state in self._straightest[0])
        return tuple((cell % width, cell // width) for cell in at)

    @cached_property
    def turns(self) -> int | None:
        """The number of turns of `path`: steps in another direction than the step before."""
        return self._straightest[1]

    @cached_property
    def _steps(self) -> PossibleSteps:
        return possible_steps(self.level)

    @cached_property
    def _lengths(self) -> list[int]:
        """The length of a shortest path from each start; empty if one of them has none."""
        lengths = [self._steps.to_exit[start] for start in self._starts]
        return lengths if min(lengths) >= 0 else []

    @cached_property
    def _straightest(self) -> tuple[list[int], int | None]:
        if self.path_length is None:
            return [], None
        ways = zip(self._starts, self._lengths, strict=True)
        farthest = [start for start, length in ways if length == self.path_length]
        return straightest_path(self._steps, farthest, self.level.size)

    @property
    def _cells(self) -> int:
        return self.level.size[0] * self.level.size[1]

    @cached_property
    def _starts(self) -> list[int]:
        """The states in which episodes begin."""
        if self.level.has_things:
            return self.level.compile().start.nonzero()[0].tolist()
        return [y * self.level.size[0] + x for x, y in self.level.starts]

    # -- things ----------------------------------------------------------------------------

    @cached_property
    def items(self) -> int:
        """The number of items."""
        return len(self.level.items)

    @cached_property
    def doors(self) -> int:
        """The number of doors."""
        return len(self.level.doors)

    @cached_property
    def switches(self) -> int:
        """The number of switches."""
        return len(self.level.switches)

    @cached_property
    def movers(self) -> int:
        """The number of movers."""
        return len(self.level.movers)

    @cached_property
    def boxes(self) -> int:
        """The number of boxes."""
        return len(self.level.boxes)

    @cached_property
    def targets(self) -> int:
        """The number of targets."""
        return len(self.level.targets)

    @cached_property
    def configurations(self) -> int:
        """The number of configurations: 1 without things."""
        return self.level.compile().num_configurations if self.level.has_things else 1

    @cached_property
    def detour(self) -> int | None:
        """The number of steps that things and wind add to the shortest path; None if there is none.

        It is `path_length` less that of the level with all doors and exits open, without movers and
        without wind. It is below 0 where wind carries the robot.
        """
        if self.path_length is None:
            return None
        fields = (*(kind.field for kind in kinds.THINGS), "exit_needs")
        direct = Metrics(changed(self.level, **dict.fromkeys(fields, ()), wind=None)).path_length
        return None if direct is None else self.path_length - direct

    # -- returns ---------------------------------------------------------------------------

    @cached_property
    def best_return(self) -> float | None:
        """The optimal expected return, as `brl.solve` has it."""
        return None if self.solution is None else self.solution.expected_return

    @cached_property
    def best_steps(self) -> float | None:
        """The expected length of an episode under the optimal policy; inf if it may never end."""
        return None if self.solution is None else self.solution.expected_steps

    @cached_property
    def random_return(self) -> float | None:
        """The expected return of the policy `"random"`, as `brl.evaluate` has it."""
        return None if self._random is None else self._random.expected_return

    @cached_property
    def random_steps(self) -> float | None:
        """The expected length of an episode under the policy `"random"`; inf if it may not end."""
        return None if self._random is None else self._random.expected_steps

    @cached_property
    def success(self) -> float | None:
        """The probability that the optimal policy reaches an exit.

        None without an exit, and if the optimal return is inf: a policy that earns as much need not
        go to an exit, and may.
        """
        if self.solution is None or not self.level.has_goal or self.best_return == math.inf:
            return None
        found = self.solution.exit_probability
        return None if math.isnan(found) else found

    @cached_property
    def wet_share(self) -> float | None:
        """The share, of the states that optimal policies come to, in which there is a puddle.

        They are those of all optimal policies without skids and other chance, both ends included.
        """
        if self.solution is None:
            return None
        wet = {y * self.level.size[0] + x for x, y in (puddle.at for puddle in self.level.puddles)}
        states = np.flatnonzero(hardness.intended_states(self.solution))
        return float(np.isin(states % self._cells, [*wet]).mean())

    @cached_property
    def difficulty(self) -> float | None:
        """How hard it is to find an exit and to stay on the path there: 0 at the least.

        It is `log2(R / L) + log2(B / L)`. L is the length of a shortest path, on average over the
        starts. R and B are the steps that the random and the optimal policy take on average until
        they reach an exit, starting over each time that an episode ends elsewhere: expected steps
        by probability of reaching an exit. So the first part counts how often the path doubles
        for a robot that knows nothing, the second how often for one that knows the level, by
        skidding, bouncing, and detours around what costs.

        It is inf if the random policy may never end, or never reaches an exit. It is None if from
        some start no exit can be reached, if the optimal policy may not go to one, and if episodes
        are too long to compute.
        """
        if not self._lengths:
            return None
        least = sum(self._lengths) / len(self._lengths)
        optimal, at_random = _steps_to_exit(self.solution), _steps_to_exit(self._random)
        if optimal is None or at_random is None or math.isinf(optimal):
            return None
        return math.log2(at_random / least) + math.log2(optimal / least)

    @cached_property
    def pushes(self) -> float | None:
        """The expected number of pushes of boxes under the optimal policy; 0 without boxes.

        It is the least of all optimal policies that end as soon as can be expected. A skid that
        pushes a box counts. None if the optimal policy may never end.
        """
        if not self.level.boxes:
            return 0.0
        if self.solution is None or math.isinf(self.solution.expected_steps):
            return None
        return hardness.fewest_pushes(self.solution)

    @cached_property
    def solution(self) -> Solution | None:
        """The solution of the level, from which the returns are; None if it is undefined."""
        try:
            return solve(self.level)
        except (UndefinedReturnError, EpisodeTooLongError):
            return None

    @property
    def ending(self) -> str | None:
        """How episodes of the optimal policy end that do not end at an exit, in a sentence.

        None if all of them do, and where there is no solution.
        """
        from babyrobot_levels.analysis.endings import ending_of

        ending = None if self.solution is None else ending_of(self.solution)
        return None if ending is None else ending.text

    @cached_property
    def _random(self) -> Evaluation | None:
        try:
            return evaluation_of(self.level, "random")
        except (UndefinedReturnError, EpisodeTooLongError):
            return None

    # -- mistakes --------------------------------------------------------------------------

    @cached_property
    def irreversible(self) -> float | None:
        """The share, of the states that can occur, from which the optimum is lost for ever.

        From these no path leads to a state, or to a hit, to which some optimal policy comes.
        """
        found = self._optimal
        return None if found is None else hardness.lost_share(self.level.compile(), found)

    @cached_property
    def decisions(self) -> int | None:
        """In how many states that optimal policies come to a valid action may lead elsewhere.

        Elsewhere is a state, or a hit that ends the episode, to which no optimal policy comes.
        """
        found = self._optimal
        return None if found is None else hardness.decisions_of(self.level.compile(), found)

    @cached_property
    def fragility(self) -> float | None:
        """How much return a player loses who takes, in one of ten steps, any valid action.

        It is the optimal expected return less that of this player, who follows an optimal policy
        otherwise: of all optimal policies, the one that loses least. It is inf if a mistake can
        cost for ever.
        """
        try:
            return None if self._optimum is None else hardness.loss_by_mistakes(self._optimum)
        except (UndefinedReturnError, EpisodeTooLongError):
            return None

    @property
    def _optimum(self) -> Solution | None:
        """The solution, if the optimal return is finite."""
        is_finite = self.best_return is not None and math.isfinite(self.best_return)
        return self.solution if is_finite else None

    @cached_property
    def _optimal(self) -> Flags | None:
        return None if self._optimum is None else hardness.optimal_ends(self._optimum)

    # -- what sight is worth ---------------------------------------------------------------

    @cached_property
    def sight_cost(self) -> float | None:
        """How much more return one can expect who sees everything than one with a view of 3 cells.

        It is the optimal expected return less that of the sight `view`, as `brl.solve` has it with
        `sight="view"`. None if this is not found exactly within a thousand beliefs, and of several
        robots.
        """
        return self._seen.cost[0] if self._seen is not None and self._seen.is_exact else None

    @cached_property
    def _seen(self) -> Any:
        """The optimum of the sight `view`; None if it is undefined."""
        if self.level.robots:
            return None
        try:
            # Observations are of levels as users have them.
            return solve(self.level.to_dict(whole=True), sight="view", beliefs=_MOST_BELIEFS)
        except (UndefinedReturnError, EpisodeTooLongError, TooLargeError):
            return None

    # -- what is needed --------------------------------------------------------------------

    @cached_property
    def needs(self) -> tuple[str, ...] | None:
        """The names of the items and switches without which no exit can be reached, sorted.

        If such an item could not be taken, or such a switch not be flipped, no path would lead to
        an exit from some start. None if from some start none does in any case, and if more states
        could occur then than a level may have.
        """
        return None if self._needs is None else (*self._needs,)

    @cached_property
    def dependencies(self) -> int | None:
        """How many of `needs` must be had one after the other, at most; None as there.

        A thing comes after another if it can be had from no start without the other.
        """
        return None if self._needs is None else hardness.longest_chain(self._needs)

    @cached_property
    def distractors(self) -> int | None:
        """The number of items and switches that can be had and are of no use for the optimum.

        From last to first, things stay without effect if that does not lower the optimal return.
        """
        return None if self._optimum is None else len(hardness.idle_things(self._optimum))

    @cached_property
    def _needs(self) -> hardness.Needs | None:
        try:
            return hardness.needs_of(self.level) if self._lengths else None
        except LevelError:
            return None


def _steps_to_exit(found: Evaluation | None) -> float | None:
    """Return the expected steps until an exit is reached, over several episodes.

    It is inf if none ever is, and None if episodes are too long to compute.
    """
    if found is None or math.isnan(found.exit_probability):
        return None
    return found.expected_steps / found.exit_probability if found.exit_probability else math.inf
