"""A wind that moves nobody.

All of its strengths are 0, or cancel each other out, or walls stand wherever it blows.

## Why it is bad

The field looks as if it did something. Mostly the strengths stand at the wrong columns or rows.

## Example

```yaml
version: 1
wind: {north: [0, 0, 0]}
```

## Instead

```yaml
version: 1
wind: {north: [0, 1, 0]}
```

## Fix

The field is taken away, or that direction of it which is all 0. That is safe: the tables stay as
they are.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR519", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for the whole wind, or for each direction of it that is all 0."""
    level, wind = case.level, case.level.wind
    if wind is None:
        return
    from babyrobot_levels.lint.variants import is_same_game, variant

    if is_same_game(level, variant(level, wind=None)):
        yield Finding(
            ("wind",),
            "the wind moves nobody",
            "take it away, or let it blow where the robot can go",
            key=True,
            fix=removal(case.document, "take the wind away", ("wind",)),
        )
        return
    for side in sorted(wind.model_fields_set):
        if not any(getattr(wind, side) or ()):
            yield Finding(
                ("wind", side),
                f"nothing blows to the {side}",
                "take the direction away",
                key=True,
                fix=removal(case.document, f"take `{side}` away", ("wind", side)),
            )
