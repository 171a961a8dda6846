"""Rules about items, and about things that nothing needs."""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs, cells_text, count_drawn
from babyrobot_levels.linter.fixes import removal
from babyrobot_levels.linter.rule import rule


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
    if len(doors) < len(level.doors):
        reached = cells_reached(level, doors=doors)
        if reached[numbers].all():
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
            if thing.name in named or (pays and thing.reward is not None):
                continue
            what = "is neither needed nor rewarded" if pays else "is not needed"
            help_text = "name it in `needs` of a door or in `exit_needs`, or remove it"
            if pays:
                help_text = "give it a `reward`, " + help_text
            route = (kind.field, number - drawn)
            yield Finding(
                context.place_of_entry(kind.field, number),
                f"`{thing.name}` {what}",
                help_text,
                fix=None
                if number < drawn
                else removal(context.document, f"remove `{thing.name}`", route, safe=False),
            )
