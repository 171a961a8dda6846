"""The rule about what a level states of itself."""

from collections.abc import Iterator, Sequence

from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.text.diagnostics import Diagnostic, Key, Severity

BROKEN_EXPECTATION = "BR540"
"""The code of `broken_expectation`, to which `not_clean` belongs too."""


@rule(BROKEN_EXPECTATION, Severity.ERROR, needs=Needs.SIZE)
def broken_expectation(context: LintContext) -> Iterator[Finding]:
    """Fact in `expect` that is not true.

    ## What it does

    Checks whether each metric that [`expect`](../level-format.md#expectations) states is what it
    states, by the exact tables, and for `lint: clean`, whether there are other findings than notes.

    ## Why is this bad?

    The level is not, or not any more, what its author meant: a wall has been moved, and the key is
    not needed; a reward has changed, and the best policy avoids the exit.

    ## Example

    ```yaml
    version: 1
    size: [4, 1]
    expect:
      path_length: 2
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 1]
    expect:
      path_length: 3
    ```
    """
    if context.level.expect is None:
        return
    if context.too_large:
        yield Finding(Key(("expect",)), f"what is expected cannot be checked: {context.too_large}")
        return
    # Most levels state nothing.
    from babyrobot_levels.analysis.expectations import broken_in

    for broken in broken_in(context.metrics, context.document):
        yield Finding(
            ("expect", broken.name),
            broken.message,
            "change the level, or have `babyrobot expect` write what is true",
        )


def not_clean(context: LintContext, others: Sequence[Diagnostic]) -> Iterator[Finding]:
    """Yield a finding if a level states that it is clean, and there are findings of other rules."""
    expect = context.level.expect
    if expect is not None and "lint" in expect.stated and others:
        count, first = len(others), others[0]
        more = f" and {count - 1} more" if count > 1 else ""
        message = f"`lint` is not clean: {first.code} on line {first.line}{more}"
        yield Finding(("expect", "lint"), message)
