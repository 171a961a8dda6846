"""A `skid`, of the level or of an area, by which nobody ever skids.

Its probability is 0 where nothing else is slippery either; or other areas and puddles say something
else about all of its cells; or nobody moves away from these, because the episode is over there or a
warp takes the robot along.

## Why it is bad

Whoever tunes it wonders why nothing changes.

## Example

```yaml
version: 1
skid: 0
```

## Instead

```yaml
version: 1
skid: 0.1
```

## Fix

The `skid` is taken away. That is safe, but where an area's cells are warps that act on entering:
the tables tell what would happen to a robot on a cell where no robot ever stands.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.effects import Effect
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs, Route
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR522", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for the level's skid and for that of each area that does something else."""
    level = case.level
    if level.skid is not None and case.ground.skid is not Effect.WORKS:
        safe = case.ground.skid is not Effect.NOBODY
        yield _finding(case, ("skid",), "nobody ever skids by the level's `skid`", safe)
    for route, area in case.listed_areas():
        if area.works and area.is_idle("skid"):
            x, y = level.areas[area.number].at
            message = f"nobody ever skids by the `skid` of the area at [{x}, {y}]"
            yield _finding(case, (*route, "skid"), message, area.is_safe_without("skid"))


def _finding(case: Case, route: Route, message: str, safe: bool) -> Finding:
    return Finding(
        route,
        message,
        "take it away, or give it to cells on which it counts",
        key=True,
        fix=removal(case.document, "take the `skid` away", route, safe=safe),
    )
