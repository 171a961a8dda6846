"""RLlib's PPO learns a level: python examples/ppo_rllib.py --level final-maze

It needs the extra `rllib`: pip install ".[rllib]"
"""

from __future__ import annotations

import os

import numpy as np
import ray
import torch
from arguments import parsed, parser_of
from comparison import print_comparison
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.connectors.env_to_module import FlattenObservations

NUM_ENVS, NUM_STEPS = 64, 64  # environments, and steps of each between two updates


def main() -> None:
    args = parsed(parser_of(__doc__, steps=160_000))
    level = args.level
    torch.set_num_threads(1)  # small networks learn fastest on one
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    ray.init("local", num_cpus=2, include_dashboard=False)

    limit = level.max_steps or 500
    settings = {"level": level, "observation": "index", "max_episode_steps": limit}
    config = (
        PPOConfig()
        # What is before the colon is imported where environments are made: it registers the ids.
        .environment("babyrobot_levels:babyrobot/Level-v0", env_config=settings)
        .env_runners(
            num_env_runners=0,
            num_envs_per_env_runner=NUM_ENVS,
            gym_env_vectorize_mode="vector_entry_point",
            # One-hot vectors of the numbers of states.
            env_to_module_connector=lambda env, spaces, device: FlattenObservations(),
        )
        # By default, values that are off by more than the square root of 10 are not learned.
        .training(vf_clip_param=float("inf"), gamma=level.discount, entropy_coeff=0.01, lr=3e-3)
        .training(train_batch_size=NUM_ENVS * NUM_STEPS, minibatch_size=512, num_epochs=8)
        .debugging(seed=args.seed)
    )
    learner = config.build_algo()
    for _ in range(-(-args.steps // (NUM_ENVS * NUM_STEPS))):
        learner.train()

    mdp = level.compile()
    with torch.no_grad():
        outputs = learner.get_module().forward_inference({"obs": torch.eye(mdp.num_states)})
    chances = np.asarray(outputs["action_dist_inputs"].softmax(dim=1))
    greedy = chances.argmax(axis=1).reshape(mdp.shape)
    print_comparison(level, {"learned, as it explores": chances, "learned, greedy": greedy})


if __name__ == "__main__":
    main()
