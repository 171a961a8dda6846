#!/usr/bin/env bash
# Everything that must pass before a commit: style, types, the order of imports, tests.
# Usage: bash scripts/check.sh             with the fast tests: about four minutes on two cores
#        bash scripts/check.sh all         with the slow ones too: large levels, browsers, notebooks ...
#        bash scripts/check.sh libraries   the tests with SB3, RLlib, TorchRL, Tianshou and Minari
#        bash scripts/check.sh jax         the tests with JAX, gymnax and JaxUED
#        bash scripts/check.sh ray         the tests on a Ray cluster of two nodes
#        bash scripts/check.sh lowest      the environments' tests, with the lowest versions allowed
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/venv.sh
options=(--quiet --disable-pip-version-check)
# Each process has tests that stand together, and takes others' once it has none left.
workers=(-n 2 --dist worksteal)
# The tests start hundreds of processes: each would compile the package anew.
unset PYTHONDONTWRITEBYTECODE
case "${1:-fast}" in
fast) tests=(-m "not slow and not libraries") ;;
all) tests=(-m "not libraries" --hypothesis-profile thorough) ;;
libraries)
    make_venv .venv-libraries
    # Named first and exactly, so that a build for the CPU is taken where one is at hand.
    .venv-libraries/bin/pip install "${options[@]}" torch==2.13.0
    .venv-libraries/bin/pip install "${options[@]}" --editable ".[test,minari,rllib,sb3,tianshou,torchrl]"
    exec .venv-libraries/bin/python -m pytest -m "libraries and not sweep" "${workers[@]}" tests/envs tests/scoring tests/e2e/test_examples.py tests/docs/test_training.py tests/docs/test_benchmark.py
    ;;
jax)
    make_venv .venv-jax
    .venv-jax/bin/pip install "${options[@]}" --editable ".[fast,jax]" hypothesis jaxued==0.0.1 pytest pytest-xdist
    exec .venv-jax/bin/python -m pytest -m libraries -rs "${workers[@]}" tests/jax_levels
    ;;
ray)
    make_venv .venv-ray
    .venv-ray/bin/pip install "${options[@]}" --editable ".[fast,ray]" hypothesis pytest
    exec .venv-ray/bin/python -m pytest -m libraries tests/on_ray
    ;;
lowest)
    make_venv .venv-lowest
    .venv-lowest/bin/pip install "${options[@]}" --constraint scripts/lowest.txt --editable ".[fast]" \
        hypothesis ipykernel moviepy nbclient nbformat opencv-python-headless pygame-ce pytest pytest-xdist
    exec .venv-lowest/bin/python -m pytest -m "not libraries and not sweep" "${workers[@]}" tests/envs
    ;;
*)
    sed -n '3,9s/^# //p' scripts/check.sh >&2
    exit 2
    ;;
esac
make_venv .venv
.venv/bin/pip install "${options[@]}" --editable ".[test]"
[ "${1:-fast}" = fast ] || bash scripts/browser.sh .venv/bin/python
.venv/bin/ruff check .
.venv/bin/ruff format --check .
.venv/bin/lint-imports
.venv/bin/babyrobot validate levels
# Types are checked while the tests run, in what they leave of two cores.
said="$(mktemp)"
.venv/bin/mypy >"$said" 2>&1 &
types=$! status=0
.venv/bin/python -m pytest "${tests[@]}" "${workers[@]}" || status=$?
wait "$types" || status=$?
cat "$said"
rm "$said"
exit "$status"
