"""A start from which the first step already wins.

One of the actions leads to an exit, with certainty. Levels in which every free cell is a start are
not looked at: there, some start has to be next to the exit.

## Why it is bad

There is nothing to learn. Mostly start or exit is on the wrong cell, or a wall between them was
forgotten.

## Example

```yaml
version: 1
exit: [1, 0]
```

## Instead

```yaml
version: 1
exit: [2, 2]
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.lint.wording import cells_text
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR514", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield one finding for all such starts, at the first of them."""
    level, reach, mdp = case.level, case.reach, case.mdp
    near = [number for number, state in enumerate(case.starts) if reach.to_exit[state] == 1]
    if not near:
        return
    warps = {case.state(warp.at) for warp in level.warps if warp.when == "enter"}
    others = {state for state, over in enumerate(mdp.over.tolist()) if not over}
    if others - warps <= {*case.starts}:
        return
    exits = [case.state(cell) for cell in level.exits]
    won = [
        number
        for number in near
        if any(
            {next_state for _, next_state, *_ in mdp.outcomes(case.starts[number], action)}
            <= {*exits}
            for action in range(mdp.possible.shape[1])
        )
    ]
    if won:
        route, mark = case.place_of_end("start", won[0])
        starts = cells_text([level.starts[number] for number in won])
        yield Finding(
            route,
            f"from the start{'s' * (len(won) > 1)} {starts} the first step can win",
            "move the start or the exit, or put something between them",
            mark=mark,
        )
