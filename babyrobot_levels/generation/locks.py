"""Keys, doors, coins and guards in a maze, such that the level can always be solved.

Doors stand on bridges: passages without which the maze falls into two parts. The first door is on
the way to the exit. Its key is put on the side of the start; the next door is on the way to the
exit or to a key, nearer to the start, and its key nearer still. So each door is needed, and the key
of the last one lies open.
"""

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.things import Door, Item, Mover
from babyrobot_levels.mdp.graph import distances
from babyrobot_levels.mdp.grid import BIT, Grid
from babyrobot_levels.mdp.mazes.lattice import below

KEY_COLORS = {
    "gold": "gold",
    "red": "crimson",
    "blue": "royalblue",
    "green": "seagreen",
    "purple": "rebeccapurple",
    "silver": "silver",
    "pink": "hotpink",
    "brown": "saddlebrown",
}
"""The colours of keys and their doors, by the words of their names."""

COIN_REWARD = 3.0
MOST_TRIES = 20
"""How often a door or a guard's path is drawn until it fits."""

GUARD_CELLS = (3, 5)
"""The fewest and the most cells of a guard's path."""


@dataclass(frozen=True, slots=True)
class Counts:
    """How many things to place."""

    keys: int = 0
    doors: int = 0
    coins: int = 0
    guards: int = 0

    def __bool__(self) -> bool:
        return bool(self.keys or self.doors or self.coins or self.guards)


