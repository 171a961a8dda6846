#!/usr/bin/env bash
# An info that is a truth of NumPy's becomes an array of objects in a vector environment, one of Python's an array of truths.
#
# Packages: gymnasium 1.4.0, numpy 2.4.6
# Tried: 2026-11-28, Python 3.11
# Expected: `{"hit": numpy.bool_(True)}` and `{"hit": True}` become the same array of bool, as numbers of NumPy and Python do.
# Seen: an array of objects, with None in place of False where an environment does not tell it, so that `~infos["hit"]` raises
#   a TypeError. Any comparison of arrays gives such a truth: `(self.agent == self.goal).all()`.
# Why it matters: an environment works alone, and in training until one of its copies leaves the key out. Masks and
#   means of such infos fail, or are None.
# Here: `reset` and `step` tell the same keys each time, and truths are Python's
#   (`test_infos_have_the_same_keys_at_reset_and_step` in tests/docs/test_infos.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile gymnasium==1.4.0 numpy==2.4.6
venv/bin/python - <<'EOF'
import gymnasium
import numpy as np
from gymnasium.spaces import Discrete
from gymnasium.vector import SyncVectorEnv

print("gymnasium", gymnasium.__version__, "numpy", np.__version__)


class Corridor(gymnasium.Env):
    observation_space = Discrete(3)
    action_space = Discrete(2)

    def __init__(self, truth):
        self.truth = truth

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return 0, {}

    def step(self, action):
        # Who bumps into the wall says so.
        return 0, 0.0, False, False, {"hit": self.truth(True)} if action == 1 else {}


def infos(truth):
    envs = SyncVectorEnv([lambda: Corridor(truth)] * 2)
    envs.reset()
    return envs.step([1, 0])[-1]["hit"]


print("Python's truth:", repr(infos(bool)))
print("expected of NumPy's truth: the same")
seen = infos(np.bool_)
print("seen:", repr(seen))
try:
    print("its opposite:", ~seen)
except TypeError as error:
    print("its opposite: TypeError,", error)
else:
    raise SystemExit("it has an opposite")
assert infos(bool).dtype == bool
assert seen.dtype == object and seen[1] is None
EOF
