"""A level whose `max_steps` lets even the best policy fail in most episodes.

Without the limit the best policy reaches an exit in at least half of its episodes, with the limit
in less than half. The chances are exact: the level is solved, and its best policy followed step by
step. Levels of more than 5,000 cells are not solved.

## Why it is bad

An agent that plays perfectly looks like one that has learned nothing.

## Example

```yaml
version: 1
size: [8, 1]
skid: 0.5
max_steps: 8
```

## Instead

```yaml
version: 1
size: [8, 1]
skid: 0.5
max_steps: 200
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR512", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding where the best policy hardly has time."""
    level, mdp, reach = case.level, case.mdp, case.reach
    if level.max_steps is None or not level.exits:
        return
    if any(not 0 <= reach.to_exit[state] <= level.max_steps for state in case.starts):
        return
    if mdp.probability.shape[2] == 1 and level.max_steps >= mdp.num_states:
        # Without chance, a policy that arrives at all comes to no cell twice.
        return
    from babyrobot_levels.lint.best import is_in_time, surely_in_time

    if surely_in_time(level, reach.to_exit):
        return
    best = case.best
    if best is None or not best.exit_probability >= 0.5:
        return
    if is_in_time(level, best, 0.5) is False:
        yield Finding(
            ("max_steps",),
            f"with {level.max_steps} steps even the best policy fails in more than half of its "
            "episodes",
            _help(best.expected_steps),
        )


def _help(steps: float) -> str:
    if steps > 1e9:
        return "give it more steps"
    return f"give it more steps: without a limit the best policy takes {steps:.0f} on average"
