"""Cells side by side that could be one rectangle.

Entries of `blocked` or `areas` that follow each other in the file, fill a rectangle, and say
the same but for the place.

## Why it is bad

A list of cells hides its shape. `size` says it.

## Example

```yaml
version: 1
size: [4, 4]
blocked:
  - {at: [1, 1]}
  - {at: [2, 1]}
```

## Instead

```yaml
version: 1
size: [4, 4]
blocked:
  - {at: [1, 1], size: [2, 1]}
```

## Fix

The first entry gets the size, the others go. That is safe: the cells are the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from babyrobot_levels.language.cells import Rectangle
from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.edits import merge
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Fix, Severity

CODE, SEVERITY, NEEDS = "BR606", Severity.INFO, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each sequence of entries that fills a rectangle."""
    for field in ("blocked", "areas"):
        if field not in case.data:
            continue
        entries: list[Rectangle] = [entry for _, entry in case.level.written(field)]
        first = 0
        while first < len(entries):
            last, whole = _longest(entries, first)
            if last > first:
                yield _finding(case, field, first, last - first + 1, whole)
            first = last + 1


Box = tuple[int, int, int, int]
"""Left, top, right, bottom; the last two exclusive."""


def _longest(entries: list[Rectangle], first: int) -> tuple[int, Box]:
    """Return the last of the most entries from `first` on that fill a rectangle, and this."""
    last, whole = first, _box(entries[first])
    box, covered = whole, _size(whole)
    rest = _rest(entries[first])
    for number in range(first + 1, len(entries)):
        other = _box(entries[number])
        if _rest(entries[number]) != rest:
            break
        box = (*map(min, box[:2], other[:2]), *map(max, box[2:], other[2:]))  # type: ignore[assignment]
        covered += _size(other)
        if covered > _size(box):
            break
        if covered == _size(box) and _apart(entries[first : number + 1]):
            last, whole = number, box
    return last, whole


def _box(entry: Rectangle) -> Box:
    (x, y), (width, height) = entry.at, entry.size
    return x, y, x + width, y + height


def _size(box: Box) -> int:
    return (box[2] - box[0]) * (box[3] - box[1])


def _rest(entry: Rectangle) -> dict[str, object]:
    return entry.model_dump(exclude={"at", "size"})


def _apart(entries: list[Rectangle]) -> bool:
    """Tell whether no two entries share a cell; else they would not fill what they count."""
    seen: set[tuple[int, int]] = set()
    for left, top, right, bottom in map(_box, entries):
        for cell in product(range(left, right), range(top, bottom)):
            if cell in seen:
                return False
            seen.add(cell)
    return True


def _finding(case: Case, field: str, first: int, count: int, box: Box) -> Finding:
    size = [box[2] - box[0], box[3] - box[1]]
    return Finding(
        (field, first),
        f"these {count} entries fill one rectangle, {size[0]} wide and {size[1]} high",
        f"write one entry with `size: {size}`",
        fix=_fix(case, field, first, count, box),
    )


def _fix(case: Case, field: str, first: int, count: int, box: Box) -> Fix | None:
    size = [box[2] - box[0], box[3] - box[1]]
    merged = {**case.data[field][first], "at": [box[0], box[1]], "size": size}
    if "label" in merged:
        # A label is written on each of them.
        return None
    return merge(case.document, field, first, count, merged)
