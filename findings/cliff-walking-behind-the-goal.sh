#!/usr/bin/env bash
# The table of CliffWalking goes on behind its goal, and that of FrozenLake does not.
#
# Packages: gymnasium 1.4.0, numpy 2.4.6
# Tried: 2026-11-28, Python 3.11
# Expected: in `env.unwrapped.P`, the goal leads to itself and pays nothing, as in FrozenLake, or both leave it out.
# Seen: from CliffWalking's goal, "up" leads back into the world with -1 and without an end, and "right" falls off the
#   cliff, with -100. No episode ever takes these, as reaching the goal ends it: they are right only for
#   programs that stop at the flag. Without it, staying at the goal costs 1 a step for ever.
# Why it matters: one function of value iteration is right for FrozenLake without the flag `terminated`, and wrong for
#   CliffWalking: with a discount of 0.95, the start is worth -20 in place of -9.733.
# Here: states in which the episode is over lead to themselves and pay 0, in every table; the goal of CliffWalking is left
#   out where tables are compared (`test_it_is_the_game_of_gymnasium` in tests/oracles/test_textbook.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile gymnasium==1.4.0 numpy==2.4.6
venv/bin/python - <<'EOF'
import gymnasium

print("gymnasium", gymnasium.__version__)
cliff = gymnasium.make("CliffWalking-v1").unwrapped.P
lake = gymnasium.make("FrozenLake-v1", is_slippery=False).unwrapped.P


def told(table, state):
    return sorted((action, int(to), int(pay), bool(end)) for action, [(_, to, pay, end)] in table[state].items())


def value(table, start, *, stops):
    values = dict.fromkeys(table, 0.0)
    for _ in range(2000):
        values = {
            state: max(
                sum(p * (pay + 0.95 * (0 if stops and end else values[to])) for p, to, pay, end in outcomes)
                for outcomes in actions.values()
            )
            for state, actions in table.items()
        }
    return round(values[start], 3)


print("FrozenLake's goal (action, next, reward, terminated):", told(lake, 15))
print("expected of CliffWalking's goal: the same, next state 47")
print("seen:", told(cliff, 47))
print("FrozenLake's start, with and without the flag:", value(lake, 0, stops=True), value(lake, 0, stops=False))
with_flag, without = value(cliff, 36, stops=True), value(cliff, 36, stops=False)
print("CliffWalking's start, with and without the flag:", with_flag, without)
assert {(to, pay, end) for _, to, pay, end in told(lake, 15)} == {(15, 0, True)}
assert (0, 35, -1, False) in told(cliff, 47) and (3, 36, -100, False) in told(cliff, 47)
assert value(lake, 0, stops=True) == value(lake, 0, stops=False)
assert (with_flag, without) == (-9.733, -20.0)
EOF
