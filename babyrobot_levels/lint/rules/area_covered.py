"""An area that is wholly covered by later areas or by puddles.

Later areas win over earlier ones, property by property, and puddles win over areas. Of this area
nothing is left: neither the game nor the picture shows any of its properties.

## Why it is bad

Mostly the order is wrong: what is special stands above what is general, and is painted over.

## Example

```yaml
version: 1
size: [4, 4]
areas:
  - {at: [1, 1], reward: -5}
  - {at: [0, 0], size: [3, 3], reward: -2}
```

## Instead

```yaml
version: 1
size: [4, 4]
areas:
  - {at: [0, 0], size: [3, 3], reward: -2}
  - {at: [1, 1], reward: -5}
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

CODE, SEVERITY, NEEDS = "BR510", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such area."""
    for route, area in case.listed_areas():
        if not area.works and area.is_covered:
            x, y = case.level.areas[area.number].at
            yield Finding(
                route,
                f"nothing is left of the area at [{x}, {y}]: others that win cover it",
                "later areas win over earlier ones, and puddles over areas: move it down, or "
                "take it away",
                fix=removal(case.document, "take the area away", route),
            )
