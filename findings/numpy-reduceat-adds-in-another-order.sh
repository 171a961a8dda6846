#!/usr/bin/env bash
# NumPy's `add.reduceat` adds in another order than `sum`, so that the same probabilities have another total.
#
# Packages: numpy 2.4.6
# Tried: 2026-11-28, Python 3.11
# Expected: `np.add.reduceat(x, [0])[0]` is `x.sum()`: both add the same numbers of one array.
# Seen: 0.4 + 0.3 + 0.2 + 0.1 is 0.9999999999999999 by `sum`, and 1.0 by `reduceat`, which adds all but the first number and then that one.
#   Of 1,000 random arrays of eight, the two differ in 408.
# Why it matters: outcomes of a state that are merged by `reduceat` and those that are merged one by one are not the same table, so
#   that digests, caches and "equal to the last bit" fail between two programs that are both right.
# Here: probabilities are merged in the order of `reduceat` wherever that is, in JAX as well
#   (tests/jax_levels/test_exactness.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile numpy==2.4.6
venv/bin/python - <<'EOF'
import numpy as np

print("numpy", np.__version__)
chances = np.array([0.4, 0.3, 0.2, 0.1])
by_sum, by_reduceat = float(chances.sum()), float(np.add.reduceat(chances, [0])[0])
print("the sum:", by_sum)
print("expected of reduceat:", by_sum)
print("seen:", by_reduceat)
first, *others = chances.tolist()
print("the others, and then the first:", sum(others) + first)
random = np.random.default_rng(0)
arrays = [random.random(8) for _ in range(1000)]
print("different of 1,000 random arrays:", sum(np.add.reduceat(x, [0])[0] != x.sum() for x in arrays))
assert by_sum == 0.9999999999999999 and by_reduceat == 1.0 == sum(others) + first
EOF
