"""An entry of `blocked` whose cells others block already.

## Why it is bad

The line looks as if it did something. Mostly it was meant for other cells.

## Example

```yaml
version: 1
size: [5, 5]
blocked:
  - {at: [1, 1], size: [2, 2]}
  - {at: [2, 2]}
```

## Instead

```yaml
version: 1
size: [5, 5]
blocked:
  - {at: [1, 1], size: [2, 2]}
```

## Fix

The entry is taken away. That is safe.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR527", Severity.WARNING, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such entry. Of two that say the same, it is the later one."""
    blocked = case.level.blocked
    if len(blocked) < 2 or "blocked" not in case.data:
        return
    import numpy as np

    width, height = case.level.size
    times = np.zeros((height, width), np.int32)
    places = []
    for (x, y), (columns, rows) in ((each.at, each.size) for each in blocked):
        places.append((slice(y, y + rows), slice(x, x + columns)))
        times[places[-1]] += 1
    for number, place in reversed([*enumerate(places)]):
        if (times[place] > 1).all():
            times[place] -= 1
            x, y = blocked[number].at
            yield Finding(
                ("blocked", number),
                f"the cells blocked at [{x}, {y}] are blocked already",
                "take the entry away",
                fix=removal(case.document, "take the entry away", ("blocked", number)),
            )
