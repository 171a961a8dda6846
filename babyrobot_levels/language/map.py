"""What a drawing gives, as fields: size, start, exit, walls, puddles, blocked, areas, things."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import MAX_SIZE, Model
from babyrobot_levels.language.cells import RandomReward, Rectangle, Wall, sides_of
from babyrobot_levels.language.fields import DRAWN, LevelFields, fields_with
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.kinds import KIND, LEGEND, MARKED, Kind
from babyrobot_levels.language.parsing import parse
from babyrobot_levels.language.things import DRAWN_NAMES, Door, LegendEntry
from babyrobot_levels.text.diagnostics import Issue, Key


@dataclass(frozen=True, slots=True)
class Drawn:
    """What a drawing gives.

    Attributes:
        drawing: the drawing.
        fields: the values of the fields that it gives.
        counts: how many of the first entries of a list come from it.
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
    drawing, faults = parse(level.map, lambda character: character in level.legend, MAX_SIZE)
    if drawing is None:
        return None, [*issues, *faults]
    starts, exits = drawing.find(d.START), drawing.find(d.EXIT)
    if not starts and not (level.robots and all(robot.start for robot in level.robots)):
        issues.append(Issue("BR313", ("map",), "the drawing has no start", "mark a cell with `S`"))
    if exits and level.exit_one_of is not None:
        message = "`exit_one_of` cannot be combined with an exit, and the drawing shows `E`"
        help_text = "remove `exit_one_of`, or draw its cells without `E`"
        issues.append(Issue("BR206", Key(("exit_one_of",)), message, help_text))
    issues += _check_wall_entries(level, drawing)
    issues += _check_doors(level, drawing)
    issues += _check_drawn_once(level, drawing)
    if issues:
        return None, issues
    drawn: dict[str, list[Model]] = {"walls": [*drawn_walls(drawing)]}
    for kinds, entries_of in ((MARKED, marked_entries), (LEGEND, legend_entries)):
        for kind in kinds:
            drawn.setdefault(kind.field, []).extend(entries_of(kind, level, drawing))
    fields = {
        "size": (drawing.width, drawing.height),
        "start": starts[0] if len(starts) == 1 else tuple(starts) or level.start,
        "exit": "none" if not exits else exits[0] if len(exits) == 1 else tuple(exits),
        "blocked": tuple(
            Rectangle(at=cell, size=(length, 1)) for cell, length in drawing.row_runs(d.BLOCKED)
        ),
        **{field: (*entries, *getattr(level, field)) for field, entries in drawn.items()},
    }
    return Drawn(drawing, fields, {field: len(entries) for field, entries in drawn.items()}), []


def drawn_walls(drawing: d.Drawing) -> list[Wall]:
    """Return the walls of a drawing, those in a line as one with a `length`."""
    return [
        Wall.model_validate({"at": cell, "side": side, "length": length, **given})
        for mark, given in KIND["wall"].marks.items()
        for cell, side, length in drawing.runs(mark)
    ]


def marked_entries(kind: Kind, level: LevelFields, drawing: d.Drawing) -> list[Model]:
    """Return the entries of a kind in cells that its marks show, where no legend has these."""
    return [
        kind.entry({"at": cell, **given})
        for mark, given in kind.marks.items()
        if mark not in level.legend
        for cell in drawing.find(mark)
    ]


def legend_entries(kind: Kind, level: LevelFields, drawing: d.Drawing) -> list[Model]:
    """Return the entries of a kind that characters of the legend stand for.

    There is one for each cell that shows the character; where the kind may lie in one of several
    cells, there is one for all of them.
    """
    return [
        kind.entry({**place, **_given(kind, entry)})
        for character, entry in level.legend.items()
        if entry.kind == kind.name
        for place in _places(kind, drawing.find(character))
    ]


def _places(kind: Kind, cells: list[tuple[int, int]]) -> list[dict[str, Any]]:
    if len(cells) > 1 and "one_of" in kind.properties:
        return [{"one_of": cells}]
    return [{"at": cell} for cell in cells]


def _given(kind: Kind, entry: LegendEntry) -> dict[str, Any]:
    """Return the given properties of what an entry of the legend stands for."""
    names = {kind.name: "name"}
    return {
        names.get(name, name): getattr(entry, name)
        for name in kind.legend
        if name in entry.model_fields_set
    }


