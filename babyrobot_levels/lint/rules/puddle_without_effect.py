"""A puddle that changes nothing.

It lies on an exit, where the episode is over; or on a warp that acts on entering, where nobody
ever stands; or the cell would cost as much and be as slippery without it.

## Why it is bad

The picture shows water, and the robot does not get wet. Mostly the puddle was meant for another
cell, or `puddle_types` says less than was meant.

## Example

```yaml
version: 1
puddles:
  - {at: [2, 2]}
```

## Instead

```yaml
version: 1
puddles:
  - {at: [1, 2]}
```

## Fix

The puddle is taken away, from the picture too. That is safe for the game, but for a puddle on a
warp: the tables tell what would happen to a robot on a cell where no robot ever stands.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.effects import Effect
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.lint.wording import cells_text
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR508", Severity.WARNING, Needs.TABLES

_HELP = "take it away, or put it where somebody can step into it"


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such puddle; one for all that are drawn."""
    level = case.level
    if not level.puddles:
        return
    idle = case.ground.puddles
    if level.map is not None:
        if idle:
            cells = [level.puddles[number].at for number, *_ in idle]
            route, mark = case.place(case.state(cells[0]))
            what = f"the puddle on {cells_text(cells)} changes"
            if len(cells) > 1:
                what = f"the puddles on {cells_text(cells)} change"
            yield Finding(route, f"{what} nothing", _HELP, mark=mark)
        return
    for number, *effects in idle:
        x, y = level.puddles[number].at
        reason = "the cell costs as much and is as slippery without it"
        if (x, y) in level.exits:
            reason = "it is on an exit, where the episode is over"
        elif Effect.NOBODY in effects:
            reason = "it is on a warp, where nobody ever stands"
        yield Finding(
            ("puddles", number),
            f"the puddle on [{x}, {y}] changes nothing: {reason}",
            _HELP,
            fix=removal(
                case.document,
                "take the puddle away",
                ("puddles", number),
                safe=Effect.NOBODY not in effects,
            ),
        )
