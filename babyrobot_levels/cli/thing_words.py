"""Changes of items, switches, movers and doors in words, for `babyrobot diff`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.render.words.phrases import cells
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.analysis.changes import Change

_SIDES = {"E": "east", "S": "south"}


def thing_lines(change: Change) -> list[str]:
    """Return a change of a thing as sentences, one for each property that differs."""
    kind, _, name = (change.name or "").partition(".")
    if kind == "things":
        orders = [", ".join(names) for names in (change.before, change.after)]
        return [f"they count in another order: {' -> '.join(orders)}"]
    subject = f"the {name}"
    if kind == "doors" and change.cell is not None:
        subject = f"the door {_SIDES[name]} of {show_cell(change.cell)}"
    before, after = (dict(_said(kind, each)) for each in (change.before, change.after))
    if not before or not after:
        state, said = ("removed", before) if before else ("new", after)
        usual = _USUAL.get(kind, {})
        told = [f"{verb} {text}" for verb, text in said.items() if usual.get(verb) != text]
        return [one_line(f"{state}: {subject}, which {' and '.join(told)}")]
    stays = "lies" in after and after["lies"] == before["lies"]
    where = f" {after['lies']}" if stays else ""
    return [
        one_line(f"{subject}{where} {verb} {text} instead of {before[verb]}")
        for verb, text in after.items()
        if before[verb] != text
    ]


_USUAL = {
    "items": {"pays": "what the cell pays"},
    "switches": {"flips": "every time", "begins": "off"},
    "doors": {"is closed by": "nothing"},
}
"""What goes without saying of a new thing."""


def _said(kind: str, fields: dict[str, Any] | None) -> Iterator[tuple[str, str]]:
    """Yield what a thing does, as verb and object; nothing of one that does not exist."""
    if fields is None:
        return
    if kind == "items":
        yield "lies", f"at {'one of ' if len(fields['in']) > 1 else ''}{cells(fields['in'])}"
        pays = fields["reward"]
        yield "pays", "what the cell pays" if pays is None else f"{pays:g}"
    elif kind == "switches":
        yield "lies", f"at {show_cell(fields['at'])}"
        yield "flips", "only the first time" if fields["once"] else "every time"
        yield "begins", "on" if fields["on"] else "off"
    elif kind == "movers":
        yield "walks", _way(fields)
    else:
        yield "needs", listed(fields["needs"]) or "nothing"
        yield "is closed by", listed(fields["unless"]) or "nothing"


def _way(fields: dict[str, Any]) -> str:
    if "path" in fields:
        return f"{cells(fields['path'])} {'and back' if fields['back'] else 'in a loop'}"
    (x, y), (width, height) = fields["within"]["at"], fields["within"]["size"]
    corners = f"{show_cell((x, y))} to {show_cell((x + width - 1, y + height - 1))}"
    start = "a random cell" if fields["start"] is None else show_cell(fields["start"])
    return f"at random within {corners} from {start}"
