# mypy: disable-error-code="import-not-found,import-untyped"
"""mazelib, asked by `mazes.py`. Runs in an environment of its own; see `peers.py`."""

import json
import sys
import time

from mazelib import Maze
from mazelib.generate.BacktrackingGenerator import BacktrackingGenerator


def main() -> None:
    """Answer questions until there are none."""
    for line in sys.stdin:
        question = json.loads(line)
        width, height = question["size"]
        begin = time.perf_counter()
        for seed in range(question["count"]):
            maze = Maze(seed)
            maze.generator = BacktrackingGenerator(height, width)
            maze.generate()
        seconds = time.perf_counter() - begin
        print(json.dumps({"seconds": seconds}), flush=True)


if __name__ == "__main__":
    main()
