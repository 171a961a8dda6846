"""A cell from which no exit can be reached any more.

The robot can come to the cell, the episode is not over there, and whatever it does from then on
it never comes to an exit. This is proved from the compiled tables: walls, warps, wind and
skidding are all taken into account.

## Why it is bad

An episode that runs into a trap can only be cut off. Agents learn nothing from it but to wait,
and its return depends on a limit of steps that the level may not even have.

## Example

```yaml
version: 1
size: [3, 1]
start: [1, 0]
warps:
  - {at: [0, 0], to: [0, 0], when: leave}
```

## Instead

Leave a way out, or let the episode end there:

```yaml
version: 1
size: [3, 1]
start: [1, 0]
areas:
  - {at: [0, 0], ends: true}
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.lint.wording import cells_count
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR503", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield one finding for all traps, at the first of them."""
    reach = case.reach
    # Where no exit can be reached from a start, another rule says so.
    good = [state for state in case.starts if reach.to_exit[state] >= 0]
    if not good or all(steps >= 0 for state, steps in enumerate(reach.to_exit) if reach.on[state]):
        return
    steps = reach.from_some(good)
    traps = [
        state
        for state, on in enumerate(reach.on)
        if on and steps[state] >= 0 > reach.to_exit[state]
    ]
    if traps:
        cells = cells_count([case.cell(state) for state in traps])
        route, mark = case.place(traps[0])
        yield Finding(
            route,
            f"{cells} can be reached, but no exit from there",
            "leave a way out, or let the episode end there with `ends: true`",
            mark=mark,
        )
