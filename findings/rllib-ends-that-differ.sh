#!/usr/bin/env bash
# RLlib does not see that an episode is over if one agent ends and the other is cut off in the same step.
#
# Packages: ray 2.60.0, pettingzoo 1.27.0, gymnasium 1.2.2; with what RLlib needs: dm-tree 0.1.10, lz4 4.4.5, ormsgpack 1.13.1,
#   pandas 3.1.1, pyarrow 26.0.1, scipy 1.17.1, tensorboardx 2.6.5, requests 2.34.2, pydantic 2.14.4, fsspec 2026.9.0
# Tried: 2026-11-30, Python 3.11
# Expected: `ParallelPettingZooEnv` says `__all__` when the last agents are gone, whether they are terminated or truncated; and
#   its agents are in the order of the environment.
# Seen: `__all__` asks for all of the step's agents to be terminated, or all to be truncated: where each is one of both, it is
#   false twice, with no agent left. `agents` comes from a set, and its order depends on PYTHONHASHSEED.
# Why it matters: who goes by `__all__` takes another step, for nobody, when a robot arrives at the time limit of another, and
#   an environment may refuse it. What goes by the order of agents differs between processes with equal seeds.
# Here: a step of `brl.parallel_env` without agents does nothing and tells nothing
#   (`test_a_step_after_the_end_does_nothing` in tests/extensions/robots/test_parallel.py); the page on several robots names
#   PYTHONHASHSEED.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile ray==2.60.0 pettingzoo==1.27.0 gymnasium==1.2.2
venv/bin/pip install --quiet --disable-pip-version-check --no-compile dm-tree==0.1.10 lz4==4.4.5 ormsgpack==1.13.1 pandas==3.1.1
venv/bin/pip install --quiet --disable-pip-version-check --no-compile pyarrow==26.0.1 scipy==1.17.1 tensorboardx==2.6.5 requests==2.34.2 pydantic==2.14.4 fsspec==2026.9.0
cat >probe.py <<'EOF'
import warnings

warnings.simplefilter("ignore")
import gymnasium
import pettingzoo
import ray
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv

NAMES = ["red", "blue", "green", "yellow"]


class Race(pettingzoo.ParallelEnv):
    """The first agent arrives in the step that cuts off the others."""

    metadata = {"name": "race"}
    possible_agents = NAMES

    def observation_space(self, agent):
        return gymnasium.spaces.Discrete(2)

    def action_space(self, agent):
        return gymnasium.spaces.Discrete(2)

    def reset(self, seed=None, options=None):
        self.agents = [*NAMES]
        return dict.fromkeys(NAMES, 0), {name: {} for name in NAMES}

    def step(self, actions):
        acted, self.agents = self.agents, []
        return (
            dict.fromkeys(acted, 1),
            dict.fromkeys(acted, 0.0),
            {name: name == "red" for name in acted},
            {name: name != "red" for name in acted},
            {name: {} for name in acted},
        )


env = ParallelPettingZooEnv(Race())
env.reset()
_, _, terminated, truncated, _ = env.step(dict.fromkeys(NAMES, 0))
assert env.par_env.agents == []
print(ray.__version__, terminated["__all__"], truncated["__all__"], env.par_env.agents, *env.agents)
EOF
declare -A orders=()
for seed in 1 2 3 4 5 6 7 8; do
    read -r version ended cut left order < <(PYTHONHASHSEED=$seed venv/bin/python probe.py 2>/dev/null | tail -1)
    [ "$version $ended $cut $left" = "2.60.0 False False []" ]
    orders["$order"]=1
done
echo "ray $version"
echo "expected: one of both flags __all__ is true, with the agents left []; one order of agents"
echo "seen: terminated $ended, truncated $cut, agents left $left; ${#orders[@]} orders with eight seeds of hashes"
[ "${#orders[@]}" -gt 1 ]
