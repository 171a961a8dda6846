"""A start from which no exit can be reached.

Whatever the robot does, and however lucky he is, none of the exits is on any of his ways. This is
proved from the compiled tables: walls, warps, wind and skidding are all taken into account. Levels
that say `exit: none` are not looked at.

## Why it is bad

The level cannot be won. Learning in it teaches nothing, and nothing else says so: the robot simply
never arrives.

## Example

```yaml
version: 1
walls:
  - {at: [1, 0], side: E, length: 3}
```

## Instead

```yaml
version: 1
walls:
  - {at: [1, 0], side: E}
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.lint.wording import cells_text
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR501", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield one finding for all starts that are shut in, at the first of them."""
    reach, level = case.reach, case.level
    shut = [n for n, state in enumerate(case.starts) if reach.to_exit[state] < 0]
    if not level.exits or not shut:
        return
    starts = cells_text([level.starts[number] for number in shut])
    route, mark = case.place_of_end("start", shut[0])
    message = f"no exit can be reached from the start{'s' * (len(shut) > 1)} {starts}"
    if level.max_steps is None and any(reach.to_end[case.starts[n]] < 0 for n in shut):
        message += ", and such episodes never end"
    help_text = "open a way, or move one of the two; a level without an exit says `exit: none`"
    yield Finding(route, message, help_text, mark=mark)
