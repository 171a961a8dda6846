"""The pictures of things in `docs/pictures.md`."""

from __future__ import annotations

from babyrobot_levels.library.level import Level
from support.places import DOCS

DOCUMENT = DOCS / "pictures.md"
FOLDER = DOCS / "images"

LEVEL = {
    "version": 1,
    "title": "A vault with a key, two gems and two guards",
    "size": [8, 5],
    "start": [0, 2],
    "exit": [7, 2],
    "exit_needs": "gem",
    "walls": [
        {"at": [4, 0], "side": "E", "length": 5},
        {"at": [0, 0], "side": "S", "length": 2},
        {"at": [3, 0], "side": "S", "length": 2},
    ],
    "openings": [{"at": [4, 2], "side": "E"}],
    "items": [
        {"name": "key", "at": [0, 0]},
        {"name": "coin", "at": [4, 4], "reward": 3},
        {"name": "gem", "one_of": [[6, 0], [6, 4]]},
    ],
    "doors": [
        {"at": [4, 2], "side": "E", "needs": "key"},
        {"at": [2, 0], "side": "S", "needs": "lever", "color": "#5b8def"},
    ],
    "switches": [{"name": "lever", "at": [0, 4], "color": "#5b8def"}],
    "movers": [
        {"path": [[2, 2], [2, 3], [3, 3], [3, 2]]},
        {"within": {"at": [6, 1], "size": [2, 1]}, "start": [6, 1]},
    ],
    "theme": "blue_green",
}


def pictures() -> dict[str, str]:
    """Return the pictures by the names of their files."""
    level = Level.from_fields(LEVEL)
    held = level.to_svg(policy="best", held=["key", "lever"])
    return {"things.svg": level.to_svg(), "things-held.svg": held}
