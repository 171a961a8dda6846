"""A drawn wall of glass of which nothing says how often it lets the robot through.

`- -` and `:` in a drawing are walls of glass. An entry of `walls` beside the drawing gives their
`pass`; without one it is 0.5.

## Why it is bad

How hard the level is depends on a number that nobody reads in its file.

## Example

```yaml
version: 1
map: |
  +---+---+---+
  | S :     E |
  +---+---+---+
```

## Instead

```yaml
version: 1
map: |
  +---+---+---+
  | S :     E |
  +---+---+---+
walls:
  - {at: [0, 0], side: E, pass: 0.5}
```

## Fix

An entry of `walls` with `pass: 0.5` is added for each such wall. That is safe: it says what is so
without it.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.language.checks import blocked_cells
from babyrobot_levels.language.map import GLASS_PASS
from babyrobot_levels.language.walls import Opening, Wall, sides_of
from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.drawn import count_drawn, side_mark
from babyrobot_levels.lint.fixes import append
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Fix, Severity

CODE, SEVERITY, NEEDS = "BR516", Severity.WARNING, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield one finding for all such walls, at the first of them."""
    level = case.level
    drawn = count_drawn(level, "walls")
    glass = [wall for wall in level.walls[:drawn] if wall.pass_ > 0]
    if not glass:
        return
    said = {
        side
        for entry in (*level.walls[drawn:], *level.openings)
        if not isinstance(entry, Wall) or "pass_" in entry.model_fields_set
        for side in _sides(entry)
    }
    blocked = blocked_cells(level)
    for side, x, y in {each for wall in glass for each in _sides(wall)}:
        # Beside a blocked cell, glass is as good as any wall.
        if blocked((x, y)) or blocked((x + (side == "E"), y + (side == "S"))):
            said.add((side, x, y))
    unsaid = [part for wall in glass for part in _parts(wall, said)]
    if unsaid:
        entries = [_entry(part) for part in unsaid]
        edit = append(case.document, "walls", entries, ("map", "legend", "maze"))
        yield Finding(
            ("map",),
            f"{_walls(len(unsaid))} no `pass`: {GLASS_PASS:g} is meant where nothing is said",
            f"say how often the robot gets through: `walls: [{entries[0]}]`",
            mark=side_mark(level, *unsaid[0].at, unsaid[0].side),
            fix=None if edit is None else Fix("add the walls with their `pass`", (edit,)),
        )


def _sides(entry: Opening) -> list[tuple[str, int, int]]:
    """Return the sides of cells where a wall or an opening stands, each as an S or an E side."""
    if entry.side in ("S", "E"):
        return [(entry.side, x, y) for x, y in sides_of(entry)]
    if entry.side == "N":
        return [("S", x, y - 1) for x, y in sides_of(entry)]
    return [("E", x - 1, y) for x, y in sides_of(entry)]


def _parts(wall: Wall, said: set[tuple[str, int, int]]) -> list[Opening]:
    """Return the wall if nothing was said of it, or those of its sides of which nothing was."""
    unsaid = [(side, x, y) for side, x, y in _sides(wall) if (side, x, y) not in said]
    if len(unsaid) == wall.length:
        return [wall]
    return [Opening.model_validate({"at": (x, y), "side": side}) for side, x, y in unsaid]


def _entry(wall: Opening) -> str:
    x, y = wall.at
    length = f"length: {wall.length}, " if wall.length > 1 else ""
    return f"{{at: [{x}, {y}], side: {wall.side}, {length}pass: {GLASS_PASS:g}}}"


def _walls(count: int) -> str:
    return "a wall of glass has" if count == 1 else f"{count} walls of glass have"
