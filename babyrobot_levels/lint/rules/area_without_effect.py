"""An area that changes neither the game nor the picture.

It gives no property at all, or only what its cells have anyway; or all of its cells are blocked,
exits, or warps that act on entering, where its properties never come into play.

## Why it is bad

The entry looks as if it did something. Mostly a property was forgotten, or the rectangle is in the
wrong place.

## Example

```yaml
version: 1
areas:
  - {at: [0, 1], size: [2, 1]}
```

## Instead

```yaml
version: 1
areas:
  - {at: [0, 1], size: [2, 1], reward: -3}
```

## Fix

The entry is taken away. That is safe, but where it lies on a warp that acts on entering: the
tables tell what would happen to a robot on a cell where no robot ever stands.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR509", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such area."""
    for route, area in case.listed_areas():
        if area.works or area.is_covered:
            continue
        (x, y) = case.level.areas[area.number].at
        what = "it gives its cells nothing that they do not have without it"
        if not area.game and area.colored is None:
            what = "it gives its cells no property"
        yield Finding(
            route,
            f"the area at [{x}, {y}] changes nothing: {what}",
            "give it a property, put it elsewhere, or take it away",
            fix=removal(case.document, "take the area away", route, safe=area.is_safe),
        )
