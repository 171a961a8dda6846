"""PPO with masks in one file of PyTorch: python examples/ppo_cleanrl.py --level final-maze

After Schulman and others, Proximal Policy Optimization Algorithms (2017). It needs PyTorch, which
comes with the extra `sb3`: pip install "babyrobot-levels[sb3]"
"""

from __future__ import annotations

import time
from typing import Any

import gymnasium
import numpy as np
import torch
from arguments import parsed, parser_of
from comparison import print_comparison
from gymnasium.wrappers.vector import NormalizeReward, RecordEpisodeStatistics
from torch import Tensor, nn
from torch.distributions import Categorical

NUM_ENVS, NUM_STEPS = 64, 64  # environments, and steps of each between two updates
EPOCHS, BATCH_SIZE, LEARNING_RATE = 8, 512, 3e-3
CLIP, LAMBDA = 0.2, 0.95
ENTROPY_WEIGHT, VALUE_WEIGHT, LARGEST_GRADIENT = 0.01, 0.5, 0.5


class Learner(nn.Module):
    """A policy and a value function of states, given by their numbers."""

    def __init__(self, num_states: int, num_actions: int) -> None:
        super().__init__()
        self.policy = network(num_states, num_actions, scale=0.01)
        self.value = network(num_states, 1, scale=1.0)

    def choice(self, states: Tensor, masks: Tensor) -> Categorical:
        """Return the distribution of actions; masked ones have probability 0."""
        logits = self.policy(states).masked_fill(~masks, -1e8)
        return Categorical(logits=logits)


def network(num_states: int, num_outputs: int, scale: float) -> nn.Sequential:
    last = nn.Linear(64, num_outputs)
    nn.init.orthogonal_(last.weight, scale)
    nn.init.zeros_(last.bias)
    first = nn.Embedding(num_states, 64)  # what a linear layer is for one-hot inputs
    return nn.Sequential(first, nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), last)


def learn(envs: Any, discount: float, steps: int, seed: int) -> Learner:
    num_actions = envs.single_action_space.n
    learner = Learner(envs.single_observation_space.n, num_actions)
    optimizer = torch.optim.Adam(learner.parameters(), LEARNING_RATE, eps=1e-5)
    # One row more than steps: the last one has the states after them.
    states = torch.zeros((NUM_STEPS + 1, NUM_ENVS), dtype=torch.long)
    masks = torch.zeros((NUM_STEPS + 1, NUM_ENVS, num_actions), dtype=torch.bool)
    done = torch.zeros((NUM_STEPS + 1, NUM_ENVS), dtype=torch.bool)
    terminated = torch.zeros((NUM_STEPS, NUM_ENVS), dtype=torch.bool)
    actions = torch.zeros((NUM_STEPS, NUM_ENVS), dtype=torch.long)
    rewards = torch.zeros((NUM_STEPS, NUM_ENVS))

    observations, info = envs.reset(seed=seed)
    states[-1], masks[-1] = torch.tensor(observations), torch.tensor(info["action_mask"])
    for _ in range(num_updates(steps)):
        states[0], masks[0], done[0] = states[-1], masks[-1], done[-1]
        for step in range(NUM_STEPS):
            with torch.no_grad():
                actions[step] = learner.choice(states[step], masks[step]).sample()
            observations, reward, ended, cut, info = envs.step(actions[step].numpy())
            rewards[step], terminated[step] = torch.tensor(reward), torch.tensor(ended)
            states[step + 1], done[step + 1] = torch.tensor(observations), torch.tensor(ended | cut)
            masks[step + 1] = torch.tensor(info["action_mask"])
        with torch.no_grad():
            values = learner.value(states).squeeze(-1)
        advantages, returns = estimate(values, rewards, terminated, done, discount)
        # The step after the end of an episode resets the environment and takes no action.
        acted = ~done[:-1]
        rows = (states[:-1], masks[:-1], actions, advantages, returns)
        update(learner, optimizer, *(each[acted] for each in rows))
    return learner


def num_updates(steps: int) -> int:
    """Return the number of updates for at least this many steps."""
    return -(-steps // (NUM_STEPS * NUM_ENVS))


def estimate(
    values: Tensor, rewards: Tensor, terminated: Tensor, done: Tensor, discount: float
) -> tuple[Tensor, Tensor]:
    """Return advantages and returns, `[steps, envs]`, by generalised advantage estimation.

    The row after a step has its next state, also at the end of an episode. So the value of that
    state counts after truncation, but not after termination.
    """
    errors = rewards + discount * values[1:] * ~terminated - values[:-1]
    advantages = torch.zeros_like(rewards)
    ahead = torch.zeros_like(rewards[0])
    for step in reversed(range(len(rewards))):
        ahead = errors[step] + discount * LAMBDA * ahead * ~done[step + 1]
        advantages[step] = ahead
    return advantages, advantages + values[:-1]


def update(learner: Learner, optimizer: torch.optim.Optimizer, *batch: Tensor) -> None:
    states, masks, actions, advantages, returns = batch
    with torch.no_grad():
        before = learner.choice(states, masks).log_prob(actions)
    advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
    for _ in range(EPOCHS):
        for rows in torch.randperm(len(states)).split(BATCH_SIZE):
            choice = learner.choice(states[rows], masks[rows])
            ratio = (choice.log_prob(actions[rows]) - before[rows]).exp()
            clipped = ratio.clamp(1 - CLIP, 1 + CLIP)
            gain = torch.min(ratio * advantages[rows], clipped * advantages[rows])
            value_loss = (learner.value(states[rows]).squeeze(-1) - returns[rows]).square()
            loss = VALUE_WEIGHT * value_loss - gain - ENTROPY_WEIGHT * choice.entropy()
            optimizer.zero_grad()
            loss.mean().backward()
            nn.utils.clip_grad_norm_(learner.parameters(), LARGEST_GRADIENT)
            optimizer.step()


def main() -> None:
    args = parsed(parser_of(__doc__, steps=200_000))
    level = args.level
    torch.set_num_threads(1)  # small networks learn fastest on one
    torch.manual_seed(args.seed)

    envs: Any = gymnasium.make_vec(
        "babyrobot/Level-v0",
        num_envs=NUM_ENVS,
        level=level,
        observation="index",
        max_episode_steps=level.max_steps or 500,
    )
    envs = RecordEpisodeStatistics(envs)
    # Returns of -1,000 are too large for a network, so rewards are scaled.
    scaled = NormalizeReward(envs, gamma=level.discount)
    began = time.perf_counter()
    learner = learn(scaled, level.discount, args.steps, args.seed)
    steps = num_updates(args.steps) * NUM_STEPS * NUM_ENVS
    print(f"{steps:,} steps in {time.perf_counter() - began:.1f} s")
    if envs.return_queue:
        print(f"mean return of the last 100 episodes: {np.mean(envs.return_queue):.2f}")

    mdp = level.compile()
    with torch.no_grad():
        possible = torch.tensor(mdp.action_mask, dtype=torch.bool)
        chances = learner.choice(torch.arange(mdp.num_states), possible).probs.numpy()
    greedy = chances.argmax(axis=1).reshape(mdp.height, mdp.width)
    print_comparison(level, {"learned, as it explores": chances, "learned, greedy": greedy})


if __name__ == "__main__":
    main()
