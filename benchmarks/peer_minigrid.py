# mypy: disable-error-code="import-not-found,import-untyped,misc,no-untyped-call"
"""MiniGrid, asked for frames by `frames.py` and for symbols by `observations.py`.

Runs in an environment of its own; see `peers.py`.
"""

import json
import random
import sys
import time
from importlib.metadata import version
from typing import Any

import numpy as np
from gymnasium.vector import SyncVectorEnv
from minigrid.core.grid import Grid
from minigrid.core.mission import MissionSpace
from minigrid.core.world_object import Goal
from minigrid.minigrid_env import MiniGridEnv
from minigrid.wrappers import FullyObsWrapper, ImgObsWrapper


class Room(MiniGridEnv):
    """An empty room with a goal in its corner, as MiniGrid's own `EmptyEnv`, but not square."""

    def __init__(self, width: int, height: int, **settings: Any) -> None:
        mission = MissionSpace(mission_func=lambda: "get to the green goal square")
        super().__init__(mission, width=width, height=height, **settings)

    def _gen_grid(self, width: int, height: int) -> None:
        self.grid = Grid(width, height)
        self.grid.wall_rect(0, 0, width, height)
        self.put_obj(Goal(), width - 2, height - 2)
        self.agent_pos, self.agent_dir = (1, 1), 0
        self.mission = "get to the green goal square"


def frames(question: dict[str, Any]) -> dict[str, Any]:
    """Return how long steps with a frame each take, and the shape of the frames."""
    width, height = question["size"]
    env = Room(
        width,
        height,
        render_mode="rgb_array",
        tile_size=question["tile"],
        highlight=question["highlight"],
    )
    rng = random.Random(0)
    # To the left, to the right, ahead.
    actions = [rng.randrange(3) for _ in range(question["frames"])]
    env.reset(seed=0)
    shape = env.render().shape
    begin = time.perf_counter()
    for action in actions:
        _, _, terminated, truncated, _ = env.step(action)
        env.render()
        if terminated or truncated:
            env.reset()
    return {"seconds": time.perf_counter() - begin, "shape": shape}


def symbols(question: dict[str, Any]) -> dict[str, Any]:
    """Return how long steps of many environments take that show cells as numbers."""
    width, height = question["size"]

    def make() -> Any:
        room = Room(width, height)
        return ImgObsWrapper(FullyObsWrapper(room) if question["whole"] else room)

    envs = SyncVectorEnv([make] * question["num_envs"])
    actions = np.random.default_rng(0).integers(3, size=(question["steps"], question["num_envs"]))
    envs.reset(seed=0)
    begin = time.perf_counter()
    for action in actions:
        envs.step(action)
    return {"seconds": time.perf_counter() - begin}


def main() -> None:
    """Answer questions until there are none."""
    for line in sys.stdin:
        question = json.loads(line)
        answer = (symbols if "num_envs" in question else frames)(question)
        print(json.dumps({**answer, "version": version("minigrid")}), flush=True)


if __name__ == "__main__":
    main()