def _check_legend(level: LevelFields) -> Iterator[Issue]:
    """Check that an entry has only fields of the kind that it stands for."""
    for character, entry in level.legend.items():
        allowed = KIND[entry.kind].legend
        for name in LegendEntry.model_fields:
            if name in allowed or name not in entry.model_fields_set:
                continue
            if getattr(entry, name) is None:
                continue
            if name in DRAWN_NAMES:
                message = f"`{name}` cannot be combined with `{entry.kind}`"
                message += ": a character stands for one"
                help_text: str | None = "use a character for each of them"
            elif entry.kind == "area":
                kind = next(kind for kind in LEGEND if name in kind.legend)
                owner = kind.one.replace(kind.noun, f"`{kind.name}`")
                message = f"`{name}` needs {owner}: `{character}` stands for an area"
                help_text = f"add {owner} with a name, or remove `{name}`"
            else:
                message = f"`{name}` cannot be combined with `{entry.kind}`"
                help_text = f"fields beside `{entry.kind}`: " + ", ".join(allowed[1:])
            yield Issue("BR206", Key(("legend", character, name)), message, help_text)
        if entry.kind == "item" and isinstance(entry.reward, RandomReward):
            message = "`reward` of an item must be a number: only that of a cell is drawn"
            yield Issue("BR206", Key(("legend", character, "reward")), message, "write one number")


def _check_drawn_once(level: LevelFields, drawing: d.Drawing) -> list[Issue]:
    """Check that the drawing shows what has a name once, if it cannot lie in one of many cells."""
    return [
        Issue(
            "BR314",
            d.mark_of(level.map or "", *cell),
            f"the {kind.noun} `{getattr(entry, kind.name)}` is drawn twice",
            f"draw it once, and give other {kind.plural} a character and a name of their own",
        )
        for character, entry in level.legend.items()
        for kind in [KIND[entry.kind]]
        if kind.has_name and "one_of" not in kind.properties
        for cell in drawing.find(character)[1:2]
    ]


MAX_UNDRAWN = 20
"""At most so many drawn doors without an entry are reported."""


def _check_doors(level: LevelFields, drawing: d.Drawing) -> Iterator[Issue]:
    """Check that `doors` has an entry for all drawn doors, and for no others."""
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
                yield Issue("BR314", ("doors", index), message, help_text)
                break
    walls = (("E", drawing.east), ("S", drawing.south))
    edges = [(*cell, side) for side, rows in walls for cell in d.cells_with(rows, d.DOOR)]
    missing = [edge for edge in edges if edge not in entered]
    for x, y, side in missing[:MAX_UNDRAWN]:
        yield Issue(
            "BR314",
            d.mark_of(level.map or "", x, y, side),
            "`doors` has no entry for this door",
            f"add `{{at: [{x}, {y}], side: {side}, needs: …}}` to `doors`",
        )


def _edges(door: Door) -> list[tuple[int, int, str]]:
    """Return the sides along which a door runs, each as the E or S side of a cell."""
    dx, dy, side = {"W": (-1, 0, "E"), "N": (0, -1, "S")}.get(door.side, (0, 0, door.side))
    return [(x + dx, y + dy, side) for x, y in sides_of(door)]


def _check_wall_entries(level: LevelFields, drawing: d.Drawing) -> Iterator[Issue]:
    """Check that `walls`, beside a drawing, only sets properties of drawn walls."""
    for index, wall in enumerate(level.walls):
        marks = {_mark(drawing, x, y, wall.side) for x, y in sides_of(wall)}
        route = ("walls", index)
        if marks & {d.OPEN, d.DOOR}:
            yield Issue(
                "BR314",
                route,
                "the map shows no wall there",
                "with a `map`, entries of `walls` set properties of walls that the map shows",
            )
        elif "pass_" in wall.model_fields_set and wall.pass_ > 0 and d.SOLID in marks:
            yield Issue(
                "BR314",
                (*route, "pass"),
                "the map shows a solid wall there, not glass",
                "draw it as `- -` or `:`",
            )
        elif "pass_" in wall.model_fields_set and wall.pass_ == 0 and d.GLASS in marks:
            yield Issue(
                "BR314",
                (*route, "pass"),
                "the map shows glass there, so `pass` must be above 0",
                "draw it as `---` or `|`",
            )


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
