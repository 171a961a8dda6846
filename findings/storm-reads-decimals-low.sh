#!/usr/bin/env bash
# Storm reads some decimals of a PRISM file one float low, 0.4 and 0.8 among them.
#
# Packages: stormpy 2.0.0
# Tried: 2026-11-28, Python 3.11, Linux
# Expected: `0.4` is the float nearest to 0.4, as in Python, C and Java, and `2/5` at most as good.
# Seen: `0.4` is 0.39999999999999997 and `0.8` is 0.7999999999999999; the fractions `2/5` and `4/5` are right. 0.1, 0.3, 0.6 and 0.7 are
#   right, too, so that a few trials do not show it.
# Why it matters: a table that another program wrote into a PRISM file is not the one that is solved, and rows with 0.2 and 0.8
#   do not add up to one. Comparisons to the last digit fail without a mistake anywhere.
# Here: probabilities and rewards are written as fractions, and Storm's floats are those of the tables
#   (`test_both_files_of_a_level_hold_the_same_floats` in tests/storm/test_second_opinion.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile stormpy==2.0.0
venv/bin/python - <<'EOF'
from pathlib import Path

import stormpy

print("stormpy", stormpy.__version__)


def read(wins, loses):
    Path("game.prism").write_text(f"""dtmc
module game
  s: [0..2] init 0;
  [] s=0 -> {wins}:(s'=1) + {loses}:(s'=2);
  [] s>0 -> (s'=s);
endmodule
""")
    model = stormpy.build_model(stormpy.parse_prism_program("game.prism"))
    return [entry.value for entry in model.transition_matrix.get_row(0)]


for wins, loses in [("0.1", "0.9"), ("0.3", "0.7"), ("2/5", "3/5"), ("4/5", "1/5")]:
    print(wins, loses, read(wins, loses))
print("expected of 0.4 0.6 and 0.2 0.8: [0.4, 0.6] and [0.2, 0.8]")
seen = read("0.4", "0.6"), read("0.2", "0.8")
print("seen:", *seen)
assert read("2/5", "3/5") == [0.4, 0.6] and read("4/5", "1/5") == [0.8, 0.2]
assert seen == ([0.39999999999999997, 0.6], [0.2, 0.7999999999999999])
EOF
