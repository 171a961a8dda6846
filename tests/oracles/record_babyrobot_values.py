# mypy: disable-error-code="import-not-found,import-untyped"
"""Record what the ValueIteration of PyPI babyrobot 1.0.40 says of mazes with puddles.

To repeat the recording, in the environment that `record_babyrobot.py` tells of:

    python tests/oracles/record_babyrobot_values.py

It writes `babyrobot_values.json` beside this script, the same bytes each time. The package's
ValueIteration contradicts its own model where a puddle lies in a dead end: a failed move out of it
stays in the model, and here goes on to the neighbour. Such puddles are left out, and every world
begins at [0, 0], because the package takes a coordinate of 0 for one that is not given.
"""

import json
import random
from pathlib import Path
from typing import Any

from babyrobot.envs.baby_robot_interface import BabyRobotInterface
from babyrobot.envs.lib.grid_base import Puddle
from babyrobot.envs.lib.maze import Maze
from babyrobot.lib.value_iteration import ValueIteration

THRESHOLD = 1e-9


def record(number: int) -> dict[str, Any]:
    rng = random.Random(number)
    width, height = rng.randint(3, 9), rng.randint(3, 7)
    seed, discount = rng.randrange(10**6), rng.choice((0.5, 0.9, 0.97, 1.0))
    maze = Maze(width, height, 0, 0, seed=seed)
    maze.make_maze()
    cells = [(x, y) for y in range(height) for x in range(width)]
    end = rng.choice(cells[1:])
    wide = [
        cell
        for cell in cells
        if cell != end and sum(maze.cell_at(*cell).walls[side] for side in "NESW") < 3
    ]
    puddles = {cell: rng.choice((1, 2)) for cell in rng.sample(wide, len(wide) // 2)}
    env = BabyRobotInterface(
        width=width,
        height=height,
        add_maze=True,
        maze_seed=seed,
        end=end,
        puddles=[(cell, Puddle(size)) for cell, size in puddles.items()],
    )
    learner = ValueIteration(env, discount)
    learner.run_to_convergence(max_iterations=10_000, threshold=THRESHOLD)
    level = {
        "version": 1,
        "size": (width, height),
        "exit": end,
        "maze": {"seed": seed},
        "puddles": [
            {"at": cell, "size": ("small", "large")[size - 1]} for cell, size in puddles.items()
        ],
        # The package chooses among moves that no wall refuses, and knows no waiting.
        "rewards": {"exit": -1, "stay": -1000, "bump": -1000},
    }
    values = [[round(value, 9) for value in row] for row in learner.values.tolist()]
    return {"level": level, "discount": discount, "values": values}


if __name__ == "__main__":
    data = {
        "package": "babyrobot 1.0.40",
        "threshold": THRESHOLD,
        "worlds": [record(number) for number in range(60)],
    }
    text = json.dumps(data, separators=(",", ":"), sort_keys=True)
    Path(__file__).with_name("babyrobot_values.json").write_text(text + "\n", encoding="utf-8")
