"""What a level file states of its level in `expect`: figures and ranges that must be true."""

# As in `base`, annotations are not postponed.
import re
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import Field, StringConstraints, create_model

from babyrobot_levels.language.base import Model, Number, Slug, form, forms
from babyrobot_levels.language.metric_names import METRICS
from babyrobot_levels.language.ranges import TEXT, ends
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.emitter import scalar


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


_NUMBER = re.compile(r"[-+]?[0-9]*(?:\.([0-9]*))?(?:[eE]([-+]?[0-9]+))?")


def decimals_in(document: Document | None, name: str, value: float) -> int:
    """Return with how many decimals a text states a figure, or else, how many it has."""
    texts = [scalar(value)]
    if document is not None:
        node, depth = document.node(("expect", name))
        if depth == 2 and node.data == value:
            texts.insert(0, node.source.text[node.first : node.last])
    match = next(filter(None, map(_NUMBER.fullmatch, texts)))
    return max(0, len(match[1] or "") - int(match[2] or 0))


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
