"""Rules about the length of episodes: limits of steps, trivial starts, and no end at all."""

from collections.abc import Iterator

from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs, cells_text
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.text.diagnostics import Key, Severity


@rule("BR511")
def max_steps_below_shortest_path(context: LintContext) -> Iterator[Finding]:
    """`max_steps` below the length of the shortest path.

    ## What it does

    Checks for starts from which the shortest path to an exit has more steps than `max_steps`
    allows. The length is the minimum over all random outcomes, so the finding is certain.

    ## Why is this bad?

    No episode from there can reach an exit.

    ## Example

    ```yaml
    version: 1
    max_steps: 3
    ```

    Use instead:

    ```yaml
    version: 1
    max_steps: 20
    ```
    """
    limit = context.level.max_steps
    if limit is None:
        return
    steps, start = max((context.reach.to_exit[state], state) for state in context.starts)
    if steps > limit:
        x, y = context.cell(start)
        yield Finding(
            ("max_steps",),
            f"`max_steps` is {limit}, but the shortest path from [{x}, {y}] to an exit has "
            f"{steps} steps",
            f"set `max_steps` to at least {steps}, or more to allow for exploration",
        )


@rule("BR512")
def insufficient_max_steps(context: LintContext) -> Iterator[Finding]:
    """`max_steps` with which even the optimal policy fails in most episodes.

    ## What it does

    Checks for levels in which the optimal policy reaches an exit with a probability of at least
    0.5 without the limit, and less than 0.5 within `max_steps`. The probabilities are exact: the
    level is solved without the limit, and the probability is computed step by step. Levels of more
    than 5,000 cells are not solved.

    ## Why is this bad?

    An optimal agent is indistinguishable from one that has learned nothing. MiniGrid's `DoorKey`
    had a limit of steps with which it could not be learned
    ([Minigrid #15](https://github.com/Farama-Foundation/Minigrid/pull/15)).

    ## Example

    ```yaml
    version: 1
    size: [8, 1]
    skid: 0.5
    max_steps: 8
    ```

    Use instead:

    ```yaml
    version: 1
    size: [8, 1]
    skid: 0.5
    max_steps: 200
    ```
    """
    level, mdp, reach = context.level, context.mdp, context.reach
    if level.max_steps is None or not level.has_goal:
        return
    if any(not 0 <= reach.to_exit[state] <= level.max_steps for state in context.starts):
        return
    if mdp.probability.shape[2] == 1 and level.max_steps >= sum(reach.on):
        # In a deterministic level, a policy that reaches an exit visits no state twice.
        return
    from babyrobot_levels.linter.optimal_policy import is_within_limit, surely_within_limit

    if surely_within_limit(level, reach.to_exit):
        return
    solution = context.solution
    if solution is None or not solution.exit_probability >= 0.5:
        return
    if is_within_limit(level, solution, 0.5) is False:
        steps = solution.expected_steps
        help_text = "increase `max_steps`"
        if steps <= 1e9:
            help_text += f": without a limit, the optimal policy takes {steps:.0f} steps on average"
        yield Finding(
            ("max_steps",),
            f"with `max_steps: {level.max_steps}` even the optimal policy fails in more than half "
            "of the episodes",
            help_text,
        )


@rule("BR514")
def trivial_start(context: LintContext) -> Iterator[Finding]:
    """Start from which one step surely reaches an exit.

    ## What it does

    Checks for starts with an action that leads to an exit with probability 1, whatever is drawn at
    reset. Levels in which every free cell is a start are not checked: there, some start is always
    next to the exit.

    ## Why is this bad?

    There is nothing to learn. Usually the start or the exit is on the wrong cell, or a wall between
    them is missing.

    ## Example

    ```yaml
    version: 1
    exit: [1, 0]
    ```

    Use instead:

    ```yaml
    version: 1
    exit: [2, 2]
    ```
    """
    level, reach, mdp = context.level, context.reach, context.mdp
    near = {context.cell(state) for state in context.starts if reach.to_exit[state] == 1}
    if not near:
        return
    warps = {context.state(warp.at) for warp in level.warps if warp.when == "enter"}
    others = {state % mdp.cells for state, over in enumerate(mdp.is_terminal.tolist()) if not over}
    if others - warps <= {*map(context.state, level.starts)}:
        return
    trivial = [
        number
        for number, cell in enumerate(level.starts)
        if cell in near
        and all(_is_won_at_once(context, state) for state in context.starts_on(cell))
    ]
    if trivial:
        starts = cells_text([level.starts[number] for number in trivial])
        yield Finding(
            context.place_of_end("start", trivial[0]),
            f"one step from start{'s' * (len(trivial) > 1)} {starts} reaches an exit",
            "move the start or the exit, or place something between them",
        )


def _is_won_at_once(context: LintContext, state: int) -> bool:
    """Return whether an action leads from a state to an exit with probability 1."""
    return any(
        all(
            context.reach.to_exit[after] == 0
            for _, after, *_ in context.mdp.outcomes(state, action)
        )
        for action in range(context.mdp.num_actions)
    )


@rule("BR521")
def non_terminating(context: LintContext) -> Iterator[Finding]:
    """Level whose episodes never end.

    ## What it does

    Checks for levels without exits in which the robot cannot reach a cell that ends the episode and
    is not hit by a mover that ends it, and which have no `max_steps`.

    ## Why is this bad?

    Programs that run until the episode is over never return.

    ## Example

    ```yaml
    version: 1
    exit: none
    ```

    Use instead:

    ```yaml
    version: 1
    exit: none
    max_steps: 100
    ```
    """
    level = context.level
    # Exits that cannot be reached are reported by another rule.
    if level.has_goal or level.max_steps is not None:
        return
    if all(context.reach.to_end[state] < 0 for state in context.starts):
        yield Finding(
            Key(("map",) if level.map is not None else ("exit",)),
            "episodes never end: there is no exit and no `max_steps`",
            "limit the number of steps, for example `max_steps: 100`",
        )


@rule("BR539", needs=Needs.SIZE)
def tables_too_large(context: LintContext) -> Iterator[Finding]:
    """Tables that are too large for the rules of play.

    ## What it does

    Tells that rules which read the tables do not check the level, or not to the end: it has more
    than 1,048,576 states times outcomes of an action, or they would take
    [more work](../level-format.md#limits) than `lint` does for a level. It is a note, reported at
    `info`.

    ## Why is this bad?

    The level may have defects that nobody finds: an exit that cannot be reached, or walls without
    effect. Above that size, to look for them takes long, and much memory.

    ## Example

    ```yaml
    version: 1
    size: [24, 24]
    movers:
      - within: {at: [0, 0], size: [24, 24]}
    hit: {reward: -20}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [24, 24]
    movers:
      - within: {at: [12, 0], size: [6, 12]}
    hit: {reward: -20}
    ```
    """
    level, reason = context.level, context.too_large or context.given_up
    if reason:
        field = "movers" if level.movers else "size" if level.map is None else "map"
        extent = "do not check it" if context.too_large else "check only a part of it"
        yield Finding(
            (field,),
            f"rules of play {extent}: {reason}",
            "use a smaller level, or less that goes astray or walks at random, to have it checked",
            severity=Severity.INFO,
        )
