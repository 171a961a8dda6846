#!/usr/bin/env bash
# A level file becomes a picture and a film, and the robot follows an optimal policy to the exit.
# Usage: bash scripts/demo.sh [LEVEL.yaml]   (default: levels/final-maze.yaml)
set -euo pipefail
level="$(realpath "${1:-"$(dirname "$0")/../levels/final-maze.yaml"}")"
cd "$(dirname "$0")/.."
source scripts/venv.sh
make_venv .venv
.venv/bin/pip install --quiet --disable-pip-version-check .
.venv/bin/babyrobot validate "$level"
.venv/bin/babyrobot preview "$level" --output demo.png
.venv/bin/babyrobot preview "$level" --policy best --output demo.gif
.venv/bin/python examples/play.py "$level"
echo "Written: demo.png (the level) and demo.gif (the episode above as a film)"
