"""What a drawing gives, as fields: size, start, exit, walls, puddles, blocked, areas, things."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.cells import Area, Puddle, Rectangle
from babyrobot_levels.language.fields import DRAWN, LevelFields, fields_with
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.things import LEGEND_FIELDS, Door, Item, LegendEntry, Switch
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
        counts: how many of the first entries of `walls`, `areas`, `items` and `switches` come
            from it.
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
    issues += _check_legend(level)
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
    if exits and level.exit_one_of is not None:
        message = "`exit_one_of` cannot be combined with an exit, and the drawing shows `E`"
        help_text = "remove `exit_one_of`, or draw its cells without `E`"
        issues.append(Issue("BR206", Key(("exit_one_of",)), message, help_text))
    issues += _check_wall_entries(level, drawing)
    issues += _check_doors(level, drawing)
    issues += _check_drawn_switches(level, drawing)
    if issues:
        return None, issues
    walls, areas = drawn_walls(drawing), legend_areas(level, drawing)
    items, switches = legend_items(level, drawing), legend_switches(level, drawing)
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
        "items": (*items, *level.items),
        "switches": (*switches, *level.switches),
    }
    counts = {
        "walls": len(walls),
        "areas": len(areas),
        "items": len(items),
        "switches": len(switches),
    }
    return Drawn(drawing, fields, counts), []


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
    """Return an area for each cell that shows a character of the legend, things left out."""
    return [
        Area.model_validate({"at": cell, **_given(traits)})
        for character, traits in level.legend.items()
        if traits.kind == "area"
        for cell in drawing.find(character)
    ]


def legend_items(level: LevelFields, drawing: d.Drawing) -> list[Item]:
    """Return the items of the legend: where several cells show one, it lies in one of them."""
    return [
        Item.model_validate(
            {
                "name": entry.item,
                **({"at": cells[0]} if len(cells) == 1 else {"one_of": cells}),
                **_given(entry),
            }
        )
        for character, entry in level.legend.items()
        if entry.kind == "item"
        for cells in [drawing.find(character)]
        if cells
    ]


def legend_switches(level: LevelFields, drawing: d.Drawing) -> list[Switch]:
    """Return the switches of the legend."""
    return [
        Switch.model_validate({"name": entry.switch, "at": cell, **_given(entry)})
        for character, entry in level.legend.items()
        if entry.kind == "switch"
        for cell in drawing.find(character)
    ]


def _given(entry: LegendEntry) -> dict[str, Any]:
    """Return the given properties of what an entry stands for, without its name."""
    names = [name for name in LEGEND_FIELDS[entry.kind] if name not in ("item", "switch")]
    return {name: getattr(entry, name) for name in names if name in entry.model_fields_set}


def _check_legend(level: LevelFields) -> list[Issue]:
    """Check that an entry has only fields of what it stands for: an area, an item, or a switch."""
    issues = []
    for character, entry in level.legend.items():
        allowed = LEGEND_FIELDS[entry.kind]
        for name in LegendEntry.model_fields:
            if name in allowed or name not in entry.model_fields_set or _is_none(entry, name):
                continue
            if name == "switch":
                message = "`switch` cannot be combined with `item`: a character stands for one"
                help_text: str | None = "use a character for each of them"
            elif entry.kind == "area":
                owner = "an `item`" if name == "shape" else "a `switch`"
                message = f"`{name}` needs {owner}: `{character}` stands for an area"
                help_text = f"add {owner} with a name, or remove `{name}`"
            else:
                message = f"`{name}` cannot be combined with `{entry.kind}`"
                help_text = f"fields beside `{entry.kind}`: " + ", ".join(allowed[1:])
            issues.append(Issue("BR206", Key(("legend", character, name)), message, help_text))
    return issues


def _is_none(entry: LegendEntry, name: str) -> bool:
    return getattr(entry, name) is None


def _check_drawn_switches(level: LevelFields, drawing: d.Drawing) -> list[Issue]:
    """Check that the drawing shows each switch once."""
    return [
        Issue(
            "BR314",
            d.mark_of(level.map or "", *cell),
            f"the switch `{entry.switch}` is drawn twice",
            "draw it once, and give other switches a character and a name of their own",
        )
        for character, entry in level.legend.items()
        if entry.kind == "switch"
        for cell in drawing.find(character)[1:2]
    ]


MAX_UNDRAWN = 20
"""At most so many drawn doors without an entry are reported."""


def _check_doors(level: LevelFields, drawing: d.Drawing) -> list[Issue]:
    """Check that `doors` has an entry for all drawn doors, and for no others."""
    issues: list[Issue] = []
    entered: set[tuple[int, int, str]] = set()
    for index, door in enumerate(level.doors):
        for cell, edge in zip(sides_of(door), _edges(door), strict=True):
            if edge in entered:
                # Looked at already; that a side has two doors is told with the walls.
                break
            entered.add(edge)
            if _mark(drawing, *edge, off=d.DOOR) != d.DOOR:
                message = f"the map shows no door on side {door.side} of {show_cell(cell)}"
                help_text = f"draw it there as `{'/' if door.side in 'EW' else '-/-'}`"
                issues.append(Issue("BR314", ("doors", index), message, help_text))
                break
    missing = [edge for edge in _drawn_doors(drawing) if edge not in entered]
    for x, y, side in missing[:MAX_UNDRAWN]:
        issues.append(
            Issue(
                "BR314",
                d.mark_of(level.map or "", x, y, side),
                "`doors` has no entry for this door",
                f"add `{{at: [{x}, {y}], side: {side}, needs: …}}` to `doors`",
            )
        )
    return issues


def _drawn_doors(drawing: d.Drawing) -> list[tuple[int, int, str]]:
    return [
        (x, y, side)
        for side, rows in (("E", drawing.east), ("S", drawing.south))
        for y, row in enumerate(rows)
        for x, mark in enumerate(row)
        if mark == d.DOOR
    ]


def _edges(door: Door) -> list[tuple[int, int, str]]:
    """Return the sides along which a door runs, each as the E or S side of a cell."""
    dx, dy, side = {"W": (-1, 0, "E"), "N": (0, -1, "S")}.get(door.side, (0, 0, door.side))
    return [(x + dx, y + dy, side) for x, y in sides_of(door)]


def _check_wall_entries(level: LevelFields, drawing: d.Drawing) -> list[Issue]:
    """Check that `walls`, beside a drawing, only sets properties of drawn walls."""
    issues = []
    for index, wall in enumerate(level.walls):
        marks = {_mark(drawing, x, y, wall.side) for x, y in sides_of(wall)}
        route = ("walls", index)
        if marks & {d.OPEN, d.DOOR}:
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


def _mark(drawing: d.Drawing, x: int, y: int, side: str, off: str = d.SOLID) -> str:
    """Return the mark of a side; one off the drawing counts as `off`, a solid outer wall."""
    if side == "W":
        x, side = x - 1, "E"
    elif side == "N":
        y, side = y - 1, "S"
    rows = drawing.east if side == "E" else drawing.south
    if 0 <= y < len(rows) and 0 <= x < len(rows[y]):
        return rows[y][x]
    return off
