"""Rules about states: which can be reached, and from which an exit can be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from babyrobot_levels.language.cells import mean_of
from babyrobot_levels.language.fields import as_cells
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, cells_count, cells_text
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.text.diagnostics import Mark, Route, Severity

if TYPE_CHECKING:
    from babyrobot_levels.mdp.tables import Ints


@rule("BR501")
def exit_unreachable_from_start(context: LintContext) -> Iterator[Finding]:
    """Start from which no exit can be reached.

    ## What it does

    Checks for starts from which the probability of reaching an exit is 0 under every policy. The
    check uses the exact transition tables, so walls, warps, wind and skidding are all taken into
    account. Levels with `exit: none` are not checked.

    In a level with things, each start is checked with all that may be drawn at reset, and the
    finding says what was drawn. Exits whose needs are never met are reported by
    [`exit-never-opens`](exit-never-opens.md).

    ## Why is this bad?

    The level cannot be solved from there. Nothing can be learned, and no other error points this
    out: the robot simply never arrives.

    ## Example

    ```yaml
    version: 1
    walls:
      - {at: [1, 0], side: E, length: 3}
    ```

    Use instead:

    ```yaml
    version: 1
    walls:
      - {at: [1, 0], side: E}
    ```
    """
    reach, level = context.reach, context.level
    shut = [state for state in context.starts if reach.to_exit[state] < 0]
    if not level.has_goal or not shut:
        return
    if "exit-never-opens" in context.active and level.exit_keys and not context.things.exits_open:
        return
    number, starts = context.starts_text(shut)
    covers = level.ends_covered
    what = "the targets cannot all be covered" if covers else "no exit can be reached"
    message = f"{what} from {starts}"
    if level.max_steps is None and any(reach.to_end[state] < 0 for state in shut):
        message += ", and such episodes never end"
    help_text = "open a path, or move the start or the exit; use `exit: none` for no exit"
    if covers:
        help_text = "open a path, or move boxes or targets"
    if level.movers and level.hit.ends and _is_open_without_hits(level):
        help_text = "movers end every such episode first: leave the robot room to get past them"
    # Where no start is written, the exit is what is out of reach.
    is_told = level.map is not None or "start" in context.data or "exit" not in context.data
    place = context.place_of_end(*(("start", number) if is_told else ("exit", 0)))
    yield Finding(place, message, help_text)


def _is_open_without_hits(level: Level) -> bool:
    """Return whether exits can be reached from all starts if hits do not end the episode."""
    from babyrobot_levels.linter.variants import variant
    from babyrobot_levels.mdp.states import reach_of

    mdp = variant(level, hit=level.hit.model_copy(update={"ends": False}))
    if mdp is None:
        return False
    to_exit = reach_of(level, mdp).to_exit
    return all(to_exit[state] >= 0 for state in mdp.start.nonzero()[0].tolist())


@rule("BR502")
def unreachable_cells(context: LintContext) -> Iterator[Finding]:
    """Free cells that the robot can never reach.

    ## What it does

    Checks for cells that are not blocked and cannot be reached from any start, according to the
    exact transition tables, whatever is held, on or open. Cells of warps that act on entering are
    not reported, because the robot never occupies them; nor are cells that only the wind makes
    unreachable. Unreachable exits have a rule of their own,
    [`unreachable-exit`](unreachable-exit.md), and so have doors that keep cells shut off,
    [`door-never-opens`](door-never-opens.md).

    ## Why is this bad?

    Nothing that is placed on such cells has an effect, and values and policies are shown for states
    that do not matter. Often a wall is too long or an opening is missing.

    An exit ends the episode, so one in the middle of a corridor cuts off the cells behind it. In a
    random maze this happens to most seeds. If the unreachable cells belong to a maze, lie behind an
    exit, and nothing else is placed on them, the finding is a note: its severity is `info`, and it
    does not affect the exit status.

    ## Example

    ```yaml
    version: 1
    size: [4, 3]
    walls:
      - {at: [0, 2], side: N}
      - {at: [0, 2], side: E}
    ```

    Open a path, or declare that the cell does not exist. Use instead:

    ```yaml
    version: 1
    size: [4, 3]
    blocked:
      - {at: [0, 2]}
    ```
    """
    import numpy as np

    level = context.level
    is_missed = np.frombuffer(context.reached_cells, np.uint8) == 0
    is_missed &= ~context.grid.blocked.ravel()
    entered = (warp.at for warp in level.warps if warp.when == "enter")
    is_missed[[context.state(cell) for cell in (*entered, *level.exits)]] = False
    # Where boxes come to stand, the robot need not.
    is_missed[context.mdp.configurations[:, level.things().of_kind("box")].ravel()] = False
    missed = np.flatnonzero(is_missed)
    if missed.size and level.wind is not None:
        missed = _still_missed(context, missed, wind=None)
    if missed.size and level.doors and "door-never-opens" in context.active:
        doors = [
            door for n, door in enumerate(level.doors) if not context.things.is_closed(n).all()
        ]
        missed = _still_missed(context, missed, doors=tuple(doors))
    if missed.size:
        cells = missed.tolist()
        yield Finding(
            context.place(cells[0]),
            f"{cells_count([context.cell(cell) for cell in cells])} cannot be reached",
            _help_for_cells(context, missed),
            severity=Severity.INFO if _is_cut_off_maze(context, cells) else None,
        )


def _still_missed(context: LintContext, missed: Ints, **fields: Any) -> Ints:
    """Return which of some cells can also not be reached with other values for some fields."""
    from babyrobot_levels.linter.variants import cells_reached

    return missed[~cells_reached(context.level, **fields)[missed]]


def _help_for_cells(context: LintContext, missed: Ints) -> str:
    import numpy as np

    reached, occupied = context.reached_cells, context.occupied_cells
    ends = np.frombuffer(reached, bool) & ~np.frombuffer(occupied, bool)
    is_open = context.grid.open.reshape(-1, 4)[missed]
    width = context.level.size[0]
    others = np.where(is_open, missed[:, None] + np.array([-width, 1, width, -1]), missed[:, None])
    if (blocking := others[is_open & ends[others]]).size:
        x, y = context.cell(int(blocking[0]))
        return f"the episode ends on [{x}, {y}], which blocks the path there"
    if context.level.map is not None:
        return "open a path, or draw cells that are not part of the level as `###`"
    return "open a path, or list cells that are not part of the level under `blocked`"


def _is_cut_off_maze(context: LintContext, unreached: list[int]) -> bool:
    """Return whether only cells of a maze are missed, and all of them lie behind an exit."""
    level = context.level
    if level.maze is None:
        return False
    missed = set(unreached)
    used = [puddle.at for puddle in level.puddles]
    used += [warp.at for warp in level.warps]
    used += [cell for warp in level.warps if warp.to != "start" for cell in level.targets_of(warp)]
    if not missed.isdisjoint(map(context.state, used)):
        return False
    for area in level.areas:
        (x, y), (columns, rows) = area.at, area.size
        cells = ((a, b) for a in range(x, x + columns) for b in range(y, y + rows))
        if missed.issuperset(map(context.state, cells)):
            return False
    exits = (context.state(cell) for cell in level.exits)
    waiting, behind = [cell for cell in exits if context.reached_cells[cell]], set[int]()
    while waiting:
        found = missed.intersection(context.neighbours(waiting.pop())) - behind
        behind |= found
        waiting += found
    return behind == missed


@rule("BR503")
def inescapable_state(context: LintContext) -> Iterator[Finding]:
    """Reachable cell from which no exit can be reached.

    ## What it does

    Checks for cells that the robot can reach, that do not end the episode, and from which the
    probability of reaching an exit is 0 under every policy. The check uses the exact transition
    tables, so walls, warps, wind and skidding are all taken into account.

    In a level with things, a cell may be a trap in some configurations only: the way back is
    closed by then, or taking a key shuts a door for good. The finding then says what is held or
    on, and names no more than it takes to tell the trap from other states of that cell.

    ## Why is this bad?

    An episode that enters such a cell can only be truncated. Its return then depends on the limit
    of steps, which the level may not even have.

    MiniGrid's `UnlockPickup` has such states: an episode that picks up the box while it holds the
    key can no longer be solved
    ([Minigrid #179](https://github.com/Farama-Foundation/Minigrid/issues/179)).

    ## Example

    ```yaml
    version: 1
    size: [3, 1]
    start: [1, 0]
    warps:
      - {at: [0, 0], to: [0, 0], when: leave}
    ```

    Leave a path to an exit, or end the episode there. Use instead:

    ```yaml
    version: 1
    size: [3, 1]
    start: [1, 0]
    areas:
      - {at: [0, 0], ends: true}
    ```
    """
    reach = context.reach
    # Starts without an exit are reported by another rule.
    good = [state for state in context.starts if reach.to_exit[state] >= 0]
    if context.level.boxes or context.level.robots:
        # A push may well lose such a level, and so may a robot that leaves before others can.
        return
    if not good or all(steps >= 0 for state, steps in enumerate(reach.to_exit) if reach.on[state]):
        return
    steps = reach.from_some(good)
    traps = [
        state
        for state, on in enumerate(reach.on)
        if on and steps[state] >= 0 > reach.to_exit[state]
    ]
    if traps and context.level.has_things:
        yield _trap_among_things(context, steps, traps)
    elif traps:
        cells = cells_count([context.cell(state) for state in traps])
        verb = "is" if len(traps) == 1 else "are"
        yield Finding(
            context.place(traps[0]),
            f"{cells} {verb} reachable, but no exit is reachable from there",
            "open a path to an exit, or end the episode there with `ends: true`",
        )


def _trap_among_things(context: LintContext, steps: Sequence[int], traps: list[int]) -> Finding:
    """Return the finding for the trap that is reached first, with the configuration in words."""
    first = min(traps, key=lambda state: (steps[state], state))
    occupied = [state for state, on in enumerate(context.reach.on) if on]
    shut = [state for state in occupied if context.reach.to_exit[state] < 0]
    told = context.things.told(first, shut, occupied)
    message = f"from {cells_text([context.cell(first)])}{told and f' with {told}'}"
    message += ", no exit can be reached"
    if len(traps) > 1:
        message += f" (and from {len(traps) - 1} more state{'s' * (len(traps) > 2)})"
    before = next(
        state
        for state, others in enumerate(context.reach.successors)
        if first in others and steps[state] == steps[first] - 1
    )
    help_text = "keep a path to an exit open, or end the episode there with `ends: true`"
    kind, number = context.things.changed(before, first)
    if kind is None or not kind.need.met:
        return Finding(context.place(first), message, help_text)
    name = kind.of(context.level)[number].name
    help_text = f"the robot gets there by {kind.need.getting} `{name}`: {help_text}"
    return Finding(context.place_of_entry(kind.field, number), message, help_text)


@rule("BR504")
def unbounded_return(context: LintContext) -> Iterator[Finding]:
    """Optimal policy that never ends the episode.

    ## What it does

    Checks for levels in which an exit, or a cell that ends the episode, can be reached, but the
    optimal policy loops forever because some loop is worth more than ending the episode. The level
    is solved exactly. Levels of more than 5,000 cells are not solved, nor are levels whose return
    does not converge because rewards and costs cancel out. Rewards that are too large to add up,
    above 1e140, are reported as well.

    ## Why is this bad?

    Without a discount the optimal return is infinite: `babyrobot solve` prints `inf`. An agent that
    learns well never arrives, and the better it learns, the longer its episodes last. Usually a
    reward is positive that was meant to be a cost, or can be collected repeatedly.

    ## Example

    ```yaml
    version: 1
    areas:
      - {at: [1, 1], color: gold, reward: 5}
    ```

    End the episode where the reward is given, or make each step cost something. Use instead:

    ```yaml
    version: 1
    areas:
      - {at: [1, 1], color: gold, reward: 5, ends: true}
    ```
    """
    from babyrobot_levels.analysis.solver.model import largest_reward, too_large_to_add_up
    from babyrobot_levels.linter.optimal_policy import endless_loop, surely_terminates

    level, reach = context.level, context.reach
    if reason := too_large_to_add_up(largest_reward(context.mdp)):
        yield Finding(("rewards",), reason)
        return
    if not any(reach.to_end[state] >= 0 for state in context.starts):
        return
    if surely_terminates(context.mdp, level.discount) or context.solution is None:
        return
    if states := endless_loop(context.mdp, reach, context.solution):
        cells = [*dict.fromkeys(context.cell(state) for state in states)]
        location = context.place(states[0])
        source = _source_of_reward(context, {*cells})
        if source is not None:
            location = source
        elif "rewards" in context.data and not isinstance(location, Mark):
            location = ("rewards",)
        why = "is worth more than ending it"
        if context.solution.expected_return == float("inf"):
            why = "gives an infinite return"
        yield Finding(
            location,
            f"the optimal policy never ends the episode: looping on {cells_text(cells)} {why}",
            "give each step a cost, give exits a higher reward, or end the episode with "
            "`ends: true` where the reward is given",
        )


def _source_of_reward(context: LintContext, cells: set[tuple[int, int]]) -> Route | None:
    """Return the route of what gives a positive reward on one of the cells."""
    for number, area in context.level.written("areas"):
        (x, y), (columns, rows) = area.at, area.size
        covered = any(x <= a < x + columns and y <= b < y + rows for a, b in cells)
        if mean_of(area.reward or 0) > 0 and covered:
            return ("areas", number)
    for number, warp in enumerate(context.level.warps):
        leads = [] if isinstance(warp.to, str) else as_cells(warp.to)
        if (warp.reward or 0) > 0 and not cells.isdisjoint((warp.at, *leads)):
            return ("warps", number)
    if context.level.hit.reward > 0 and "hit" in context.data and "reward" in context.data["hit"]:
        return ("hit", "reward")
    return None


@rule("BR517")
def unreachable_exit(context: LintContext) -> Iterator[Finding]:
    """Exit that cannot be reached while another one can.

    ## What it does

    Checks for exits that cannot be reached from any start, in levels with another exit that can be.
    The check uses the exact transition tables. Of the cells of `exit_one_of`, each is checked in
    the episodes in which it is the exit, and an exit with needs counts as reached when it ends an
    episode.

    ## Why is this bad?

    The exit is shown and never used. The choice between exits, which makes such a level
    interesting, does not exist.

    ## Example

    ```yaml
    version: 1
    size: [4, 3]
    start: [1, 0]
    exit: [[0, 2], [3, 2]]
    walls:
      - {at: [0, 2], side: N}
      - {at: [0, 2], side: E}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 3]
    start: [1, 0]
    exit: [[0, 2], [3, 2]]
    walls:
      - {at: [0, 2], side: N}
    ```
    """
    exits = context.level.exits
    # Each of several robots has exits of its own, of which the tables of all tell no cells.
    if len(exits) < 2 or context.level.robots:
        return
    ended = context.ended_exits
    missed = [number for number, cell in enumerate(exits) if context.state(cell) not in ended]
    if missed and len(missed) < len(exits):
        cells = cells_text([exits[number] for number in missed])
        yield Finding(
            context.place_of_end("exit", missed[0]),
            f"exit{'s' * (len(missed) > 1)} {cells} cannot be reached from any start",
            "open a path, or remove the exit",
        )
