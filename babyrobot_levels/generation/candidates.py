"""Candidates: levels drawn from the suite's seed, the level's number and the attempt alone."""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import cached_property, lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.metrics import Metrics
from babyrobot_levels.analysis.paths import neighbours
from babyrobot_levels.generation.boxes import pulled
from babyrobot_levels.generation.locks import Counts, Placer
from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.cells import Maze, Opening, Puddle, Wind
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.language.kinds import THINGS
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.ranges import bounds
from babyrobot_levels.language.suite import SuiteFields, split_ranges
from babyrobot_levels.language.things import Box, Hit, Target, hit_reward
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.graph import Graph, Successors, distances
from babyrobot_levels.mdp.grid import BIT
from babyrobot_levels.mdp.gridworld import changed
from babyrobot_levels.mdp.mazes.lattice import below
from babyrobot_levels.text import budget

SEED_BITS = 48
"""Bits of a maze's seed: enough that no two levels draw the same one."""

SHARED = [
    name
    for name in fields_with(Role.REWARD, Role.LIMIT, Role.LOOK)
    if name in SuiteFields.model_fields
]
"""The fields of a suite that are fields of its levels."""

PLACED = (*(kind.field for kind in THINGS), "hit", "wind")
"""The fields of levels that are drawn after their mazes, besides puddles, or follow from that."""

SIZES_KEPT = 256

CELL = 60
"""Steps of work for a cell of a candidate."""

TOLERANCE = 1e-6
"""Optima that differ by less are the same."""


