#!/usr/bin/env bash
# In MiniGrid's Dynamic-Obstacles, walking into a wall ends the episode with -1.
#
# Packages: minigrid 3.2.0, gymnasium 1.4.0, numpy 2.4.6
# Tried: 2026-11-28, Python 3.11
# Expected: a wall stops the agent, as in all other environments of MiniGrid: reward 0, and the episode goes on. The page of the
#   environment names three ends: the goal, an obstacle, and the time.
# Seen: reward -1 and `terminated`, at the first step, beside no obstacle. Whatever is in front of the agent and is not the goal
#   counts as an obstacle.
# Why it matters: the exploring agent dies at walls, not at balls, so that curves measure something else
#   than they say. A copy of the task in another program has other optimal values.
# Here: a level made of the environment says that walls do no harm in it
#   (`test_obstacles_walk_at_random` in tests/extensions/formats/test_minigrid.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile minigrid==3.2.0 gymnasium==1.4.0 numpy==2.4.6
venv/bin/python -W ignore - <<'EOF'
from importlib.metadata import version

import gymnasium
import minigrid  # noqa: F401

print("minigrid", version("minigrid"))
LEFT, FORWARD = 0, 2


def bump(name):
    env = gymnasium.make(name)
    env.reset(seed=0)
    # From east to north: the agent stands in the upper left corner.
    env.step(LEFT)
    ahead = env.unwrapped.grid.get(*env.unwrapped.front_pos).type
    _, reward, terminated, _, _ = env.step(FORWARD)
    return ahead, reward, terminated


print("Empty-6x6:", bump("MiniGrid-Empty-6x6-v0"))
print("expected in Dynamic-Obstacles-6x6: the same")
seen = bump("MiniGrid-Dynamic-Obstacles-6x6-v0")
print("seen:", seen)
assert bump("MiniGrid-Empty-6x6-v0") == ("wall", 0, False)
assert seen == ("wall", -1, True)
EOF
