"""A comment that silences a rule which finds nothing there.

A comment `# babyrobot: ignore[BR503] why` tells the reader that something odd is meant to be so.
This rule finds those that silence nothing: the rule is content, the comment stands on the wrong
line, or there is no such rule. Rules that do not run, because they are not selected, are not
judged.

## Why it is bad

A silence that is of no use hides the next fault on that line.

## Example

```yaml
version: 1
size: [4, 4]  # babyrobot: ignore[BR503] a trap on purpose
```

## Instead

```yaml
version: 1
size: [4, 4]
```

## Fix

The word is taken out of the comment, and with the last word the comment. That is safe.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.registry import find
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.lint.silence import Silence
from babyrobot_levels.text.diagnostics import Edit, Fix, Severity
from babyrobot_levels.text.source import Position, Span

CODE, SEVERITY, NEEDS = "BR699", Severity.INFO, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield one finding for each comment that says too much; all other rules have run by now."""
    active = [rule for rule in case.rules if rule.check is not None and rule.code != CODE]
    for silence in case.silences:
        if not silence.words:
            yield Finding(
                (),
                "the comment silences nothing: it names no rule",
                "name the rules: `# babyrobot: ignore[BR503] why`",
                span=silence.comment.span,
            )
            continue
        unknown = [word for word in silence.words if find(word) is None]
        idle = [
            word
            for word in silence.words
            if word not in silence.used and any(rule.is_called(word) for rule in active)
        ]
        useless = [word for word in silence.words if word in {*unknown, *idle}]
        if useless:
            words = ", ".join(f"`{word}`" for word in useless)
            said = f"there is no rule {words}" if not idle else f"{words} finds nothing here"
            yield Finding(
                (),
                f"the comment silences nothing: {said}",
                "take it out of the comment",
                span=silence.comment.span,
                fix=Fix("take it out", (_without(silence, useless, case),)),
            )


def _without(silence: Silence, useless: list[str], case: Case) -> Edit:
    comment = silence.comment
    kept = [word for word in silence.words if word not in useless]
    if kept:
        before, _, rest = comment.text.partition("[")
        return Edit(comment.span, f"{before}[{', '.join(kept)}]{rest.partition(']')[2]}")
    line = comment.span.start.line
    if comment.is_alone:
        return Edit(Span(Position(line, 1), Position(line + 1, 1)), "")
    before = case.source.line(line)[: comment.span.start.column - 1].rstrip()
    return Edit(Span(Position(line, len(before) + 1), comment.span.end), "")
