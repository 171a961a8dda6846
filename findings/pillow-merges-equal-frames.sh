#!/usr/bin/env bash
# Pillow merges equal frames of a GIF, so that a film has fewer frames than steps were painted.
#
# Packages: pillow 13.0.0
# Tried: 2026-11-28, Python 3.11. APNG and WebP files are the same in this.
# Expected: of 6 frames that are saved with `save_all=True`, 6 can be read, 100 ms each.
# Seen: 3 frames of 200, 300 and 100 ms: each that is equal to the one before is left out, and the one before lasts longer.
#   Five equal frames are a picture without an animation.
# Why it matters: in a grid world, bumping into a wall changes nothing. Frame 17 of the film is not step 17 of the episode, films of two
#   episodes side by side fall apart, and a test that counts frames depends on the policy.
# Here: films have frames between cells, in which the robot moves toward the wall and back
#   (`test_he_bumps_into_a_wall_and_is_back_where_he_was` in tests/render/test_gif.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile pillow==13.0.0
venv/bin/python - <<'EOF'
import io

import PIL
from PIL import Image, ImageSequence

print("pillow", PIL.__version__)
STEPS = ["red", "red", "blue", "blue", "blue", "green"]


def times(colors, kind):
    first, *others = [Image.new("RGB", (8, 8), color) for color in colors]
    file = io.BytesIO()
    first.save(file, kind, save_all=True, append_images=others, duration=100, loop=0)
    found = []
    for frame in ImageSequence.Iterator(Image.open(file)):
        frame.load()
        found.append(int(frame.info["duration"]))
    return found


print("expected of six frames, three of them like the one before:", [100] * 6)
seen = {kind: times(STEPS, kind) for kind in ("GIF", "PNG", "WEBP")}
print("seen:", seen)
print("of five equal frames:", times(["red"] * 5, "GIF"))
assert times(["red", "blue", "red"], "GIF") == [100] * 3
assert list(seen.values()) == [[200, 300, 100]] * 3
assert times(["red"] * 5, "GIF") == [500]
EOF
