"""Rules about rewards: those that no step gives, and ends that are worth more than an exit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.language.cells import RandomReward
from babyrobot_levels.language.things import hit_reward
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, cells_text
from babyrobot_levels.linter.fixes import removal, setting
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.text.diagnostics import Fix, Key, Location, Mark, Route

if TYPE_CHECKING:
    from babyrobot_levels.analysis.endings import Ending

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
    for name in sorted(context.level.rewards.model_fields_set - {"step"}):
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
    if name == "bounce" and not context.grid.glass:
        return False
    value = getattr(level.rewards, name)
    if not (context.grid.glass or level.boxes or isinstance(value, str)):
        # Without glass and boxes, no reward is added to another.
        if not (mdp.reward == value).any():
            return False
        if value not in _other_rewards(context, name):
            return True
    if _is_surely_given(context, name):
        return True
    from babyrobot_levels.linter.variants import gives

    return gives(level, name)


def _other_rewards(context: LintContext, name: str) -> set[float | None]:
    """Return all other rewards of the level, and 0, the reward of terminal states."""
    level = context.level
    return {
        0.0,
        *level.rewards.model_dump(exclude={name}).values(),
        *(level.puddle_types.small.reward, level.puddle_types.large.reward),
        *(value for area in level.areas for value in _values(area.reward)),
        *(warp.reward for warp in level.warps),
        *(item.reward for item in level.items),
        level.hit.reward,
    }


def _values(reward: float | RandomReward | None) -> tuple[float | None, ...]:
    return reward.values if isinstance(reward, RandomReward) else (reward,)


def _is_surely_given(context: LintContext, name: str) -> bool:
    """Return whether some move gives a reward, in levels where little else takes precedence.

    False means unknown.
    """
    level, successors = context.level, context.reach.successors
    if level.has_things:
        return False
    if name == "exit":
        # Only a warp takes precedence over the exit.
        cells = frozenset(level.exits)
        if any(not cells.isdisjoint(level.targets_of(warp)) for warp in level.warps):
            return False
        exits = {*map(context.state, cells)}
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


RISK_TAKEN = 0.2
"""How much less likely than possible an exit may be reached: a small risk saves time."""


@rule("BR537")
def exit_given_up(context: LintContext) -> Iterator[Finding]:
    """Exit that the optimal policy gives up for another end of the episode.

    ## What it does

    Checks for levels in which the optimal policy ends episodes in a cell with `ends: true` or by a
    hit, although another policy reaches an exit more often: from some start, the probabilities of
    reaching an exit differ by more than 0.2. Both are exact. So nothing is reported where an end
    cannot be avoided, as on slippery ice, or where a small risk saves time. Ends with a positive
    reward are goals of their own. Levels of more than 5,000 states are not solved.

    If the optimal policy never ends the episode, [`unbounded-return`](unbounded-return.md) says so.

    ## Why is this bad?

    Each step costs something, so an end that costs less than the way to the exit is the best that
    the robot can do. An agent that learns well walks into the guard or into the hole, and the
    better it learns, the less often it arrives.

    ## Example

    ```yaml
    version: 1
    size: [6, 3]
    areas:
      - {at: [1, 1], color: black, ends: true}
    ```

    Let the end cost more than the way. Use instead:

    ```yaml
    version: 1
    size: [6, 3]
    areas:
      - {at: [1, 1], color: black, ends: true, reward: -50}
    ```

    ## Fix safety

    The fix gives the end a reward that is worse than any way to the exit. It is unsafe: it changes
    what the level pays.
    """
    reach = context.reach
    if not context.level.has_goal or reach.to_end == reach.to_exit or context.solution is None:
        return
    from babyrobot_levels.analysis.endings import ending_of, exit_chances
    from babyrobot_levels.analysis.solver.results import EpisodeTooLongError
    from babyrobot_levels.render.words.phrases import percent

    try:
        starts, own, best = exit_chances(context.solution)
    except EpisodeTooLongError:
        return
    worst = int((best - own).argmax())
    if best[worst] - own[worst] <= RISK_TAKEN:
        return
    ending = ending_of(context.solution, int(starts[worst]))
    # What gives a reward is a goal of its own.
    if ending is None or ending.goes_on or ending.reward > 0:
        return
    whence = f"from {cells_text([context.cell(int(starts[worst]))])} " if own.size > 1 else ""
    place, level = _place_of(context, ending), context.level
    yield Finding(
        place,
        f"{whence}{ending.text}; another policy reaches one in {percent(float(best[worst]))}",
        "give this end a reward that is worse than any way to the exit, or the exit a higher one",
        fix=_dearer(context, place, hit_reward(level.rewards, level.size)),
    )


def _dearer(context: LintContext, place: Location, reward: float) -> Fix | None:
    """Return the fix that gives an end a reward; None if a drawing or an alias gives the end."""
    match place:
        case ("hit" | "movers", *_):
            route: Route = ("hit", "reward")
        case ("areas", int()):
            route = (*place, "reward")
        case _:
            return None
    return setting(context.document, route, int(reward) if reward.is_integer() else reward)


def _place_of(context: LintContext, ending: Ending) -> Location:
    """Return where the file has the cell or the hit by which episodes end."""
    if ending.cell is None:
        assert ending.mover is not None
        is_given = "hit" in context.data
        return ("hit",) if is_given else context.place_of_entry("movers", ending.mover)
    location = context.place(context.state(ending.cell))
    if isinstance(location, Mark):
        return location
    x, y = ending.cell
    for number, area in context.level.written("areas"):
        (left, top), (columns, rows) = area.at, area.size
        if area.ends and left <= x < left + columns and top <= y < top + rows:
            location = ("areas", number)
    return location
