"""A level that does not say what it is about.

This rule is not on by itself: select it for levels that others are to use.

## Why it is bad

A gallery, a pack and `babyrobot show` print the description. Without it, people must play the
level to learn what it is for.

## Example

```yaml
version: 1
size: [4, 1]
```

## Instead

```yaml
version: 1
description: A corridor of four cells, to see that learning works at all.
size: [4, 1]
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR602", Severity.INFO, Needs.LEVEL
DEFAULT = False


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding if there is no description, or an empty one."""
    if not (case.level.description or "").strip():
        yield Finding((), "the level has no description", "say in a `description` what it is for")
