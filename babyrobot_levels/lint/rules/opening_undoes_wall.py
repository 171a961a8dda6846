"""An opening that takes away a wall of the same file.

The wall is an entry of `walls`, or drawn, and the opening takes it away again, or a part of it.

## Why it is bad

One of the two says the opposite of the other. Mostly one of them has the wrong cell or side; and if
not, a wall with a gap is clearer as two walls.

## Example

```yaml
version: 1
walls:
  - {at: [0, 0], side: E}
openings:
  - {at: [1, 0], side: W}
```

## Instead

```yaml
version: 1
walls:
  - {at: [0, 1], side: E}
```

## Fix

Where nothing is left of the wall, its entry is taken away, and the opening too where there is
nothing else for it to take away. That is safe. There is no fix where a part of the wall is left.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.drawn import count_drawn
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR513", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each opening and wall of which that is true."""
    level = case.level
    if not level.openings or not level.walls:
        return
    drawn = count_drawn(level, "walls")
    for undoing in case.barriers.undoings:
        route, wall = ("openings", undoing.opening), ("walls", undoing.wall - drawn)
        if undoing.opening in case.barriers.idle_openings:
            continue
        fix = None
        if undoing.wall < drawn:
            what = "a wall that is drawn"
        else:
            line = case.document.span(wall).start.line
            what = f"the wall of line {line}" if undoing.wholly else f"a part of line {line}'s wall"
            if undoing.wholly:
                routes = [wall, route] if undoing.idle else [wall]
                fix = removal(case.document, "take what is undone away", *routes)
        yield Finding(
            route,
            f"the opening takes away {what}",
            "say only what is to be: a wall that is not there, or one with a gap as two walls",
            fix=fix,
        )
