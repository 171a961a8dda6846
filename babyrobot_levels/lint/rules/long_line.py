"""A line of more than 88 characters.

Only lines with a list or a mapping in brackets are meant, which can be written over several
lines; a comment behind them does not count.

## Why it is bad

Such lines are cut or wrapped by editors and in reviews, and a change in one of them shows
as a change of everything on it.

## Example

```yaml
version: 1
puddles: [{at: [1, 0], size: small}, {at: [2, 0], size: large}, {at: [0, 1]}, {at: [1, 1]}]
```

## Instead

```yaml
version: 1
puddles:
  - {at: [1, 0], size: small}
  - {at: [2, 0], size: large}
  - {at: [0, 1]}
  - {at: [1, 1]}
```

## Fix

`babyrobot format` breaks such lines.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity
from babyrobot_levels.text.emitter import WIDTH
from babyrobot_levels.text.source import Position, Span

CODE, SEVERITY, NEEDS = "BR603", Severity.INFO, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such line."""
    for number, line in enumerate(case.source.lines, 1):
        if len(line) <= WIDTH or not ("{" in line or "[" in line):
            continue
        comments = (each for each in case.comments if each.span.start.line == number)
        ends = (comment.span.start.column - 1 for comment in comments)
        width = len(line[: next(ends, len(line))].rstrip())
        if width > WIDTH:
            yield Finding(
                (),
                f"the line has {width} characters, more than {WIDTH}",
                "`babyrobot format` writes it over several lines",
                span=Span(Position(number, WIDTH + 1), Position(number, width + 1)),
            )
