"""Stable-Baselines3's PPO learns a level: python examples/ppo_sb3.py --level final-maze

It needs the extra `sb3`: pip install ".[sb3]"
"""

from __future__ import annotations

import numpy as np
import torch
from arguments import parsed, parser_of
from comparison import print_comparison
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from babyrobot_levels.envs.sb3 import LevelVecEnv


def main() -> None:
    args = parsed(parser_of(__doc__, steps=200_000))
    level, limit = args.level, args.level.max_steps or 500
    # Small networks learn fastest on one thread.
    torch.set_num_threads(1)

    # With their numbers, the network has parameters of its own for each cell.
    envs = LevelVecEnv(level, num_envs=64, observation="index", max_episode_steps=limit)
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
    learner.learn(args.steps)

    # An environment for each episode, so that all of them run at once.
    envs = LevelVecEnv(level, num_envs=100, observation="index", max_episode_steps=limit)
    envs.seed(args.seed)
    mean, deviation = evaluate_policy(learner, VecMonitor(envs), n_eval_episodes=100)
    print(f"evaluate_policy: {mean:.2f} ± {deviation:.2f} in 100 episodes")

    width, height = level.size
    with torch.no_grad():
        cells, _ = learner.policy.obs_to_tensor(np.arange(width * height))
        chances = learner.policy.get_distribution(cells).distribution.probs.numpy()
    greedy = chances.argmax(axis=1).reshape(height, width)
    print_comparison(level, {"learned, as it explores": chances, "learned, greedy": greedy})


if __name__ == "__main__":
    main()
