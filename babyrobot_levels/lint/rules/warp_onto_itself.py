"""A warp that leads surely back to where it stands.

Every move away from the cell ends on it again. This is proved from the compiled tables, so that
warps are followed that lead on to others, or to the start.

## Why it is bad

Whoever comes there is held for ever. If that is what is meant, the episode should end there, or
else it goes on until it is cut off.

## Example

```yaml
version: 1
size: [4, 4]
warps:
  - {at: [1, 2], to: [1, 2], when: leave}
```

## Instead

```yaml
version: 1
size: [4, 4]
areas:
  - {at: [1, 2], ends: true}
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR505", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such warp."""
    mdp = case.mdp
    for number, warp in enumerate(case.level.warps):
        state = case.state(warp.at)
        if warp.when != "leave" or mdp.over[state]:
            continue
        targets = mdp.next_state[state, 1:][mdp.probability[state, 1:] > 0]
        if (targets == state).all():
            x, y = warp.at
            yield Finding(
                ("warps", number),
                f"the warp on [{x}, {y}] leads back to [{x}, {y}] for ever",
                "let it lead elsewhere; a cell that ends the episode is an area with `ends: true`",
            )
