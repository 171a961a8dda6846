"""A warp that never acts.

It acts on leaving, but the episode is over where it stands; or on entering, but no move of the
robot ever ends there.

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

The warp is taken away, from the picture too. That is safe where the tables stay as they are. It is
not where they tell what would happen to a robot on cells to which no robot ever comes.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.mdp.grid import BIT
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR518", Severity.WARNING, Needs.TABLES


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such warp."""
    level = case.level
    if not level.warps:
        return
    suspects = _suspects(case)
    if not suspects:
        return
    import numpy as np

    from babyrobot_levels.lint.variants import is_same_game, is_same_play, max_variants, variant

    stood = np.flatnonzero(np.frombuffer(case.reach.on, np.uint8))
    rest = level.warps
    for number in suspects[-max_variants(level) :][::-1]:
        without = (*rest[:number], *rest[number + 1 :])
        mdp, enters = variant(level, warps=without), level.warps[number].when == "enter"
        safe = is_same_game(level, mdp)
        if safe or (enters and is_same_play(case.mdp, mdp, stood)):
            rest = without if safe else rest
            x, y = level.warps[number].at
            yield Finding(
                ("warps", number),
                f"the warp on [{x}, {y}] never acts",
                "no move ends there" if enters else "the episode is over there",
                fix=removal(case.document, "take the warp away", ("warps", number), safe=safe),
            )


def _suspects(case: Case) -> list[int]:
    """Return the warps that do not surely act, by what can be seen at once."""
    level = case.level
    if level.wind is not None:
        return [*range(len(level.warps))]
    enters = any(warp.when == "enter" for warp in level.warps)
    left = {case.state(warp.at) for warp in level.warps if warp.when == "leave"}
    starts = {*level.starts}
    found = []
    for number, warp in enumerate(level.warps):
        state = case.state(warp.at)
        if warp.when == "leave":
            # Whoever moves without a warp gets to several cells, or stays where he is.
            home = warp.at in starts if isinstance(warp.to, str) else warp.at == warp.to
            acts = not (enters or home or case.mdp.over[state])
        else:
            acts = any(case.reach.on[other] and other not in left for other in _around(case, state))
        if not acts:
            found.append(number)
    return found


def _around(case: Case, state: int) -> Iterator[int]:
    """Yield the cells next to a cell, as far as nothing stands between them."""
    for side, bit in BIT.items():
        other = case.grid.neighbour(state, side)
        if other is not None and case.grid.open_bits[state] & bit:
            yield other
