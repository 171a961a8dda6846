"""sb3-contrib's MaskablePPO learns a level: python examples/maskable_ppo.py --level final-maze

Action masks exclude moves against walls. It needs the extra `sb3`:
pip install "babyrobot-levels[sb3]"
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import torch
from arguments import parsed, parser_of
from comparison import print_comparison
from numpy.typing import NDArray
from sb3_contrib import MaskablePPO
from sb3_contrib.common.maskable.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

import babyrobot_levels as brl
from babyrobot_levels.envs.sb3 import LevelVecEnv

NUM_ENVS = 64
NUM_EPISODES = 100


def main() -> None:
    args = parsed(parser_of(__doc__, steps=200_000))
    level = args.level
    # Small networks learn fastest on one thread.
    torch.set_num_threads(1)

    limit = level.max_steps or 500
    envs = VecMonitor(LevelVecEnv(level, num_envs=NUM_ENVS, max_episode_steps=limit))
    # Returns of -1,000 are too large for a network, so rewards are scaled.
    scaled = VecNormalize(envs, norm_obs=False, gamma=level.discount)
    learner = MaskablePPO(
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

    # An environment for each episode, so that all of them run at once.
    envs = VecMonitor(LevelVecEnv(level, num_envs=NUM_EPISODES, max_episode_steps=limit))
    envs.seed(args.seed)
    mean, deviation = evaluate_policy(learner, envs, n_eval_episodes=NUM_EPISODES)
    print(f"evaluate_policy: {mean:.2f} ± {deviation:.2f} in {NUM_EPISODES} episodes")

    width, height = level.size
    chances = probabilities(learner, level)
    greedy = chances.argmax(axis=1).reshape(height, width)
    print_comparison(level, {"learned, as it explores": chances, "learned, greedy": greedy})


def probabilities(learner: Any, level: brl.Level) -> NDArray[np.float32]:
    """Return the learner's probability of each action in each cell, `[states, actions]`."""
    width, height = level.size
    cells = np.array([(x, y) for y in range(height) for x in range(width)])
    masks = level.compile().action_mask.copy()
    with torch.no_grad():
        observations, _ = learner.policy.obs_to_tensor(cells)
        chances = learner.policy.get_distribution(observations, masks).distribution.probs
    return np.asarray(chances)


if __name__ == "__main__":
    main()
