# mypy: disable-error-code="import-not-found,import-untyped"
"""PyPI babyrobot's mazes, for `mazes.py`. Runs in an environment of its own; see `peers.py`."""

import json
import sys
import time

from babyrobot.envs.lib.maze import Maze


def main() -> None:
    """Answer questions until there are none."""
    for line in sys.stdin:
        question = json.loads(line)
        width, height = question["size"]
        begin = time.perf_counter()
        for seed in range(question["count"]):
            maze = Maze(width, height, 0, 0, seed=seed)
            maze.make_maze()
        seconds = time.perf_counter() - begin
        print(json.dumps({"seconds": seconds}), flush=True)


if __name__ == "__main__":
    main()
