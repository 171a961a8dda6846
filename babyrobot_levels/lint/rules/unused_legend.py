"""A character of the legend that the drawing does not show.

## Why it is bad

Mostly the drawing has another character where this one was meant.

## Example

```yaml
version: 1
map: |
  +---+---+---+
  | S       E |
  +---+---+---+
legend:
  x: {reward: -5}
```

## Instead

```yaml
version: 1
map: |
  +---+---+---+
  | S   x   E |
  +---+---+---+
legend:
  x: {reward: -5}
```

## Fix

The character is taken out of the legend. That is safe.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR523", Severity.WARNING, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such character."""
    level = case.level
    if not level.legend or level.map is None:
        return
    # Corners, walls and blanks cannot be in a legend.
    shown = {*level.map}
    for character in level.legend:
        if character not in shown:
            yield Finding(
                ("legend", character),
                f"the drawing does not show `{character}`",
                "draw it, or take it out of the legend",
                key=True,
                fix=removal(case.document, f"take `{character}` out", ("legend", character)),
            )
