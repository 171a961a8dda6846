#!/usr/bin/env bash
# The distribution of MaskablePPO's policy has an attribute of another name where the actions are several.
#
# Packages: sb3-contrib 2.9.2, stable-baselines3 2.9.2, torch 2.13.0, gymnasium 1.4.0
# Tried: 2026-11-29, Python 3.11
# Expected: `policy.get_distribution(…).distribution`, which PPO has for `Discrete` and for `MultiDiscrete` actions (one of
#   torch, or a list of them), and MaskablePPO for `Discrete` ones, is there for MaskablePPO with `MultiDiscrete`, too.
# Seen: AttributeError there; the list is called `distributions`.
# Why it matters: who wants the probabilities of actions, as for several robots that one agent moves, reads this attribute, and
#   code that was tried with three of the four fails with the fourth.
# Here: `brl.score` reads either
#   (`test_models_that_move_several_robots` in tests/extensions/scoring/test_models.py).
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
import numpy as np
import torch
from gymnasium.spaces import Discrete, MultiDiscrete
from sb3_contrib import MaskablePPO
from stable_baselines3 import PPO

torch.set_num_threads(1)
print("sb3-contrib", version("sb3-contrib"), "stable-baselines3", version("stable-baselines3"))


class Walk(gymnasium.Env):
    observation_space = Discrete(9)

    def __init__(self, actions):
        self.action_space = actions

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return 0, {}

    def step(self, action):
        return 0, -1.0, False, False, {}

    def action_masks(self):
        return np.ones(10 if isinstance(self.action_space, MultiDiscrete) else 5, bool)


def seen(algorithm, actions):
    policy = algorithm("MlpPolicy", Walk(actions), n_steps=4, batch_size=4, device="cpu").policy
    found = policy.get_distribution(policy.obs_to_tensor(np.array([0]))[0])
    return type(getattr(found, "distribution", None)).__name__, hasattr(found, "distributions")


one, several = Discrete(5), MultiDiscrete([5, 5])
names = {}
for algorithm in (PPO, MaskablePPO):
    for actions in (one, several):
        name = f"{algorithm.__name__}, {actions}"
        names[name] = seen(algorithm, actions)
        print(f"{name}: distribution is a {names[name][0]}, distributions is there: {names[name][1]}")
print("expected: four times a distribution, or a list of them, by one name")
assert names == {
    "PPO, Discrete(5)": ("Categorical", False),
    "PPO, MultiDiscrete([5 5])": ("list", False),
    "MaskablePPO, Discrete(5)": ("MaskableCategorical", False),
    "MaskablePPO, MultiDiscrete([5 5])": ("NoneType", True),
}, names
EOF
