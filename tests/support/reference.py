"""The rules of the level language in plain Python, written from its text and from nothing else.

Slow and straightforward on purpose: dictionaries, loops and one cell at a time. The compiled
tables are held against what `transitions` says.
"""

from __future__ import annotations

import random
from collections import defaultdict
from fractions import Fraction
from typing import Any

World = dict[str, Any]
Cell = tuple[int, int]
Outcomes = dict[tuple[Cell, float, bool], float]
"""Probability by (next cell, reward, terminal)."""

STEPS = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}
BACK = {"N": "S", "S": "N", "E": "W", "W": "E"}
FULL_NAMES = {"north": "N", "east": "E", "south": "S", "west": "W", **{s: s for s in "NESW"}}
ACTIONS = ("stay", "N", "E", "S", "W")
REWARDS = {
    "step": -1.0,
    "exit": 0.0,
    "bump": None,
    "bounce": -1.0,
    "stay": None,
    "closer": None,
    "farther": None,
}
PUDDLES = {"small": {"reward": -2.0, "skid": 0.4}, "large": {"reward": -4.0, "skid": 0.6}}


def ahead(cell: Cell, side: str) -> Cell:
    return cell[0] + STEPS[side][0], cell[1] + STEPS[side][1]


def cells_of(value: Any) -> list[Cell]:
    """Return `[x, y]`, `[[x, y], …]` or `none` as a list of cells."""
    if value == "none":
        return []
    if isinstance(value[0], int):
        return [(value[0], value[1])]
    return [(x, y) for x, y in value]


def rectangle(entry: World) -> list[Cell]:
    (x, y), (width, height) = entry["at"], entry.get("size", (1, 1))
    return [(x + i, y + j) for j in range(height) for i in range(width)]


def along(entry: World) -> list[tuple[Cell, str]]:
    """Return the sides that a wall or an opening covers."""
    x, y = entry["at"]
    side = FULL_NAMES[entry["side"]]
    count = entry.get("length", 1)
    if side in "NS":
        return [((x + i, y), side) for i in range(count)]
    return [((x, y + i), side) for i in range(count)]


