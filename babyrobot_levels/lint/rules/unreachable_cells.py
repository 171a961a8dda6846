"""Free cells on which the robot can never stand.

No way leads there from any start, whatever the robot does, with any luck. This is proved from the
compiled tables. Cells of a warp that acts on entering are not counted, because nobody ever stands
there; nor are those to which only the wind bars the way. Exits have a rule of their own.

## Why it is bad

What stands on such cells is never met, and values and policies are shown for cells that do not
matter. Often a wall is one too long, an opening was forgotten, or an exit stands in the only way
there, so that a part of the maze lies behind it.

## Example

```yaml
version: 1
size: [4, 3]
walls:
  - {at: [0, 2], side: N}
  - {at: [0, 2], side: E}
```

## Instead

Open a way, or say that the cell does not exist:

```yaml
version: 1
size: [4, 3]
blocked:
  - {at: [0, 2]}
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.lint.wording import cells_count
from babyrobot_levels.mdp.grid import BIT
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR502", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield one finding for all such cells, at the first of them."""
    level, blocked = case.level, case.grid.blocked_cells
    missed = [
        state for state, steps in enumerate(case.reach.steps) if steps < 0 and not blocked[state]
    ]
    if not missed:
        return
    warps = {case.state(warp.at) for warp in level.warps if warp.when == "enter"}
    others = warps | {case.state(cell) for cell in level.exits}
    missed = [state for state in missed if state not in others]
    if missed and level.wind is not None:
        from babyrobot_levels.lint.variants import variant
        from babyrobot_levels.mdp.reachability import reach_of

        calm = reach_of(level, variant(level, wind=None))
        missed = [state for state in missed if not calm.reached(state)]
    if missed:
        route, mark = case.place(missed[0])
        yield Finding(
            route,
            f"the robot can never come to {cells_count([case.cell(state) for state in missed])}",
            _help(case, missed),
            mark=mark,
        )


def _help(case: Case, missed: list[int]) -> str:
    """Return what to do; where the way there leads over the end of the episode, that."""
    for state in missed:
        for side, bit in BIT.items():
            other = case.grid.neighbour(state, side) if case.grid.open_bits[state] & bit else None
            if other is not None and case.mdp.over[other] and case.reach.reached(other):
                x, y = case.cell(other)
                return f"the episode ends on [{x}, {y}], which stands in the way there"
    return "open a way there, or list what is not part of the level under `blocked`"
