"""Rules about boxes and targets."""

from collections.abc import Iterator

from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.linter.rule import rule


@rule("BR542", needs=Needs.ARRAYS)
def lost_box(context: LintContext) -> Iterator[Finding]:
    """Box that can reach no target.

    ## What it does

    Checks for boxes that cannot be pushed to any target, even if there were no other box and all
    doors were open. A box in a corner is one, and one at a wall without a target along it.

    ## Why is this bad?

    Without enough other boxes, the level cannot be solved, and the robot can only find that out.

    ## Example

    ```yaml
    version: 1
    map: |
      +---+---+---+---+
      | S           $ |
      +   +   +   +   +
      |     $   .     |
      +   +   +   +   +
      |               |
      +---+---+---+---+
    ```

    Use instead:

    ```yaml
    version: 1
    map: |
      +---+---+---+---+
      | S             |
      +   +   +   +   +
      |     $   .     |
      +   +   +   +   +
      |               |
      +---+---+---+---+
    ```
    """
    from babyrobot_levels.mdp.pushing import lost_cells

    level = context.level
    lost = lost_cells(level) if level.boxes else frozenset()
    for number, box in enumerate(level.boxes):
        x, y = box.at
        if context.state(box.at) in lost:
            yield Finding(
                context.place_of_entry("boxes", number),
                f"the box at [{x}, {y}] can reach no target",
                "move the box, or put a target where it can be pushed to",
            )


@rule("BR543", needs=Needs.LEVEL)
def boxes_and_targets(context: LintContext) -> Iterator[Finding]:
    """More boxes than targets, or more targets than boxes.

    ## What it does

    Checks for levels that end when all targets are covered, and have more targets than boxes; and
    for levels with targets that have more boxes.

    ## Why is this bad?

    Two boxes cannot cover three targets, so such an episode never ends. A box that no target needs
    may be meant as an obstacle, but it multiplies the states; often a target is missing.

    If it is meant, suppress the finding: `# babyrobot: ignore[boxes-and-targets]`.

    ## Example

    ```yaml
    version: 1
    size: [5, 3]
    boxes:
      - {at: [1, 1]}
      - {at: [2, 1]}
    targets:
      - {at: [3, 1]}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [5, 3]
    boxes:
      - {at: [1, 1]}
    targets:
      - {at: [3, 1]}
    ```
    """
    level = context.level
    boxes, targets = len(level.boxes or level.robots), len(level.targets)
    what = "robots" if level.robots else "boxes"
    if level.ends_covered and targets > boxes:
        yield Finding(
            context.place_of_entry("targets", boxes),
            f"there are more targets ({targets}) than {what} ({boxes}): they cannot all be covered",
            f"add {what}, or remove targets",
        )
    elif targets and len(level.boxes) > targets:
        yield Finding(
            context.place_of_entry("boxes", targets),
            f"there are more boxes ({boxes}) than targets ({targets})",
            "add targets, or remove boxes",
        )