class Reference:
    """A level that is played by the book."""

    def __init__(self, world: World):
        self.world = world
        self.width, self.height = world.get("size", (3, 3))
        self.cells = [(x, y) for y in range(self.height) for x in range(self.width)]
        self.blocked = {cell for entry in world.get("blocked", []) for cell in rectangle(entry)}
        self.starts = cells_of(world.get("start", (0, 0)))
        self.exits = cells_of(world.get("exit", (self.width - 1, self.height - 1)))
        self.rewards = {**REWARDS, **world.get("rewards", {})}
        self.warps = {tuple(warp["at"]): warp for warp in world.get("warps", [])}
        # Which sides have a wall, and with which probability it lets the robot through.
        self.walls: dict[tuple[Cell, str], float] = {}
        self.build_walls()

    # -- walls ---------------------------------------------------------------------------

    def put(self, cell: Cell, side: str, chance: float | None) -> None:
        """Put up a wall; without a `chance` one that stands already stays as it is."""
        for key in ((cell, side), (ahead(cell, side), BACK[side])):
            if chance is not None or key not in self.walls:
                self.walls[key] = chance or 0.0

    def take_away(self, cell: Cell, side: str) -> None:
        for key in ((cell, side), (ahead(cell, side), BACK[side])):
            self.walls.pop(key, None)

    def build_walls(self) -> None:
        for cell in self.cells:
            for side in STEPS:
                if ahead(cell, side) not in self.cells or "maze" in self.world:
                    self.put(cell, side, None)
        if "maze" in self.world:
            self.carve(self.world["maze"]["seed"])
        for wall in self.world.get("walls", []):
            for cell, side in along(wall):
                self.put(cell, side, wall.get("pass"))
        for opening in self.world.get("openings", []):
            for cell, side in along(opening):
                self.take_away(cell, side)

    def carve(self, seed: int) -> None:
        rng = random.Random(seed)
        path = [self.starts[0]]
        visited = {self.starts[0]} | self.blocked
        while path:
            cell = path[-1]
            ways = [
                side
                for side in "WESN"
                if ahead(cell, side) in self.cells and ahead(cell, side) not in visited
            ]
            if not ways:
                path.pop()
                continue
            side = rng.choice(ways)
            self.take_away(cell, side)
            visited.add(ahead(cell, side))
            path.append(ahead(cell, side))

    def exists(self, cell: Cell) -> bool:
        return cell in self.cells and cell not in self.blocked

    def is_open(self, cell: Cell, side: str) -> bool:
        """Whether nothing at all closes the side. A wall of glass does."""
        return (
            self.exists(cell) and self.exists(ahead(cell, side)) and (cell, side) not in self.walls
        )

    def glass(self, cell: Cell, side: str) -> float:
        """Return the probability of getting through a wall of glass, 0 where there is none."""
        if not (self.exists(cell) and self.exists(ahead(cell, side))):
            return 0.0
        return self.walls.get((cell, side), 0.0)

    # -- cells ---------------------------------------------------------------------------

    def puddle(self, cell: Cell) -> World | None:
        for puddle in self.world.get("puddles", []):
            if tuple(puddle["at"]) == cell:
                size = puddle.get("size", "small")
                return {**PUDDLES[size], **self.world.get("puddle_types", {}).get(size, {})}
        return None

    def area(self, cell: Cell, what: str) -> Any:
        """Return a property of the last area that has it, or None."""
        found = None
        for area in self.world.get("areas", []):
            if cell in rectangle(area) and area.get(what) is not None:
                found = area[what]
        return found

    def cell_reward(self, cell: Cell) -> float:
        puddle, area = self.puddle(cell), self.area(cell, "reward")
        if puddle is not None:
            return float(puddle["reward"])
        return float(area if area is not None else self.rewards["step"])

    def skid(self, cell: Cell) -> tuple[float, str]:
        puddle, area = self.puddle(cell), self.area(cell, "skid")
        if puddle is not None:
            skid = puddle["skid"]
        elif area is not None:
            skid = area
        else:
            skid = self.world.get("skid") or 0.0
        if isinstance(skid, dict):
            return float(skid["probability"]), skid.get("to", "open")
        return float(skid), "open"

    def is_over(self, cell: Cell) -> bool:
        return cell in self.blocked or cell in self.exits or bool(self.area(cell, "ends"))

    # -- moves ---------------------------------------------------------------------------

    def push(self, cell: Cell) -> tuple[int, int]:
        """Return the wind on a cell: how far east and how far south it pushes."""
        wind = self.world.get("wind") or {}
        x, y = cell

        def strength(side: str, line: int) -> int:
            values = wind.get(side)
            return values[line] if values else 0

        return (
            strength("east", y) - strength("west", y),
            strength("south", x) - strength("north", x),
        )

    def walk(self, cell: Cell, amount: int, axis: int) -> Cell:
        """Walk along an axis (0: east and west) until the amount is gone or a wall is there."""
        side = (("E", "W"), ("S", "N"))[axis][amount < 0]
        for _ in range(abs(amount)):
            if not self.is_open(cell, side):
                break
            cell = ahead(cell, side)
        return cell

    def displacement(self, cell: Cell, side: str) -> tuple[int, int, int]:
        """Return the move's own axis, how far it goes on it, and how far on the other one."""
        axis = 0 if side in "EW" else 1
        push = self.push(cell)
        return axis, STEPS[side][axis] + push[axis], push[1 - axis]

    def pushes_on(self, cell: Cell, side: str) -> bool:
        """Whether a move still goes where it was meant to, with the wind on its own axis."""
        axis, own, _ = self.displacement(cell, side)
        return own * STEPS[side][axis] > 0

    def attempt(self, cell: Cell, side: str) -> tuple[Cell, bool]:
        """Return where a direction leads, glass being a wall, and whether a wall refused it."""
        axis, own, other = self.displacement(cell, side)
        refused = self.pushes_on(cell, side) and not self.is_open(cell, side)
        return self.walk(self.walk(cell, own, axis), other, 1 - axis), refused

    def beyond(self, cell: Cell, side: str) -> Cell:
        """Return where the robot comes to stand that got through the glass on that side."""
        axis, own, other = self.displacement(cell, side)
        rest = own - STEPS[side][axis]
        return self.walk(self.walk(ahead(cell, side), rest, axis), other, 1 - axis)

    def branches(self, cell: Cell, side: str) -> list[tuple[float, Cell, bool, bool]]:
        """Return probability, cell, refused, bounced of all that a move may come to."""
        chance, rule = self.skid(cell)
        glass = self.glass(cell, side) if self.pushes_on(cell, side) else 0.0
        if glass > 0:
            through = glass * (1 - chance)
            behind = ahead(cell, BACK[side])
            back = behind if self.is_open(cell, BACK[side]) else cell
            return [
                (through, self.beyond(cell, side), False, False),
                (1 - through, back, False, True),
            ]
        landing, refused = self.attempt(cell, side)
        if rule == "open":
            if refused:
                return [(1.0, landing, True, False)]
            found = [(1 - chance, landing, False, False)]
            ways = [other for other in STEPS if other != side and self.is_open(cell, other)]
            found += [(chance / len(ways), *self.attempt(cell, way), False) for way in ways]
            if not ways:
                found.append((chance, cell, False, False))
            return found
        others = [other for other in STEPS if other != side]
        if rule == "sides":
            others.remove(BACK[side])
        found = [(1 - chance, landing, refused, False)]
        for other in others:
            found.append((chance / len(others), *self.attempt(cell, other), False))
        return found

    # -- outcomes ------------------------------------------------------------------------

    def arrive(self, cell: Cell) -> list[tuple[float, Cell, float | None]]:
        """Follow the `enter` warps: probability, where one stands, the reward of the warps."""
        reward = None
        while cell in self.warps and self.warps[cell].get("when", "enter") == "enter":
            warp = self.warps[cell]
            if reward is None:
                reward = warp.get("reward")
            if warp["to"] == "start":
                return [(1 / len(self.starts), start, reward) for start in self.starts]
            cell = tuple(warp["to"])
        return [(1.0, cell, reward)]

    def distance(self, cell: Cell) -> Fraction | int:
        return min((cell[0] - x) ** 2 + (cell[1] - y) ** 2 for x, y in self.exits)

    def step_reward(self, before: Cell, after: Cell, refused: bool) -> float:
        """Return the reward of a step in which no warp had a say, without a bounce's."""
        if after in self.exits:
            return float(self.rewards["exit"])
        if refused and self.rewards["bump"] is not None:
            return float(self.rewards["bump"])
        if self.exits:
            change = self.distance(after) - self.distance(before)
            if change < 0 and self.rewards["closer"] is not None:
                return float(self.rewards["closer"])
            if change > 0 and self.rewards["farther"] is not None:
                return float(self.rewards["farther"])
        return self.cell_reward(after)

    def outcomes(self, cell: Cell, action: str) -> Outcomes:
        """Return all that an action can lead to."""
        found: Outcomes = defaultdict(float)
        if self.is_over(cell):
            found[cell, 0.0, True] = 1.0
            return found
        if action == "stay":
            stay = self.rewards["stay"]
            reward = self.cell_reward(cell) if stay is None else float(stay)
            found[cell, reward, False] = 1.0
            return found
        warp = self.warps.get(cell)
        if warp is not None and warp.get("when") == "leave":
            goals = self.starts if warp["to"] == "start" else [tuple(warp["to"])]
            for goal in goals:
                for chance, after, chained in self.arrive(goal):
                    given = warp.get("reward")
                    given = chained if given is None else given
                    reward = self.step_reward(cell, after, False) if given is None else given
                    found[after, float(reward), self.is_over(after)] += chance / len(goals)
            return found
        for probability, landing, refused, bounced in self.branches(cell, action):
            if probability <= 0:
                continue
            for chance, after, given in self.arrive(landing):
                reward = self.step_reward(cell, after, refused) if given is None else float(given)
                if bounced:
                    reward += self.rewards["bounce"]
                found[after, reward, self.is_over(after)] += probability * chance
        return found

    def transitions(self) -> dict[tuple[Cell, str], Outcomes]:
        """Return the outcomes of every cell and action."""
        return {
            (cell, action): self.outcomes(cell, action) for cell in self.cells for action in ACTIONS
        }

    def possible(self, cell: Cell) -> list[int]:
        """Return 1 for each action that nothing refuses."""
        if self.is_over(cell):
            return [1, 0, 0, 0, 0]
        if cell in self.warps and self.warps[cell].get("when") == "leave":
            return [1, 1, 1, 1, 1]
        mask = [1]
        for side in STEPS:
            refused = self.attempt(cell, side)[1] and not self.glass(cell, side)
            mask.append(0 if refused else 1)
        return mask