@dataclass(slots=True)
class Placer:
    """Places things in a maze.

    Attributes:
        grid: walls and cells.
        start: the index of the start.
        exit: the index of the exit.
        rng: what is drawn is drawn from here.
        taken: the indices of cells that stay free of things, start and exit among them.
    """

    grid: Grid
    start: int
    exit: int
    rng: random.Random
    taken: set[int]
    ahead: list[list[int]] = field(init=False)
    doors: list[tuple[int, int, int]] = field(init=False, default_factory=list)
    """The cells on both sides of each door, and the number of its key."""
    keys: list[int] = field(init=False, default_factory=list)

    def __post_init__(self) -> None:
        grid = self.grid
        self.taken |= {self.start, self.exit}
        self.ahead = [
            [
                other
                for side in SIDES
                if grid.open_bits[cell] & BIT[side]
                and (other := grid.neighbour(cell, side)) is not None
            ]
            for cell in range(grid.width * grid.height)
        ]

    def fields(self, counts: Counts) -> dict[str, Any] | None:
        """Return the fields of the things, None where there is no room for all of them."""
        if not self._lock(counts.keys, counts.doors):
            return None
        coins = self._coins(counts.coins)
        guards = self._guards(counts.guards)
        if coins is None or guards is None:
            return None
        names = _key_names(counts.keys)
        items: list[dict[str, Any]] = [
            {"name": name, "at": self._cell(cell), "shape": "key", "color": color}
            for (name, color), cell in zip(names, self.keys, strict=True)
        ]
        items += [
            {"name": name, "at": self._cell(cell), "shape": "coin", "reward": COIN_REWARD}
            for name, cell in zip(_numbered("coin", len(coins)), coins, strict=True)
        ]
        doors = [
            {
                "at": self._cell(one),
                "side": next(side for side in SIDES if self.grid.neighbour(one, side) == other),
                "needs": names[key][0],
                "color": names[key][1],
            }
            for one, other, key in self.doors
        ]
        movers = [
            {"name": name, "path": [self._cell(cell) for cell in path], "back": True}
            for name, path in zip(_numbered("guard", len(guards)), guards, strict=True)
        ]
        fields = {
            "doors": tuple(map(Door.model_validate, doors)),
            "items": tuple(map(Item.model_validate, items)),
            "movers": tuple(map(Mover.model_validate, movers)),
        }
        return {name: values for name, values in fields.items() if values}

    def _cell(self, cell: int) -> tuple[int, int]:
        return cell % self.grid.width, cell // self.grid.width

    # -- doors and keys --------------------------------------------------------------------

    def _lock(self, keys: int, doors: int) -> bool:
        targets = [self.exit]
        for number in range(keys):
            reached = self._reached()
            # Each key that is still to come needs a cell of its own in front of the door.
            edges = [
                edge
                for edge in self._bridges(targets, reached)
                if self._free_before(edge, keys - number)
            ]
            if not edges:
                return False
            self.doors.append((*self._draw(edges), number))
            free = self._far_half(sorted(self._reached() - self.taken))
            if not free:
                return False
            cell = self._draw(free)
            self.keys.append(cell)
            self.taken.add(cell)
            targets.append(cell)
        return all(self._more_door() for _ in range(doors - keys))

    def _reached(self) -> set[int]:
        """Return the cells that can be reached while all doors are closed."""
        return _flood(self.ahead, self.start, {frozenset(door[:2]) for door in self.doors})

    def _bridges(self, targets: Sequence[int], within: set[int]) -> list[tuple[int, int]]:
        """Return the bridges on ways from the start to some cells, in part of the maze."""
        found = set()
        for target in targets:
            for edge in self._way(target):
                if set(edge) <= within and target not in _flood(
                    self.ahead, self.start, {frozenset(edge)}
                ):
                    found.add(edge)
        return sorted(found)

    def _way(self, target: int) -> Iterator[tuple[int, int]]:
        """Yield the passages of a shortest way from the start to a cell, the last one first."""
        steps = distances([self.start], self.ahead)
        while target != self.start:
            before = next(cell for cell in self.ahead[target] if steps[cell] == steps[target] - 1)
            yield before, target
            target = before

    def _free_before(self, edge: tuple[int, int], count: int) -> bool:
        closed = {frozenset(door[:2]) for door in self.doors} | {frozenset(edge)}
        return len(_flood(self.ahead, self.start, closed) - self.taken) >= count

    def _far_half(self, cells: list[int]) -> list[int]:
        """Return the half of some cells that is farther from the start: keys are worth a detour."""
        steps = distances([self.start], self.ahead)
        ordered = sorted(cells, key=lambda cell: (-steps[cell], cell))
        return sorted(ordered[: (len(ordered) + 1) // 2])

    def _more_door(self) -> bool:
        """Place a further door that one of the keys opens, on a bridge of its own."""
        doors = {frozenset(door[:2]) for door in self.doors}
        edges = [
            (cell, other)
            for cell, others in enumerate(self.ahead)
            for other in others
            if cell < other and frozenset((cell, other)) not in doors
        ]
        for _ in range(MOST_TRIES if edges else 0):
            edge = self._draw(edges)
            door = (*edge, below(self.rng, len(self.keys)))
            separates = len(_flood(self.ahead, self.start, {frozenset(edge)})) < len(self.ahead)
            if separates and self._is_solvable([*self.doors, door]):
                self.doors.append(door)
                return True
        return False

    def _is_solvable(self, doors: list[tuple[int, int, int]]) -> bool:
        """Tell whether all keys and the exit can be reached."""
        held: set[int] = set()
        while True:
            closed = {frozenset(door[:2]) for door in doors if door[2] not in held}
            reached = _flood(self.ahead, self.start, closed)
            now = {number for number, cell in enumerate(self.keys) if cell in reached}
            if now == held:
                return len(held) == len(self.keys) and self.exit in reached
            held = now

    # -- coins and guards ------------------------------------------------------------------

    def _coins(self, count: int) -> list[int] | None:
        free = [cell for cell, others in enumerate(self.ahead) if others and cell not in self.taken]
        if len(free) < count:
            return None
        chosen = []
        for _ in range(count):
            cell = free.pop(below(self.rng, len(free)))
            self.taken.add(cell)
            chosen.append(cell)
        return sorted(chosen)

    def _guards(self, count: int) -> list[list[int]] | None:
        """Return a path for each guard, away from start and exit, through no door."""
        doors = {frozenset(door[:2]) for door in self.doors}
        kept = {self.start, self.exit, *self.ahead[self.start], *self.ahead[self.exit]}
        paths: list[list[int]] = []
        for _ in range(count):
            free = [cell for cell, others in enumerate(self.ahead) if others and cell not in kept]
            path = self._path(free, kept, doors)
            if path is None:
                return None
            kept |= set(path)
            paths.append(path)
        return paths

    def _path(
        self, free: list[int], kept: set[int], doors: set[frozenset[int]]
    ) -> list[int] | None:
        """Return the cells of a walk that the robot can pass, None where every try fails."""
        fewest, most = GUARD_CELLS
        for _ in range(MOST_TRIES if free else 0):
            path = [self._draw(free)]
            while len(path) < most:
                ways = self._beside(path, -1, kept, doors)
                if not ways:
                    break
                path.append(self._draw(ways))
            # Beyond its ends the robot is safe, and in a niche beside it the guard passes.
            ends = [self._beside(path, end, kept, doors) for end in (0, -1)]
            niches = [self._beside(path, place, kept, doors) for place in range(1, len(path) - 1)]
            if len(path) >= fewest and all(ends) and any(niches):
                return path
        return None

    def _beside(
        self, path: list[int], place: int, kept: set[int], doors: set[frozenset[int]]
    ) -> list[int]:
        """Return the neighbours of a cell of a path that are not on it, nor behind a door."""
        cell = path[place]
        return [
            other
            for other in self.ahead[cell]
            if other not in kept and other not in path and frozenset((cell, other)) not in doors
        ]

    def _draw(self, choices: Sequence[Any]) -> Any:
        return choices[below(self.rng, len(choices))]


def _flood(ahead: list[list[int]], start: int, closed: set[frozenset[int]]) -> set[int]:
    """Return the cells that can be reached without some passages."""
    seen, stack = {start}, [start]
    while stack:
        cell = stack.pop()
        for other in ahead[cell]:
            if other not in seen and frozenset((cell, other)) not in closed:
                seen.add(other)
                stack.append(other)
    return seen


def _key_names(count: int) -> list[tuple[str, str]]:
    """Return the name and the colour of each key."""
    if count == 1:
        return [("key", KEY_COLORS["gold"])]
    return [(f"{word}-key", color) for word, color in [*KEY_COLORS.items()][:count]]


def _numbered(name: str, count: int) -> list[str]:
    """Return a name for each of several things."""
    return [name] if count == 1 else [f"{name}-{number}" for number in range(1, count + 1)]
