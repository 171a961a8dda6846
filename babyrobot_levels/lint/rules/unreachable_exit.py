"""An exit that cannot be reached, while another one can.

No way leads there from any start, whatever the robot does, with any luck. This is proved from the
compiled tables.

## Why it is bad

The exit is shown and never counts. What makes the level interesting, a choice between exits, is
not there.

## Example

```yaml
version: 1
size: [4, 3]
start: [1, 0]
exit: [[0, 2], [3, 2]]
walls:
  - {at: [0, 2], side: N}
  - {at: [0, 2], side: E}
```

## Instead

```yaml
version: 1
size: [4, 3]
start: [1, 0]
exit: [[0, 2], [3, 2]]
walls:
  - {at: [0, 2], side: N}
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.lint.wording import cells_text
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR517", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield one finding for all such exits, at the first of them."""
    exits = case.level.exits
    if len(exits) < 2:
        return
    missed = [n for n, cell in enumerate(exits) if not case.reach.reached(case.state(cell))]
    if missed and len(missed) < len(exits):
        route, mark = case.place_of_end("exit", missed[0])
        cells = cells_text([exits[number] for number in missed])
        yield Finding(
            route,
            f"the exit{'s' * (len(missed) > 1)} {cells} cannot be reached from any start",
            "open a way there, or take the exit away",
            mark=mark,
        )
