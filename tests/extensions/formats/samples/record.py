# mypy: disable-error-code="import-not-found,import-untyped"
"""Record worlds of other packages as they write them, as samples for the tests.

To repeat the recording, from the top of the repository, in an environment of its own:

    pip install maze-dataset==1.4.2 "muutils<0.9" mazelib==0.9.16 minigrid==3.2.0
    pip install --no-deps gymnasium-robotics==1.4.2
    python tests/extensions/formats/samples/record.py

It writes the JSON files beside this script, each a mapping of names to worlds; `README.md` there
says what they are and under which licences the packages stand.
"""

import ast
import importlib.util
import json
import random
from pathlib import Path
from typing import Any

import gymnasium
import minigrid as minigrid_package  # noqa: F401  (registers its environments)
import numpy as np
from maze_dataset import SolvedMaze
from maze_dataset.generation import LatticeMazeGenerators
from mazelib import Maze
from mazelib.generate.Prims import Prims

MINIGRIDS = (
    *("Empty-5x5", "FourRooms", "LavaCrossingS9N2", "SimpleCrossingS9N1", "DistShift1"),
    *("DoorKey-8x8", "KeyCorridorS3R2", "MultiRoom-N4-S5"),
)
ENVIRONMENTS = (
    *("MiniGrid-LavaGapS5-v0", "MiniGrid-FourRooms-v0", "MiniGrid-DoorKey-8x8-v0"),
    *("MiniGrid-Unlock-v0", "MiniGrid-MultiRoom-N2-S4-v0", "MiniGrid-KeyCorridorS3R2-v0"),
    *("MiniGrid-LockedRoom-v0", "MiniGrid-RedBlueDoors-6x6-v0", "MiniGrid-MemoryS7-v0"),
    *("MiniGrid-Fetch-6x6-N2-v0", "MiniGrid-GoToDoor-5x5-v0", "MiniGrid-GoToObject-6x6-N2-v0"),
    *("MiniGrid-ObstructedMaze-1Dlhb-v0", "MiniGrid-Playground-v0", "MiniGrid-PutNear-6x6-N2-v0"),
    *("MiniGrid-Dynamic-Obstacles-5x5-v0", "MiniGrid-Dynamic-Obstacles-6x6-v0"),
    *("BabyAI-GoToLocalS5N2-v0", "BabyAI-OpenRedDoor-v0", "BabyAI-UnlockToUnlock-v0"),
    *("BabyAI-PutNextS4N1-v0", "BabyAI-OpenTwoDoors-v0", "BabyAI-GoToDoor-v0"),
)
GENERATORS: tuple[tuple[str, tuple[int, int], dict[str, float]], ...] = (
    ("gen_dfs", (5, 5), {}),
    ("gen_wilson", (4, 6), {}),
    ("gen_dfs_percolation", (6, 6), {"p": 0.3}),
    ("gen_percolation", (5, 7), {"p": 0.3}),
)


def maze_dataset() -> dict[str, str]:
    """Return mazes with and without their solutions."""
    random.seed(1)
    np.random.seed(1)  # the package draws from the global generator
    found = {}
    for name, shape, more in GENERATORS:
        maze = getattr(LatticeMazeGenerators, name)(np.array(shape), **more)
        found[name] = maze.as_ascii()
        solved = SolvedMaze.from_lattice_maze(maze, maze.generate_random_path())
        found[f"{name}-solved"] = solved.as_ascii()
    return found


def mazelib() -> dict[str, str]:
    """Return mazes whose entrances are in the outer wall, and one with them inside."""
    found = {}
    for seed, size, outer in ((3, (4, 6), True), (4, (6, 4), True), (5, (3, 3), False)):
        maze = Maze(seed)
        maze.generator = Prims(*size)
        maze.generate()
        maze.generate_entrances(outer, outer)
        found[f"prims-{seed}"] = maze.tostring(entrances=True)
    return found


