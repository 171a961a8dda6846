"""The building blocks of all models: strict scalars, cells, sides, and the frozen base."""

# Modules of models do without postponed annotations: pydantic would evaluate each of them again
# for each model that inherits it.
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    StrictBool,
    StrictFloat,
    StrictInt,
    StrictStr,
    StringConstraints,
    Tag,
    WithJsonSchema,
)
from pydantic_core import CoreSchema, PydanticCustomError

from babyrobot_levels.language.names import SLUG
from babyrobot_levels.text.words import Telling, no_attribute, no_item

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)

MAX_SIZE = 1024
"""The most cells that a level is wide or high."""

FORM_PREFIX = "form:"
"""Marks the segment that pydantic puts into an error's location for the form of a union."""

_OF_PYDANTIC = frozenset(dir(BaseModel))


class Once:
    """As the last part of a type: pydantic makes its schema once, however many fields have it."""

    def __init__(self) -> None:
        self._schema: CoreSchema | None = None

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        if self._schema is None:
            self._schema = handler(source)
        return {**self._schema}


class _Telling(ModelMetaclass):
    """The class of models, which tell which attribute of them is meant."""

    if not TYPE_CHECKING:
        # Models look for many names of fields as they are made: guesses would take long.
        is_made = True

        def __new__(cls, *args: Any, **options: Any) -> type:
            _Telling.is_made = False
            try:
                return super().__new__(cls, *args, **options)
            finally:
                _Telling.is_made = True

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_") or not _Telling.is_made:
                return super().__getattr__(name)
            raise no_attribute(self, name)


class Model(Telling, BaseModel, metaclass=_Telling):
    """A frozen model that refuses fields that it does not know.

    As models are frozen, those that are defaults are made once; that needs no validator.
    """

    # Help for a file without any field.
    BEGINNING: ClassVar[str] = "a level begins with `version: 1`"

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        allow_inf_nan=False,
        # Most models are only parts of a level, whose validator has theirs built in.
        defer_build=True,
    )

    if not TYPE_CHECKING:
        __getitem__ = no_item

        def __setattr__(self, name: str, value: Any) -> None:
            if name in type(self).model_fields:
                raise AttributeError("levels do not change: `level.replace(…)` returns another one")
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        """Return what the model itself has; the many names of pydantic are no part of it."""
        return [name for name in super().__dir__() if name not in _OF_PYDANTIC]


def _whole(value: Any) -> Any:
    """Take `3.0` for `3`, as JSON Schema does."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


Integer = Annotated[StrictInt, BeforeValidator(_whole, json_schema_input_type=int), Once()]


def _number(value: Any) -> Any:
    """Keep numbers finite: an integer beyond the range of a float would overflow later."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise PydanticCustomError("float_type", "must be a number")
    try:
        # Adding 0.0 turns -0.0 into 0.0: there is one zero.
        return float(value) + 0.0
    except OverflowError:
        raise PydanticCustomError("finite_number", "must be a finite number") from None


Number = Annotated[StrictFloat, BeforeValidator(_number, json_schema_input_type=float), Once()]
Probability = Annotated[Number, Field(ge=0, le=1)]
Text = StrictStr
Flag = StrictBool
Slug = Annotated[StrictStr, StringConstraints(pattern=SLUG, max_length=100)]

# Bounds before the function are checked by pydantic's core, behind it by functions in Python.
Coordinate = Annotated[StrictInt, Field(ge=0, lt=MAX_SIZE), BeforeValidator(_whole)]


def _pair(what: str) -> Callable[[Any], Any]:
    def check(value: Any) -> Any:
        is_pair = isinstance(value, list | tuple) and len(value) == 2
        if not is_pair or isinstance(value[0], list | tuple):
            raise PydanticCustomError("pair", "must be {what}", {"what": what})
        return value

    return check


def _pair_schema(item: dict[str, Any]) -> WithJsonSchema:
    # `items` with two bounds, and not `prefixItems`, which most editors do not know yet.
    return WithJsonSchema({"type": "array", "items": item, "minItems": 2, "maxItems": 2})


Cell = Annotated[
    tuple[Coordinate, Coordinate],
    BeforeValidator(_pair("a cell, `[x, y]`")),
    Once(),
    _pair_schema({"type": "integer", "minimum": 0, "exclusiveMaximum": MAX_SIZE}),
]
"""A cell, `(x, y)`: x grows to the east, y to the south, `(0, 0)` is the top-left cell."""

_Extent = Annotated[StrictInt, Field(ge=1, le=MAX_SIZE), BeforeValidator(_whole)]
Size = Annotated[
    tuple[_Extent, _Extent],
    BeforeValidator(_pair("`[width, height]`")),
    Once(),
    _pair_schema({"type": "integer", "minimum": 1, "maximum": MAX_SIZE}),
]

SIDES = ("N", "E", "S", "W")
"""The four sides of a cell, in the order that arrays over sides use."""

SIDE_NAMES = {"north": "N", "east": "E", "south": "S", "west": "W"}
Side = Annotated[
    Literal["N", "E", "S", "W"],
    BeforeValidator(
        lambda value: SIDE_NAMES.get(value, value) if isinstance(value, str) else value
    ),
    WithJsonSchema({"enum": [*SIDES, *SIDE_NAMES]}),
]


def form(name: str) -> Tag:
    """Name one form of a field that can be written in several ways."""
    return Tag(FORM_PREFIX + name)


@dataclass(frozen=True, slots=True)
class Forms(Discriminator):
    """Chooses the form of a field that can be written in several ways.

    Attributes:
        words: the forms, as messages call them.
    """

    words: str = ""


def forms(words: str, choose: Callable[[Any], str]) -> Forms:
    """Choose the form of a value by `choose`, so that errors are about that form only.

    Args:
        words: the forms, as messages call them.
        choose: returns the name of the form of a value.
    """
    return Forms(lambda value: FORM_PREFIX + choose(value), words=words)


def cell_or_cells(value: Any) -> str:
    """Tell `[x, y]` from `[[x, y], …]`."""
    is_list = isinstance(value, list | tuple)
    return "cells" if is_list and value and isinstance(value[0], list | tuple | dict) else "cell"


Cells = Annotated[tuple[Cell, ...], Field(min_length=1)]
