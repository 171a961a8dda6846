#!/usr/bin/env bash
# ipycanvas refuses "beige", "indianred" and "indigo", and none other of CSS's 148 names of colours.
#
# Packages: ipycanvas 0.14.3, pillow 13.0.0
# Tried: 2026-11-28, Python 3.11
# Expected: a canvas takes the names that the browser's canvas takes, all or none.
# Seen: a TraitError for three of them, which says that a valid HTML color is expected.
# Why it matters: a theme of a grid world that works in SVG and PNG raises in a notebook, and so does whoever picks colours from a list of
#   names.
# Here: colours are sent as numbers (`test_what_is_hostile_is_sent_as_a_text_and_nothing_else` in tests/render/notebook/test_canvas.py,
#   which paints in beige).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile ipycanvas==0.14.3 pillow==13.0.0
venv/bin/python - <<'EOF'
from importlib.metadata import version

from ipycanvas import Canvas
from PIL import ImageColor
from traitlets import TraitError

print("ipycanvas", version("ipycanvas"))
canvas, refused = Canvas(), []
for name in ImageColor.colormap:
    try:
        canvas.fill_style = name
    except TraitError:
        refused.append(name)
print("names of colours that Pillow knows:", len(ImageColor.colormap))
print("expected of those that are refused: none")
print("seen:", refused)
assert len(ImageColor.colormap) == 148 and sorted(refused) == ["beige", "indianred", "indigo"]
EOF
