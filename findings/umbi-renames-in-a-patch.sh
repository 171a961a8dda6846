#!/usr/bin/env bash
# umbi renamed its transition systems and their methods between two patch versions.
#
# Packages: umbi 0.2.5, umbi 0.2.14 (needs Python 3.12 or later: set PYTHON if `python3` is older)
# Tried: 2026-11-28, Python 3.13
# Expected: what reads a file with 0.2.5 does so with 0.2.14, at least as far as names that both versions have.
# Seen: `ExplicitAts` is gone, and `SimpleAts` came; its `add_state_choice` became `new_state_choice`.
# Why it matters: 0.2.14 asks for Python 3.12, so the same `umbi>=0.2` means either version by the Python that is there: programs of a model
#   checker's output work on one machine, and raise AttributeError on the next.
# Here: archives are written and read by the arrays of the format, whose names have stayed
#   (`test_an_archive_says_what_the_tables_say` in tests/extensions/formats/test_models.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cat >told.py <<'EOF'
from importlib.metadata import version

import umbi.ats

kind = getattr(umbi.ats, "ExplicitAts", None) or umbi.ats.SimpleAts
for name in ("add_state_choice", "new_state_choice"):
    print(version("umbi"), kind.__name__, name, hasattr(kind, name))
EOF
for version in 0.2.5 0.2.14; do
    "${PYTHON:-python3}" -m venv --clear venv
    venv/bin/pip install --quiet --disable-pip-version-check --no-compile "umbi==$version"
    venv/bin/python told.py >>seen
done
echo "expected: the same class with the same methods in both versions"
echo "seen:"
cat seen
diff seen - <<'EOF'
0.2.5 ExplicitAts add_state_choice True
0.2.5 ExplicitAts new_state_choice False
0.2.14 SimpleAts add_state_choice False
0.2.14 SimpleAts new_state_choice True
EOF
