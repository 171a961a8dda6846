"""A side that is not written as N, E, S or W.

The long names and small letters are read too, but one way of writing is enough.

## Why it is bad

A search for `side: N` does not find `side: north`.

## Example

```yaml
version: 1
walls:
  - {at: [1, 1], side: north}
```

## Instead

```yaml
version: 1
walls:
  - {at: [1, 1], side: N}
```

## Fix

The letter is written. That is safe.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.edits import replace
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Fix, Severity

CODE, SEVERITY, NEEDS = "BR608", Severity.INFO, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each side that has another spelling."""
    for field in ("walls", "openings"):
        for number, entry in enumerate(case.data.get(field) or []):
            side = entry["side"]
            letter = side[:1].upper()
            if side != letter:
                route = (field, number, "side")
                yield Finding(
                    route,
                    f"the side `{side}` is usually written `{letter}`",
                    fix=Fix(f"write `{letter}`", (replace(case.document, route, letter),)),
                )
