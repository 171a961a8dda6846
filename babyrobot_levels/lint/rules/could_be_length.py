"""Walls or openings in a row that could be one with a `length`.

Entries that follow each other in the file, stand side by side, and say the same but for the place.

## Why it is bad

Three entries hide that they are one wall. With a `length` the wall can be moved, coloured or taken
away as one.

## Example

```yaml
version: 1
walls:
  - {at: [0, 0], side: S}
  - {at: [1, 0], side: S}
```

## Instead

```yaml
version: 1
walls:
  - {at: [0, 0], side: S, length: 2}
```

## Fix

The first entry gets the length, the others go. That is safe: the walls are the same.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.language.walls import Opening
from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.edits import merge
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Fix, Severity

CODE, SEVERITY, NEEDS = "BR605", Severity.INFO, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each row of entries."""
    for field in ("walls", "openings"):
        if field not in case.data:
            continue
        entries: list[Opening] = [entry for _, entry in case.level.written(field)]
        first = 0
        while first < len(entries):
            last = first
            while last + 1 < len(entries) and _goes_on(entries[last], entries[last + 1]):
                last += 1
            if last > first:
                yield _finding(case, field, first, entries[first : last + 1])
            first = last + 1


def _goes_on(entry: Opening, following: Opening) -> bool:
    x, y = entry.at
    end = (x + entry.length, y) if entry.side in ("N", "S") else (x, y + entry.length)
    return following.at == end and _rest(entry) == _rest(following)


def _rest(entry: Opening) -> dict[str, object]:
    return entry.model_dump(exclude={"at", "length"})


def _finding(case: Case, field: str, first: int, entries: list[Opening]) -> Finding:
    length, what = sum(entry.length for entry in entries), field.removesuffix("s")
    return Finding(
        (field, first),
        f"these {len(entries)} {field} are one {what} of length {length}",
        f"write one {what} with `length: {length}`",
        fix=_fix(case, field, first, len(entries), length),
    )


def _fix(case: Case, field: str, first: int, count: int, length: int) -> Fix | None:
    merged = {**case.data[field][first], "length": length}
    return merge(case.document, field, first, count, merged)
