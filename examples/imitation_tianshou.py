"""Tianshou imitates optimal policies, for unseen mazes. It needs: pip install ".[tianshou]"."""

import numpy as np
import torch
from arguments import parser_of
from comparison import print_mean_comparison
from gymnasium.spaces import Discrete
from numpy.typing import NDArray
from tianshou.algorithm.imitation.imitation_base import ImitationPolicy, OfflineImitationLearning
from tianshou.algorithm.optim import AdamOptimizerFactory, LRSchedulerFactoryLinear
from tianshou.data import Batch, ReplayBuffer
from tianshou.trainer import OfflineTrainerParams

import babyrobot_levels as brl

MAZES = {"size": [5, 5], "maze": {"algorithm": "wilson"}, "splits": {"train": 0.8, "test": 0.2}}
SUITE = brl.load_suite({"version": 1, "kind": "suite", "seed": 1, "count": 5000, **MAZES})
CELLS = [(x, y) for y in range(5) for x in range(5)][:-1]  # all but the exit


class Planner(torch.nn.Module):
    def __init__(self, num_planes: int) -> None:
        super().__init__()
        self.first = torch.nn.Conv2d(num_planes, 24, 3, padding=1)
        self.again = torch.nn.Conv2d(24, 24, 3, padding=1, bias=False)
        self.last = torch.nn.Conv2d(24, 4, 1)

    def forward(self, obs: NDArray[np.float32], **others: object) -> tuple[torch.Tensor, None]:
        planes = torch.as_tensor(obs)
        hidden = first = self.first(planes)
        for _ in range(12):  # carries what is ahead from cell to cell
            hidden = first + self.again(hidden.relu())
        # The first plane has the robot: the outputs in its cell are those of the actions.
        return (self.last(hidden.relu()) * planes[:, :1]).sum((2, 3)), None


def planes_of(mazes: brl.Suite) -> NDArray[np.float32]:
    """Return what mazes show of a robot in each cell, `[cells * mazes, planes, height, width]`."""
    envs = brl.LevelVectorEnv(levels=mazes, observation="planes")
    return np.concatenate([envs.reset(options={"start": cell})[0] for cell in CELLS])


args = parser_of(__doc__, 1000, "steps of the optimizer", level=None).parse_args()
torch.set_num_threads(1)  # small networks learn fastest on one
torch.manual_seed(args.seed)
mazes, unseen = SUITE.split("train")[:1500], SUITE.split("test")[:300]
optimal = [brl.solve(maze, actions="moves").policy.ravel()[:-1] for maze in mazes]
planes, actions = planes_of(mazes), np.transpose(optimal).ravel()
none = np.zeros(len(actions), bool)  # imitation needs no rewards, and no ends of episodes
data = ReplayBuffer.from_data(planes, actions, none, none, none, none, planes)
policy = ImitationPolicy(actor=Planner(planes.shape[1]), action_space=Discrete(4))
decay = LRSchedulerFactoryLinear(1, args.steps, 1)  # to zero at the last step
optimizer = AdamOptimizerFactory(lr=3e-3).with_lr_scheduler_factory(decay)
learner = OfflineImitationLearning(policy=policy, optim=optimizer)
settings = {"max_epochs": 1, "batch_size": 128, "show_progress": False, "verbose": False}
learner.run_training(OfflineTrainerParams(buffer=data, epoch_num_steps=args.steps, **settings))

greedy = policy(Batch(obs=planes_of(unseen), info={})).act.reshape(len(CELLS), -1)
tables = np.pad(greedy, [(0, 1), (0, 0)]).T.reshape(-1, 5, 5)  # any action in the exit
print_mean_comparison(unseen, {"learned, greedy": list(tables)}, steps=100, actions="moves")
