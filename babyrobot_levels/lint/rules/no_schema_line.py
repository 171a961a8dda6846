"""A level file that does not begin with the line by which editors find its schema.

This rule is not on by itself: select it for files that are written by hand.

## Why it is bad

With `# yaml-language-server: $schema=…` as the first line, editors complete field names, show
what they mean, and underline mistakes as you type. `babyrobot new-level` writes it.

## Example

```yaml
version: 1
```

## Instead

```yaml
# yaml-language-server: $schema=../schemas/level.schema.json
version: 1
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR612", Severity.INFO, Needs.LEVEL
DEFAULT = False


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding if no comment above the first field names a schema."""
    first = case.document.root.span.start.line
    above = (comment for comment in case.comments if comment.span.start.line < first)
    if not any("yaml-language-server:" in comment.text for comment in above):
        yield Finding(
            (),
            "the file does not begin with the line by which editors find its schema",
            "begin with `# yaml-language-server: $schema=…`; `babyrobot new-level` shows how",
        )
