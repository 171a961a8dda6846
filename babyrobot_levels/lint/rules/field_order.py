"""Fields that do not stand in the usual order.

The order is that of the reference: first what the level is called and who made it, then its size
or drawing, start and exit, then walls, cells, moves and rewards, at last how it looks.

## Why it is bad

Who reads many levels looks for a field where it always is, and a difference between two
files is easier to see where both follow one order.

## Example

```yaml
exit: [2, 0]
size: [3, 1]
version: 1
```

## Instead

```yaml
version: 1
size: [3, 1]
exit: [2, 0]
```

## Fix

`babyrobot format` puts fields in order, with their comments.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR604", Severity.INFO, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for the first field that stands too late."""
    order = {name: number for number, name in enumerate(type(case.level).model_fields)}
    last, behind = -1, ""
    for name in case.data:
        if order[name] < last:
            yield Finding(
                (name,),
                f"`{name}` comes before `{behind}`",
                "`babyrobot format` puts fields in order",
                key=True,
            )
            return
        last, behind = order[name], name
