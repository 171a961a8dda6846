"""Draw the pictures with answers in `docs/pictures.md` anew.

From the top of the repository: `PYTHONPATH=tests python -m renew.answer_pictures`
"""

from __future__ import annotations

import io

from PIL import Image
from support.places import DOCS

import babyrobot_levels as brl

FOLDER = DOCS / "images" / "answers"

GALLERY = (
    "final-maze",
    "river-crossing",
    "teleport-pads",
    "cliff-walking",
    "gridworld-3-5",
    "frozen-lake",
    "frozen-lake-dry",
    "treasure-chests",
)
SIDE = 64
"""The side of a large maze."""

COLORS = 96
"""Few colours make small files."""


def small(picture: bytes) -> bytes:
    """Return a PNG file with few colours."""
    buffer = io.BytesIO()
    Image.open(io.BytesIO(picture)).convert("RGB").quantize(COLORS).save(
        buffer, "PNG", optimize=True
    )
    return buffer.getvalue()


if __name__ == "__main__":
    for name in GALLERY:
        picture = brl.load(name).to_png(values=True, policy=True, scale=40 / 64)
        (FOLDER / f"{name}.png").write_bytes(small(picture))
    maze = brl.Level(version=1, size=(SIDE, SIDE), maze={"seed": 1})
    picture = maze.to_png(values=True, scale=10 / 64)
    (FOLDER / f"maze-{SIDE}.png").write_bytes(small(picture))
    print(f"{len(GALLERY) + 1} pictures")
