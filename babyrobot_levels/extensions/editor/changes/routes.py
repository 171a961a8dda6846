"""Values at routes of plain data: read, put, removed."""

from contextlib import suppress
from typing import Any

from babyrobot_levels.extensions.editor.changes.draft import RefusedError
from babyrobot_levels.extensions.editor.forms import LEVEL, forms, short_forms
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.formatting import Fields, fields_of
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.text.errors import LevelError

Route = list[str | int]

MAX_VALUES = 100_000
"""The most parts that a value may have which is set."""


def get(data: Any, route: Route) -> Any:
    """Return the value at a route.

    Raises:
        RefusedError: there is none.
    """
    for segment in route:
        if not _has(data, segment):
            raise RefusedError(f"there is no `{shown(route)}`")
        data = data[segment]
    return data


def put(data: dict[str, Any], route: Route, value: Any) -> None:
    """Put a value at a route, in place.

    Mappings that are missing on the way are made, new fields are put in their order, and what is
    written in short (`skid: 0.4`) stays so as long as it can.

    Raises:
        RefusedError: the route leads through something else.
    """
    short, holder, fields = short_forms(), data, fields_of(LevelFields)
    *above, last = route
    if above and _stands_for(above, last) and not isinstance(_found(data, above), dict):
        put(data, above, value)
        return
    for number, segment in enumerate(above, 1):
        inner = _found(holder, [segment])
        if not isinstance(inner, dict | list):
            if isinstance(holder, list) or (inner is not None and segment not in short):
                raise RefusedError(f"`{shown(above[:number])}` has no fields")
            if inner is None:
                inner = _default(above[:number])
            inner = {} if inner is None else {short[str(segment)]: inner}
            _set(holder, segment, inner, fields)
        holder = inner
        fields = fields.of(segment) if isinstance(segment, str) else fields
    _set(holder, last, value, fields)


def remove(data: dict[str, Any], route: Route) -> None:
    """Remove a value, and each field above it that is left empty.

    Raises:
        RefusedError: there is none.
    """
    *above, last = route
    if above and _stands_for(above, last):
        remove(data, above)
        return
    get(data, route)
    holder = get(data, above)
    del holder[last]
    if not holder and above and isinstance(above[-1], str):
        remove(data, above)


def shown(route: Route) -> str:
    """Return a route as messages show it: `walls[2].side`."""
    parts = (f"[{each}]" if isinstance(each, int) else f".{each}" for each in route)
    return "".join(parts).removeprefix(".")


def ordered(field: str, entry: dict[str, Any]) -> dict[str, Any]:
    """Return an entry of a list with its fields in their order."""
    return _ordered(entry, fields_of(LevelFields).of(field))


def plain_value(value: Any) -> Any:
    """Return a value that came from a browser, which may be no value of a file.

    Raises:
        RefusedError: it is none, or has too many parts.
    """
    try:
        return plain(value, most=MAX_VALUES)
    except LevelError as error:
        raise RefusedError(str(error)) from None


def _ordered(entry: dict[str, Any], fields: Fields) -> dict[str, Any]:
    return {name: entry[name] for name in fields.order(entry)}


def _found(data: Any, route: Route) -> Any:
    """Return the value at a route, None if there is none."""
    with suppress(RefusedError):
        return get(data, route)
    return None


def _has(data: Any, segment: str | int) -> bool:
    if isinstance(data, list):
        return isinstance(segment, int) and 0 <= segment < len(data)
    return isinstance(data, dict) and isinstance(segment, str) and segment in data


def _set(holder: Any, name: str | int, value: Any, fields: Fields) -> None:
    if isinstance(holder, list) and isinstance(name, int):
        get(holder, [name])
        holder[name] = value
    elif not isinstance(name, str) or not isinstance(holder, dict):
        raise RefusedError(f"there is no `{shown([name])}` in it")
    elif name in holder:
        holder[name] = value
    else:
        values = _ordered({**holder, name: value}, fields)
        holder.clear()
        holder.update(values)


def _default(route: Route) -> Any:
    """Return what a field of the level is in short where it is left out, None if it is nothing."""
    fields = (each for each in forms()[LEVEL] if "short" in each and each["route"][:-1] == route)
    return next((each.get("default") for each in fields), None)


def _stands_for(mapping: Route, name: str | int) -> bool:
    """Tell whether a field stands for the whole mapping where that is written in short."""
    return short_forms().get(str(mapping[-1])) == name
