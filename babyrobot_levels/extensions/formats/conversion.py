"""The results of conversions, what could not be kept, and data of other programs, checked."""

from __future__ import annotations

import ast
import json
import math
import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from babyrobot_levels.extensions.formats.places import At, Places, Route
from babyrobot_levels.language.kinds import THINGS
from babyrobot_levels.language.looks import LONGEST_COLOR, is_color
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.emitter import emit_field
from babyrobot_levels.text.errors import LevelError, warn
from babyrobot_levels.text.files import is_within, read_source, source_of
from babyrobot_levels.text.source import START, Position, SourceFile, Span
from babyrobot_levels.text.words import Telling

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

    __module__ = "babyrobot_levels"

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
        at: where it stands in the file; None in a conversion from a level, which has its field.
    """

    field: str
    message: str
    at: At | None = None

    def __str__(self) -> str:
        return f"{self.field}: {self.message}"

    def place(self, file: str) -> str:
        """Return what a message about it begins with: file, line and column, as far as known."""
        at = self.at
        if not isinstance(at, Position):
            return f"{one_line(file)}: " if file else ""
        return f"{one_line(file)}:{at.line}:{at.column}: "


def on_map(lost: Iterable[Lost], rows: Sequence[Position], wide: int = 1) -> tuple[Lost, ...]:
    """Return losses with the places in the text of cells `(x, y)` of a map.

    Args:
        lost: the losses; those without a place are of the whole map.
        rows: where each row begins.
        wide: how many characters a cell takes.
    """

    def place(at: At | None) -> Position:
        if isinstance(at, Position):
            return at
        x, y = map(int, at or (0, 0))
        return Position(rows[y].line, rows[y].column + wide * x)

    return tuple(replace(each, at=place(each.at)) for each in lost)


@dataclass(frozen=True, slots=True)
class World:
    """A world of another format, in the fields of the language.

    Attributes:
        fields: the fields, as in a level file.
        origin: where it comes from, as a sentence.
        comments: for some fields, a comment that stands above them in a file.
        lost: what is not kept.
        file: the name of the file that it is read from.
    """

    fields: dict[str, Any]
    origin: str
    comments: Mapping[str, str] = field(default_factory=dict)
    lost: tuple[Lost, ...] = ()
    file: str = ""


@dataclass(frozen=True, slots=True)
class Conversion(Telling):
    """The result of a conversion.

    Attributes:
        text: the world in its new form; empty if that is no text.
        warnings: what is not kept, in the order in which it was found.
        beside: files that belong to the text, by name.
        data: the world in its new form, if that is no text.
    """

    __module__ = "babyrobot_levels"

    text: str
    warnings: tuple[Lost, ...] = ()
    beside: Mapping[str, bytes] = field(default_factory=dict)
    data: bytes | None = None

    @property
    def content(self) -> str | bytes:
        """The world in its new form, as a file holds it."""
        return self.text if self.data is None else self.data


class Part(NamedTuple):
    """One of several worlds in a text.

    Attributes:
        text: what a text of this format has that holds it alone.
        line: where it begins in the text of all, counted from 1.
        route: where it is in data, if the text is made of a part of it.
        rows: where its lines stand, if they do not follow each other in the text of all.
    """

    text: str
    line: int = 1
    route: Route = ()
    rows: tuple[Position, ...] = ()

    def placed(self, at: At | None, places: Callable[[Route], Position]) -> Position:
        """Return where a place in this part is in the text of all; None stands for the part."""
        if at is None:
            at = START if not self.route else ()
        if not isinstance(at, Position):
            return places((*self.route, *at))
        if self.rows:
            row = self.rows[min(at.line, len(self.rows)) - 1]
            return Position(row.line, row.column + at.column - 1)
        return Position(self.line + at.line - 1, at.column)


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
        decodes: returns the text that the bytes of a file stand for, which is then read; None if
            they are no such file. Formats that are texts have none.
        parts: returns the worlds of a text, each as a text of its own; None if texts of this format
            have a single one.
        team: returns the world of several robots of a text that has many, by how many they are;
            None if texts of this format have none.
        places: returns what finds the places of values in a text, which is data.
    """

    read: Callable[..., World]
    write: Callable[[Level], Conversion] | None = None
    draws: Callable[[SourceFile, set[str]], bool] = _never
    holds: Callable[[Any], bool] = _never
    decodes: Callable[[bytes], str | None] | None = None
    parts: Callable[[SourceFile], Sequence[Part]] | None = None
    team: Callable[[SourceFile, int], Part] | None = None
    places: Callable[[SourceFile], Callable[[Route], Position]] = Places


