"""A property of an entry that says what would be so without it.

`length: 1`, `pass: 0` and `fit: false` of walls and openings, `size: [1, 1]` of areas and blocked
cells, `loops: 0` of a maze.

## Why it is bad

It is one more thing to read in every line of a list, and hides the entries that are different.

## Example

```yaml
version: 1
walls:
  - {at: [1, 1], side: N, length: 1}
```

## Instead

```yaml
version: 1
walls:
  - {at: [1, 1], side: N}
```

## Fix

The property is taken away. That is safe.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.edits import remove
from babyrobot_levels.lint.rule import Finding, Needs, Route
from babyrobot_levels.text.diagnostics import Fix, Severity

CODE, SEVERITY, NEEDS = "BR610", Severity.INFO, Needs.LEVEL

_USUAL: dict[str, dict[str, object]] = {
    "maze": {"loops": 0},
    "walls": {"length": 1, "pass": 0, "fit": False},
    "openings": {"length": 1},
    "areas": {"size": [1, 1]},
    "blocked": {"size": [1, 1]},
}


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each property that says what is so anyway."""
    for route, entry in _entries(case):
        for name, usual in _USUAL[str(route[0])].items():
            # `false == 0` in Python, and is another thing in a file.
            if name in entry and entry[name] == usual:
                place = (*route, name)
                shown = str(entry[name]).lower()
                yield Finding(
                    place,
                    f"`{name}: {shown}` says what is so anyway",
                    fix=Fix(f"take `{name}` away", (remove(case.document, place),)),
                )


def _entries(case: Case) -> Iterator[tuple[Route, dict[str, object]]]:
    for field in _USUAL:
        value = case.data.get(field)
        if isinstance(value, dict):
            yield (field,), value
        for number, entry in enumerate(value if isinstance(value, list) else []):
            yield (field, number), entry
