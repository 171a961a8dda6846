"""Data of other programs: JSON and Python literals, read without running code, and checked values.

The functions that check a value raise a `ConversionError` that names the value as its format does.
"""

from __future__ import annotations

import ast
import json
import math
import re
import warnings
from typing import Any, NoReturn

from babyrobot_levels.convert.conversion import ConversionError, shown
from babyrobot_levels.language.looks import PATTERN
from babyrobot_levels.text.source import START, Position, SourceFile

MAX_DEPTH = 32
"""Lists and mappings inside one another. No format has more than a few."""

_MAX_INTEGER = 2**53
"""Numbers up to this are written as integers: all of these are floats as well."""

_PLAIN = "use only numbers, strings, lists, tuples and dicts; names and calls are not allowed"
_DATA = (
    *(ast.Constant, ast.List, ast.Tuple, ast.Set, ast.Dict, ast.UnaryOp, ast.unaryop),
    *(ast.Module, ast.Expr, ast.Assign, ast.expr_context),
)


def looks_like_data(text: str) -> bool:
    """Return whether a text may be JSON or a Python literal, rather than a drawn map."""
    return text.lstrip().startswith(("{", "[", "(", "'", '"')) or "=" in text


def read_data(source: SourceFile) -> Any:
    """Return the data of a text: JSON, or a Python literal, also one that a name is given to.

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
    cells = [cell for row in data if isinstance(row, list | tuple | str) for cell in row]
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
    return text if len(text) <= 64 and re.fullmatch(PATTERN, text) else None
