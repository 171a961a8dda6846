"""RLlib's PPO learns a level of several robots, each of which has a policy of its own.

It needs the extras `pettingzoo` and `rllib`: pip install ".[pettingzoo,rllib]". Runs with the same
seed are the same where PYTHONHASHSEED is set, too: RLlib takes robots in the order of sets.
"""

from __future__ import annotations

import os

import numpy as np
import ray
import torch
from arguments import parsed, parser_of
from comparison import print_teams
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.connectors.env_to_module import FlattenObservations
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
from ray.tune.registry import register_env

import babyrobot_levels as brl

NUM_ENVS, BATCH = 8, 1024  # environments, and steps of all of them between two updates
DISCOUNT = 0.95  # without one, a robot that waits for ever has no return


def main() -> None:
    args = parsed(parser_of(__doc__, steps=12_288, level="passing-place"))
    level = args.level
    names = [robot.name for robot in level.robots]
    torch.set_num_threads(1)  # small networks learn fastest on one
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    ray.init("local", num_cpus=2, include_dashboard=False)

    limit = level.max_steps or 200
    settings = {"level": level, "observation": "index", "max_cycles": limit}
    register_env("team", lambda config: ParallelPettingZooEnv(brl.parallel_env(**config)))
    config = (
        PPOConfig()
        .environment("team", env_config=settings)
        .env_runners(
            num_env_runners=0,
            num_envs_per_env_runner=NUM_ENVS,
            # One-hot vectors of the numbers of states, which tell where all robots are.
            env_to_module_connector=lambda *_, **__: FlattenObservations(multi_agent=True),
        )
        .multi_agent(policies=names, policy_mapping_fn=lambda name, *_, **__: name)
        # By default, values that are off by more than the square root of 10 are not learned.
        .training(vf_clip_param=float("inf"), gamma=DISCOUNT, entropy_coeff=0.01, lr=3e-3)
        .training(train_batch_size=BATCH, minibatch_size=256, num_epochs=8, grad_clip=0.5)
        .debugging(seed=args.seed)
    )
    learner = config.build_algo()
    for _ in range(-(-args.steps // BATCH)):
        learner.train()

    states = {"obs": torch.eye(level.compile().num_states)}
    with torch.no_grad():
        outputs = [learner.get_module(name).forward_inference(states) for name in names]
    chances = [np.asarray(each["action_dist_inputs"].softmax(dim=1)) for each in outputs]
    greedy = [each.argmax(axis=1) for each in chances]
    print_teams(level, {"learned, as they explore": chances, "learned, greedy": greedy}, DISCOUNT)


if __name__ == "__main__":
    main()
