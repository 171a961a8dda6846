"""The examples of the documentation: the level that a block stands for, its picture, its errors.

A comment on the line before a block of YAML says what it is, and is not seen: `<!-- fragment -->`
are fields to be put below `version: 1`, `<!-- error BR301 -->` is a level with that error,
`<!-- theme -->` is the file of a theme, and `<!-- no picture -->` stands before a level without a
picture. Tests read further comments.
"""

from __future__ import annotations

import pathlib
import re
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from textwrap import indent
from typing import Any, Self

from pydantic import ValidationError, model_validator

from babyrobot_levels.extensions.editor.findings import Linting, findings_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.rules import all_rules
from babyrobot_levels.linter.runner import Report, lint_source
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.icons import RIM
from babyrobot_levels.render.scene.layout import CELL, Layout, layout_of
from babyrobot_levels.render.scene.marks import MARK
from babyrobot_levels.render.scene.shapes import Path, Scene, rounded
from babyrobot_levels.text.errors import InvalidDocument, LevelError
from babyrobot_levels.text.source import SourceFile

NAME = "levels/first.yaml"
"""The file in which an example is said to be; it need not be there."""

FAULT = re.compile(r"error (BR\d{3})")
"""The comment before a level with an error."""

_BEYOND = 2
"""So many columns and rows beyond the grid are in the picture if something is marked there."""

_INSET, _AROUND = 5.0, 19.0
"""How far a ring is within its cell, and how far from the side that it surrounds, in pixels."""

_SAMPLE = """\
version: 1
map: |
  +---+---+---+---+
  | S   k : o     |
  +   +---+   +   +
  |     O |###  E |
  +---+---+---+---+
legend:
  k: {item: key}
display: {robot: {show: true}}
theme:
"""
"""A level that shows what a theme colours; the theme follows."""


Place = tuple[int, int, str]
"""A cell `(x, y)` and a side of it, which is empty for the cell itself."""


@dataclass(frozen=True)
class Example:
    """An example as it is shown.

    Attributes:
        scene: its picture; None if there is nothing to draw.
        lines: the lines of the text that errors and findings are about, from 1.
        messages: the errors and findings, as the command reports them.
        is_broken: whether it seems to be a level and has errors that it is not meant to have.
    """

    scene: Scene | None
    lines: tuple[int, ...]
    messages: str
    is_broken: bool


def level_text(text: str, marks: Collection[str]) -> str:
    """Return the level that a block stands for.

    Args:
        text: the block.
        marks: what the comments before it say.
    """
    if "fragment" in marks:
        return "version: 1\n" + text
    return _SAMPLE + indent(text, "  ") if "theme" in marks else text


@cache
def example_of(text: str, marks: frozenset[str] = frozenset(), code: str = "") -> Example:
    """Return how an example is shown.

    Args:
        text: the block.
        marks: what the comments before it say.
        code: the code of an error or a rule that finds something in it: that is marked.
    """
    code = code or next((found[1] for found in map(FAULT.fullmatch, marks) if found), "")
    # BR699 looks at what the others find.
    rules = [rule for rule in all_rules() if code in (rule.code, "BR699")]
    source = SourceFile(NAME, level_text(text, marks))
    report = lint_source(source, rules, pathlib.Path(NAME))
    found = [each for each in report.diagnostics if each.code == code]
    shown = replace(report, diagnostics=found)
    before = source.text.count("\n") - text.count("\n")
    lines = {
        line - before
        for each in found
        for line in range(each.line, each.end.line + (each.end.column > 1))
        # What the whole text is about is no line of it.
        if each.end.line < len(source.lines) or each.line > 1
    }
    messages = "\n\n".join(map(str, found))
    is_level = source.text.startswith("version: 1\n") and "\nkind:" not in source.text
    is_broken = is_level and not report.is_valid and not found
    return Example(_picture_of(shown), tuple(sorted(lines)), messages, is_broken)


def _picture_of(report: Report) -> Scene | None:
    """Return the picture of a text in which the places of its findings are marked.

    None if the text is no level, or if its faults leave nothing to draw that would show them.
    """
    places = _places(report)
    level = report.level
    if level is not None:
        return _with_marks(level, places)
    if report.document is None or not isinstance(report.document.data, dict) or not places:
        return None
    with suppress(ValidationError, LevelError, ValueError):
        level = _unchecked(report.document.data)
        if level.map is None or level.drawing is not None:
            return _with_marks(level, places)
    return None


class _Unchecked(Level):
    """A level with valid fields that need not go together."""

    @model_validator(mode="after")
    def _complete(self) -> Self:
        with suppress(InvalidDocument):
            # To mypy this is a decorator and no method.
            super()._complete()  # type: ignore[operator]
        return self


def _unchecked(data: Mapping[str, Any]) -> Level:
    """Return the level of a mapping with faults, without entries of lists that are invalid."""
    try:
        return _Unchecked.model_validate(data)
    except ValidationError as error:
        faulty = {detail["loc"][:2] for detail in error.errors()}
    rest = {
        name: [each for number, each in enumerate(value) if (name, number) not in faulty]
        if isinstance(value, list)
        else value
        for name, value in data.items()
    }
    return _Unchecked.model_validate(rest)


def _places(report: Report) -> list[Place]:
    """Return what findings are about."""
    found = [*findings_of(Linting(report), (1024, 1024))]
    cells = [(x, y, "") for each in found for x, y in each["cells"]]
    sides = [(x, y, side) for each in found for x, y, side in each["sides"]]
    return [*dict.fromkeys(cells + sides)]


def _with_marks(level: Level, places: list[Place]) -> Scene:
    """Return the picture of a level with rings around places, also around some off the grid."""
    if level.has_random_maze:
        level = level.with_maze_seed(0)
    scene, layout = build_scene(level), layout_of(level)
    columns, rows = (length + _BEYOND for length in level.size)
    shown = [place for place in places if place[0] < columns and place[1] < rows]
    if not shown:
        return scene
    boxes = [_box(layout, *place) for place in shown]
    commands = tuple(command for box in boxes for command in rounded(*box, 10))
    rings = (Path(commands, stroke=color, width=width) for color, width in ((RIM, 8), (MARK, 4)))
    return replace(
        scene,
        width=max(scene.width, *(left + width + _INSET for left, _, width, _ in boxes)),
        height=max(scene.height, *(top + height + _INSET for _, top, _, height in boxes)),
        shapes=(*scene.shapes, *rings),
    )


def _box(layout: Layout, x: int, y: int, side: str) -> tuple[float, float, float, float]:
    """Return left, top, width and height of the ring in a cell, or around a side of it."""
    left, top = layout.corner(x + (side == "E"), y + (side == "S"))
    long = CELL - 2 * _INSET
    if not side:
        return left + _INSET, top + _INSET, long, long
    if side in "NS":
        return left + _INSET, top - _AROUND, long, 2 * _AROUND
    return left - _AROUND, top + _INSET, 2 * _AROUND, long
