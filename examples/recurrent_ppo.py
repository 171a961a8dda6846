"""sb3-contrib's RecurrentPPO learns what to remember: python examples/recurrent_ppo.py

The robot sees only the cells around it. At the end of the corridor of t-maze.yaml, a policy without
memory chooses the wrong pad half the time. It needs the extra `sb3`: pip install ".[sb3]"
"""

from __future__ import annotations

from pathlib import Path

import torch
from arguments import parsed, parser_of
from comparison import print_comparison
from sb3_contrib import RecurrentPPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

import babyrobot_levels as brl
from babyrobot_levels.envs.sb3 import LevelVecEnv

T_MAZE = str(Path(__file__).with_name("t-maze.yaml"))


def many(level: brl.Level, num_envs: int) -> VecMonitor:
    limit = level.max_steps or 500
    kwargs = {"observation": "view", "view_radius": 1, "actions": "moves"}
    return VecMonitor(LevelVecEnv(level, num_envs=num_envs, max_episode_steps=limit, **kwargs))


def main() -> None:
    args = parsed(parser_of(__doc__, steps=50_000, level=T_MAZE))
    level = args.level
    # Small networks learn fastest on one thread.
    torch.set_num_threads(1)

    learner = RecurrentPPO(
        "MlpLstmPolicy",
        VecNormalize(many(level, num_envs=32), norm_obs=False),
        n_steps=64,
        batch_size=512,
        n_epochs=8,
        learning_rate=3e-3,
        ent_coef=0.01,
        policy_kwargs={"lstm_hidden_size": 32, "net_arch": []},
        seed=args.seed,
    )
    learner.learn(args.steps)

    # An environment for each episode, so that all of them run at once.
    trials = many(level, num_envs=500)
    trials.seed(args.seed)
    mean, deviation = evaluate_policy(learner, trials, n_eval_episodes=500)
    print(f"evaluate_policy: {mean:.2f} ± {deviation:.2f} in 500 episodes")
    print_comparison(level, {"learned, in trials": float(mean)}, actions="moves")


if __name__ == "__main__":
    main()
