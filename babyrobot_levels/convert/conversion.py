"""The results of conversions, with everything that could not be kept, and their errors."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from babyrobot_levels.language.kinds import THINGS
from babyrobot_levels.library.level import Level
from babyrobot_levels.suites.checking import errors_of
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.emitter import emit_field
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import source_of
from babyrobot_levels.text.source import Position, SourceFile, Span

_NOT_LOST = frozenset({"version", "name", "map", "legend"})
"""Fields of the file itself, or whose content is in other fields as well."""


_THINGS = {
    **{kind.field: "they are left out" for kind in THINGS},
    "doors": "they stand open",
    "exit_one_of": "each of the cells is an exit",
    "exit_needs": "the exits need nothing",
}
"""What becomes of fields that no format but Tiled's can hold."""


class ConversionWarning(UserWarning):
    """Something of another program's world that its level does not have."""

    __module__ = "babyrobot_levels"


class ConversionError(LevelError):
    """Text or data that is not a valid world of the format that it is read as.

    `help` says what to do about it, or is None.
    """

    def __init__(self, message: str, help_text: str | None = None):
        self.help = help_text
        super().__init__((), f"{message}\n  help: {help_text}" if help_text else message)

    def __reduce__(self) -> Any:
        # The message has the help already.
        return LevelError, ((), self.message)

    @classmethod
    def at(
        cls, source: SourceFile, place: Position, message: str, help_text: str | None = None
    ) -> ConversionError:
        """Return the error for a place in a text, which it shows."""
        lines = [f"{one_line(source.name)}:{place.line}:{place.column}: error: {one_line(message)}"]
        if source.line(place.line):
            end = Position(place.line, place.column + 1)
            excerpt = source.excerpt(Span(place, end))
            number, gutter = str(place.line), " " * len(str(place.line))
            lines += [f"  {gutter} |", f"  {number} | {excerpt[0]}", f"  {gutter} | {excerpt[1]}"]
        return cls("\n".join(lines), help_text)


@dataclass(frozen=True, slots=True)
class Lost:
    """Something that a conversion does not keep.

    Attributes:
        field: its name where it comes from: a field of the level, or a name of the format.
        message: what becomes of it.
    """

    field: str
    message: str

    def __str__(self) -> str:
        return f"{self.field}: {self.message}"


@dataclass(frozen=True, slots=True)
class World:
    """A world of another format, in the fields of the language.

    Attributes:
        fields: the fields, as in a level file.
        origin: where it comes from, as a sentence.
        comments: for some fields, a comment that stands above them in a file.
        lost: what is not kept.
    """

    fields: dict[str, Any]
    origin: str
    comments: Mapping[str, str] = field(default_factory=dict)
    lost: tuple[Lost, ...] = ()


@dataclass(frozen=True, slots=True)
class Conversion:
    """The result of a conversion.

    Attributes:
        text: the world in its new form.
        warnings: what is not kept, in the order in which it was found.
        beside: files that belong to the text, by name.
    """

    text: str
    warnings: tuple[Lost, ...] = ()
    beside: Mapping[str, bytes] = field(default_factory=dict)


def _never(*_: Any) -> bool:
    return False


@dataclass(frozen=True, slots=True)
class Codec:
    """How the texts of a format are read, written and recognised.

    Attributes:
        read: returns the world of a text; it may take keywords, which the format names.
        write: returns a level as a text; None if levels are not written.
        draws: whether a text, with these characters beside line ends, is a map that is drawn.
        holds: whether data in JSON, or in a Python literal, is a world.
    """

    read: Callable[..., World]
    write: Callable[[Level], Conversion] | None = None
    draws: Callable[[SourceFile, set[str]], bool] = _never
    holds: Callable[[Any], bool] = _never


def level_of(world: World, *, name: str | None = None, stacklevel: int = 1) -> Level:
    """Return the level of a world, with a `ConversionWarning` for each thing that is not kept.

    Args:
        world: the world.
        name: the level's name.
        stacklevel: which caller the warnings name; 1 is the caller of this function.

    Raises:
        LevelError: the world is not a valid level.
    """
    for lost in world.lost:
        warnings.warn(str(lost), ConversionWarning, stacklevel=stacklevel + 1)
    return Level.from_fields(world.fields, name=name)


def file_text(world: World, *, schema: str | None, name: str | None, title: str) -> str:
    """Return the text of a level file.

    Args:
        world: its content.
        schema: where editors find the JSON schema, for the file's first line; None for no line.
        name: the level's name, None to use that of the file.
        title: the level's title, if the world has none.

    Raises:
        ConversionError: the world is too large for a file.
        LevelError: it is not a valid level.
    """
    fields = {"version": 1, **({"name": name} if name else {}), "title": title, **world.fields}
    if name:
        fields["name"] = name
    lines = [f"# yaml-language-server: $schema={schema}\n"] if schema else []
    lines.append(f"# {world.origin}\n")
    for key, value in fields.items():
        if key in world.comments:
            lines.append(f"# {world.comments[key]}\n")
        lines.append(emit_field(key, value))
    return _tidy("".join(lines))


def _tidy(text: str) -> str:
    """Return a level's text as `babyrobot lint --fix` and `babyrobot format` leave it."""
    # Here, because exporting does not need the linter.
    from babyrobot_levels.language.formatting import format_source
    from babyrobot_levels.linter.fixer import fix
    from babyrobot_levels.linter.rules import select

    try:
        source = source_of(text.encode("utf-8"), "<imported>")
    except LevelError as error:
        raise ConversionError(
            f"the level would be too large for one file: {error.diagnostics[0].message}",
            "a drawing takes eight characters a cell, so it has room for some 360 by 360 cells",
        ) from None
    errors = errors_of(source)
    if errors:
        raise ConversionError("this is not a valid level:\n" + "\n".join(map(str, errors[:5])))
    fixed = fix(source, select(None)).text
    return format_source(SourceFile(source.name, fixed)).text


def fields_lost(level: Level, carried: frozenset[str], place: str) -> Iterator[Lost]:
    """Yield the fields of a level that are not at their defaults and not kept by a format.

    Args:
        level: the level.
        carried: the fields that the format can hold.
        place: what cannot hold the others: "a FrozenLake map".
    """
    given = level.model_dump(by_alias=True, exclude_defaults=True)
    for name in type(level).model_fields:
        if name in given and name not in carried and name not in _NOT_LOST:
            becomes = f"them: {_THINGS[name]}" if name in _THINGS else "it"
            yield Lost(name, f"{place} cannot hold {becomes}")


def shown(value: Any) -> str:
    """Return a value of any kind and size as a short text for a message."""
    # Only a few levels deep: a value from a file may be nested as deep as its parser allows.
    if isinstance(value, list | tuple | dict):
        return f"a {type(value).__name__} of {len(value)}" if len(value) > 4 else _brief(value)
    return _brief(value)


def _brief(value: Any) -> str:
    try:
        text = one_line(repr(value))
    except (RecursionError, ValueError):
        text = f"a {type(value).__name__}"
    return text if len(text) <= 60 else text[:59] + "…"
