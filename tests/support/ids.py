"""All ids with what they need to be made, and all kinds of observations."""

from __future__ import annotations

from typing import Any

from babyrobot_levels.envs.observations import OBSERVATIONS
from support.playing import GALLERY, level_named

LEVEL_ID, SUITE_ID = "babyrobot/Level-v0", "babyrobot/Suite-v0"

IDS: dict[str, dict[str, Any]] = {
    **{f"babyrobot/{name}-v0": {} for name in GALLERY},
    LEVEL_ID: {"level": "final-maze"},
    SUITE_ID: {"suite": "small-mazes"},
}
"""The arguments without which the environment of an id cannot be made."""

FEW: dict[str, dict[str, Any]] = {
    "babyrobot/final-maze-v0": {},
    "babyrobot/frozen-lake-v0": {},
    "babyrobot/random-maze-v0": {},
    LEVEL_ID: {"level": level_named("things of all kinds").model_dump(exclude_unset=True)},
    SUITE_ID: {"suite": "small-mazes"},
}
"""A plain level, a slippery one, random mazes, things, and a suite with levels of many sizes."""

KINDS: dict[str, dict[str, Any]] = {
    **{name: {"observation": name} for name in OBSERVATIONS},
    "image": {"observation": "image", "image_size": (12, 15)},
    "grey image": {"observation": "image", "image_size": (12, 15), "grayscale": True},
    "planes of bytes": {"observation": "planes", "planes_dtype": "uint8", "channels_last": True},
    "dict": {"observation": ("position", "walls", "vector")},
}
"""Arguments for each kind of observation."""
