"""Rules about items, movers, and things that nothing needs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs, cell_mark, cells_text, count_drawn
from babyrobot_levels.linter.fixes import removal
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.mdp.tables import Flags


@rule("BR528")
def unreachable_item(context: LintContext) -> Iterator[Finding]:
    """Item that can never be taken.

    ## What it does

    Checks for items that no episode takes, and for cells of `one_of` from which no episode takes
    the item. The check uses the exact transition tables: walls, doors and the order in which they
    open, warps, movers that end the episode, and chance are all taken into account.

    ## Why is this bad?

    The item is shown and can never be had. If a door or the exit needs it, the level cannot be
    solved, or not in all episodes. Typically a key lies behind the door that it opens.

    Generators make such levels: MiniGrid's `ObstructedMaze` could put a ball on the box that held a
    key ([Minigrid #323](https://github.com/Farama-Foundation/Minigrid/issues/323)).

    ## Example

    ```yaml
    version: 1
    size: [4, 2]
    doors:
      - {at: [1, 0], side: E, length: 2, needs: key}
    items:
      - {name: key, at: [3, 0]}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 2]
    doors:
      - {at: [1, 0], side: E, length: 2, needs: key}
    items:
      - {name: key, at: [0, 1]}
    ```
    """
    drawn = count_drawn(context.level, "items")
    for number, item in enumerate(context.level.items):
        left = context.things.places_left(number)
        if not left:
            continue
        location = context.place_of_entry("items", number)
        message = f"`{item.name}` can never be taken"
        cells = [item.places[place] for place in left]
        if len(left) < len(item.places):
            message += f" from {cells_text(cells)}"
            if number >= drawn:
                location = ("items", number - drawn, "one_of", left[0])
            else:
                location = context.place(context.state(cells[0]))
        yield Finding(location, message, _help_for_item(context, item.name, cells))


def _help_for_item(context: LintContext, name: str, cells: list[tuple[int, int]]) -> str:
    from babyrobot_levels.linter.variants import cells_reached

    level = context.level
    numbers = [context.state(cell) for cell in cells]
    if all(context.reached_cells[number] for number in numbers):
        return "move it: the robot gets there only while it lies elsewhere"
    doors = tuple(door for door in level.doors if name not in door.keys)
    if len(doors) < len(level.doors) and cells_reached(level, doors=doors)[numbers].all():
        return "move it, or the door: it lies behind a door that it opens"
    return "open a path to it, or move it"


@rule("BR529", needs=Needs.LEVEL)
def unused_thing(context: LintContext) -> Iterator[Finding]:
    """Item that is neither needed nor rewarded, or switch that nothing needs.

    ## What it does

    Checks for items without a `reward` and for switches whose names occur neither in `needs` nor
    in `unless` of a door, nor in `exit_needs`.

    ## Why is this bad?

    Taking the item or flipping the switch makes no difference, but it multiplies the states by two
    or more. Usually the `needs` of a door is missing, or the `reward` of the item.

    If the item is meant to distract, suppress the finding: `# babyrobot: ignore[unused-thing]`.

    ## Example

    ```yaml
    version: 1
    items:
      - {name: key, at: [1, 1]}
    ```

    Use instead:

    ```yaml
    version: 1
    exit_needs: key
    items:
      - {name: key, at: [1, 1]}
    ```

    ## Fix safety

    The fix removes the entry. It is unsafe, because the tables then have fewer states; the optimal
    return stays the same. There is no fix for what is drawn.
    """
    level = context.level
    named = {*level.exit_keys}
    for door in level.doors:
        named |= {*door.keys, *door.locks}
    for kind in NEEDED:
        pays = "reward" in kind.properties
        drawn = count_drawn(level, kind.field)
        for number, thing in enumerate(kind.of(level)):
            if thing.name in named or (kind.name == "target" and level.ends_covered):
                continue
            if pays and thing.reward is not None:
                continue
            what = "is neither needed nor rewarded" if pays else "is not needed"
            help_text = "name it in `needs` of a door or in `exit_needs`, or remove it"
            if pays:
                help_text = "give it a `reward`, " + help_text
            route, called = (kind.field, number - drawn), thing.name or kind.noun
            yield Finding(
                context.place_of_entry(kind.field, number),
                f"`{called}` {what}",
                help_text,
                fix=None
                if number < drawn
                else removal(context.document, f"remove `{called}`", route, safe=False),
            )


@rule("BR535")
def unavoidable_mover(context: LintContext) -> Iterator[Finding]:
    """Mover that the robot cannot avoid on its way to an exit.

    ## What it does

    Checks for movers that hit the robot with a probability above 0 under every policy that can
    reach an exit, from some start and with what may be drawn at reset. In a level without exits,
    all policies count. The check is exact: it finds the states in which some action surely leads
    to such states again without a hit, and whether an exit can be reached by such actions alone.
    If each mover can be avoided, but not all of them, the finding names all that may be met.

    ## Why is this bad?

    How an episode ends depends on luck. Often a mover can begin beside the start: in about 7% of
    the seeds of Procgen's `Jumper` the agent begins on an enemy or on the goal, and the episode is
    over after one step ([Procgen #59](https://github.com/openai/procgen/issues/59)).

    If the risk is intended, suppress the finding: `# babyrobot: ignore[unavoidable-mover]`.

    ## Example

    ```yaml
    version: 1
    size: [4, 4]
    movers:
      - {name: bat, within: {at: [0, 0], size: [4, 3]}}
    hit: {reward: -20}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 4]
    movers:
      - {name: bat, within: {at: [1, 0], size: [3, 3]}, start: [3, 0]}
    hit: {reward: -20}
    ```
    """
    level, things = context.level, context.things
    if not level.movers or not things.can_look_for_hits:
        return
    import numpy as np

    every = _unavoidable(context, np.logical_or.reduce(things.hits))
    if not every:
        return
    alone = [(number, _unavoidable(context, hits)) for number, hits in enumerate(things.hits)]
    for number, states in alone:
        if states:
            yield _unavoidable_finding(context, [number], states)
    if not any(states for _, states in alone):
        met = [number for number, hits in enumerate(things.hits) if hits.any()]
        yield _unavoidable_finding(context, met, every)


def _unavoidable(context: LintContext, hits: Flags) -> list[int]:
    """Return the starts from which an exit can be reached, but not without risking a hit."""
    from babyrobot_levels.linter.things import unavoidable_starts
    from babyrobot_levels.mdp.states import exit_states

    exits = exit_states(context.level, context.mdp) if context.level.has_goal else None
    found = unavoidable_starts(context.mdp, hits, exits) or []
    # Starts from which no exit can be reached at all are reported by another rule.
    return [state for state in found if exits is None or context.reach.to_exit[state] >= 0]


def _unavoidable_finding(context: LintContext, numbers: list[int], states: list[int]) -> Finding:
    names = [f"`{context.things.mover_name(number)}`" for number in numbers]
    message = f"{listed(names)} cannot {'all ' * (len(names) > 1)}be avoided"
    if context.level.exits:
        message += " on the way to an exit"
    if len(states) < len(context.starts):
        message += f" from {context.starts_text(states)[1]}"
    return Finding(
        context.place_of_entry("movers", numbers[0]),
        message,
        "leave the robot room or time to get past, or let it start farther away",
    )


@rule("BR536")
def mover_never_met(context: LintContext) -> Iterator[Finding]:
    """Mover that never hits the robot.

    ## What it does

    Checks for movers that hit the robot in no transition of a state that an episode can reach,
    whatever the robot does. The check uses the exact transition tables.

    ## Why is this bad?

    The mover is a decoration, but multiplies the states by the length of its path or the cells of
    its rectangle. Usually the path is in the wrong place, or a wall cuts it off.

    In NAVIX's `DynamicObstacles`, agents that walked into a ball were not hit
    ([NAVIX #91](https://github.com/epignatelli/navix/issues/91)).

    ## Example

    ```yaml
    version: 1
    size: [4, 2]
    exit: [3, 0]
    walls:
      - {at: [0, 1], side: N, length: 4}
    movers:
      - {name: guard, path: [[1, 1], [2, 1]], back: true}
    hit: {reward: -20}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 2]
    exit: [3, 0]
    movers:
      - {name: guard, path: [[1, 1], [2, 1]], back: true}
    hit: {reward: -20}
    ```

    ## Fix safety

    The fix removes the mover. It is unsafe, because the tables then have fewer states; the optimal
    return stays the same.
    """
    level, things = context.level, context.things
    if not level.movers or not things.can_look_for_hits:
        return
    for number, hits in enumerate(things.hits):
        if not hits.any():
            name = f"`{things.mover_name(number)}`"
            yield Finding(
                ("movers", number),
                f"{name} never meets the robot",
                "let it move where the robot goes, or remove it",
                fix=removal(context.document, f"remove {name}", ("movers", number), safe=False),
            )


@rule("BR538", needs=Needs.LEVEL)
def doubled_mover(context: LintContext) -> Iterator[Finding]:
    """Mover that walks in step with another one.

    ## What it does

    Checks for movers with the same path as one before them: both are in the same cell at each
    step. Wanderers walk at random, so two of them may share a rectangle.

    ## Why is this bad?

    There seems to be one mover, and its picture is too small. Usually the path was drawn, or the
    entry copied, twice.

    ## Example

    ```yaml
    version: 1
    size: [4, 2]
    movers:
      - {path: [[1, 1], [2, 1]], back: true}
      - {path: [[1, 1], [2, 1]], back: true}
    hit: {reward: -20}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 2]
    movers:
      - {path: [[1, 1], [2, 1]], back: true}
      - {path: [[2, 1], [1, 1]], back: true}
    hit: {reward: -20}
    ```

    ## Fix safety

    The fix removes the mover. It is unsafe, because the level gets another digest.
    """
    things = context.level.things()
    first: dict[tuple[tuple[int, int], ...], int] = {}
    for number, mover in enumerate(context.level.movers):
        if mover.path is None or first.setdefault(mover.phases, number) == number:
            continue
        same = (things.static + each for each in (number, first[mover.phases]))
        name, other = (f"`{things.names[each]}`" for each in same)
        yield Finding(
            ("movers", number),
            f"{name} is always in the same cell as {other}",
            "let it begin elsewhere on the path, or remove it",
            fix=removal(context.document, f"remove {name}", ("movers", number), safe=False),
        )


@rule("BR541", needs=Needs.LEVEL)
def item_drawn_in_several_cells(context: LintContext) -> Iterator[Finding]:
    """Item that several cells of the drawing show, of which it lies in one.

    ## What it does

    Checks for characters of the legend that stand for an item and that the drawing shows in more
    than one cell.

    ## Why is this bad?

    The picture shows several items, and there is one: each reset draws the cell in which it lies.
    A reward is paid once, and a door that needs it opens with the first one that is taken. Usually
    several items were meant. Switches of one name in several cells are an error.

    If one item is meant, write it as an entry of `items` with `one_of`.

    ## Example

    ```yaml
    version: 1
    map: |
      +---+---+---+---+
      | S   c   c   E |
      +---+---+---+---+
    legend:
      c: {item: coin, reward: 5}
    ```

    Use instead:

    ```yaml
    version: 1
    map: |
      +---+---+---+---+
      | S   c   d   E |
      +---+---+---+---+
    legend:
      c: {item: coin, reward: 5}
      d: {item: second-coin, shape: coin, reward: 5}
    ```
    """
    level, drawing = context.level, context.level.drawing
    for character, entry in level.legend.items() if drawing is not None else ():
        assert drawing is not None
        cells = drawing.find(character)
        if entry.item is not None and len(cells) > 1:
            yield Finding(
                cell_mark(level, *cells[1]),
                f"`{entry.item}` is one item: it lies in one of the {len(cells)} cells that show "
                f"`{character}`, drawn at each reset",
                "for an item in each cell, give each a character and a name of its own; for one, "
                "write an entry of `items` with `one_of`",
            )
