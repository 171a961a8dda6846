"""A field that says nothing: an empty list, an empty mapping, or `null`.

## Why it is bad

Nothing would be different without it. Often it is what is left of something that
was taken away, or that was still to come.

## Example

```yaml
version: 1
walls: []
```

## Instead

```yaml
version: 1
```

## Fix

The field is taken away. That is safe.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.edits import remove
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Fix, Severity

CODE, SEVERITY, NEEDS = "BR609", Severity.INFO, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each empty field at the top."""
    for name, value in case.data.items():
        if value is None or value == [] or value == {}:
            shown = {"[]": "an empty list", "{}": "an empty mapping"}.get(str(value), "null")
            yield Finding(
                (name,),
                f"`{name}` is {shown}, and says nothing",
                key=True,
                fix=Fix(f"take `{name}` away", (remove(case.document, (name,)),)),
            )
