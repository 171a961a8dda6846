#!/usr/bin/env bash
# A FrozenLake that is one column wide cannot be made from a list of rows.
#
# Packages: gymnasium 1.4.0, numpy 2.4.6
# Tried: 2026-11-28, Python 3.11
# Expected: `desc=["S", "F", "G"]` is a lake of 3 rows and 1 column, as `desc=["SFG"]` is one of 1 row and 3 columns.
# Seen: ValueError, "not enough values to unpack". Of rows with one letter, NumPy's type of characters makes an array with
#   one axis, of rows with more letters one with two. Rows as lists of letters, `[["S"], ["F"], ["G"]]`, work.
# Why it matters: whoever generates lakes of random sizes, or shrinks a lake to the smallest that shows a mistake,
#   comes to one column at last.
# Here: lakes of one column are exported as lists of letters
#   (`test_a_lake_of_one_column_can_be_made` in tests/extensions/formats/test_frozen_lake.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile gymnasium==1.4.0 numpy==2.4.6
venv/bin/python - <<'EOF'
import gymnasium

print("gymnasium", gymnasium.__version__)


def shape(rows):
    return gymnasium.make("FrozenLake-v1", desc=rows).unwrapped.desc.shape


print("a row as a text:", shape(["SFG"]))
print("a column as lists of letters:", shape([["S"], ["F"], ["G"]]))
print("expected of a column as texts: (3, 1)")
try:
    seen = shape(["S", "F", "G"])
except ValueError as error:
    seen = f"ValueError, {error}"
print("seen:", seen)
assert shape(["SFG"]) == (1, 3) and shape([["S"], ["F"], ["G"]]) == (3, 1)
assert "not enough values to unpack" in seen
EOF
