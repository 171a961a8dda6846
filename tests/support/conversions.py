"""Samples of other packages' worlds, and short ways to convert."""

from __future__ import annotations

import json
from typing import Any

from babyrobot_levels.extensions.formats.conversion import World
from babyrobot_levels.extensions.formats.formats import FORMATS
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile
from support.places import TESTS

SAMPLES = TESTS / "extensions" / "formats" / "samples"


def sample(name: str) -> dict[str, Any]:
    """Return a file of samples."""
    found: dict[str, Any] = json.loads((SAMPLES / f"{name}.json").read_text(encoding="utf-8"))
    return found


def world_of(text: str, name: str) -> World:
    """Return the world that a text in a format says."""
    return FORMATS[name].read(SourceFile("world.txt", text))


def level_of_world(world: World) -> Level:
    """Return the level of a world."""
    return Level.from_fields(world.fields)


def lost_fields(world: World) -> list[str]:
    """Return the names of what could not come along."""
    return [lost.field for lost in world.lost]
