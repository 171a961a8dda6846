"""Tries: levels drawn from the suite's seed, the level's number and the try's, and nothing else."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from babyrobot_levels.level import Level, plain
from babyrobot_levels.maze.draws import below
from babyrobot_levels.measures.metrics import Metrics
from babyrobot_levels.measures.walks import distances, neighbours
from babyrobot_levels.reading import from_mapping
from babyrobot_levels.spec.cells import Puddle
from babyrobot_levels.spec.ranges import bounds
from babyrobot_levels.spec.suite import SuiteFields, split_ranges
from babyrobot_levels.spec.walls import Maze

SEED_BITS = 48
"""Mazes have seeds of so many bits: too many for two levels to draw the same one."""

SHARED = ("rewards", "discount", "max_steps", "theme")
"""What a suite says of all its levels in the words of a level."""

SIZES_KEPT = 256


@dataclass(frozen=True, slots=True)
class Candidate:
    """A level that was drawn, and what conditions ask about it.

    Attributes:
        level: the level.
        path_length: the number of steps of a shortest walk from start to exit; None if the robot
            cannot come to the exit and to all other cells.
        layout: a number in [0, 1) that size and open sides alone decide.
    """

    level: Level
    path_length: int | None
    layout: float

    @property
    def dead_ends(self) -> int:
        """The number of cells with exactly one open side."""
        return Metrics(self.level).dead_ends

    @property
    def difficulty(self) -> float | None:
        """How hard the level is, None where it cannot be told."""
        return Metrics(self.level).difficulty


class Maker:
    """Draws the levels of a suite.

    Args:
        suite: what it states.
        names: what levels are called: a text with `{index}`, or `{index:05}`, in it.
        folder: where `themes/` may stand.
    """

    def __init__(self, suite: SuiteFields, names: str, folder: Path | None = None) -> None:
        self.suite, self.names, self.folder = suite, names, folder
        self.splits = split_ranges(suite)
        self._blank = lru_cache(SIZES_KEPT)(self._make_blank)

    def name(self, number: int) -> str:
        """Return what a level is called."""
        return self.names.format(index=number)

    def split(self, number: int) -> str | None:
        """Return the split that a level is in, None where there are none."""
        return next((name for name, part in self.splits.items() if number in part), None)

    def layouts(self, number: int) -> tuple[float, float]:
        """Return between which bounds the layout of a level lies: splits share no layout."""
        first = 0.0
        for name, share in self.suite.splits.items():
            if number in self.splits[name]:
                is_last = self.splits[name].stop == self.suite.count
                return first, 1.0 if is_last else first + share
            first += share
        return 0.0, 1.0

    def draw(self, number: int, attempt: int) -> Candidate:
        """Return a try at a level."""
        suite = self.suite
        key = sha256(f"{suite.seed}/{number}/{attempt}".encode("ascii")).digest()
        rng = random.Random(int.from_bytes(key, "big"))
        (least_wide, least_high), (most_wide, most_high) = bounds(suite.size)
        width = _between(rng, least_wide, most_wide)
        height = _between(rng, least_high, most_high)
        maze = self._draw_maze(rng)
        cells = width * height
        start, exit_ = 0, cells - 1
        if suite.start == "random":
            start = _another(rng, cells, exit_ if suite.exit == "corner" else None)
        level = _grown(self._blank(width, height), maze, start)
        ahead = neighbours(level.grid())
        if suite.exit == "random":
            ends = [cell for cell, ways in enumerate(ahead) if len(ways) == 1 and cell != start]
            exit_ = ends[below(rng, len(ends))] if ends else _another(rng, cells, start)
        if suite.start == "farthest":
            # If both are to be far apart: in a maze without loops, the ends of a longest path.
            start = _farthest(distances([0 if suite.exit == "farthest" else exit_], ahead))
        if suite.exit == "farthest":
            exit_ = _farthest(distances([start], ahead))
        ahead[exit_] = []
        steps = distances([start], ahead)
        puddles = _draw_puddles(rng, _between(rng, *bounds(suite.puddles)), cells, (start, exit_))
        fields = {
            "name": self.name(number),
            "start": (start % width, start // width),
            "exit": (exit_ % width, exit_ // width),
            "puddles": tuple(
                Puddle(at=(cell % width, cell // width), size=kind) for cell, kind in puddles
            ),
        }
        level = level.model_copy(update={key: fields[key] for key in fields if fields[key]})
        if suite.start == "farthest":
            level = self._drawn(level)
        return Candidate(level, steps[exit_] if min(steps) >= 0 else None, _layout(level))

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
        """Return the level of a size in which nothing is drawn yet."""
        given = plain(self.suite)
        shared = {field: given[field] for field in SHARED if field in given}
        return from_mapping(
            {"version": 1, "size": [width, height], "exit": "none", **shared}, folder=self.folder
        )

    def _drawn(self, level: Level) -> Level:
        """Return a level as a drawing.

        A maze grows from the start: where that is chosen by the maze, the file cannot say both.
        """
        given = level.to_dict()
        kept = {field: given[field] for field in ("name", *SHARED) if field in given}
        return from_mapping({"version": 1, "map": level.draw(), **kept}, folder=self.folder)


def _grown(blank: Level, maze: dict[str, Any], start: int) -> Level:
    """Return a level with a maze; its loops are left out where no dead end is opened up."""
    width = blank.size[0]
    cell = (start % width, start // width)
    level = blank.model_copy(update={"maze": Maze.model_validate(maze), "start": cell})
    if "loops" in maze:
        tree = {name: maze[name] for name in maze if name != "loops"}
        plain_maze = blank.model_copy(update={"maze": Maze.model_validate(tree), "start": cell})
        if plain_maze.grid().open_bits == level.grid().open_bits:
            return plain_maze
    return level


def _draw_puddles(
    rng: random.Random, count: int, cells: int, taken: Sequence[int]
) -> list[tuple[int, str]]:
    """Return cells, in their order, and the sizes of their puddles."""
    if not count:
        return []
    free = [cell for cell in range(cells) if cell not in taken]
    chosen = []
    for _ in range(count):
        place = below(rng, len(free))
        chosen.append(free[place])
        free[place] = free[-1]
        free.pop()
    return [(cell, "large" if rng.getrandbits(1) else "small") for cell in sorted(chosen)]


def _between(rng: random.Random, least: int, most: int) -> int:
    return least if least == most else least + below(rng, most - least + 1)


def _another(rng: random.Random, cells: int, taken: int | None) -> int:
    """Draw a cell that is not taken."""
    if taken is None:
        return below(rng, cells)
    cell = below(rng, cells - 1)
    return cell + (cell >= taken)


def _farthest(steps: Sequence[int]) -> int:
    """Return the cell that is the most steps away, the first of several."""
    return max(range(len(steps)), key=steps.__getitem__)


def _layout(level: Level) -> float:
    grid = level.grid()
    hashed = sha256(f"{grid.width}x{grid.height} ".encode("ascii") + grid.open_bits)
    return int.from_bytes(hashed.digest()[:6], "big") / 2**48
