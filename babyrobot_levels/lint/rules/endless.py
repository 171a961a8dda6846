"""A level whose episodes nothing ends.

It has no exit, the robot can come to no cell that ends the episode, and there is no `max_steps`.

## Why it is bad

Programs that play until the episode is over never come back.

## Example

```yaml
version: 1
exit: none
```

## Instead

```yaml
version: 1
exit: none
max_steps: 100
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR521", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding where nothing ends. Exits out of reach have a rule of their own."""
    level = case.level
    if level.exits or level.max_steps is not None:
        return
    if all(case.reach.to_end[state] < 0 for state in case.starts):
        yield Finding(
            ("map",) if level.map is not None else ("exit",),
            "nothing ever ends an episode: there is no exit and no `max_steps`",
            "say after how many steps an episode is cut off, as in `max_steps: 100`",
            key=True,
        )
