"""CleanRL's single files learn a level, unchanged:

    python examples/cleanrl_files.py path/to/cleanrl/ppo.py --total-timesteps 200000

The options after the file are those of the file. It runs CleanRL's ppo.py and dqn.py, which need
PyTorch, tensorboard and tyro.
"""

from __future__ import annotations

import runpy
import sys
from typing import Any

import gymnasium
import torch
from comparison import actions_in_cells, print_comparison
from gymnasium.wrappers import TransformReward

import babyrobot_levels as brl

LEVEL = "final-maze"


def make(**kwargs: Any) -> gymnasium.Env[Any, Any]:
    # These files take the end of an episode by a time limit for an exit (ppo.py), or cannot take
    # it (dqn.py), so there is no limit: exploration ends every episode.
    env = gymnasium.make(
        "babyrobot/Level-v0", level=LEVEL, observation="vector", max_episode_steps=-1, **kwargs
    )
    # Returns of -1,000 are too large for a network, so rewards are scaled.
    return TransformReward(env, lambda reward: float(reward) / 100)


gymnasium.register("CleanMaze-v0", entry_point=make)


def main() -> None:
    file, *options = sys.argv[1:]
    torch.set_num_threads(1)
    sys.argv = [file, "--env-id", "CleanMaze-v0", *options]
    after = runpy.run_path(file, run_name="__main__")
    network = after["agent"].actor if "agent" in after else after["q_network"]

    def act(observation: Any) -> int:
        with torch.no_grad():
            return int(network(torch.tensor(observation)).argmax())

    greedy = actions_in_cells(brl.load(LEVEL), act, observation="vector")
    print_comparison(brl.load(LEVEL), {"learned, greedy": greedy})


if __name__ == "__main__":
    main()