def level_of(world: World, *, name: str | None = None) -> Level:
    """Return the level of a world, with a `ConversionWarning` for each thing that is not kept.

    Args:
        world: the world.
        name: the level's name.

    Raises:
        LevelError: the world is not a valid level.
    """
    for lost in world.lost:
        warn(f"{lost.place(world.file)}{lost}", ConversionWarning)
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
    named = {"name": name} if name else {}
    fields = {"version": 1, **named, "title": title, **world.fields, **named}
    lines = [f"# yaml-language-server: $schema={schema}\n"] if schema else []
    lines.append(f"# {world.origin}\n")
    for key, value in fields.items():
        if key in world.comments:
            lines.append(f"# {world.comments[key]}\n")
        lines.append(emit_field(key, plain(value)))
    return _tidy("".join(lines))


def _tidy(text: str) -> str:
    """Return a level's text as `babyrobot lint --fix` and `babyrobot format` leave it."""
    # Here, because exporting does not need the linter.
    from babyrobot_levels.language.formatting import format_source
    from babyrobot_levels.linter.finding import Needs
    from babyrobot_levels.linter.rules import select
    from babyrobot_levels.linter.runner import fix

    try:
        source = source_of(text.encode("utf-8"), "<imported>", is_made=True)
    except LevelError as error:
        raise ConversionError(
            f"the level would be too large for one file: {error.diagnostics[0].message}",
            "a drawing takes eight characters a cell, so it has room for some 360 by 360 cells",
        ) from None
    # What needs tables may take long, and is no matter of style.
    fixed = fix(source, [rule for rule in select(None) if rule.needs is Needs.LEVEL])
    if not fixed.report.is_valid:
        errors = map(str, fixed.report.diagnostics[:5])
        raise ConversionError("this is not a valid level:\n" + "\n".join(errors))
    return format_source(SourceFile(source.name, fixed.text)).text


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
    if isinstance(value, list | tuple | dict) and len(value) > 4:
        return f"a {type(value).__name__} of {len(value)}"
    try:
        text = one_line(repr(value))
    except (RecursionError, ValueError):
        text = f"a {type(value).__name__}"
    return text if len(text) <= 60 else text[:59] + "…"


def file_beside(folder: Path, name: str) -> SourceFile:
    """Return a file that a text names, which must be in its folder or below it.

    Raises:
        ConversionError: it is outside, or cannot be read.
    """
    path = folder / name
    if not is_within(path, folder):
        raise ConversionError(f"{shown(name)} is outside the folder of the file, and is not read")
    try:
        return read_source(path, one_line(name))
    except LevelError as error:
        raise ConversionError(f"{shown(name)}: {error.diagnostics[0].message}") from None


# -- data of other programs ------------------------------------------------------------------------

MAX_DEPTH = 32
"""Lists and mappings inside one another. No format has more than a few."""

_MAX_INTEGER = 2**53
"""Numbers up to this are written as integers: all of these are floats as well."""

_PLAIN = "use only numbers, strings, lists, tuples and dicts; names and calls are not allowed"
_DATA = (
    *(ast.Constant, ast.List, ast.Tuple, ast.Set, ast.Dict, ast.UnaryOp, ast.unaryop),
    *(ast.Module, ast.Expr, ast.Assign, ast.expr_context),
)


_DATA_BEGINS = re.compile(r"""\s*([\[{("']|\w+\s*=)""")


def looks_like_data(text: str) -> bool:
    """Return whether a text may be JSON or a Python literal, rather than a drawn map."""
    return _DATA_BEGINS.match(text) is not None


def read_data(source: SourceFile) -> Any:
    """Return the data of a text: JSON, or a Python literal, also one that a name is given to.

    Keyword arguments, as in a call, are a mapping.

    Raises:
        ConversionError: it is neither, or nested too deep.
    """
    _check_depth(source)
    try:
        return json.loads(source.text, parse_constant=_refuse)
    except ValueError as json_error:
        try:
            return _literal(source.text)
        except SyntaxError as error:
            if isinstance(json_error, json.JSONDecodeError):
                _raise_farther(source, json_error, error)
            message = str(json_error)
            # Python speaks of its own limits there.
            raise ConversionError(
                "a number has too many digits" if "digits" in message else message
            ) from None
        except (ValueError, MemoryError, RecursionError):
            message = "this is neither JSON nor a plain Python literal"
            raise ConversionError.at(source, _first_code(source.text), message, _PLAIN) from None


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not a finite number")


