"""Levels as workers get them: the number of one in a suite, its share code, its file, or itself."""

import json
import os
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.language.share_code import is_code
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.library.catalogue import LevelLike, level_path, load
from babyrobot_levels.library.level import Level, load_code, load_file, load_source
from babyrobot_levels.parallel.executor import Failure, portable
from babyrobot_levels.suites.suite import Levels, Suite, load_suite, named_levels
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.source import SourceFile

Item = int | str | SourceFile | Level | Exception
"""A level as it is sent: its number in a suite, its share code, its file, itself, or an error."""


def sent(levels: Levels) -> tuple[str | None, Iterable[Item]]:
    """Return the suite that workers need, as JSON, and what is sent to them for each level."""
    suite = named_levels(levels)
    if not isinstance(suite, Suite):
        return None, _items(_item_of, suite)
    if isinstance(suite.fields, SuiteFields):
        # A file may give the suite its name, and this one its levels theirs.
        return json.dumps({**suite.to_dict(whole=True), "name": suite.name}), suite.numbers
    return None, _items(lambda index: suite[index], range(len(suite)))


def _items(make: Callable[[Any], Item], levels: Iterable[Any]) -> Iterator[Item]:
    """Yield what is sent for each level. Errors are raised by workers, to have their places."""
    for level in levels:
        try:
            item = make(level)
        except (BabyRobotError, OSError) as error:
            item = portable_error(error)
        yield item


def _item_of(level: LevelLike) -> str | SourceFile | Level:
    if isinstance(level, str) and is_code(level):
        return level
    if isinstance(level, str | os.PathLike):
        path = level_path(level)
        source = read_source(path)
        if "theme" in source.text:
            file = load_file(path)
            if isinstance(file.theme, str) and file.theme not in BUILTIN_THEMES:
                # It may be a file beside the level, which other machines need not have.
                text = file.replace(theme=file.resolved_theme).to_yaml(comments=True)
                return SourceFile(source.name, text)
        return source
    return load(level)


def received(suite: str | None, item: Item) -> Level:
    """Return a level that was sent.

    Raises:
        Exception: it cannot be loaded, here or where it was sent from.
    """
    if isinstance(item, Exception):
        raise item
    if isinstance(item, SourceFile):
        return load_source(item, Path(item.name))
    if isinstance(item, str):
        return load_code(item)
    if isinstance(item, Level):
        # What is compiled is not kept for whoever has the level.
        return item.model_copy()
    assert suite is not None
    return _suite(suite)[item]


@lru_cache(maxsize=2)
def _suite(text: str) -> Suite:
    return load_suite(json.loads(text))


def portable_error(error: Exception) -> Exception:
    """Return an error that another process can read."""
    return portable(Failure(0, error)).error
