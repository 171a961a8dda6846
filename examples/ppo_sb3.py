"""Stable-Baselines3's PPO learns a level: python examples/ppo_sb3.py --level final-maze

It needs the extra `sb3`: pip install "babyrobot-levels[sb3]"
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import torch
from arguments import parsed, parser_of
from comparison import print_comparison
from numpy.typing import NDArray
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from babyrobot_levels.envs.sb3 import LevelVecEnv

NUM_ENVS = 64


def main() -> None:
    args = parsed(parser_of(__doc__, steps=200_000))
    level = args.level
    # Small networks learn fastest on one thread.
    torch.set_num_threads(1)

    limit = level.max_steps or 500
    # With their numbers, the network has parameters of its own for each cell.
    observation = "index"
    envs = LevelVecEnv(level, num_envs=NUM_ENVS, observation=observation, max_episode_steps=limit)
    # Returns of -1,000 are too large for a network, so rewards are scaled.
    scaled = VecNormalize(VecMonitor(envs), norm_obs=False, gamma=level.discount)
    learner = PPO(
        "MlpPolicy",
        scaled,
        n_steps=64,
        batch_size=512,
        n_epochs=8,
        learning_rate=3e-3,
        gamma=level.discount,
        ent_coef=0.01,
        seed=args.seed,
    )
    began = time.perf_counter()
    learner.learn(args.steps)
    print(f"{learner.num_timesteps:,} steps in {time.perf_counter() - began:.1f} s")

    env = Monitor(level.make(observation=observation, max_episode_steps=limit))
    env.reset(seed=args.seed)
    mean, deviation = evaluate_policy(learner, env, n_eval_episodes=20)
    print(f"evaluate_policy: {mean:.2f} ± {deviation:.2f} in 20 episodes")

    width, height = level.size
    chances = probabilities(learner, width * height)
    greedy = chances.argmax(axis=1).reshape(height, width)
    print_comparison(level, {"learned, as it explores": chances, "learned, greedy": greedy})


def probabilities(learner: Any, num_states: int) -> NDArray[np.float32]:
    """Return the learner's probability of each action in each cell, `[states, actions]`."""
    with torch.no_grad():
        observations, _ = learner.policy.obs_to_tensor(np.arange(num_states))
        chances = learner.policy.get_distribution(observations).distribution.probs
    return np.asarray(chances)


if __name__ == "__main__":
    main()
