"""Hostile levels, drawn from the JSON schema: as many entries of a field as are asked for.

Whatever the language gets, it is drawn as well: new lists and new properties of entries need
nothing here. What is not valid together is left out again.
"""

from __future__ import annotations

import json
from math import isqrt
from random import Random
from typing import Any

from support.places import ROOT

from babyrobot_levels import validate

SCHEMA: dict[str, Any] = json.loads((ROOT / "schemas/level.schema.json").read_text("utf-8"))

ROUNDS = 12
"""So often entries with errors are drawn again, and then left out: an error may hide others."""


def _variants(schema: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the forms that a value may have, `null` left out."""
    if "$ref" in schema:
        return _variants(SCHEMA["$defs"][schema["$ref"].rpartition("/")[2]])
    forms = schema.get("oneOf") or schema.get("anyOf")
    if forms is None or "properties" in schema:
        return [schema] if schema.get("type") != "null" else []
    return [form for each in forms for form in _variants(each)]


def _is_cell(schema: dict[str, Any]) -> bool:
    return schema.get("maxItems") == 2 and schema["items"].get("minimum") == 0


def _list_of(schema: dict[str, Any]) -> dict[str, Any] | None:
    """Return the schema of the entries, of a field that may be a list of any length."""
    for form in _variants(schema):
        if form.get("type") == "array" and "maxItems" not in form:
            entry: dict[str, Any] = form["items"]
            return entry
    return None


LISTS = {
    name: entry
    for name, value in SCHEMA["properties"].items()
    if (entry := _list_of(value)) and not name.endswith("_weights")
}
"""The fields that are lists, with the schemas of their entries; weights are as long as others."""


class _Drawn:
    """Draws values; each cell, and each name of its own, is another one.

    Args:
        rng: decides.
        side: how many cells the level is wide, and high but for the last rows.
    """

    def __init__(self, rng: Random, side: int) -> None:
        self.rng, self.side, self.count = rng, side, 0

    def cell(self) -> list[int]:
        self.count += 1
        # None is the default start.
        place = 1 + self.count % (self.side**2 - 1)
        return [place % self.side, place // self.side]

    def value(self, name: str, schema: dict[str, Any]) -> Any:
        form = self.rng.choice(_variants(schema))
        if "const" in form or "enum" in form:
            return form.get("const") or self.rng.choice(form["enum"])
        match form.get("type"):
            case "object":
                return self.entry(form)
            case "array" if _is_cell(form):
                return self.cell()
            case "array" if form.get("maxItems") == 2:
                return [self.rng.randint(1, 2), self.rng.randint(1, 2)]
            case "array" if name == "path":
                # Neighbours, or the same cell again.
                return [self.cell()] * 2
            case "array":
                count = self.rng.randint(form.get("minItems", 1), 4)
                return [self.value(name, form["items"]) for _ in range(count)]
            case "integer":
                return self.rng.randint(form.get("minimum", 0), min(form.get("maximum", 3), 3))
            case "number":
                return round(self.rng.uniform(form.get("minimum", -9), form.get("maximum", 9)), 2)
            case "boolean":
                return self.rng.random() < 0.5
        if name in NEEDS:
            return self.rng.choice(["key", "lever"])
        if name == "color":
            return self.rng.choice(["red", "#0af"])
        self.count += name == "name"
        return f"n{self.count}"

    def entry(self, form: dict[str, Any]) -> dict[str, Any]:
        """Return an entry with what it must have, and some of what it may have."""
        # Of fields that exclude each other, one is needed.
        one_of = [each["required"][0] for each in form.get("oneOf", ()) if "required" in each]
        needed = [*form.get("required", ()), *([self.rng.choice(one_of)] if one_of else [])]
        return {
            name: self.value(name, value)
            for name, value in form["properties"].items()
            if name in needed or (name not in one_of and self.rng.random() < 0.4)
        }


NEEDS = ("needs", "unless", "exit_needs")
"""The fields whose entries are names of other things."""

TOO_LARGE = {"BR404", "BR405"}
"""The errors of levels that come to more than they may."""


def hostile(field: str, count: int, seed: int) -> str:
    """Return a level with at most so many entries in a field, valid unless it is too large."""
    rng = Random(f"{field} {seed}")
    side = isqrt(2 * count) + 3
    drawn = _Drawn(rng, side)
    lines = [
        "version: 1",
        f"size: [{side}, {side + 3}]",
        rng.choice(["skid: 0.1", "max_steps: 1000", "rewards: {closer: 1}", "maze: {seed: 1}"]),
    ]
    last = side + 2
    if field not in ("items", "switches"):
        lines.append(f"items: [{{name: key, at: [1, {last}]}}]")
        lines.append(f"switches: [{{name: lever, at: [0, {last}]}}]")
    if field != "exit_one_of" and field != "exit":
        lines.append(f"exit: [{side - 1}, {last}]")
    head = len(lines) + 1

    def entry() -> str:
        return f"- {json.dumps(drawn.value(field, LISTS[field]))}"

    lines += [f"{field}:", *(entry() for _ in range(count))]
    for left in reversed(range(ROUNDS)):
        text = "\n".join(lines) + "\n"
        found = validate(text)
        if not found or {each.code for each in found} <= TOO_LARGE:
            return text
        wrong = {each.line for each in found}
        assert min(wrong) > head, (text, found[0])
        for number in sorted(wrong, reverse=True):
            lines[number - 1 : number] = [entry()] if left > ROUNDS // 2 else []
    raise AssertionError("there are errors behind errors")
