#!/usr/bin/env bash
# PettingZoo's own tests hand `reset` an option that nobody has, and fail an environment that says so.
#
# Packages: pettingzoo 1.27.0, gymnasium 1.4.0, numpy 2.4.6
# Tried: 2026-11-29, Python 3.11
# Expected: `parallel_api_test` tries `reset(seed=…, options=…)` with options that an environment may refuse, as a misspelt
#   one is best refused; Gymnasium's `check_env` passes an environment that refuses all options that it does not know.
# Seen: `parallel_api_test` calls `reset(seed=0, options={"options": 1})` and lets the exception through: an environment that
#   is strict about its options cannot pass, and one that reads them by `options["…"]` is never tried with its own.
# Why it matters: an environment for one agent that is strict becomes lax where it is wrapped for several, and a misspelt
#   option has no effect there, without a word.
# Here: `brl.parallel_env` ignores options that are not its own, which its docstring says; environments of one agent refuse
#   them (`test_pettingzoo_finds_no_fault` in tests/extensions/robots/test_parallel.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile pettingzoo==1.27.0 gymnasium==1.4.0 numpy==2.4.6
venv/bin/python -W ignore - <<'EOF'
import gymnasium
import pettingzoo
from gymnasium.spaces import Discrete
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import parallel_api_test

print("pettingzoo", pettingzoo.__version__, "gymnasium", gymnasium.__version__)


def checked(options):
    for name in options or {}:
        if name != "level":
            raise ValueError(f"reset has no option {name!r}")


class Alone(gymnasium.Env):
    observation_space, action_space = Discrete(2), Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        checked(options)
        return 0, {}

    def step(self, action):
        return 1, 0.0, True, False, {}


class Several(pettingzoo.ParallelEnv):
    metadata = {"name": "several"}
    possible_agents = ["agent_0", "agent_1"]

    def observation_space(self, agent):
        return Discrete(2)

    action_space = observation_space

    def reset(self, seed=None, options=None):
        checked(options)
        self.agents = self.possible_agents[:]
        return dict.fromkeys(self.agents, 0), {agent: {} for agent in self.agents}

    def step(self, actions):
        ended, self.agents = self.agents, []
        told = {agent: {} for agent in ended}
        return dict.fromkeys(ended, 1), dict.fromkeys(ended, 0.0), dict.fromkeys(ended, True), dict.fromkeys(ended, False), told


check_env(Alone(), skip_render_check=True)
print("Gymnasium's check_env: passed")
try:
    parallel_api_test(Several(), num_cycles=5)
except ValueError as error:
    seen = str(error)
else:
    seen = "passed"
print("expected of parallel_api_test: passed")
print("seen:", seen)
assert seen == "reset has no option 'options'"
EOF
