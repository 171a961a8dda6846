"""Pydantic's errors as messages for people who write levels."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, Literal, TypeGuard, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from babyrobot_levels.language.base import FORM_PREFIX, SIDE_NAMES, SIDES, Forms
from babyrobot_levels.language.cells import Puddle, PuddleType, RandomReward
from babyrobot_levels.language.kinds import KINDS, THINGS
from babyrobot_levels.language.looks import COLOR_CHECK, NAMES, THEME_NAME
from babyrobot_levels.language.names import FUNCTION, SLUG, VERSION, slug
from babyrobot_levels.language.rewriting import LONGEST, number_in, rewritten, takes
from babyrobot_levels.text.emitter import flow
from babyrobot_levels.text.scalars import is_plain_string
from babyrobot_levels.text.words import SHORT, did_you_mean, nearest, shortened, words_beside

Complaint = tuple[str, str, str | None]
"""Code, message, help."""

SAMPLES = {bool: "true", float: "1", int: "1", str: "name"}
"""Values of the plain types, for showing the form of what holds them."""

NOT_OF_NUMBERS = ("size", "at", "rewards")
"""Fields that mean more than one number, unless it is negative: a cost is a reward."""

MANY = 1_000_000
"""Numbers of things are not as high."""

NUMERIC = ("float_type", "int_type")
"""The errors of numbers."""

PLACES = ("at", "path")
"""Fields that entries need, though another may take their place."""

NAMING = {*(kind.field for kind in THINGS), "exit_needs", "legend"}
"""Fields with names of things in them."""


def _words(table: str) -> dict[str, str]:
    words: dict[str, str] = words_beside(__file__)[table]
    return words


def complaint(error: Any, model: type[BaseModel]) -> Complaint:
    """Return code, message and help for one of pydantic's error details.

    Args:
        error: the detail.
        model: what the whole file should be.
    """
    kind, context, value = error["type"], error.get("ctx", {}), error.get("input")
    help_text: str | None
    names = _names(error["loc"])
    field = names[-1] if names else ""
    fields = fields_around(error["loc"], model)
    info = fields.get(field)
    is_form = bool(error["loc"]) and str(error["loc"][-1]).startswith(FORM_PREFIX)
    if kind == "extra_forbidden":
        if value is None and field.isdigit():
            # `{step: -0,1}` is what YAML takes for `{step: -0, 1: }`.
            help_text = "write decimals with a point, such as `0.1`: a comma separates entries"
            return "BR201", f"unknown field `{shortened(field)}`", help_text
        return _unknown(field, value, _around(error["loc"], model), model)
    if kind == "missing":
        help_text = beginning(model) if field == "version" else _words("missing").get(field)
        if len(names) > 1 and field in fields:
            help_text = f"add `{field}: {_form(field, fields)}`"
        return "BR202", f"missing field `{field}`", help_text
    types = _words("types")
    if kind in types or kind == "pair" or (is_form and kind == "literal_error"):
        words = types.get(kind) or context.get("what", "")
        code, guess = "BR203", ""
        if is_form:
            words = next(part.words for part in _parts(info) if isinstance(part, Forms))
        if kind == "literal_error":
            code, guess = "BR204", guessed(value, _choices(context["expected"]))
        elif not is_form and kind in NUMERIC:
            words += _between(info)
        return code, f"must be {words}, not {show(value)}{guess}", _form_help(error, model)
    if kind in ("literal_error", "enum"):
        return _choice(field, context["expected"], value)
    if kind in ("greater_than_equal", "greater_than", "less_than_equal", "less_than"):
        is_percent = context.get("le") == 1 and 2 <= value <= 100
        help_text = f"write `{value / 100:g}` for {value:g} %" if is_percent else None
        if field == "max_steps":
            help_text = "leave it out for episodes without a limit"
        return "BR205", f"must be {_bound(kind, context)}, not {show(value)}", help_text
    if kind == "finite_number":
        return "BR205", f"must be a finite number, not {show(value)}", None
    if kind in ("too_short", "too_long"):
        return _length(kind, context, field, value)
    if kind == "color":
        message = f"{_named(value)} is not a CSS colour{did_you_mean(str(value), NAMES)}"
        help_text = 'use a CSS name in lower case, `"#rrggbb"`, `rgb(…)`, `rgba(…)` or `hsl(…)`'
        if "(" in str(value) and ")" not in str(value):
            help_text = "put quotes around the colour: a comma separates entries"
        return "BR403", message, help_text
    if kind == "string_pattern_mismatch":
        code, message, help_text = _pattern(context["pattern"], names[0] if names else "", value)
        is_list = bool(re.search(r"([,;&+]| and ) *\w", str(value)))
        return code, message, (is_list and _form_help(error, model)) or help_text
    if kind == "string_too_long":
        return "BR205", f"must have at most {context['max_length']} characters", None
    return "BR203", str(error["msg"]), None


def beginning(model: type[BaseModel]) -> str | None:
    """Return what a file of a kind needs at least."""
    return getattr(model, "BEGINNING", None)


def fields_around(location: Sequence[str | int], model: type[BaseModel]) -> dict[str, FieldInfo]:
    """Return the fields of the mapping in which one of pydantic's locations ends.

    Args:
        location: the location.
        model: what the whole file should be.
    """
    around = _around(location, model)
    return {} if around is None else _fields(around)


def _around(location: Sequence[str | int], model: type[BaseModel]) -> type[BaseModel] | None:
    around: type[BaseModel] | None = model
    for name in _names(location)[:-1]:
        fields = {} if around is None else _fields(around)
        if name in fields:
            around = next((part for part in _parts(fields[name]) if _is_model(part)), None)
    return around


def _names(location: Sequence[str | int]) -> list[str]:
    """Return the names in one of pydantic's locations, without the forms of unions."""
    return [s for s in location if isinstance(s, str) and not s.startswith(FORM_PREFIX)]


