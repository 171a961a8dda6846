"""The rule about the `rewards` of a level."""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.context import LintContext
from babyrobot_levels.lint.finding import Finding
from babyrobot_levels.lint.fixes import removal
from babyrobot_levels.lint.rule import rule
from babyrobot_levels.text.diagnostics import Key

_HELP = {
    "exit": "the level has no exit that a step can reach",
    "closer": "the level has no exit to move closer to",
    "farther": "the level has no exit to move away from",
    "bounce": "the level has no glass wall to bounce off",
    "bump": "no move is ever refused by a wall",
}


@rule("BR520")
def reward_without_effect(context: LintContext) -> Iterator[Finding]:
    """Entry of `rewards` that no step gives.

    ## What it does

    Checks for rewards that no outcome in the transition tables includes: `exit`, `closer` and
    `farther` in a level without exits, `bounce` in a level without glass walls, or `bump` where
    every move is possible.

    ## Why is this bad?

    Changing the value makes no difference.

    ## Example

    ```yaml
    version: 1
    rewards: {step: -1, bounce: -5}
    ```

    Use instead:

    ```yaml
    version: 1
    rewards: {step: -1, bump: -5}
    ```

    ## Fix safety

    The fix removes the reward. It is safe: the transition tables stay the same.
    """
    given = context.level.rewards.model_fields_set - {"step"}
    for name in sorted(given):
        if getattr(context.level.rewards, name) is not None and not _is_given(context, name):
            yield Finding(
                Key(("rewards", name)),
                f"the reward `{name}` is never given",
                _HELP.get(name),
                fix=removal(context.document, f"remove `{name}`", ("rewards", name)),
            )


def _is_given(context: LintContext, name: str) -> bool:
    """Return whether some outcome includes a reward; compile a variant only if necessary."""
    level, mdp = context.level, context.mdp
    if not context.grid.glass:
        # Without glass, no reward is added to another.
        value = getattr(level.rewards, name)
        if name == "bounce" or not (mdp.reward == value).any():
            return False
        if value not in _other_rewards(context, name):
            return True
    if _is_surely_given(context, name):
        return True
    from babyrobot_levels.lint.variants import gives

    return gives(level, name)


def _other_rewards(context: LintContext, name: str) -> set[float | None]:
    """Return all other rewards of the level, and 0, the reward of terminal states."""
    level = context.level
    puddles = [level.puddle_types.small.reward, level.puddle_types.large.reward]
    rewards = level.rewards.model_dump(exclude={name})
    return {
        0.0,
        *rewards.values(),
        *puddles,
        *(area.reward for area in level.areas),
        *(warp.reward for warp in level.warps),
        *(item.reward for item in level.items),
        level.hit.reward,
    }


def _is_surely_given(context: LintContext, name: str) -> bool:
    """Return whether some move gives a reward, in levels where little else takes precedence.

    False means unknown.
    """
    level, successors = context.level, context.reach.successors
    if level.has_things:
        return False
    if name == "exit":
        # Only a warp takes precedence over the exit.
        exits = {context.state(cell) for cell in level.exits}
        if any(warp.to in level.exits for warp in level.warps):
            return False
        return any(not exits.isdisjoint(others) for others in successors)
    if name in ("bump", "stay"):
        # Only a warp takes precedence where the robot stays on a cell that is no exit.
        from babyrobot_levels.mdp.tables import REFUSED

        is_possible = name == "stay" or bool((context.mdp.obstruction == REFUSED).any())
        return is_possible and not level.warps and not level.wind
    if name not in ("closer", "farther") or level.warps or level.wind or len(level.exits) != 1:
        return False
    # A transition to another state was not refused.
    (x, y), (width, height) = level.exits[0], level.size
    far = [(x - column) ** 2 + (y - row) ** 2 for row in range(height) for column in range(width)]
    sign = 1 if name == "closer" else -1
    return any(
        far[other] and sign * far[state] > sign * far[other]
        for state, others in enumerate(successors)
        for other in others
    )
