"""A level in which it is best never to leave.

An exit, or a cell that ends the episode, can be reached; but the best policy goes on for ever,
because some loop gives more than ending does. The level is solved exactly to find out. Levels of
more than 5,000 cells are not solved, and neither are those in which rewards and costs cancel out.

## Why it is bad

An agent that learns well never arrives, and the better it learns the longer its episodes last.
Mostly a reward is positive that was meant to be a cost, or can be collected again and again.

## Example

```yaml
version: 1
areas:
  - {at: [1, 1], color: gold, reward: 5}
```

## Instead

Let what pays end the episode, or let each step cost something:

```yaml
version: 1
areas:
  - {at: [1, 1], color: gold, reward: 5, ends: true}
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs, Route
from babyrobot_levels.lint.wording import cells_text
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR504", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield one finding where the best policy never leaves."""
    from babyrobot_levels.lint.best import lingering, surely_leaves

    level, reach = case.level, case.reach
    if not any(reach.to_end[state] >= 0 for state in case.starts):
        return
    if surely_leaves(case.mdp, level.discount) or case.best is None:
        return
    states = lingering(case.mdp, reach, case.best)
    if states:
        cells = [case.cell(state) for state in states]
        route, mark = case.place(states[0])
        prize = _prize(case, {*cells})
        if prize is not None or (mark is None and "rewards" in case.data):
            route, mark = prize or ("rewards",), None
        yield Finding(
            route,
            f"the best policy never leaves: going on for ever on {cells_text(cells)} is worth more",
            "let a step cost something, let the end give more, or let what pays end the episode",
            mark=mark,
        )


def _prize(case: Case, cells: set[tuple[int, int]]) -> Route | None:
    """Return the area or the warp that pays on one of the cells."""
    for number, area in case.level.written("areas"):
        (x, y), (columns, rows) = area.at, area.size
        covered = any(x <= a < x + columns and y <= b < y + rows for a, b in cells)
        if (area.reward or 0) > 0 and covered:
            return ("areas", number)
    for number, warp in enumerate(case.level.warps):
        if (warp.reward or 0) > 0 and (warp.at in cells or warp.to in cells):
            return ("warps", number)
    return None
