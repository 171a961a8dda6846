#!/usr/bin/env bash
# gymnax cannot be imported after it was installed alone: it needs six, and says so nowhere.
#
# Packages: gymnax 1.0.1, jax 0.10.2, python-dateutil 4.0.0
# Tried: 2026-11-28, Python 3.11
# Expected: `pip install gymnax` brings what `import gymnax` needs.
# Seen: ModuleNotFoundError: No module named 'six'. It used to come with python-dateutil, of which Matplotlib takes any version, and whose
#   version 4 does without.
# Why it matters: environments in JAX cannot be built anew with the versions of gymnax and JAX with which they worked.
#   What changed is two packages away, and no pin of one's own names it.
# Here: the extra `jax` names six, and the step `jax` of scripts/check.sh runs the tests with gymnax
#   (tests/jax_levels/test_gymnax.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile gymnax==1.0.1 jax==0.10.2 python-dateutil==4.0.0
venv/bin/python -W ignore - <<'EOF'
from importlib.metadata import requires, version

for name in ("gymnax", "jax", "python-dateutil"):
    print(name, version(name))
print("gymnax requires six:", any(each.startswith("six") for each in requires("gymnax")))
print("expected of `import gymnax`: nothing")
try:
    import gymnax  # noqa: F401
except ModuleNotFoundError as error:
    seen = error.name
else:
    seen = None
print("seen: it misses", seen)
assert seen == "six"
EOF
