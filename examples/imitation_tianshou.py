"""Tianshou imitates optimal policies and plays unseen mazes: python examples/imitation_tianshou.py

A network that sees whole mazes, as planes, learns the optimal actions of a suite's training mazes.
It needs the extra `tianshou`: pip install ".[tianshou]"
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
import torch
from arguments import at_least
from comparison import print_mean_comparison
from gymnasium.spaces import Discrete
from numpy.typing import NDArray
from tianshou.algorithm.imitation.imitation_base import ImitationPolicy, OfflineImitationLearning
from tianshou.algorithm.optim import AdamOptimizerFactory, LRSchedulerFactoryLinear
from tianshou.data import Batch, ReplayBuffer
from tianshou.trainer import OfflineTrainerParams
from torch import nn

import babyrobot_levels as brl

MAZES = {"size": [5, 5], "maze": {"algorithm": "wilson"}, "splits": {"train": 0.8, "test": 0.2}}
SUITE = brl.load_suite({"version": 1, "kind": "suite", "seed": 1, "count": 5000, **MAZES})
NUM_MAZES, NUM_TESTS = 1500, 300


class Planner(nn.Module):
    """A layer that is applied repeatedly carries what is ahead from cell to cell."""

    def __init__(self, num_planes: int, width: int = 24) -> None:
        super().__init__()
        self.first = nn.Conv2d(num_planes, width, 3, padding=1)
        self.again = nn.Conv2d(width, width, 3, padding=1, bias=False)
        self.last = nn.Conv2d(width, 4, 1)

    def forward(self, obs: Any, state: Any = None, info: Any = None) -> Any:
        planes = torch.as_tensor(obs)
        hidden = first = self.first(planes)
        for _ in range(12):
            hidden = first + self.again(hidden.relu())
        # The first plane has the robot: the outputs in its cell are those of the actions.
        return (self.last(hidden.relu()) * planes[:, :1]).sum((2, 3)), state


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=at_least(1), default=1000, help="steps of the optimizer")
    parser.add_argument("--seed", type=at_least(0), default=0)
    args = parser.parse_args()
    torch.set_num_threads(1)
    torch.manual_seed(args.seed)

    mazes = SUITE.split("train")[:NUM_MAZES]
    optimal = np.array([brl.solve(maze, actions="moves").policy for maze in mazes])
    cells = np.argwhere((optimal >= 0).all(axis=0))  # all but the exit
    planes, actions = planes_of(mazes, cells), optimal[:, *cells.T].ravel()
    # Imitation needs no rewards, and no ends of episodes.
    none = np.zeros(len(actions), bool)
    data = ReplayBuffer.from_data(planes, actions, none, none, none, none, planes)
    actor = Planner(planes.shape[1])
    policy = ImitationPolicy(actor=actor, action_space=Discrete(4), action_bound_method=None)
    decay = LRSchedulerFactoryLinear(1, args.steps, 1)  # to zero at the last step
    optimizer = AdamOptimizerFactory(lr=3e-3).with_lr_scheduler_factory(decay)
    learner = OfflineImitationLearning(policy=policy, optim=optimizer)
    settings = {"max_epochs": 1, "batch_size": 128, "show_progress": False, "verbose": False}
    learner.run_training(OfflineTrainerParams(buffer=data, epoch_num_steps=args.steps, **settings))

    mazes = SUITE.split("test")[:NUM_TESTS]
    greedy = np.zeros((NUM_TESTS, *optimal.shape[1:]), int)
    seen = Batch(obs=planes_of(mazes, cells), info={})
    greedy[:, *cells.T] = policy(seen).act.reshape(NUM_TESTS, -1)
    print_mean_comparison(mazes, {"learned, greedy": list(greedy)}, steps=100, actions="moves")


def planes_of(mazes: brl.Suite, cells: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return what mazes show of a robot in each cell, `[mazes * cells, planes, height, width]`."""
    envs = brl.LevelVectorEnv(levels=mazes, observation="planes")
    each = [envs.reset(options={"start": [int(x), int(y)]})[0] for y, x in cells]
    return np.stack(each, axis=1).reshape(-1, *each[0].shape[1:])


if __name__ == "__main__":
    main()
