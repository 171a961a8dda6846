#!/usr/bin/env bash
# Stable-Baselines3 turns the axes of a grid of bytes by its size: 8x8 cells with 3 planes are turned, 3x8 cells with 4 planes are not.
#
# Packages: stable-baselines3 2.9.2, torch 2.13.0, gymnasium 1.4.0
# Tried: 2026-11-28, Python 3.11
# Expected: a box of bytes of shape (rows, columns, planes) reaches the network in the same order for every grid, also with `MlpPolicy`,
#   which says nothing of pictures.
# Seen: any box of three axes of bytes from 0 to 255 is taken for a picture, and its smallest axis for the channels. (8, 8, 3)
#   becomes (3, 8, 8); (3, 8, 4) stays, as the three rows count as channels.
# Why it matters: networks for planes of a grid are trained on levels of many sizes. In flat ones, convolutions run over columns
#   and planes, and nothing fails.
# Here: planes are floats by default, which are never turned, and docs/training.md warns of bytes
#   (`test_an_algorithm_takes_an_observation` in tests/envs/test_sb3_algorithms.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile torch==2.13.0
venv/bin/pip install --quiet --disable-pip-version-check --no-compile stable-baselines3==2.9.2 gymnasium==1.4.0
venv/bin/python -W ignore - <<'EOF'
from importlib.metadata import version

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Discrete
from stable_baselines3 import PPO

print("stable-baselines3", version("stable-baselines3"))


class Planes(gymnasium.Env):
    action_space = Discrete(4)

    def __init__(self, shape):
        self.observation_space = Box(0, 255, shape, np.uint8)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self.observation_space.sample(), {}

    def step(self, action):
        return self.observation_space.sample(), -1.0, False, False, {}


def seen_by_network(shape):
    return PPO("MlpPolicy", Planes(shape), n_steps=4, batch_size=4, device="cpu").observation_space.shape


print("8 rows, 8 columns, 3 planes:", seen_by_network((8, 8, 3)))
print("expected of 3 rows, 8 columns, 4 planes: (4, 3, 8)")
seen = seen_by_network((3, 8, 4))
print("seen:", seen)
assert seen_by_network((8, 8, 3)) == (3, 8, 8) and seen == (3, 8, 4)
EOF
