"""What a drawing gives, as fields: size, start, exit, walls, puddles, blocked, areas."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.cells import Area, Puddle, Rectangle
from babyrobot_levels.language.fields import DRAWN, LevelFields, fields_with
from babyrobot_levels.language.walls import Wall, sides_of
from babyrobot_levels.text.diagnostics import Issue, Key

GLASS_PASS = 0.5
"""The `pass` of a drawn wall of glass without an entry in `walls`."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """What a drawing gives.

    Attributes:
        drawing: the drawing.
        fields: the values of the fields that it gives.
        counts: how many of the first entries of `walls` and `areas` come from it.
    """

    drawing: d.Drawing
    fields: dict[str, Any]
    counts: dict[str, int]


def expand_map(level: LevelFields) -> tuple[Drawn | None, list[Issue]]:
    """Return what the level's drawing gives, or None and what is wrong with it."""
    if level.map is None:
        return None, [Issue("BR206", Key(("legend",)), "`legend` needs a `map`")]
    issues = [
        Issue(
            "BR206",
            Key((field,)),
            f"`{field}` cannot be combined with `map`: the drawing gives it",
            f"remove `{field}`, or draw it",
        )
        for field in fields_with(DRAWN)
        if field in level.model_fields_set
    ]
    if level.map.strip() and "\n" not in level.map.strip():
        return None, [
            *issues,
            Issue(
                "BR312",
                ("map",),
                "the drawing is on a single line",
                "write `map: |` and put the drawing on the lines below, indented",
            ),
        ]
    drawing, faults = d.parse(level.map, lambda character: character in level.legend, MAX_SIZE)
    if drawing is None:
        return None, [*issues, *faults]
    starts, exits = drawing.find(d.START), drawing.find(d.EXIT)
    if not starts:
        issues.append(Issue("BR313", ("map",), "the drawing has no start", "mark a cell with `S`"))
    issues += _check_wall_entries(level, drawing)
    if issues:
        return None, issues
    walls, areas = drawn_walls(drawing), legend_areas(level, drawing)
    fields = {
        "size": (drawing.width, drawing.height),
        "start": starts[0] if len(starts) == 1 else tuple(starts),
        "exit": "none" if not exits else exits[0] if len(exits) == 1 else tuple(exits),
        "walls": (*walls, *level.walls),
        "puddles": tuple(
            Puddle(at=cell, size=size)
            for character, size in ((d.SMALL, "small"), (d.LARGE, "large"))
            for cell in drawing.find(character)
        ),
        "blocked": tuple(
            Rectangle(at=cell, size=(length, 1)) for cell, length in drawing.row_runs(d.BLOCKED)
        ),
        "areas": (*areas, *level.areas),
    }
    return Drawn(drawing, fields, {"walls": len(walls), "areas": len(areas)}), []


def drawn_walls(drawing: d.Drawing) -> list[Wall]:
    """Return the walls of a drawing, those in a line as one with a `length`."""
    walls = [
        Wall.model_validate({"at": cell, "side": side, "length": length})
        for cell, side, length in drawing.runs(d.SOLID)
    ]
    walls += [
        Wall.model_validate({"at": cell, "side": side, "length": length, "pass": GLASS_PASS})
        for cell, side, length in drawing.runs(d.GLASS)
    ]
    return walls


def legend_areas(level: LevelFields, drawing: d.Drawing) -> list[Area]:
    """Return an area for each cell that shows a character of the legend."""
    return [
        Area.model_validate({"at": cell, **{name: getattr(traits, name) for name in given}})
        for character, traits in level.legend.items()
        for given in [sorted(traits.model_fields_set)]
        for cell in drawing.find(character)
    ]


def _check_wall_entries(level: LevelFields, drawing: d.Drawing) -> list[Issue]:
    """Check that `walls`, beside a drawing, only sets properties of drawn walls."""
    issues = []
    for index, wall in enumerate(level.walls):
        marks = {_mark(drawing, x, y, wall.side) for x, y in sides_of(wall)}
        route = ("walls", index)
        if d.OPEN in marks:
            issues.append(
                Issue(
                    "BR314",
                    route,
                    "the map shows no wall there",
                    "with a `map`, entries of `walls` set properties of walls that the map shows",
                )
            )
        elif "pass_" in wall.model_fields_set and wall.pass_ > 0 and d.SOLID in marks:
            issues.append(
                Issue(
                    "BR314",
                    (*route, "pass"),
                    "the map shows a solid wall there, not glass",
                    "draw it as `- -` or `:`",
                )
            )
        elif "pass_" in wall.model_fields_set and wall.pass_ == 0 and d.GLASS in marks:
            issues.append(
                Issue(
                    "BR314",
                    (*route, "pass"),
                    "the map shows glass there, so `pass` must be above 0",
                    "draw it as `---` or `|`",
                )
            )
    return issues


def _mark(drawing: d.Drawing, x: int, y: int, side: str) -> str:
    """Return the mark of a side; a side off the drawing counts as the solid outer wall."""
    if side == "W":
        x, side = x - 1, "E"
    elif side == "N":
        y, side = y - 1, "S"
    rows = drawing.east if side == "E" else drawing.south
    if 0 <= y < len(rows) and 0 <= x < len(rows[y]):
        return rows[y][x]
    return d.SOLID