def _literal(text: str) -> Any:
    with warnings.catch_warnings():
        # Python warns of invalid escapes in string literals.
        warnings.simplefilter("ignore")
        with suppress(SyntaxError):
            call = ast.parse(f"f({text}\n)", mode="eval").body
            # One keyword is a name that is given to data.
            if isinstance(call, ast.Call) and len(call.keywords) > 1 and not call.args:
                return {each.arg: ast.literal_eval(each.value) for each in call.keywords}
        body = ast.parse(text).body
        statement = body[0] if len(body) == 1 else None
        if isinstance(statement, ast.Assign | ast.Expr):
            return ast.literal_eval(statement.value)
    raise ValueError("more than one statement, or none")


def _first_code(text: str) -> Position:
    """Return the first place of a Python text that is not plain data."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return START
    targets = {id(target) for node in tree.body for target in getattr(node, "targets", ())}
    code = [n for n in ast.walk(tree) if not isinstance(n, _DATA) and id(n) not in targets]
    nodes = [node for node in code if isinstance(node, ast.expr | ast.stmt)]
    places = [(node.lineno, node.col_offset + 1) for node in nodes]
    return Position(*min(places, default=START))


def _check_depth(source: SourceFile) -> None:
    """Refuse what would exhaust a parser: all brackets count, also those inside strings."""
    depth = 0
    for index, character in enumerate(source.text):
        if character in "[{(":
            depth += 1
            if depth > MAX_DEPTH:
                place = source.position(index)
                raise ConversionError.at(source, place, f"nested deeper than {MAX_DEPTH} levels")
        elif character in "]})":
            depth -= 1


def _raise_farther(
    source: SourceFile, json_error: json.JSONDecodeError, error: SyntaxError
) -> NoReturn:
    """Raise the error of the parser that got farther: the text is more likely in its format."""
    python = Position(error.lineno or 1, max(error.offset or 1, 1))
    if Position(json_error.lineno, json_error.colno) >= python:
        place = Position(json_error.lineno, json_error.colno)
        raise ConversionError.at(source, place, f"invalid JSON ({json_error.msg})") from None
    raise ConversionError.at(source, python, f"invalid Python literal ({error.msg})") from None


def letters_in(data: Any) -> set[str]:
    """Return what the rows of a map in a list hold, as texts; nothing if data is no such map."""
    if not isinstance(data, list | tuple):
        return set()
    rows = [row.decode("latin-1") if isinstance(row, bytes) else row for row in data]
    cells = [cell for row in rows if isinstance(row, list | tuple | str) for cell in row]
    return {cell.decode("latin-1") if isinstance(cell, bytes) else str(cell) for cell in cells}


# -- checked values --------------------------------------------------------------------------


def integer(value: Any, where: str) -> int:
    """Return a whole number."""
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int):
        raise ConversionError(f"{where} must be a whole number, not {shown(value)}")
    return value


def truncated(value: float) -> float:
    """Return a number without its fraction, as an integer unless that would have many digits."""
    return int(value) if abs(value) < _MAX_INTEGER else float(value)


def number(value: Any, where: str) -> float:
    """Return a finite number, an integer only if it has few digits."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            if math.isfinite(value):
                return value if abs(value) < _MAX_INTEGER else float(value)
        except OverflowError:
            pass
    raise ConversionError(f"{where} must be a number, not {shown(value)}")


def probability(value: Any, where: str) -> float:
    """Return a number from 0 to 1."""
    if not 0 <= number(value, where) <= 1:
        raise ConversionError(f"{where} must be a probability from 0 to 1, not {shown(value)}")
    return number(value, where)


def sequence(value: Any, where: str) -> list[Any]:
    """Return a list."""
    if not isinstance(value, list):
        raise ConversionError(f"{where} must be a list, not {shown(value)}")
    return value


def mapping(value: Any, where: str) -> dict[str, Any]:
    """Return a mapping."""
    if not isinstance(value, dict):
        raise ConversionError(f"{where} must be a mapping, not {shown(value)}")
    return value


def integers(value: Any, where: str, *counts: int) -> list[int]:
    """Return a list of so many whole numbers."""
    found = [integer(each, where) for each in sequence(value, where)]
    if len(found) not in counts:
        wanted = " or ".join(map(str, counts))
        raise ConversionError(f"{where} must be {wanted} whole numbers, not {len(found)}")
    return found


def color(value: Any) -> str | None:
    """Return a colour as level files write it, None if it is not a valid one there."""
    if not isinstance(value, str):
        return None
    text = value.strip()
    text = text if text.startswith("#") else text.lower()
    return text if len(text) <= LONGEST_COLOR and is_color(text) else None
