"""Facts of levels for tests of walls, without the levels."""

from __future__ import annotations

import hashlib
from typing import Any

from babyrobot_levels.extensions.publish.facts import Facts, Files


def facts_of_wall(
    name: str,
    *,
    title: str = "",
    description: str = "",
    tags: tuple[str, ...] = (),
    split: str = "",
    size: tuple[int, int] = (3, 3),
    things: tuple[str, ...] = (),
    features: tuple[str, ...] = (),
    best_return: float | None = -4.0,
    best_steps: float | None = 4.0,
    difficulty: float | None = 2.0,
    film: bool = False,
    hardness: dict[str, Any] | None = None,
) -> Facts:
    """Return the facts of a level that is deterministic."""
    return Facts(
        id=name,
        name=name,
        title=title or name,
        description=description,
        author="",
        source="",
        tags=tags,
        split=split,
        digest=hashlib.sha256(name.encode()).hexdigest(),
        size=size,
        states=9,
        max_steps=None,
        discount=1.0,
        deterministic=True,
        things=things,
        features=features,
        best_return=best_return,
        best_steps=best_steps,
        random_return=-40.0,
        difficulty=difficulty,
        files=Files(
            page=f"{name}/index.html",
            level=f"{name}/level.yaml",
            svg=f"{name}/picture.svg",
            png=f"{name}/picture.png",
            tile=f"{name}/tile.png",
            film=f"{name}/film.gif" if film else None,
        ),
        hardness=hardness or {},
    )