def minigrid() -> dict[str, str]:
    """Return the text of some environments after a reset."""
    found = {}
    for name in MINIGRIDS:
        env: Any = gymnasium.make(f"MiniGrid-{name}-v0")
        env.reset(seed=3)
        found[name] = env.unwrapped.pprint_grid()
    return found


def minigrid_environments() -> dict[str, Any]:
    """Return grids and tasks of environments after a reset."""
    found = {}
    for name in ENVIRONMENTS:
        made: Any = gymnasium.make(name)
        made.reset(seed=3)
        found[name] = _environment(made.unwrapped)
    return found


def _environment(env: Any) -> dict[str, Any]:
    """Return what the task in an environment depends on, after a reset."""
    width, height = env.grid.width, env.grid.height
    cells = [(x, y) for y in range(height) for x in range(width)]
    things = {cell: env.grid.get(*cell) for cell in cells if env.grid.get(*cell) is not None}

    def place(thing: Any) -> list[int]:
        return next(list(cell) for cell, each in things.items() if each is thing)

    task: dict[str, Any] = {}
    for attribute in ("obj", "door", "red_door", "blue_door"):
        if hasattr(env, attribute):
            task[attribute] = place(getattr(env, attribute))
    for attribute in ("target_pos", "success_pos", "failure_pos"):
        if hasattr(env, attribute):
            task[attribute] = [int(each) for each in getattr(env, attribute)]
    for attribute in ("targetType", "targetColor"):
        if hasattr(env, attribute):
            task[attribute] = getattr(env, attribute)
    if hasattr(env, "obstacles"):
        task["obstacles"] = [place(each) for each in env.obstacles]
    if hasattr(env, "instrs"):
        desc = getattr(env.instrs, "desc", None)
        poss = [[int(each) for each in cell] for cell in desc.obj_poss] if desc else []
        task["instrs"] = {"kind": type(env.instrs).__name__, "cells": poss}
    return {
        "agent": [int(each) for each in env.agent_pos],
        # Beside the last ones: MiniGridEnv, Env, Generic, object.
        "classes": [kind.__name__ for kind in reversed(type(env).__mro__[:-4])],
        "direction": int(env.agent_dir),
        "max_steps": env.max_steps,
        "mission": env.mission,
        "task": task,
        "things": [
            {"at": list(cell), **_thing(thing)}
            for cell, thing in things.items()
            if thing.type != "wall"
        ],
        "walls": [
            "".join("#" if getattr(env.grid.get(x, y), "type", "") == "wall" else " " for x in row)
            for y, row in enumerate([range(width)] * height)
        ],
    }


def _thing(thing: Any) -> dict[str, Any]:
    found = {"type": thing.type, "color": thing.color}
    if thing.type == "door":
        found |= {"is_open": bool(thing.is_open), "is_locked": bool(thing.is_locked)}
    if thing.contains is not None:
        found["contains"] = _thing(thing.contains)
    return found


class _Letters(ast.NodeTransformer):
    """Puts letters in the place of the names that stand for them: R, G and C."""

    def visit_Name(self, node: ast.Name) -> ast.Constant:
        return ast.Constant(node.id.lower())


def gymnasium_robotics() -> dict[str, Any]:
    """Return the maps of the package, whose other modules need a physics engine."""
    spec = importlib.util.find_spec("gymnasium_robotics")
    assert spec is not None
    assert spec.origin is not None
    text = Path(spec.origin).parent.joinpath("envs", "maze", "maps.py").read_text("utf-8")
    found: dict[str, Any] = {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign):
            value = ast.literal_eval(_Letters().visit(node.value))
            found |= {t.id: value for t in node.targets if isinstance(t, ast.Name)}
    return {name: rows for name, rows in found.items() if isinstance(rows, list)}


if __name__ == "__main__":
    for record in (maze_dataset, mazelib, minigrid, minigrid_environments, gymnasium_robotics):
        path = Path(__file__).with_name(f"{record.__name__.replace('_', '-')}.json")
        path.write_text(json.dumps(record(), indent=1, sort_keys=True) + "\n", encoding="utf-8")
