"""A level whose `max_steps` is below the shortest path.

From a start, even the shortest way to an exit takes more steps than an episode has. With luck all
chances are counted as if they came out well, so that this is certain.

## Why it is bad

No episode from there is ever won.

## Example

```yaml
version: 1
max_steps: 3
```

## Instead

```yaml
version: 1
max_steps: 20
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR511", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding where some start is too far from every exit."""
    limit = case.level.max_steps
    if limit is None:
        return
    steps, start = max((case.reach.to_exit[state], state) for state in case.starts)
    if steps > limit:
        x, y = case.cell(start)
        yield Finding(
            ("max_steps",),
            f"`max_steps` is {limit}, but the shortest way from [{x}, {y}] to an exit takes "
            f"{steps} steps",
            f"give it {steps} steps at the least, and some more for learning",
        )
