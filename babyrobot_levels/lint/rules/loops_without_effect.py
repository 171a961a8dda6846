"""A maze whose `loops` open nothing.

`loops` is the share of the dead ends that are opened. Where that comes to less than half a dead
end, or where no dead end has a wall that could go, the maze is the same without.

## Why it is bad

The maze was meant to have several ways, and has one.

## Example

```yaml
version: 1
size: [5, 5]
maze: {seed: 2, loops: 0.01}
```

## Instead

```yaml
version: 1
size: [5, 5]
maze: {seed: 2, loops: 0.5}
```

## Fix

`loops` is taken away. That is safe: the maze is the same.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.mdp.grid import build_grid
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR526", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding where the maze would be the same without loops."""
    level, maze = case.level, case.level.maze
    if maze is None or not maze.loops:
        return
    grid = case.bare_grid
    # A maze without loops leads from cell to cell on one way only: it has more cells than ways.
    if int.from_bytes(grid.open_bits).bit_count() // 2 >= grid.blocked_cells.count(0):
        return
    plain = maze.model_copy(update={"loops": 0.0})
    bare = {"walls": (), "openings": (), "maze": plain}
    if build_grid(level.model_copy(update=bare)).wall_bits == grid.wall_bits:
        yield Finding(
            ("maze", "loops"),
            f"`loops: {maze.loops:g}` opens none of the maze's dead ends",
            "it is the share of the dead ends that are opened, and comes to none here",
            key=True,
            fix=removal(case.document, "take `loops` away", ("maze", "loops")),
        )
