#!/usr/bin/env bash
# Everything that must pass before a commit: style, types, tests.
# Usage: bash scripts/check.sh        all but the tests that need Stable-Baselines3
#        bash scripts/check.sh sb3    only those (they bring torch)
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/venv.sh
options=(--quiet --disable-pip-version-check)
# The tests start hundreds of processes: each would compile the package anew.
unset PYTHONDONTWRITEBYTECODE
if [ "${1:-}" = sb3 ]; then
    make_venv .venv-sb3
    # Named first and exactly, so that a build for the CPU is taken where one is at hand.
    .venv-sb3/bin/pip install "${options[@]}" torch==2.13.0
    .venv-sb3/bin/pip install "${options[@]}" --editable ".[test,sb3]"
    exec .venv-sb3/bin/python -m pytest -m sb3 -n 2 tests/envs tests/e2e/test_examples.py tests/docs/test_training.py
fi
make_venv .venv
.venv/bin/pip install "${options[@]}" --editable ".[test]"
bash scripts/browser.sh .venv/bin/python
.venv/bin/ruff check .
.venv/bin/ruff format --check .
.venv/bin/mypy
.venv/bin/babyrobot validate levels
exec .venv/bin/python -m pytest -m "not sb3" -n 2