class Candidate:
    """A candidate for a level. Its properties are computed when they are asked for.

    Attributes:
        size: width and height in cells.
        start: the index of the start, row by row.
        exit: the index of the exit.
    """

    is_placed = False
    """Whether its things have their places already, and are not drawn when they are asked for."""

    def __init__(
        self, maker: Maker, name: str, rng: random.Random, grown: Level, start: int, exit_: int
    ) -> None:
        self._maker, self._name, self._rng, self._grown = maker, name, rng, grown
        self.size, self.start, self.exit = grown.size, start, exit_

    @cached_property
    def layout(self) -> float:
        """A number in [0, 1) that depends on size and walls alone."""
        grid = self._grown.grid()
        hashed = sha256(f"{grid.width}x{grid.height} ".encode("ascii") + grid.open_bits)
        return int.from_bytes(hashed.digest()[:6], "big") / 2**48

    @cached_property
    def is_playable(self) -> bool:
        """Whether exit and all other cells are reachable, and the exit is not next to the start."""
        grid, maze = self._grown.grid(), self._grown.maze
        is_tree = maze is not None and not maze.loops
        if is_tree and grid.open_bits[self.exit].bit_count() > 1:
            # The exit stands between two parts of the maze.
            return False
        return self.path_length > 1 and min(self._steps) >= 0

    @property
    def path_length(self) -> int:
        """The length of a shortest path from start to exit, with all doors open; -1 if none."""
        return self._steps[self.exit]

    @cached_property
    def has_room(self) -> bool:
        """Whether all its things could be placed, with a way to the exit.

        In wind, there is a way to the exit from wherever the robot gets.
        """
        if self._things is None:
            return False
        if not self._has_more:
            return True
        return self._steps_among_things > 0 and self._is_never_lost

    @cached_property
    def metrics(self) -> Metrics:
        """The metrics of the level."""
        return Metrics(self.level)

    @cached_property
    def is_surely_won(self) -> bool:
        """Whether its rewards alone show that the optimal policy surely reaches the exit.

        Without guards only the exit ends an episode, and it can be reached from everywhere. So this
        holds if every step costs something and there is no discount, or if all steps cost the same,
        and for ever more than the exit.
        """
        suite = self._maker.suite
        rewards = suite.rewards
        others = (rewards.bump, rewards.stay, rewards.closer, rewards.farther)
        steps = {rewards.step, *(reward for reward in others if reward is not None)}
        if self.level.movers:
            return False
        if suite.discount == 1:
            return max(steps) < 0
        is_even = len(steps) == 1 and not self._puddles
        worth = rewards.step if isinstance(rewards.exit, str) else rewards.exit
        return is_even and worth > rewards.step / (1 - suite.discount)

    def value(self, metric: str) -> Any:
        """Return a metric of the level, that which is plain without solving it."""
        is_plain = metric == "success" and self.is_surely_won
        return 1.0 if is_plain else getattr(self.metrics, metric)

    @property
    def states(self) -> int:
        """The number of states of its tables; 0 as long as nothing has asked for these."""
        level = vars(self).get("level")
        return level.compile().num_states if level is not None and "_mdp" in vars(level) else 0

    @property
    def _has_more(self) -> bool:
        """Whether there are things or wind, so that walls alone do not tell the way."""
        return bool(self._things or self._wind)

    @property
    def needs_its_doors(self) -> bool:
        """Whether the optimum would be another one without any of the doors.

        Doors that share a key may stand in one way, where one of them would do.
        """
        doors, level = self.level.doors, self.level
        if not doors or len(doors) > sum(item.picture == "key" for item in level.items):
            return True
        optimum = self.metrics.best_return
        fewer = (doors[:number] + doors[number + 1 :] for number in range(len(doors)))
        others = (Metrics(changed(level, doors=left)).best_return for left in fewer)
        return optimum is not None and all(
            other is not None and other > optimum + TOLERANCE for other in others
        )

    @property
    def detour(self) -> int:
        """How many steps more the shortest way has than `path_length`."""
        return self._steps_among_things - self.path_length if self._has_more else 0

    @cached_property
    def _steps_among_things(self) -> int:
        """The fewest steps to the exit, -1 where it cannot be reached."""
        graph, is_exit = self._graph
        steps = graph.distances(self._first_states)[is_exit]
        return int(min((count for count in steps.tolist() if count >= 0), default=-1))

    @property
    def _is_never_lost(self) -> bool:
        """Whether the exit can be reached from every state in which the robot can get."""
        if not self._wind:
            return True
        graph, is_exit = self._graph
        is_met = graph.distances(self._first_states) >= 0
        leads_out = graph.reversed().distances(np.flatnonzero(is_exit)) >= 0
        return bool(leads_out[is_met].all())

    @property
    def _first_states(self) -> NDArray[np.intp]:
        return np.flatnonzero(self.level.compile().start)

    @cached_property
    def _graph(self) -> tuple[Graph, NDArray[np.bool_]]:
        """Which states lead to which without a hit, and which states are at the exit."""
        mdp = self.level.compile()
        states = np.arange(mdp.num_states)[:, None, None]
        goes_on = (mdp.probability > 0) & ~mdp.is_terminal[:, None, None]
        is_exit = mdp.is_terminal & (np.arange(mdp.num_states) % mdp.cells == self.exit)
        # What ends the episode without being at the exit is a hit.
        goes_on &= ~mdp.terminal | is_exit[mdp.next_state]
        source = np.broadcast_to(states, goes_on.shape)[goes_on]
        return Graph(mdp.num_states, source, mdp.next_state[goes_on]), is_exit

    @property
    def dead_ends(self) -> int:
        """The number of cells with exactly one open side."""
        return Metrics(self._grown).dead_ends

    @cached_property
    def _puddles(self) -> list[tuple[int, str]]:
        """The cells of its puddles, and their sizes. They are drawn before things are."""
        width, height = self.size
        count = _between(self._rng, *bounds(self._maker.suite.puddles))
        return _draw_puddles(self._rng, count, width * height, (self.start, self.exit))

    @cached_property
    def _things(self) -> dict[str, Any] | None:
        """The fields of its things, None where there is no room for them."""
        suite, puddles = self._maker.suite, self._puddles
        keys = _between(self._rng, *bounds(suite.keys))
        doors = keys
        if suite.doors is not None:
            fewest, most = bounds(suite.doors)
            doors = _between(self._rng, max(fewest, keys), most)
        coins = _between(self._rng, *bounds(suite.coins))
        counts = Counts(keys, doors, coins, _between(self._rng, *bounds(suite.guards)))
        if not counts:
            return {}
        taken = {cell for cell, _ in puddles}
        return Placer(self._grown.grid(), self.start, self.exit, self._rng, taken).fields(counts)

    @cached_property
    def _wind(self) -> dict[str, list[int]]:
        """The wind of its columns and rows, drawn after everything else."""
        width, height = self.size
        count = _between(self._rng, *bounds(self._maker.suite.wind))
        wind: dict[str, list[int]] = {}
        for line in _some(self._rng, count, [*range(width + height)]):
            is_column, turns = line < width, self._rng.getrandbits(1)
            side = (("north", "south") if is_column else ("west", "east"))[turns]
            pushes = wind.setdefault(side, [0] * (width if is_column else height))
            pushes[line if is_column else line - width] = 1
        return wind

    @cached_property
    def level(self) -> Level:
        """The level."""
        suite, width, puddles = self._maker.suite, self.size[0], self._puddles
        fields: dict[str, Any] = {
            "name": self._name,
            "start": (self.start % width, self.start // width),
            "exit": (self.exit % width, self.exit // width),
        }
        if puddles:
            fields["puddles"] = tuple(
                Puddle(at=(cell % width, cell // width), size=size) for cell, size in puddles
            )
        fields |= self._things or {}
        if "movers" in fields:
            fields["hit"] = suite.hit or Hit(reward=hit_reward(suite.rewards, self.size))
        if self._wind:
            fields["wind"] = Wind.model_validate(self._wind)
        level = self._grown.model_copy(update=fields)
        return self._maker.drawn(level) if suite.start == "farthest" else level

    @cached_property
    def _steps(self) -> Sequence[int]:
        """The distance of each cell from the start, with the exit as a terminal cell."""
        ahead = neighbours(self._grown.grid())
        ahead[self.exit] = []
        return distances([self.start], ahead)


class Boxed(Candidate):
    """A candidate with boxes, which ends where all targets are covered, and not at an exit."""

    is_surely_won = False
    has_room = True
    detour = 0

    def __init__(
        self, maker: Maker, name: str, rng: random.Random, grown: Level, start: int
    ) -> None:
        super().__init__(maker, name, rng, _opened(grown, rng), start, -1)

    @property
    def path_length(self) -> int:
        """The fewest steps in which all targets are covered."""
        return self.metrics.path_length or -1

    @cached_property
    def is_playable(self) -> bool:
        """Whether its boxes and targets could be placed."""
        return self._boxes is not None

    @cached_property
    def _boxes(self) -> tuple[list[int], list[int]] | None:
        count = _between(self._rng, *bounds(self._maker.suite.boxes))
        return pulled(self._grown.grid(), self.start, count, self._rng)

    @cached_property
    def level(self) -> Level:
        """The level, as a drawing."""
        assert self._boxes is not None
        width = self.size[0]
        boxes, targets = ([(cell % width, cell // width) for cell in each] for each in self._boxes)
        fields: dict[str, Any] = {
            "name": self._name,
            "boxes": tuple(Box(at=cell) for cell in boxes),
            "targets": tuple(Target(at=cell) for cell in targets),
        }
        return self._maker.drawn(changed(self._grown, **fields))


class Maker:
    """Draws the levels of a suite.

    Attributes:
        is_made_of_others: whether they are not grown, but made of other levels.

    Args:
        suite: its fields.
        names: the names of the levels: a text with `{index}` or `{index:05}` in it.
        folder: the folder that may have `themes/` in it.
        first: the index of the first level in its name.
    """

    is_made_of_others = False

    def __init__(
        self, suite: SuiteFields, names: str, folder: Path | None = None, first: int = 0
    ) -> None:
        self.suite, self.names, self.folder, self.first = suite, names, folder, first
        self.splits = split_ranges(suite)
        self.promised: dict[str, Any] = {"success": 1.0}
        """What must be true of all levels' metrics, unless the suite expects something else."""
        self._blank = lru_cache(SIZES_KEPT)(self._make_blank)

    def name(self, number: int) -> str:
        """Return the name of a level."""
        return self.names.format(index=self.first + number)

    def split(self, number: int) -> str | None:
        """Return the split of a level, None without splits."""
        return next((name for name, part in self.splits.items() if number in part), None)

    def layouts(self, number: int) -> tuple[float, float]:
        """Return the bounds of a level's `layout`, which differ between splits."""
        first = 0.0
        for name, share in self.suite.splits.items():
            if number in self.splits[name]:
                is_last = self.splits[name].stop == self.suite.count
                return first, 1.0 if is_last else first + share
            first += share
        return 0.0, 1.0

    def draw(self, number: int, attempt: int) -> Candidate:
        """Return a candidate for a level.

        Raises:
            OverBudgetError: it takes more work than is left.
        """
        suite, rng = self.suite, self._rng(number, attempt)
        (least_wide, least_high), (most_wide, most_high) = bounds(suite.size)
        width = _between(rng, least_wide, most_wide)
        height = _between(rng, least_high, most_high)
        maze = self._draw_maze(rng)
        cells = width * height
        budget.spend(CELL * cells)
        start, exit_ = 0, cells - 1
        if suite.start == "random":
            start = _another(rng, cells, exit_ if suite.exit == "corner" else None)
        grown = _grown(self._blank(width, height), maze, start)
        if bounds(suite.boxes)[1]:
            return Boxed(self, self.name(number), rng, grown, start)
        if suite.exit == "random":
            sides = [bits.bit_count() for bits in grown.grid().open_bits]
            ends = [cell for cell in range(cells) if sides[cell] == 1 and cell != start]
            exit_ = ends[below(rng, len(ends))] if ends else _another(rng, cells, start)
        if "farthest" in (suite.start, suite.exit):
            start, exit_ = _far_apart(suite, neighbours(grown.grid()), start, exit_)
        return Candidate(self, self.name(number), rng, grown, start, exit_)

    def _rng(self, number: int, attempt: int) -> random.Random:
        """Return the generator from which a candidate is drawn."""
        key = sha256(f"{self.suite.seed}/{number}/{attempt}".encode("ascii")).digest()
        return random.Random(int.from_bytes(key, "big"))

    def _draw_maze(self, rng: random.Random) -> dict[str, Any]:
        suite = self.suite
        algorithms = suite.algorithms
        algorithm = algorithms[_between(rng, 0, len(algorithms) - 1)]
        least, most = bounds(suite.maze.loops)
        if least != most:
            least = _between(rng, round(100 * least), round(100 * most)) / 100
        maze: dict[str, Any] = {"seed": rng.getrandbits(SEED_BITS)}
        if algorithm != "depth-first":
            maze["algorithm"] = algorithm
        if least:
            maze["loops"] = least
        return maze

    def _make_blank(self, width: int, height: int) -> Level:
        """Return the empty level of a size."""
        given = plain(self.suite)
        shared = {field: given[field] for field in SHARED if field in given}
        return Level.from_fields(
            {"version": 1, "size": [width, height], "exit": "none", **shared}, folder=self.folder
        )

    def drawn(self, level: Level) -> Level:
        """Return a level as a drawing.

        A maze is generated from its start cell, so a file cannot have both a maze and a start that
        depends on it.
        """
        given = level.to_dict()
        kept = {field: given[field] for field in ("name", *PLACED, *SHARED) if field in given}
        for drawn in ("boxes", "targets"):
            kept.pop(drawn, None)
        return Level.from_fields({"version": 1, "map": level.draw(), **kept}, folder=self.folder)


def _grown(blank: Level, maze: dict[str, Any], start: int) -> Level:
    """Return a level with a maze; without `loops` where they open no dead end."""
    width = blank.size[0]
    cell = (start % width, start // width)
    level = blank.model_copy(update={"maze": Maze.model_validate(maze), "start": cell})
    if "loops" in maze:
        tree = {name: maze[name] for name in maze if name != "loops"}
        plain_maze = blank.model_copy(update={"maze": Maze.model_validate(tree), "start": cell})
        if plain_maze.grid().open_bits == level.grid().open_bits:
            return plain_maze
    return level


def _opened(level: Level, rng: random.Random) -> Level:
    """Return a level without half of the walls of its maze: boxes need room to be pushed around."""
    grid, width = level.grid(), level.size[0]
    openings = tuple(
        Opening(at=(cell % width, cell // width), side=side)
        for cell, bits in enumerate(grid.open_bits)
        for side in SIDES[1:3]
        if not bits & BIT[side] and grid.neighbour(cell, side) is not None and rng.getrandbits(1)
    )
    return changed(level, openings=openings)


def _draw_puddles(
    rng: random.Random, count: int, cells: int, taken: Sequence[int]
) -> list[tuple[int, str]]:
    """Return the cells of puddles, sorted, and their sizes."""
    if not count:
        return []
    chosen = _some(rng, count, [cell for cell in range(cells) if cell not in taken])
    return [(cell, "large" if rng.getrandbits(1) else "small") for cell in chosen]


def _some(rng: random.Random, count: int, free: list[int]) -> list[int]:
    """Draw different numbers, and return them sorted; they are taken out of the list."""
    chosen = []
    for _ in range(count):
        place = below(rng, len(free))
        chosen.append(free[place])
        free[place] = free[-1]
        free.pop()
    return sorted(chosen)


def _between(rng: random.Random, least: int, most: int) -> int:
    return least if least == most else least + below(rng, most - least + 1)


def _another(rng: random.Random, cells: int, taken: int | None) -> int:
    """Draw a cell that is not taken."""
    if taken is None:
        return below(rng, cells)
    cell = below(rng, cells - 1)
    return cell + (cell >= taken)


def _far_apart(suite: SuiteFields, ahead: Successors, start: int, exit_: int) -> tuple[int, int]:
    """Return start and exit, with the ones that are `farthest` as far apart as possible."""
    if suite.start == "farthest":
        # If both are, in a maze without loops: the ends of a longest path.
        start = _farthest(distances([0 if suite.exit == "farthest" else exit_], ahead))
    if suite.exit == "farthest":
        exit_ = _farthest(distances([start], ahead))
    return start, exit_


def _farthest(steps: Sequence[int]) -> int:
    """Return the cell at the largest distance, the first of several."""
    return max(range(len(steps)), key=steps.__getitem__)
