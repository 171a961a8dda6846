"""Values that were written in another form than that of their field, as the field takes them."""

import re
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel, ValidationError

from babyrobot_levels.text.scalars import resolve

LONGEST = 100
"""Values of more characters are not written anew: nobody would read them."""

_PERCENT = re.compile(r"([0-9]{1,3}(?:\.[0-9]{1,9})?) ?%")
_DECIMAL_COMMA = re.compile(r"[-+]?[0-9]{1,20},[0-9]{1,20}")
_PAIR = re.compile(r"[(\[]? ?([0-9]{1,4}) ?(?:[x×,;*.-]| ) ?([0-9]{1,4}) ?[)\]]?", re.I)
_LEAST = re.compile(r"(?:>=|=>|>|min|at least|from) ?(-?[0-9.]{1,20})|(-?[0-9.]{1,20}) ?\+", re.I)
_MOST = re.compile(r"(?:<=|=<|<|max|at most|up to) ?(-?[0-9.]{1,20})", re.I)
_BETWEEN = re.compile(r"(-?[0-9.]{1,20}) ?(?:-|–|to|\.\.\.|:|,) ?(-?[0-9.]{1,20})", re.I)
_SWITCHED = {"yes": True, "on": True, "no": False, "off": False}
_CORNERS = (("x", "y"), ("col", "row"), ("column", "row"), ("width", "height"), ("w", "h"))


def rewritten(value: Any, field: str, model: type[BaseModel], is_entry: bool = False) -> Any:
    """Return what a value is meant to be, in a form that its field takes; None if nobody knows.

    Args:
        value: the value.
        field: its field.
        model: what has the field.
        is_entry: whether the value is an entry of the field, which is a list.
    """
    if (isinstance(value, str | list | dict) and len(value) > LONGEST) or len(f"{value}") > LONGEST:
        return None
    square = [[value, value]] if field == "size" and isinstance(value, int) else []
    for each in (*square, *_readings(value)):
        if takes(model, field, [each] if is_entry else each):
            return each
    return None


def takes(model: type[BaseModel], field: str, value: Any) -> bool:
    """Return whether a field takes a value, as far as the field alone tells."""
    try:
        model.model_validate({field: value})
    except ValidationError as error:
        return not any(each["loc"][:1] == (field,) for each in error.errors(include_url=False))
    return True


def number_in(value: Any) -> float | None:
    """Return the number that a value is meant to be, None if nobody knows."""
    return next((each for each in _readings(value) if type(each) in (int, float)), None)


def _readings(value: Any) -> Iterator[Any]:
    """Yield what a value may be meant to be, in forms that fields have, the likeliest first."""
    if isinstance(value, bool):
        yield from ({"seed": 1}, {"show": value}) if value else ({"show": value},)
    elif isinstance(value, int | float):
        yield from ({"seed": value}, {"reward": value}, [value])
        yield {"step": value} if value < 0 else {"step": -1, "exit": value}
        yield str(value)
        yield f"#{value:06}" if 99 < value <= 999999 else None
    elif isinstance(value, str):
        yield from _of_text(value.strip())
    elif isinstance(value, list):
        yield from _of_list(value)
    elif isinstance(value, dict):
        yield from _of_mapping(value)


def _of_text(text: str) -> Iterator[Any]:
    if found := _PERCENT.fullmatch(text):
        yield float(found[1]) / 100
    if found := re.fullmatch(r"(\d+) */ *([1-9]\d*)", text):
        yield int(found[1]) / int(found[2])
    if found := _PAIR.fullmatch(text):
        yield [int(found[1]), int(found[2])]
    if _DECIMAL_COMMA.fullmatch(text):
        yield resolve(text.replace(",", "."))
    yield resolve(text)
    yield resolve(text.lstrip("= "))
    if found := re.fullmatch(r"([-+]?[0-9.]{1,20}) ?[^\W\d][^\d]{0,20}", text):
        yield resolve(found[1])
    if found := re.fullmatch(r"([0-9]+)x([0-9]+) ?(?:\.\.+|-|to) ?([0-9]+)x([0-9]+)", text):
        low, high, *others = [*map(int, found.groups())]
        yield {"min": [low, high], "max": others}
    if found := _BETWEEN.fullmatch(text):
        yield f"{found[1]}..{found[2]}"
    if found := _LEAST.fullmatch(text):
        yield f"{found[1] or found[2]}.."
    if found := _MOST.fullmatch(text):
        yield f"..{found[1]}"
    if text.lower() in _SWITCHED:
        yield _SWITCHED[text.lower()]
    words = re.split(r"(?:[,;&+\s]|\band\b)+", text)
    yield from (words, {"seed": text.lower()})
    yield from ({"seed": 1, "algorithm": text.lower()}, {"algorithm": text.lower()})


def _of_list(items: list[Any]) -> Iterator[Any]:
    yield [resolve(each) if isinstance(each, str) else each for each in items]
    if items and all(isinstance(each, dict) for each in items):
        yield {name: value for each in items for name, value in each.items()}
    if len(items) == 1:
        yield items[0]
        yield from _readings(items[0])
    if len(items) == 2:
        if all(isinstance(each, int | float) for each in items):
            yield f"{items[0]}..{items[1]}"
        yield {"min": items[0], "max": items[1]}
        if all(ranges := [re.fullmatch(r"(\d+)\.\.(\d+)", str(each)) for each in items]):
            low, high = zip(*(map(int, each.groups()) for each in ranges if each), strict=True)
            yield {"min": [*low], "max": [*high]}
    entries: list[Mapping[str, Any]] = [{"at": items}, {"path": items}]
    if len(items) == 2:
        if all(isinstance(each, list) and [*map(type, each)] == [int, int] for each in items):
            (left, top), (right, bottom) = items
            yield {"at": items[0], "size": [right - left + 1, bottom - top + 1]}
        entries.append({"at": items[0], "to": items[1]})
    if len(items) > 2:
        at, rest = items[:2], items[2:]
        entries.append({"at": at, "size": rest[0] if len(rest) == 1 else rest})
        entries.append({"at": at, "side": rest[0], **({"needs": rest[1]} if rest[1:] else {})})
    yield from entries
    yield from ([each] for each in entries)
    yield [{"at": each} for each in items]
    yield {"north": items}
    yield ", ".join(map(str, items)) or None


def _of_mapping(mapping: dict[str, Any]) -> Iterator[Any]:
    if not mapping:
        return
    for names in _CORNERS:
        if mapping.keys() == {*names}:
            yield [mapping[name] for name in names]
    if "at" in mapping or len(mapping) == 1:
        yield mapping.get("at", next(iter(mapping.values())))
    yield [*mapping.values()]
    yield [mapping]
    yield [{"name": name, "at": at} for name, at in mapping.items()]
    yield [{"name": name, "start": at} for name, at in mapping.items()]
