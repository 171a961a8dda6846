"""CleanRL's single files learn a level, unchanged:

    python examples/cleanrl_files.py path/to/cleanrl/ppo.py --total-timesteps 200000

The options after it are the file's. CleanRL's ppo.py and dqn.py need torch, tensorboard and tyro.
"""

from __future__ import annotations

import argparse
import runpy
import sys
from typing import Any

import gymnasium
import numpy as np
import torch
from comparison import actions_in_cells, print_comparison
from gymnasium.wrappers import DtypeObservation, FlattenObservation, TransformReward

import babyrobot_levels as brl


def make(**kwargs: Any) -> gymnasium.Env[Any, Any]:
    # These files take the end of an episode by a time limit for an exit (ppo.py), or cannot take
    # it (dqn.py), so there is no limit: as they explore, they always come to the exit.
    env = gymnasium.make(
        "babyrobot/final-maze-v0", observation="index", max_episode_steps=-1, **kwargs
    )
    # A float for each cell, so that the network has parameters of its own for it.
    env = DtypeObservation(FlattenObservation(env), np.float32)
    # Returns of -1,000 are too large for a network, so rewards are scaled.
    return TransformReward(env, lambda reward: float(reward) / 10)


gymnasium.register("FinalMaze-v0", entry_point=make)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("file", help="CleanRL's ppo.py or dqn.py; its options follow")
    file = parser.parse_args(sys.argv[1:2]).file
    options = sys.argv[2:]
    torch.set_num_threads(1)
    sys.argv = [file, "--env-id", "FinalMaze-v0", "--gamma", "1", *options]
    after = runpy.run_path(file, run_name="__main__")
    network = after["agent"].actor if "agent" in after else after["q_network"]

    def act(state: int) -> int:
        with torch.no_grad():
            return int(network(torch.eye(level.compile().num_states)[state]).argmax())

    level = brl.load("final-maze")
    print_comparison(level, {"learned, greedy": actions_in_cells(level, act, observation="index")})


if __name__ == "__main__":
    main()
