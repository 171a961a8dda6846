#!/usr/bin/env bash
# RecurrentPPO of sb3-contrib takes a number as an observation, and refuses a pair of numbers.
#
# Packages: sb3-contrib 2.9.2, stable-baselines3 2.9.2, torch 2.13.0, gymnasium 1.4.0
# Tried: 2026-11-28, Python 3.11
# Expected: `MultiDiscrete([5, 5])`, the column and the row of a cell, works as it does with PPO, or is refused by name.
# Seen: TypeError: "input_size should be of type int, got: int64", from within torch. The width of one-hot numbers is added up by
#   NumPy, and torch's memory cells take no integer of NumPy, which its other layers do.
# Why it matters: it is the natural observation of a grid world, and memory is what partly seen ones need. The message names
#   neither the space nor the policy.
# Here: docs and tests name the observations that it refuses
#   (`test_the_memory_takes_no_numbers_of_several_columns` in tests/envs/test_sb3_algorithms.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile torch==2.13.0
venv/bin/pip install --quiet --disable-pip-version-check --no-compile sb3-contrib==2.9.2 stable-baselines3==2.9.2 gymnasium==1.4.0
venv/bin/python -W ignore - <<'EOF'
from importlib.metadata import version

import gymnasium
import torch
from gymnasium.spaces import Discrete, MultiDiscrete
from sb3_contrib import RecurrentPPO
from stable_baselines3 import PPO

torch.set_num_threads(1)
print("sb3-contrib", version("sb3-contrib"), "torch", version("torch"))


class Walk(gymnasium.Env):
    action_space = Discrete(4)

    def __init__(self, space):
        self.observation_space = space

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self.observation_space.sample(), {}

    def step(self, action):
        return self.observation_space.sample(), -1.0, False, False, {}


def made(algorithm, policy, space):
    try:
        algorithm(policy, Walk(space), n_steps=4, batch_size=4, device="cpu").learn(8)
    except TypeError as error:
        return f"TypeError: {error}"
    return "learns"


pair = MultiDiscrete([5, 5])
plain, number = made(PPO, "MlpPolicy", pair), made(RecurrentPPO, "MlpLstmPolicy", Discrete(25))
print("PPO, a pair:", plain)
print("RecurrentPPO, a number:", number)
print("expected of RecurrentPPO, a pair: learns")
seen = made(RecurrentPPO, "MlpLstmPolicy", pair)
print("seen:", seen)
assert plain == number == "learns"
assert seen == "TypeError: input_size should be of type int, got: int64"
EOF
