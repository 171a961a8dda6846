"""RLlib's PPO learns mazes of a suite with action masks, and is scored in mazes it has not seen.

On this machine or on a cluster: python examples/ppo_rllib_suite.py --address auto --env-runners 8
It needs the extra `rllib`: pip install ".[rllib]"
"""

from __future__ import annotations

from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import torch
from arguments import at_least, parser_of, suite_of
from cluster import add_address, connect
from gymnasium.spaces import Box, Dict, Space
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.connectors.env_to_module import FlattenObservations
from ray.rllib.connectors.env_to_module.observation_preprocessor import (
    SingleAgentObservationPreprocessor,
)
from ray.rllib.core.rl_module.rl_module import RLModuleSpec
from ray.rllib.examples.rl_modules.classes.action_masking_rlm import ActionMaskingTorchRLModule

import babyrobot_levels as brl

TINY = str(Path(__file__).with_name("tiny-mazes.yaml"))
SHOWN: dict[str, Any] = {"observation": "planes", "actions": "moves"}  # the whole maze
BATCH = 4096  # steps of all environments between two updates


class MasksFromInfos(SingleAgentObservationPreprocessor):
    """Puts the action masks, which environments give in infos, beside the observations."""

    def recompute_output_observation_space(
        self, input_observation_space: Space[Any], input_action_space: Any
    ) -> Space[Any]:
        mask = Box(0, 1, (input_action_space.n,))
        return Dict(action_mask=mask, observations=input_observation_space)

    def preprocess(self, observation: Any, episode: Any) -> dict[str, Any]:
        mask = episode.get_infos(-1)["action_mask"].astype(np.float32)
        return {"action_mask": mask, "observations": observation}


def main() -> None:
    parser = parser_of(__doc__, steps=100_000, level=None)
    parser.add_argument(
        "--suite", type=suite_of, default=TINY, help="a name or a path; with splits train and test"
    )
    parser.add_argument("--env-runners", type=at_least(1), default=2, help="processes that play")
    add_address(parser)
    args = parser.parse_args()
    torch.set_num_threads(1)  # small networks learn fastest on one
    connect(args.address, cpus=args.env_runners)

    config = (
        PPOConfig()
        # What is before the colon is imported in each process that plays: it registers the ids.
        .environment(
            "babyrobot_levels:babyrobot/Suite-v0",
            env_config={"suite": args.suite, "split": "train", **SHOWN},
        )
        .env_runners(
            num_env_runners=args.env_runners,
            num_envs_per_env_runner=32,
            gym_env_vectorize_mode="vector_entry_point",
            env_to_module_connector=lambda *_, **__: [FlattenObservations(), MasksFromInfos()],
        )
        .rl_module(
            rl_module_spec=RLModuleSpec(
                module_class=ActionMaskingTorchRLModule,
                model_config={"fcnet_activation": "relu", "vf_share_layers": False},
            )
        )
        # By default, values that are off by more than the square root of 10 are not learned. With
        # a constant learning rate, what was learned can be lost from one update to the next. The
        # shortest way is optimal with any discount, and learned sooner with one below 1.
        .training(vf_clip_param=float("inf"), gamma=0.95, entropy_coeff=0.01, grad_clip=0.5)
        .training(lr=[[0, 1e-3], [args.steps, 0.0]])
        .training(train_batch_size_per_learner=BATCH, minibatch_size=512, num_epochs=8)
        .debugging(seed=args.seed)
    )
    learner = config.build_algo()
    begin = perf_counter()
    for _ in range(-(-args.steps // BATCH)):
        result = learner.train()
        print(
            f"{result['num_env_steps_sampled_lifetime']:8.0f} steps  mean return",
            f"{result['env_runners']['episode_return_mean']:7.2f}  {perf_counter() - begin:5.0f} s",
            flush=True,
        )

    explores, greedy = (
        brl.score(args.suite, learner.get_module(), split="test", deterministic=each, **SHOWN)
        for each in (False, True)
    )
    print(f"\n{'level':18}    random   learned    greedy   optimum    share")
    for each, likeliest in zip(explores, greedy, strict=True):
        returns = each.random, each.expected_return, likeliest.expected_return, each.optimum
        columns = " ".join(f"{value:9.2f}" for value in returns)
        print(f"{each.level:18} {columns} {each.share:8.1%}")
    print(f"mean share of the optimum in {len(greedy)} unseen mazes:", end=" ")
    print(f"{explores.summary.mean:.1%}, greedy {greedy.summary.mean:.1%}")


if __name__ == "__main__":
    main()
