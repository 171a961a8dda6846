"""An entry of `walls` that changes nothing, because its walls stand there already.

The maze has put them up, an entry above says the same, it is the outer wall, or all of it stands
between blocked cells. Entries that give a wall of their own a colour, a width or `fit` change the
picture and are not found, and neither are walls that an opening takes away, which have a rule of
their own. Beside a drawing, an entry is found that says nothing of the walls that are drawn.

## Why it is bad

The line looks as if it did something. Mostly it was meant for another cell or another side.

## Example

```yaml
version: 1
walls:
  - {at: [0, 0], side: E}
  - {at: [1, 0], side: W}
```

## Instead

```yaml
version: 1
walls:
  - {at: [0, 0], side: E}
```

## Fix

The entry is taken away. That is safe: neither the game nor the picture changes.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.language.walls import sides_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.drawn import count_drawn
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR506", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such entry."""
    if "walls" not in case.data or _are_apart(case.level):
        return
    drawn = count_drawn(case.level, "walls")
    for number in case.barriers.idle_walls:
        wall = case.level.walls[number]
        (x, y), route = wall.at, ("walls", number - drawn)
        yield Finding(
            route,
            f"the wall on side {wall.side} of [{x}, {y}] changes nothing",
            "it stands there already, or nobody ever meets it: take the entry away",
            fix=removal(case.document, "take the wall away", route),
        )


def _are_apart(level: Level) -> bool:
    """Tell whether it is plain to see that all walls matter: inside, apart, and nothing else."""
    if level.maze is not None or level.map is not None or level.openings or level.blocked:
        return False
    width, height = level.size
    sides: set[tuple[bool, int, int]] = set()
    count = 0
    for wall in level.walls:
        runs_down = wall.side in ("E", "W")
        for x, y in sides_of(wall):
            across = x + (wall.side == "E") if runs_down else y + (wall.side == "S")
            if not 0 < across < (width if runs_down else height):
                return False
            sides.add((runs_down, across, y if runs_down else x))
            count += 1
    return len(sides) == count
