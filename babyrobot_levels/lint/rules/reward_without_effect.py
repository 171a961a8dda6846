"""A reward that nothing in the level ever gives.

`exit` or `closer` and `farther` in a level without exits, `bounce` in one without walls of glass,
`bump` where no wall can refuse a move. It is proved from the compiled tables that no outcome has
the reward.

## Why it is bad

Whoever tunes it wonders why nothing changes.

## Example

```yaml
version: 1
rewards: {step: -1, bounce: -5}
```

## Instead

```yaml
version: 1
rewards: {step: -1, bump: -5}
```

## Fix

The reward is taken away. That is safe: the tables stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR520", Severity.WARNING, Needs.TABLES

_HELP = {
    "exit": "the level has no exit to which a step could lead",
    "closer": "the level has no exit to come closer to",
    "farther": "the level has no exit to get away from",
    "bounce": "the level has no wall of glass to bounce off",
    "bump": "no wall ever refuses a move",
}


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each such reward."""
    given = case.level.rewards.model_fields_set - {"step"}
    for name in sorted(given):
        if getattr(case.level.rewards, name) is not None and not _is_given(case, name):
            yield Finding(
                ("rewards", name),
                f"no step ever gives the reward `{name}`",
                _HELP.get(name),
                key=True,
                fix=removal(case.document, f"take `{name}` away", ("rewards", name)),
            )


def _is_given(case: Case, name: str) -> bool:
    """Tell whether some outcome has a reward: by what can be seen at once, else by proof."""
    level, mdp = case.level, case.mdp
    if not case.grid.glass:
        # Then no reward is added to another.
        value = getattr(level.rewards, name)
        if name == "bounce" or not (mdp.reward == value).any():
            return False
        if value not in _other_rewards(case, name):
            return True
    if _is_surely_given(case, name):
        return True
    from babyrobot_levels.lint.variants import gives

    return gives(level, name)


def _other_rewards(case: Case, name: str) -> set[float | None]:
    """Return all rewards that may be given, but for one, and that of where all is over."""
    level = case.level
    puddles = [level.puddle_types.small.reward, level.puddle_types.large.reward]
    rewards = level.rewards.model_dump(exclude={name})
    return {
        0.0,
        *rewards.values(),
        *puddles,
        *(area.reward for area in level.areas),
        *(warp.reward for warp in level.warps),
    }


def _is_surely_given(case: Case, name: str) -> bool:
    """Tell whether some move gives a reward, in levels where little else could have a say."""
    level, ahead = case.level, case.reach.successors
    if name == "exit":
        # Only a warp has a say before the exit.
        exits = {case.state(cell) for cell in level.exits}
        if any(warp.to in level.exits for warp in level.warps):
            return False
        return any(not exits.isdisjoint(others) for others in ahead)
    if name in ("bump", "stay"):
        # Only a warp has a say before them where the robot stays on a cell that is no exit.
        from babyrobot_levels.mdp.tables import REFUSED

        can_be = name == "stay" or bool((case.mdp.hindered == REFUSED).any())
        return can_be and not level.warps and not level.wind
    if name not in ("closer", "farther") or level.warps or level.wind or len(level.exits) != 1:
        return False
    # Whoever gets elsewhere was not refused.
    (x, y), (width, height) = level.exits[0], level.size
    far = [(x - column) ** 2 + (y - row) ** 2 for row in range(height) for column in range(width)]
    sign = 1 if name == "closer" else -1
    return any(
        far[other] and sign * far[state] > sign * far[other]
        for state, others in enumerate(ahead)
        for other in others
    )
