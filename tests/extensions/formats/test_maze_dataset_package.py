"""Mazes and maze-dataset itself: the same moves, the same paths."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from support.conversions import level_of_world, world_of

import babyrobot_levels as brl

pytestmark = [pytest.mark.libraries, pytest.mark.sweep]
maze_dataset: Any = pytest.importorskip(
    "maze_dataset", reason="the package maze-dataset is not installed"
)


@pytest.mark.parametrize("name", ["gen_dfs", "gen_wilson", "gen_kruskal"])
def test_moves_and_shortest_paths_are_those_of_the_package(name: str) -> None:
    generator = getattr(maze_dataset.generation.LatticeMazeGenerators, name)
    random.seed(1)
    np.random.seed(1)
    maze = generator(np.array((5, 7)))
    way = maze.generate_random_path()
    text = maze_dataset.SolvedMaze.from_lattice_maze(maze, way).as_ascii()
    level = level_of_world(world_of(text, "maze-dataset"))
    assert level.size == (7, 5)
    next_state = level.compile().next_state
    for cell in set(range(35)) - {y * 7 + x for x, y in level.exits}:
        found = {*next_state[cell, 1:, 0].tolist()} - {cell}
        beside = maze.get_coord_neighbors(np.array(divmod(cell, 7)))
        assert found == {int(y) * 7 + int(x) for y, x in beside}
    assert brl.metrics(level).path_length == len(way) - 1
