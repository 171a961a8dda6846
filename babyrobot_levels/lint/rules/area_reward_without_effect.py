"""The `reward` of an area that no step ever gives.

The area does something else, it is coloured perhaps; but later areas or puddles give another reward
on all of its cells, or these are exits, which give `rewards.exit`, or warps that act on entering:
whoever would come there stands elsewhere, and gets the reward of the warp or of where he is then.

## Why it is bad

The area looks costly, or like a prize, and is not. A cliff that sends the robot back to the start
takes its `reward` at the warp.

## Example

```yaml
version: 1
areas:
  - {at: [1, 2], color: black, reward: -100}
warps:
  - {at: [1, 2], to: start}
```

## Instead

```yaml
version: 1
areas:
  - {at: [1, 2], color: black}
warps:
  - {at: [1, 2], to: start, reward: -100}
```

## Fix

The `reward` is taken away. That is safe, but where the area's cells are warps: the tables tell what
would happen to a robot on a cell where no robot ever stands.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR524", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such reward."""
    for route, area in case.listed_areas():
        if area.works and area.is_idle("reward"):
            x, y = case.level.areas[area.number].at
            yield Finding(
                (*route, "reward"),
                f"no step ever gives the `reward` of the area at [{x}, {y}]",
                "give it to cells on which it counts; a warp has a `reward` of its own, an exit "
                "that of `rewards: {exit: ...}`",
                key=True,
                fix=removal(
                    case.document,
                    "take the `reward` away",
                    (*route, "reward"),
                    safe=area.is_safe_without("reward"),
                ),
            )
