"""A level with all kinds of things, for the tests of what people see and play."""

from __future__ import annotations

from typing import Any

from babyrobot_levels.library.level import Level

FIELDS: dict[str, Any] = {
    "version": 1,
    "title": "The vault",
    "size": [7, 5],
    "exit": [6, 4],
    "exit_needs": ["gem"],
    "items": [
        {"name": "key", "at": [0, 4], "color": "gold"},
        {"name": "coin", "at": [3, 0], "reward": 5},
        {"name": "gem", "one_of": [[5, 1], [5, 3]]},
    ],
    "walls": [{"at": [4, 0], "side": "E", "length": 2}, {"at": [4, 3], "side": "E", "length": 2}],
    "doors": [{"at": [4, 2], "side": "E", "needs": "key"}],
    "switches": [{"name": "lever", "at": [2, 2]}],
    "movers": [
        {"name": "guard", "path": [[2, 4], [3, 4], [4, 4]], "back": True},
        {"name": "bat", "within": {"at": [5, 0], "size": [2, 2]}, "start": [6, 0], "label": "Bo"},
    ],
    "puddles": [{"at": [1, 2]}],
    "hit": {"reward": -10, "ends": True},
    "display": {"robot": {"speed": 100}},
}


def vault(**fields: Any) -> Level:
    """Return the level, with other fields."""
    return Level.from_fields({**FIELDS, **fields})
