"""A warp that never acts.

It acts on leaving, but the episode is over where it stands; or on entering, but no move ends
there.

## Why it is bad

The picture shows an arrow along which nobody is ever sent. Mostly the warp stands on the wrong
cell, or it acts on the wrong occasion.

## Example

```yaml
version: 1
areas:
  - {at: [1, 1], reward: -5, ends: true}
warps:
  - {at: [1, 1], to: start, when: leave}
```

## Instead

```yaml
version: 1
warps:
  - {at: [1, 1], to: start, when: enter, reward: -5}
```

## Fix

The warp is taken away, from the picture too. That is safe: the tables stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.diagnostics import Severity
from babyrobot_levels.grid import BIT
from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs

CODE, SEVERITY, NEEDS = "BR518", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such warp."""
    level = case.level
    suspects = [number for number in range(len(level.warps)) if not _surely_acts(case, number)]
    if not suspects:
        return
    from babyrobot_levels.lint.variants import is_same_game, max_variants, variant

    rest = level.warps
    for number in suspects[-max_variants(level) :][::-1]:
        without = (*rest[:number], *rest[number + 1 :])
        if is_same_game(level, variant(level, warps=without)):
            rest = without
            x, y = level.warps[number].at
            yield Finding(
                ("warps", number),
                f"the warp on [{x}, {y}] never acts",
                "nobody comes to stand there"
                if level.warps[number].when == "enter"
                else "the episode is over there, or its moves lead there anyway",
                fix=removal(case.document, "take the warp away", ("warps", number)),
            )


def _surely_acts(case: Case, number: int) -> bool:
    """Tell whether a warp acts, by what can be seen at once."""
    level, mdp, grid = case.level, case.mdp, case.grid
    warp = level.warps[number]
    state = case.state(warp.at)
    if level.wind is not None:
        return False
    if warp.when == "leave":
        # Whoever moves without a warp gets to several cells, or stays where he is.
        enters = any(other.when == "enter" for other in level.warps)
        goals = level.starts if isinstance(warp.to, str) else (warp.to,)
        return not mdp.over[state] and not enters and warp.at not in goals
    left = {other.at for other in level.warps if other.when == "leave"}
    for side in ("N", "E", "S", "W"):
        other = grid.neighbour(state, side)
        if (
            other is not None
            and grid.open_bits[state] & BIT[side]
            and not mdp.over[other]
            and case.cell(other) not in left
        ):
            return True
    return False
