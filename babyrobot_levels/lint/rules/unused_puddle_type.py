"""A size of puddle that `puddle_types` changes, and of which the level has no puddle.

## Why it is bad

Mostly the puddles are of the other size, and as deep as ever.

## Example

```yaml
version: 1
puddles:
  - {at: [1, 1]}
puddle_types:
  large: {reward: -10}
```

## Instead

```yaml
version: 1
puddles:
  - {at: [1, 1], size: large}
puddle_types:
  large: {reward: -10}
```

## Fix

The size is taken out of `puddle_types`. That is safe.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR525", Severity.WARNING, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such size."""
    level = case.level
    sizes = {puddle.size for puddle in level.puddles}
    for size in case.data.get("puddle_types", ()):
        if size not in sizes:
            yield Finding(
                ("puddle_types", size),
                f"the level has no {size} puddle",
                "take the size away, or lay such a puddle",
                key=True,
                fix=removal(case.document, f"take `{size}` away", ("puddle_types", size)),
            )
