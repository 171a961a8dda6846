#!/usr/bin/env bash
# RecordEpisodeStatistics leaves out the first step of each later episode in SAME_STEP mode, before Gymnasium 1.4.
#
# Packages: gymnasium 1.3.0, numpy 2.4.6
# Tried: 2026-11-28, Python 3.11. With gymnasium 1.4.0, all episodes count 6 steps.
# Expected: a way of 6 steps through FrozenLake has length 6, in whichever episode it is walked.
# Seen: the first episode has length 6, all later ones 5; the reward of the first step is left out, too. The wrapper
#   takes every step after an end for a reset, which is so in NEXT_STEP mode only.
# Why it matters: rewards of -1 a step become returns that are 1 too good, and curves of learning begin with a jump that nobody
#   has learned. The mode is that of choice where a buffer shall hold no empty steps.
# Here: levels in SAME_STEP mode tell the whole episode in `final_info`
#   (`test_same_step_tells_the_end_in_final_entries_and_the_rest_of_the_next_episode` in tests/docs/test_infos.py), and
#   docs/vector.md warns of the wrapper.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile gymnasium==1.3.0 numpy==2.4.6
venv/bin/python - <<'EOF'
import gymnasium
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.wrappers.vector import RecordEpisodeStatistics

print("gymnasium", gymnasium.__version__)
DOWN, RIGHT = 1, 2
WAY = [DOWN, DOWN, RIGHT, DOWN, RIGHT, RIGHT]


def lengths(mode, way):
    make = lambda: gymnasium.make("FrozenLake-v1", is_slippery=False)
    envs = RecordEpisodeStatistics(SyncVectorEnv([make], autoreset_mode=mode))
    envs.reset(seed=0)
    found = []
    for action in way * 3:
        info = envs.step([action])[-1]
        told = info.get("episode") or info.get("final_info", {}).get("episode")
        if told:
            found.append(int(told["l"][0]))
    return found


# In NEXT_STEP mode, one more step resets: its action is ignored.
print("NEXT_STEP:", lengths(AutoresetMode.NEXT_STEP, [*WAY, DOWN]))
print("expected in SAME_STEP: [6, 6, 6]")
seen = lengths(AutoresetMode.SAME_STEP, WAY)
print("seen in SAME_STEP:", seen)
assert lengths(AutoresetMode.NEXT_STEP, [*WAY, DOWN]) == [6, 6, 6]
assert seen == [6, 5, 5]
EOF
