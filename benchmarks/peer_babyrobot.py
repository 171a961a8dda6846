# mypy: disable-error-code="import-not-found,import-untyped"
"""PyPI babyrobot, asked by the other scripts. Runs in an environment of its own; see `peers.py`."""

import json
import sys
import time

from babyrobot.envs.baby_robot_interface import BabyRobotInterface
from babyrobot.envs.lib.grid_base import Puddle
from babyrobot.lib.value_iteration import ValueIteration


def main() -> None:
    """Answer questions until there are none."""
    for line in sys.stdin:
        question = json.loads(line)
        width, height = question["size"]
        env = BabyRobotInterface(
            width=width,
            height=height,
            add_maze=True,
            maze_seed=question["seed"],
            end=[width - 1, height - 1],
            puddles=[((x, y), Puddle[size.capitalize()]) for x, y, size in question["puddles"]],
        )
        learner = ValueIteration(env, question["discount"])
        begin = time.perf_counter()
        learner.run_to_convergence(max_iterations=100_000, threshold=1e-3)
        seconds = time.perf_counter() - begin
        print(json.dumps({"seconds": seconds, "values": learner.values.tolist()}), flush=True)


if __name__ == "__main__":
    main()
