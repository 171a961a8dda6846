# mypy: disable-error-code="import-not-found,import-untyped"
"""Record worlds of other packages as they write them, as samples for the tests.

To repeat the recording, from the top of the repository, in an environment of its own:

    pip install maze-dataset==1.4.2 "muutils<0.9" mazelib==0.9.16 minigrid==3.2.0
    pip install --no-deps gymnasium-robotics==1.4.2
    python tests/convert/samples/record.py

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
    for record in (maze_dataset, mazelib, minigrid, gymnasium_robotics):
        path = Path(__file__).with_name(f"{record.__name__.replace('_', '-')}.json")
        path.write_text(json.dumps(record(), indent=1, sort_keys=True) + "\n", encoding="utf-8")
