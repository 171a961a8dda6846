#!/usr/bin/env bash
# A level file becomes a picture and a played episode.
# Usage: bash scripts/demo.sh [LEVEL.yaml]   (default: levels/final-maze.yaml)
set -euo pipefail
level="$(realpath "${1:-"$(dirname "$0")/../levels/final-maze.yaml"}")"
cd "$(dirname "$0")/.."
source scripts/venv.sh
make_venv .venv
.venv/bin/pip install --quiet --disable-pip-version-check .
.venv/bin/babyrobot validate "$level"
.venv/bin/babyrobot preview "$level" --output demo.png --force
.venv/bin/python examples/play.py "$level"
echo "The picture of the level is in demo.png."
