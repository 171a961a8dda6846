"""Tianshou's DQN with action masks learns a level: python examples/dqn_tianshou.py

It needs the extra `tianshou`: pip install ".[tianshou]"
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import torch
from arguments import parsed, parser_of
from comparison import print_comparison
from gymnasium.spaces import Box, Dict
from gymnasium.wrappers import FlattenObservation, TransformObservation
from tianshou.algorithm import DQN
from tianshou.algorithm.modelfree.dqn import DiscreteQLearningPolicy
from tianshou.algorithm.optim import AdamOptimizerFactory
from tianshou.data import Batch, Collector, VectorReplayBuffer
from tianshou.env import DummyVectorEnv
from tianshou.trainer import OffPolicyTrainerParams
from tianshou.utils.net.common import Net

import babyrobot_levels as brl

NUM_ENVS = 32


def make(level: brl.Level) -> Any:
    """Return an environment with the action mask in its observations, where Tianshou needs it."""
    env: Any = level.make(observation="index", max_episode_steps=level.max_steps or 500)
    env = FlattenObservation(env)  # one-hot: the network has parameters of its own for each state
    space = Dict(obs=env.observation_space, mask=Box(0, 1, (env.action_space.n,), np.int8))
    masks = env.unwrapped.action_masks
    return TransformObservation(env, lambda one_hot: {"obs": one_hot, "mask": masks()}, space)


def main() -> None:
    args = parsed(parser_of(__doc__, steps=40_000))
    level, mdp = args.level, args.level.compile()
    torch.set_num_threads(1)  # small networks learn fastest on one
    torch.manual_seed(args.seed)
    np.random.seed(args.seed)  # noqa: NPY002 (Tianshou explores with the global generator)

    envs = DummyVectorEnv([lambda: make(level)] * NUM_ENVS)
    envs.seed(args.seed)
    network = Net(state_shape=mdp.num_states, action_shape=mdp.num_actions, hidden_sizes=[64])
    policy = DiscreteQLearningPolicy(
        model=network, action_space=envs.action_space[0], eps_training=0.2
    )
    optimizer = AdamOptimizerFactory(lr=5e-3)
    learner = DQN(policy=policy, optim=optimizer, gamma=level.discount, target_update_freq=50)
    buffer = VectorReplayBuffer(50_000, NUM_ENVS)
    collector = Collector(learner, envs, buffer, exploration_noise=True)
    params = OffPolicyTrainerParams(
        training_collector=collector,
        max_epochs=1,
        epoch_num_steps=args.steps,
        collection_step_num_env_steps=4 * NUM_ENVS,
        update_step_num_gradient_steps_per_sample=0.1,
        batch_size=256,
        show_progress=False,
        verbose=False,
    )
    began = time.perf_counter()
    learner.run_training(params)
    print(f"{collector.collect_step:,} steps in {time.perf_counter() - began:.1f} s")

    states = Batch(obs={"obs": np.eye(mdp.num_states), "mask": mdp.action_mask}, info={})
    greedy = policy(states).act.reshape(mdp.height, mdp.width)
    print_comparison(level, {"learned, greedy": greedy})


if __name__ == "__main__":
    main()
