"""Environments of MiniGrid without the package: as recorded, and with its rules for grids."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

from support.conversions import sample

_VECTORS = ((1, 0), (0, 1), (-1, 0), (0, -1))
_OBJECTS = ("obj", "door", "red_door", "blue_door")


class Grid:
    """A grid of things, as MiniGrid's: row by row, None for nothing."""

    def __init__(self, width: int, height: int):
        self.width, self.height = width, height
        self.grid: list[Any] = [None] * (width * height)

    def get(self, x: int, y: int) -> Any:
        """Return what is in a cell."""
        return self.grid[y * self.width + x]

    def put(self, cell: Sequence[int], thing: dict[str, Any]) -> None:
        """Put a thing into a cell."""
        x, y = cell
        self.grid[y * self.width + x] = _thing(thing)


def _thing(data: dict[str, Any]) -> SimpleNamespace:
    inside = data.get("contains")
    return SimpleNamespace(**data | {"contains": _thing(inside) if inside else None})


class MiniGridEnv:
    """Moves as MiniGrid's source says, on grids of walls, lava, goals and floor."""

    action_space = SimpleNamespace(n=7)
    max_steps = 100

    def __init__(self, grid: Grid, agent: tuple[int, int], direction: int):
        self.grid, self.agent_pos, self.agent_dir = grid, agent, direction
        self.step_count = 0

    @property
    def unwrapped(self) -> MiniGridEnv:
        """The environment itself."""
        return self

    def close(self) -> None:
        """Do nothing."""

    def step(self, action: int) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Turn, or move: lava ends the episode before it is entered."""
        reward, ends = 0.0, False
        if action < 2:
            self.agent_dir = (self.agent_dir + (-1, 1)[action]) % 4
        elif action == 2:
            right, down = _VECTORS[self.agent_dir]
            ahead = self.agent_pos[0] + right, self.agent_pos[1] + down
            kind = getattr(self.grid.get(*ahead), "type", None)
            if kind in (None, "goal", "floor"):
                self.agent_pos = ahead
            ends = kind in ("goal", "lava")
            reward = 1.0 if kind == "goal" else 0.0
        return None, reward, ends, False, {}


def recorded(name: str) -> Any:
    """Return an environment as `samples/record.py` has found it after a reset."""
    data = sample("minigrid-environments")[name]
    grid = Grid(len(data["walls"][0]), len(data["walls"]))
    for y, row in enumerate(data["walls"]):
        for x, mark in enumerate(row):
            if mark == "#":
                grid.put((x, y), {"type": "wall", "color": "grey"})
    for thing in data["things"]:
        grid.put(thing["at"], thing)
    kind: type[MiniGridEnv] = MiniGridEnv
    for each in data["classes"]:
        kind = type(each, (kind,), {})
    env = kind(grid, tuple(data["agent"]), data["direction"])
    for attribute in ("mission", "max_steps"):
        setattr(env, attribute, data[attribute])
    for attribute, value in data["task"].items():
        setattr(env, attribute, _attribute(grid, attribute, value))
    return env


def _attribute(grid: Grid, name: str, value: Any) -> Any:
    if name in _OBJECTS:
        return grid.get(*value)
    if name == "obstacles":
        return [grid.get(*cell) for cell in value]
    if name == "instrs":
        desc = SimpleNamespace(obj_poss=[tuple(cell) for cell in value["cells"]])
        return type(value["kind"], (), {"desc": desc})()
    return value
