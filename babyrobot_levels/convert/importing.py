"""`import_`: files and environments of other programs as levels."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from babyrobot_levels.analysis.environments import ComparisonError, made_minigrid
from babyrobot_levels.convert.conversion import ConversionError, World, file_text, level_of
from babyrobot_levels.convert.formats import FORMATS, guess
from babyrobot_levels.convert.minigrid import world_of_environment
from babyrobot_levels.language.documents import slug
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.files import read_source, schema_for, write_new

ENVIRONMENT = re.compile(r"([\w.]+:)?(MiniGrid|BabyAI)-[\w./-]+-v\d+")
"""The ids of MiniGrid's environments."""


def import_(
    source: str | os.PathLike[str],
    path: str | os.PathLike[str] | None = None,
    *,
    format: str | None = None,  # noqa: A002
    name: str | None = None,
    seed: int = 0,
    kwargs: Mapping[str, Any] | None = None,
    slippery: bool | None = None,
    force: bool = False,
) -> Level:
    """Return the level of a file of another program, as `babyrobot import` converts it.

    What a level cannot express is told in `ConversionWarning`s.

    Args:
        source: the path of the file, or the id of an environment of MiniGrid.
        path: a level file to write.
        format: the format of the file, such as `"frozen-lake"`; by default it is detected.
        name: the name of the level; by default that of the file.
        seed: the seed of the reset of an environment.
        kwargs: the keyword arguments of an environment.
        slippery: whether a FrozenLake map is slippery, if it does not say so; by default it is.
        force: whether to replace an existing file.

    Raises:
        ConversionError: the source is not in the format, or not in a known one.
        LevelError: the file cannot be read, or is no valid level.
        ValueError: there is no such format.
        FileExistsError: there is a file, and `force` is not given.
    """
    world = _world(source, format, seed, kwargs, slippery)
    own = name or slug(Path(source).stem)
    if path is not None:
        title = (own or "imported").replace("-", " ").capitalize()
        text = file_text(world, schema=schema_for(Path(path)), name=name, title=title)
        write_new(Path(path), text, force=force)
    return level_of(world, name=own, stacklevel=2)


def _world(
    source: str | os.PathLike[str],
    chosen: str | None,
    seed: int,
    kwargs: Mapping[str, Any] | None,
    slippery: bool | None,
) -> World:
    if isinstance(source, str) and ENVIRONMENT.fullmatch(source) and not Path(source).exists():
        try:
            env = made_minigrid(source, seed, kwargs)
        except ComparisonError as error:
            raise ConversionError(str(error)) from error
        try:
            return world_of_environment(env, source, seed)
        finally:
            env.close()
    text = read_source(Path(source))
    known = [chosen] if chosen is not None else guess(text)
    if chosen is not None and chosen not in FORMATS:
        raise ValueError(f"there is no format {chosen!r}; use one of {', '.join(FORMATS)}")
    if len(known) != 1:
        why = f"may be {' or '.join(known)}" if known else f"is none of {', '.join(FORMATS)}"
        raise ConversionError(f"{text.name} {why}: give its format")
    return FORMATS[known[0]].read(text, slippery=slippery, folder=Path(source).parent)