def _fields(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """Return the fields of a model by their names in files."""
    return {info.alias or name: info for name, info in model.model_fields.items()}


def _is_model(part: Any) -> TypeGuard[type[BaseModel]]:
    return isinstance(part, type) and issubclass(part, BaseModel)


def _parts(info: Any) -> Iterator[Any]:
    """Yield what the type of a field is put together from: types, and what is said about them."""
    inner = (info.annotation, *info.metadata) if isinstance(info, FieldInfo) else get_args(info)
    for part in inner:
        yield part
        yield from _parts(part)


def _sample(type_: Any) -> str:
    """Return a value of a type as it would stand in a file."""
    if _is_model(type_):
        return "{" + ", ".join(f"{name}: {_sample_of(info)}" for name, info in _needed(type_)) + "}"
    origin, inner = get_origin(type_), get_args(type_)
    if origin is tuple:
        return f"[{_sample(inner[0])}]" if inner[1:] == (...,) else "[x, y]"
    if origin is dict:
        return f"{{a: {_sample(inner[1])}}}"
    if origin is Literal:
        return str(inner[0])
    return _sample(inner[0]) if inner else SAMPLES.get(type_, "…")


def _sample_of(info: FieldInfo) -> str:
    """Return a value of a field: its default, if that is a number."""
    is_number = isinstance(info.default, int | float) and not isinstance(info.default, bool)
    return f"{info.default:g}" if is_number else _sample(info.annotation)


def _needed(model: type[BaseModel]) -> list[tuple[str, FieldInfo]]:
    """Return the fields that a mapping needs, or the first one if it needs none."""
    fields = [*_fields(model).items()]
    return [each for each in fields if each[1].is_required() or each[0] in PLACES] or fields[:1]


def show(value: Any) -> str:
    """Return a value as it would stand in a file, shortened."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list | tuple):
        if not value or len(value) > SHORT or len(text := flow(value)) > SHORT:
            return f"a list of {len(value)}" if value else "an empty list"
        return f"`{text}`"
    if isinstance(value, str):
        if not value:
            return "an empty text"
        # Without quotes it would be a number, or `true`.
        return f"`{shortened(value)}`" if is_plain_string(value) else f'`"{shortened(value)}"`'
    return f"`{shortened(value)}`"


def _named(value: Any) -> str:
    return f"`{shortened(value)}`" if value != "" else "an empty text"


def _unknown(
    field: str, value: Any, model: type[BaseModel] | None, whole: type[BaseModel]
) -> Complaint:
    """Return what a field that does not exist may be meant to be, in a mapping of the whole."""
    message, fields = f"unknown field `{shortened(field)}`", _fields(model) if model else {}
    word = field.lower().replace("-", "_")
    if (text := _elsewhere(word, fields) or _of_puddles(word, value, model)) is not None:
        return "BR201", message, text
    if field in (keys := _words("keys")):
        return "BR201", message, keys[field]
    known = "known fields: " + ", ".join(fields) if 0 < len(fields) <= 14 else None
    if inner := _inner(word, value, fields):
        return "BR201", message + inner[0], inner[1]
    other = word[:-1] if word[:-1] in fields and word[-1] == "s" else _other_name(word, fields)
    other = other or next(iter(nearest(field, fields, 1, 0.9)), None)
    if text := _further_in(word, value, fields):
        is_fitting = text.startswith("write ")
        if not (other and model) or (is_fitting and not takes(model, other, value)):
            return "BR201", message, text
    if isinstance(value, dict) and model and value and fields.keys() >= value.keys():
        return (
            "BR201",
            message,
            "its fields stand at the top: remove this line, and their indentation",
        )
    if other is None and model is not None:
        is_name = model is not whole and "name" in fields and not nearest(field, fields, 1, 0.75)
        if is_name and _is_cell(value) and (place := {"at", "start"} & fields.keys()):
            return "BR201", message, f"write `{{name: {word}, {min(place)}: {flow(value)}}}`"
        if chosen := next((each for each in fields if word in _chosen(fields[each])), None):
            return "BR201", message, f"write `{chosen}: {word}`"
        if model is not whole and (text := _outside(word, value, _fields(whole))):
            return "BR201", message, text
    other = other or next(iter(nearest(field, fields, 1)), None)
    if other is None or model is None:
        metrics = "`expect` takes the metrics that `babyrobot show` shows"
        if "states" in fields:
            return "BR201", message, metrics + ", and `lint`" * ("lint" in fields)
        return "BR201", message, known or "leave it out; `babyrobot skill` explains all fields"
    written = _each_side(value) if other == "side" else _written(other, value, model)
    form = f"write `{other}: {_form(other, fields)}`{_words('after').get(other, '')}"
    is_shown = other in ("at", "size") or isinstance(value, bool)
    return (
        "BR201",
        f"{message}; did you mean `{other}`?",
        written or (not is_shown and known) or form,
    )


def _chosen(info: FieldInfo) -> Collection[str]:
    """Return the words of which a field is one."""
    return [each for part in _parts(info) if get_origin(part) is Literal for each in get_args(part)]


def _outside(word: str, value: Any, fields: Mapping[str, FieldInfo]) -> str | None:
    """Return where a field of this name stands in the whole, outside of a mapping in it."""
    if word in fields:
        is_short = len(text := flow(value)) <= SHORT
        return f"it stands at the top: `{word}: {text if is_short else '…'}`"
    return _further_in(word, value, fields)


def _of_puddles(word: str, value: Any, model: type[BaseModel] | None) -> str | None:
    """Return where a property of a puddle is given."""
    if model is not Puddle or word not in PuddleType.model_fields:
        return None
    is_percent = word == "skid" and isinstance(value, int | float) and 1 < value <= 100
    given = f"{word}: {flow(value / 100 if is_percent else value)}"
    return f"puddles of a size share it: `puddle_types: {{small: {{{given}}}}}`"


def _inner(word: str, value: Any, fields: Mapping[str, FieldInfo]) -> tuple[str, str] | None:
    """Return what is meant by two words, such as `exit_reward`, and how that is written."""
    first, _, second = word.rpartition("_")
    for outer, inner in ((first, second), (second, first)):
        field = next((each for each in (outer, f"{outer}s") if each in fields), None)
        annotation = fields[field].annotation if field else None
        part = next(filter(_is_model, (annotation, *get_args(annotation))), None)
        if not inner or part is None or get_origin(annotation) is tuple:
            continue
        known = _fields(part)
        if (text := _elsewhere(inner, known)) is not None:
            return "", text
        name = inner if inner in known else _other_name(inner, known)
        if name and field and (text := _special_help(name, (field, name), value, known)):
            return "", text
        if name and takes(part, name, value):
            meant = f"write `{field}: {{{name}: {flow(value)}}}`"
            return f"; did you mean `{field}`?", meant
    return None


def _further_in(word: str, value: Any, fields: Mapping[str, FieldInfo]) -> str | None:
    """Return which fields have mappings with a field of this name in them."""
    parts = [(name, each) for name, info in fields.items() for each in _parts(info)]
    found = {name: each for name, each in parts if _is_model(each) and word in _fields(each)}
    fitting = [name for name, each in found.items() if takes(each, word, value)]
    if len(fitting) == 1:
        entry = f"{word}: {flow(value)}"
        is_list = get_origin(fields[fitting[0]].annotation) is tuple
        return f"write `{fitting[0]}: " + (f"[{{…, {entry}}}]`" if is_list else f"{{{entry}}}`")
    return f"it stands in `{'` or `'.join(found)}`" if found else None


def _elsewhere(word: str, fields: Collection[str]) -> str | None:
    """Return where something is that is no field of a mapping with these fields."""
    rows: list[tuple[str, str, str]] = words_beside(__file__)["elsewhere"]
    for beside, names, text in rows:
        there = beside in fields or beside == f"only {' '.join(fields)}"
        if there and word not in fields and word in names.split():
            return text
    return None


def _written(field: str, value: Any, model: type[BaseModel]) -> str | None:
    """Return how the value of a field is written that was given by another name, if it fits."""
    if value in ([], {}, "", None) or (field == "theme" and isinstance(value, str)):
        return None
    if isinstance(value, int | float) and value >= 0 and field in NOT_OF_NUMBERS:
        return None
    meant = value if takes(model, field, value) and len(f"{value}") <= LONGEST else None
    if meant is None:
        if told := _special_help(field, [field], value, _fields(model)):
            return told
        meant = None if isinstance(value, bool) else rewritten(value, field, model)
    return None if meant is None else f"write `{field}: {flow(meant)}`"


def _form(field: str, fields: Mapping[str, FieldInfo]) -> str:
    return _words("forms").get(field) or _sample_of(fields[field])


def _each_side(value: Any) -> str | None:
    """Return how an entry is written for each of several sides, if a value names such ones."""
    names = list(value.upper()) if isinstance(value, str) and len(value) < 5 else value
    if (
        not isinstance(names, list)
        or not 1 < len(names) < 5
        or not {*map(str, names)} <= {*SIDES, *SIDE_NAMES}
    ):
        return None
    entries = ", ".join(f"{{at: …, side: {name}}}" for name in names)
    return f"write an entry for each side: `{entries}`"


def _other_name(word: str, fields: Mapping[str, FieldInfo]) -> str | None:
    """Return the field that others call by this name."""
    names = {kind.field: set(kind.other_names) for kind in KINDS}
    for field in (each for each in fields if each != word):
        others = names.get(field, set()) | set(_words("fields").get(field, "").split())
        if word in others or word.removesuffix("s") in others:
            return field
    return None


def _form_help(error: Any, model: type[BaseModel]) -> str | None:
    """Return how to write a value that has a wrong form."""
    names, value = _names(error["loc"]), error["input"]
    field = names[-1] if names else ""
    around = _around(error["loc"], model)
    info = {} if around is None else _fields(around)
    special = _special_help(field, names, value, info)
    if special is not None or around is None or field not in info:
        number = number_in(value) if error["type"] in NUMERIC else None
        return special or (None if number is None else f"write `{field}: {number:g}`")
    is_entry = isinstance(error["loc"][-1], int)
    meant = rewritten(value, field, around, is_entry)
    if meant is not None:
        shown = flow(meant) if is_entry else f"{field}: {flow(meant)}"
        return f"write `{shown}`{_words('after').get(field, '')}"
    words = _words("types").get(error["type"]) or error["ctx"].get("what", "")
    if not words.startswith(("a list", "a mapping")):
        return None
    sample = _sample_of(info[field])
    if not is_entry:
        return f"write `{field}: {_form(field, info)}`{_words('after').get(field, '')}"
    is_cell = _is_cell(value) and "at: [x, y]" in sample
    return f"write `{(sample.replace('[x, y]', flow(value), 1) if is_cell else sample)[1:-1]}`"


def _is_cell(value: Any) -> bool:
    return isinstance(value, list) and [*map(type, value)] == [int, int]


_RANGE = re.compile(r"\d+ *(\.\.+|[-:]|to) *\d+")
"""What is meant for several columns or rows."""


def _special_help(
    field: str, names: Sequence[str], value: Any, fields: Mapping[str, FieldInfo]
) -> str | None:
    """Return what to do about a value of a wrong form that no other form mends."""
    told, kinds = _words("instead"), [type(value).__name__]
    kinds += value if isinstance(value, dict) else [str(value).strip().lower()]
    for key in (f"{each} {kind}" for kind in kinds for each in (field, " ".join(names), "*")):
        if key in told:
            return told[key]
    if str(value).lower() in ("null", "nil", "none") and field in fields:
        if COLOR_CHECK in _parts(fields[field]) and value is None:
            return "put quotes around a colour that begins with `#`, or remove the field"
        return "give it a value, or remove the field"
    if isinstance(value, list) and RandomReward in _parts(fields.get(field)):
        is_drawn = takes(RandomReward, "values", value)
        values, weights = (value, [1] * len(value)) if is_drawn else ([-1, 5], [3, 1])
        drawn = f"{{values: {flow(values)}, weights: {flow(weights)}}}"
        return f"write `{field}: {drawn}` for a reward that is drawn"
    if names[:1] == ["legend"] and len(names) == 2:
        return _elsewhere(str(value), ("switch",)) or (
            f"write `{field}: {{item: key}}`, with what the character stands for"
        )
    if field == "at" and isinstance(value, list) and [*map(type, value)].count(list) > 1:
        if "one_of" in fields:
            return "give several cells as `one_of: [[x, y], [x, y]]`"
        entries = ", ".join(f"{{at: {flow(each)}}}" for each in value[:3])
        return f"write an entry for each cell: `{entries}`"
    if field == "at" and isinstance(value, str) and _RANGE.fullmatch(value.strip()):
        if "size" in fields:
            return "give the first cell, and how many: `{at: [x, y], size: [width, height]}`"
        if "length" in fields:
            return "give the first cell, and how many: `{at: [x, y], side: S, length: n}`"
        return "write an entry for each cell"
    if COLOR_CHECK in _parts(fields.get(field)) and isinstance(value, list) and value[2:]:
        return f'write `{field}: "rgb{"a" * len(value[3:4])}({", ".join(map(str, value))})"`'
    return told.get(" ".join(names))


def _choice(field: str, expected: str, value: Any) -> Complaint:
    names = _choices(expected)
    if field == "version":
        also = "; `babyrobot pack` checks a `pack.yaml`" * bool(re.match(VERSION, str(value)))
        return ("BR204", f"unsupported version {show(value)}", f"write `version: 1`{also}")
    if names == list(SIDES):
        names += SIDE_NAMES
    guess = guessed(value, names)
    shown = f"`{names[0]}`" if len(names) == 1 else "one of " + ", ".join(f"`{n}`" for n in names)
    help_text = _words("instead").get(f"{field} {str(value).lower()}")
    if field == "side":
        help_text = _each_side(value)
    if isinstance(value, list) and len(value) == 1:
        help_text = f"write `{field}: {shortened(value[0])}`"
    return "BR204", f"must be {shown}, not {show(value)}{'' if help_text else guess}", help_text


def guessed(value: Any, names: Sequence[str]) -> str:
    """Return the question whether one of several values is meant."""
    if not isinstance(value, str):
        return ""
    word, others = re.sub(r"[ _]+", "-", value.strip().lower()), _words("choices")
    other = next((each for each in names if word in others.get(each, "").split()), None)
    return f"; did you mean `{other}`?" if other else did_you_mean(value, names)


def _choices(expected: str) -> list[str]:
    # pydantic lists them as `'a', 'b' or 'c'`.
    return [part.strip().strip("'") for part in expected.replace(" or ", ", ").split(", ")]


def _between(info: Any) -> str:
    """Return the bounds of a number that a field holds, but for those that nobody meets."""
    bounds = {
        key: getattr(each, key)
        for each in _parts(info)
        for key in ("ge", "gt", "le")
        if hasattr(each, key)
    }
    low, above, high = map(bounds.get, ("ge", "gt", "le"))
    is_known = high is not None and high < MANY
    if above is not None:
        return f" above {above:g}" + (f" and at most {high:g}" if is_known else "")
    return "" if low is None else f" from {low:g} " + (f"to {high:g}" if is_known else "on")


def _bound(kind: str, context: dict[str, Any]) -> str:
    words = {
        "greater_than_equal": ("ge", "at least"),
        "greater_than": ("gt", "above"),
        "less_than_equal": ("le", "at most"),
        "less_than": ("lt", "below"),
    }
    key, text = words[kind]
    bound = context[key]
    return f"{text} {int(bound) if float(bound).is_integer() else bound}"


def _length(kind: str, context: dict[str, Any], field: str, value: Any) -> Complaint:
    if kind == "too_long":
        return "BR205", f"must have at most {context['max_length']} entries", None
    least = context["min_length"]
    if least == 1 or not value:
        return "BR203", "must not be an empty list", None
    return (
        "BR205",
        f"must have at least {least} entries, not {len(value)}",
        _words("singles").get(field),
    )


def _pattern(pattern: str, root: str, value: Any) -> Complaint:
    is_name = root in NAMING
    known = {SLUG: "name" if is_name else "slug", VERSION: "version", FUNCTION: "function"}
    kind = "theme" if pattern == THEME_NAME else known.get(pattern, "legend")
    word = slug(str(value)) or ("red-key" if is_name else "first-maze")
    given = {"shown": show(value), "named": _named(value), "slug": word}
    code, message, help_text = (each.format(**given) for each in [*_words("patterns")[kind]])
    return code, message, help_text
