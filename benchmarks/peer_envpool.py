# mypy: disable-error-code="import-not-found,import-untyped"
"""EnvPool's FrozenLake: answers how long steps of many environments take."""

from __future__ import annotations

import json
import sys
import time
from importlib.metadata import version
from typing import Any

import envpool
import numpy as np

MADE: dict[int, Any] = {}


def seconds(num_envs: int, steps: int) -> float:
    """Return how long steps with random moves take; EnvPool begins anew by itself."""
    if num_envs not in MADE:
        MADE[num_envs] = envpool.make("FrozenLake8x8-v1", env_type="gymnasium", num_envs=num_envs)
    env = MADE[num_envs]
    moves = np.random.default_rng(0).integers(4, size=(steps, num_envs), dtype=np.int32)
    env.reset()
    begin = time.perf_counter()
    for move in moves:
        env.step(move)
    return time.perf_counter() - begin


for line in sys.stdin:
    answer = {"version": version("envpool"), "seconds": seconds(**json.loads(line))}
    print(json.dumps(answer), flush=True)
