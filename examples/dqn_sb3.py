"""Stable-Baselines3's DQN learns a level: python examples/dqn_sb3.py --level final-maze

It needs the extra `sb3`: pip install ".[sb3]"
"""

from __future__ import annotations

import numpy as np
import torch
from arguments import parsed, parser_of
from comparison import actions_in_cells, print_comparison
from stable_baselines3 import DQN
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from babyrobot_levels.envs.sb3 import LevelVecEnv


def main() -> None:
    args = parsed(parser_of(__doc__, steps=50_000))
    level, limit = args.level, args.level.max_steps or 500
    # Small networks learn fastest on one thread.
    torch.set_num_threads(1)

    envs = LevelVecEnv(level, num_envs=16, observation="vector", max_episode_steps=limit)
    # Returns of -1,000 are too large for a network, so rewards are scaled.
    scaled = VecNormalize(VecMonitor(envs), norm_obs=False, gamma=level.discount)
    learner = DQN(
        "MlpPolicy",
        scaled,
        learning_rate=lambda left: 2e-3 * left,  # decreases to 0, so that values settle
        buffer_size=50_000,
        batch_size=256,
        gamma=level.discount,
        train_freq=1,
        gradient_steps=4,  # after each step of the 16 environments
        target_update_interval=500,
        learning_starts=1_000,
        exploration_fraction=0.5,
        seed=args.seed,
    )
    learner.learn(args.steps)

    # All episodes run at once.
    envs = LevelVecEnv(level, num_envs=100, observation="vector", max_episode_steps=limit)
    envs.seed(args.seed)
    mean, deviation = evaluate_policy(learner, VecMonitor(envs), n_eval_episodes=100)
    print(f"evaluate_policy: {mean:.2f} ± {deviation:.2f} in 100 episodes")

    def act(seen: object) -> int:
        return int(learner.predict(seen, deterministic=True)[0])

    greedy = actions_in_cells(level, act, observation="vector")
    # At the end, 5 % of the actions are random.
    explores = 0.95 * np.eye(5)[greedy.ravel()] + 0.05 / 5
    print_comparison(level, {"learned, as it explores": explores, "learned, greedy": greedy})


if __name__ == "__main__":
    main()
