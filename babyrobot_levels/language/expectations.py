"""What a level file states of its level in `expect`: figures and ranges that must be true."""

# As in `base`, annotations are not postponed.
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import Field, StringConstraints, create_model

from babyrobot_levels.language.base import Model, Number, Slug, form, forms
from babyrobot_levels.language.metric_names import METRICS
from babyrobot_levels.language.ranges import TEXT, ends


class FigureRange(Model):
    """Numbers from `min` to `max`, both included; without one of them, open there."""

    min: Number | None = None
    """The least."""
    max: Number | None = None
    """The most."""


def _form(value: Any) -> str:
    if isinstance(value, dict | Model):
        return "mapping"
    return "text" if isinstance(value, str) and ends(value) else "number"


Figure = Annotated[
    Annotated[Number, form("number")]
    | Annotated[str, StringConstraints(strict=True, pattern=TEXT), form("text")]
    | Annotated[FigureRange, form("mapping")],
    forms("a number, or a range such as `3..5`", _form),
]
"""What a metric must be, as it is written."""

_KINDS: dict[str, Any] = {"needs": tuple[Slug, ...], "lint": Literal["clean"]}
"""What is stated of those that are no figures."""


class Facts(Model):
    """The facts that a level file states."""

    @property
    def stated(self) -> dict[str, Any]:
        """What each fact must be, as it is written, in the order of the metrics."""
        return {name: value for name, value in self if name in self.model_fields_set}


if TYPE_CHECKING:
    Expect: TypeAlias = Facts
else:
    Expect = create_model(
        "Expect",
        __base__=Facts,
        **{
            name: (_KINDS.get(name, Figure), Field(None, description=f"What `{name}` must be."))
            for name in (*METRICS, "lint")
        },
    )
