"""An opening that takes nothing away.

There is no wall at any of its sides, or other openings take away all that there is.

## Why it is bad

The line looks as if it opened a way. Mostly it was meant for another cell or another side.

## Example

```yaml
version: 1
openings:
  - {at: [1, 1], side: E}
```

## Instead

```yaml
version: 1
```

## Fix

The entry is taken away. That is safe: neither the game nor the picture changes.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR507", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such entry."""
    if not case.level.openings:
        return
    for number in case.barriers.idle_openings:
        opening = case.level.openings[number]
        (x, y), route = opening.at, ("openings", number)
        yield Finding(
            route,
            f"the opening on side {opening.side} of [{x}, {y}] takes nothing away",
            "there is no wall, or another opening takes it away: take the entry away",
            fix=removal(case.document, "take the opening away", route),
        )
