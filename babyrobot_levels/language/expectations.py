"""What a level file states of its level in `expect`: figures and ranges that must be true."""

# As in `base`, annotations are not postponed.
import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import Field, StringConstraints, create_model

from babyrobot_levels.language.base import Model, Number, Slug, form, forms
from babyrobot_levels.language.metric_names import STATED
from babyrobot_levels.language.ranges import TEXT, bounds, ends
from babyrobot_levels.text.diagnostics import Issue
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
    """Facts that are stated of a level, or of all levels of a suite."""

    @property
    def stated(self) -> dict[str, Any]:
        """What each fact must be, as it is written, in the order of the metrics."""
        return {name: value for name, value in self if name in self.model_fields_set}

    def faulty_ranges(self) -> Iterator[Issue]:
        """Yield an error for each range that no number is in."""
        for name, value in self.stated.items():
            if name in _KINDS:
                continue
            route, (least, most) = ("expect", name), bounds(value)
            if least is most is None:
                yield Issue("BR326", route, "a range needs `min`, `max` or both")
            elif None not in (least, most) and least > most:
                message = f"the range is upside down: {least:g} is above {most:g}"
                yield Issue("BR326", route, message, f"write `{name}: {most:g}..{least:g}`")


if TYPE_CHECKING:
    Expect: TypeAlias = Facts
    SuiteExpect: TypeAlias = Facts
else:

    def _model(name: str, facts: Iterable[str]) -> type[Facts]:
        # pydantic 2.11 keeps in a `Field` what it reads of a model: each has its own.
        fields = {
            fact: (_KINDS.get(fact, Figure), Field(None, description=f"What `{fact}` must be."))
            for fact in facts
        }
        return create_model(name, __base__=Facts, **fields)

    Expect = _model("Expect", (*STATED, "lint"))
    SuiteExpect = _model("SuiteExpect", STATED)
