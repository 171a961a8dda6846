"""The rule about comments that suppress nothing. It runs last, because its code is the highest."""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.linter.rule import is_known, rule
from babyrobot_levels.linter.suppressions import Suppression
from babyrobot_levels.text.diagnostics import Edit, Fix, Severity
from babyrobot_levels.text.source import Position, Span


@rule("BR699", Severity.INFO, needs=Needs.LEVEL)
def unused_ignore(context: LintContext) -> Iterator[Finding]:
    """Comment that suppresses a rule without findings.

    ## What it does

    Checks for comments such as `# babyrobot: ignore[BR503] reason` that suppress nothing: because
    the rule finds nothing there, the comment is on the wrong line, or the rule does not exist.
    Rules that are not selected do not run, and comments for them are not reported.

    ## Why is this bad?

    An unused suppression hides the next problem on that line.

    ## Example

    ```yaml
    version: 1
    size: [4, 4]  # babyrobot: ignore[BR503] the pit is intended
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 4]
    ```

    ## Fix safety

    The fix removes the rule from the comment, and the comment with its last rule. It is safe: the
    level stays the same.
    """
    for suppression in context.suppressions:
        if not suppression.words:
            yield Finding(
                suppression.comment.span,
                "unused suppression: the comment names no rule",
                "name the rules: `# babyrobot: ignore[BR503] reason`",
            )
            continue
        unknown = [word for word in suppression.words if not is_known(word)]
        idle = [
            word
            for word in suppression.words
            if word not in suppression.used and word.lower() in context.active - {"br699"}
        ]
        useless = [word for word in suppression.words if word in {*unknown, *idle}]
        if useless:
            words = ", ".join(f"`{word}`" for word in useless)
            what = f"{words} finds nothing here" if idle else f"unknown rule {words}"
            yield Finding(
                suppression.comment.span,
                f"unused suppression: {what}",
                f"remove {words} from the comment",
                fix=Fix(f"remove {words}", (_without(suppression, useless, context),)),
            )


def _without(suppression: Suppression, useless: list[str], context: LintContext) -> Edit:
    comment = suppression.comment
    kept = [word for word in suppression.words if word not in useless]
    if kept:
        before, _, rest = comment.text.partition("[")
        return Edit(comment.span, f"{before}[{', '.join(kept)}]{rest.partition(']')[2]}")
    line = comment.span.start.line
    if comment.is_alone:
        return Edit(Span(Position(line, 1), Position(line + 1, 1)), "")
    before = context.source.line(line)[: comment.span.start.column - 1].rstrip()
    return Edit(Span(Position(line, len(before) + 1), comment.span.end), "")
