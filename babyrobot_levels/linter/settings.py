"""The linter's settings of a project.

They are the table `[tool.babyrobot.lint]` of a `pyproject.toml` or `[lint]` of a `babyrobot.toml`,
in the nearest such file above the level file.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from functools import lru_cache
from pathlib import Path
from typing import Any

from babyrobot_levels.linter.registry import UnknownRuleError, select
from babyrobot_levels.linter.rule import Rule
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.files import is_file
from babyrobot_levels.text.words import did_you_mean

_KEYS = ("select", "ignore", "per-file-ignores")
_TABLES: dict[str, tuple[str, ...]] = {
    "babyrobot.toml": (),
    "pyproject.toml": ("tool", "babyrobot"),
}
"""The settings files, each with the table that contains the settings of this package."""


class SettingsError(BabyRobotError):
    """A settings file is invalid."""


@dataclass(frozen=True, slots=True)
class Settings:
    """The rules that a project selects.

    Attributes:
        select: codes, prefixes of codes, names or `ALL`; None for the default rules.
        ignore: the same for rules to leave out.
        per_file_ignores: the same for files that match a pattern, relative to `folder`.
        folder: the folder of the settings file, None if there is none.
        file: the settings file, None if there is none.
    """

    select: tuple[str, ...] | None = None
    ignore: tuple[str, ...] = ()
    per_file_ignores: tuple[tuple[str, tuple[str, ...]], ...] = ()
    folder: Path | None = None
    file: Path | None = None

    @property
    def words(self) -> tuple[str, ...]:
        """All codes and names in the settings."""
        extra = (word for _, words in self.per_file_ignores for word in words)
        return (*(self.select or ()), *self.ignore, *extra)

    def ignoring(self, words: tuple[str, ...]) -> Settings:
        """Return the settings with further rules to leave out."""
        return replace(self, ignore=(*self.ignore, *words)) if words else self

    def rules_for(self, path: Path) -> tuple[Rule, ...]:
        """Return the rules that are selected for a file."""
        extra = (
            word
            for pattern, words in self.per_file_ignores
            if self._matches(path, pattern)
            for word in words
        )
        return select(self.select, (*self.ignore, *extra))

    def _matches(self, path: Path, pattern: str) -> bool:
        name = path.absolute()
        inside = self.folder is not None and name.is_relative_to(self.folder)
        shown = name.relative_to(self.folder) if inside and self.folder is not None else name
        return fnmatch(shown.as_posix(), pattern) or fnmatch(path.name, pattern)


def settings_for(path: Path) -> Settings:
    """Return the settings for a level file: those of the nearest settings file above it.

    Raises:
        SettingsError: that file is invalid.
    """
    for folder in path.absolute().parents:
        for name in _TABLES:
            file = folder / name
            if is_file(file):
                status = file.stat()
                found = _settings_in(file, (status.st_mtime_ns, status.st_size))
                if found is not None:
                    return found
    return Settings()


@lru_cache
def _settings_in(path: Path, _state: tuple[int, int]) -> Settings | None:
    """Return the settings in a file, None if it has none. The state makes the cache current."""
    try:
        data: Any = tomllib.loads(path.read_text("utf-8-sig"))
    except (OSError, ValueError) as error:
        raise SettingsError(f"{path} cannot be read: {error}") from None
    for table in _TABLES[path.name]:
        data = data.get(table) if isinstance(data, Mapping) else None
        if data is None:
            return None
    if not isinstance(data, Mapping):
        raise SettingsError(f"{path}: `{'.'.join(_TABLES[path.name])}` must be a table")
    for key in data:
        if key in _KEYS:
            table = ".".join((*_TABLES[path.name], "lint"))
            raise SettingsError(f"{path}: `{key}` belongs in the table `[{table}]`")
        if key != "lint":
            hint = did_you_mean(key, ("lint",))
            raise SettingsError(f"{path}: unknown setting `{key}`{hint}")
    return _settings(path, data.get("lint", {}))


def _settings(path: Path, data: Any) -> Settings:
    if not isinstance(data, Mapping):
        raise SettingsError(f"{path}: `lint` must be a table")
    for key in data:
        if key not in _KEYS:
            raise SettingsError(f"{path}: unknown setting `{key}`{did_you_mean(key, _KEYS)}")
    ignores = data.get("per-file-ignores", {})
    if not isinstance(ignores, Mapping):
        raise SettingsError(f"{path}: `per-file-ignores` must be a table of lists")
    settings = Settings(
        _words(path, "select", data["select"]) if "select" in data else None,
        _words(path, "ignore", data.get("ignore", [])),
        tuple((name, _words(path, name, words)) for name, words in ignores.items()),
        path.parent,
        path,
    )
    try:
        select(settings.select, settings.ignore)
        for _, words in settings.per_file_ignores:
            select(words)
    except UnknownRuleError as error:
        raise SettingsError(f"{path}: {error}") from None
    return settings


def _words(path: Path, key: str, value: Any) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(word, str) for word in value):
        raise SettingsError(f'{path}: `{key}` must be a list of codes, for example `["BR5"]`')
    return tuple(value)
