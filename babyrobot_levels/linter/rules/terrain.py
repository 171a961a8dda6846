"""Rules about what lies on cells: areas, puddles, skidding, blocked cells, and legends."""

from collections.abc import Iterator

from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs, cells_text
from babyrobot_levels.linter.fixes import removal
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.text.diagnostics import Key, Route


@rule("BR508")
def puddle_without_effect(context: LintContext) -> Iterator[Finding]:
    """Puddle that does not affect the MDP.

    ## What it does

    Checks for puddles on an exit, where the episode ends; on a warp that acts on entering, which
    the robot never occupies; and on cells that would have the same reward and the same skid without
    them.

    ## Why is this bad?

    The picture shows water that makes no difference. Usually the puddle was meant for another cell,
    or `puddle_types` is incomplete.

    ## Example

    ```yaml
    version: 1
    puddles:
      - {at: [2, 2]}
    ```

    Use instead:

    ```yaml
    version: 1
    puddles:
      - {at: [1, 2]}
    ```

    ## Fix safety

    The fix removes the puddle, also from the picture. It is safe, except for a puddle on a warp:
    the transition tables also contain states that are never occupied.
    """
    from babyrobot_levels.linter.terrain import Effect, sure_exits

    level = context.level
    if not level.puddles:
        return
    help_text = "remove it, or move it to a cell that the robot can occupy"
    idle = context.terrain.puddles
    if level.map is not None:
        if idle:
            cells = [level.puddles[number].at for number, *_ in idle]
            location = context.place(context.state(cells[0]))
            what = f"the puddle on {cells_text(cells)} has"
            if len(cells) > 1:
                what = f"the puddles on {cells_text(cells)} have"
                help_text = "remove them, or move them to cells that the robot can occupy"
            yield Finding(location, f"{what} no effect", help_text)
        return
    for number, *effects in idle:
        x, y = level.puddles[number].at
        reason = "the cell has the same reward and skid without it"
        if (x, y) in sure_exits(level):
            reason = "it is on an exit, where the episode ends"
        elif Effect.UNREACHABLE in effects:
            reason = "it is on a warp, which the robot never occupies"
        yield Finding(
            ("puddles", number),
            f"the puddle on [{x}, {y}] has no effect: {reason}",
            help_text,
            fix=removal(
                context.document,
                "remove the puddle",
                ("puddles", number),
                safe=Effect.UNREACHABLE not in effects,
            ),
        )


@rule("BR509")
def area_without_effect(context: LintContext) -> Iterator[Finding]:
    """Area that changes neither the MDP nor the picture.

    ## What it does

    Checks for areas that set no property, that only set properties which their cells have anyway,
    or whose cells are all blocked, exits, or warps that act on entering, where the properties never
    apply.

    ## Why is this bad?

    The entry looks as if it had an effect. Usually a property is missing, or the rectangle is in
    the wrong place.

    ## Example

    ```yaml
    version: 1
    areas:
      - {at: [0, 1], size: [2, 1]}
    ```

    Use instead:

    ```yaml
    version: 1
    areas:
      - {at: [0, 1], size: [2, 1], reward: -3}
    ```

    ## Fix safety

    The fix removes the entry. It is safe, except for an area on a warp that acts on entering: the
    transition tables also contain states that are never occupied.
    """
    for route, area in context.listed_areas():
        if area.works or area.is_covered:
            continue
        (x, y) = context.level.areas[area.number].at
        what = "its cells have the same properties without it"
        if not area.effects and area.colored is None:
            what = "it sets no property"
        yield Finding(
            route,
            f"the area at [{x}, {y}] has no effect: {what}",
            "set a property, move the area, or remove it",
            fix=removal(context.document, "remove the area", route, safe=area.is_safe),
        )


@rule("BR510")
def area_covered(context: LintContext) -> Iterator[Finding]:
    """Area that later areas or puddles cover completely.

    ## What it does

    Checks for areas whose properties are all overridden. Later areas take precedence over earlier
    ones, property by property, and puddles take precedence over areas.

    ## Why is this bad?

    The entry has no effect. Usually the order is wrong: the special case comes before the general
    one and is overridden by it.

    ## Example

    ```yaml
    version: 1
    size: [4, 4]
    areas:
      - {at: [1, 1], reward: -5}
      - {at: [0, 0], size: [3, 3], reward: -2}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 4]
    areas:
      - {at: [0, 0], size: [3, 3], reward: -2}
      - {at: [1, 1], reward: -5}
    ```

    ## Fix safety

    The fix removes the entry. It is safe: neither the MDP nor the picture changes.
    """
    for route, area in context.listed_areas():
        if not area.works and area.is_covered:
            x, y = context.level.areas[area.number].at
            yield Finding(
                route,
                f"the area at [{x}, {y}] is covered by later areas or puddles",
                "move it down, or remove it: later areas take precedence over earlier ones, and "
                "puddles over areas",
                fix=removal(context.document, "remove the area", route),
            )


@rule("BR522")
def skid_without_effect(context: LintContext) -> Iterator[Finding]:
    """`skid` that never makes the robot skid.

    ## What it does

    Checks for the `skid` of the level and of areas. It has no effect if its probability is 0 and
    nothing else is slippery, if other areas and puddles override it on all of its cells, or if the
    robot never moves away from these cells because the episode ends there or a warp takes it along.

    ## Why is this bad?

    Changing the value makes no difference.

    ## Example

    ```yaml
    version: 1
    skid: 0
    ```

    Use instead:

    ```yaml
    version: 1
    skid: 0.1
    ```

    ## Fix safety

    The fix removes `skid`. It is safe, except for an area on warps that act on entering: the
    transition tables also contain states that are never occupied.
    """
    from babyrobot_levels.linter.terrain import Effect

    level = context.level
    if level.skid is not None and context.terrain.skid is not Effect.WORKS:
        safe = context.terrain.skid is not Effect.UNREACHABLE
        yield _skid_finding(context, ("skid",), "`skid` has no effect", safe)
    for route, area in context.listed_areas():
        if area.works and area.is_idle("skid"):
            x, y = level.areas[area.number].at
            message = f"`skid` of the area at [{x}, {y}] has no effect"
            yield _skid_finding(context, (*route, "skid"), message, area.is_safe_without("skid"))


def _skid_finding(context: LintContext, route: Route, message: str, safe: bool) -> Finding:
    return Finding(
        Key(route),
        message,
        "remove it, or set it on cells from which the robot moves",
        fix=removal(context.document, "remove `skid`", route, safe=safe),
    )


@rule("BR524")
def area_reward_without_effect(context: LintContext) -> Iterator[Finding]:
    """`reward` of an area that no step gives.

    ## What it does

    Checks for areas that have some effect, such as a colour, but whose `reward` is never given.
    Later areas or puddles override it on all of its cells; or these are exits, which give
    `rewards.exit`, unless that is `cell`; or they are warps that act on entering, so that the
    robot gets the reward of the warp or of the cell where it arrives.

    ## Why is this bad?

    The area looks like a penalty or a prize and is neither. The penalty of a cliff that sends the
    robot back to the start, for example, is the `reward` of the warp.

    ## Example

    ```yaml
    version: 1
    areas:
      - {at: [1, 2], color: black, reward: -100}
    warps:
      - {at: [1, 2], to: start}
    ```

    Use instead:

    ```yaml
    version: 1
    areas:
      - {at: [1, 2], color: black}
    warps:
      - {at: [1, 2], to: start, reward: -100}
    ```

    ## Fix safety

    The fix removes `reward`. It is safe, except for an area on warps: the transition tables also
    contain states that are never occupied.
    """
    for route, area in context.listed_areas():
        if area.works and area.is_idle("reward"):
            x, y = context.level.areas[area.number].at
            yield Finding(
                Key((*route, "reward")),
                f"`reward` of the area at [{x}, {y}] is never given",
                "set it on other cells; warps have a `reward` of their own, exits pay "
                "it with `rewards: {exit: cell}`",
                fix=removal(
                    context.document,
                    "remove `reward`",
                    (*route, "reward"),
                    safe=area.is_safe_without("reward"),
                ),
            )


@rule("BR525", needs=Needs.LEVEL)
def unused_properties(context: LintContext) -> Iterator[Finding]:
    """Entry of `puddle_types` for a size that no puddle has, or `hit` or `team` for nobody.

    ## What it does

    Checks for sizes under `puddle_types` of which the level has no puddle, for `hit` in a level
    without movers, and for `team` in one without `robots`.

    ## Why is this bad?

    The entry has no effect. Usually the puddles have the other size, with its default properties.

    ## Example

    ```yaml
    version: 1
    puddles:
      - {at: [1, 1]}
    puddle_types:
      large: {reward: -10}
    ```

    Use instead:

    ```yaml
    version: 1
    puddles:
      - {at: [1, 1], size: large}
    puddle_types:
      large: {reward: -10}
    ```

    ## Fix safety

    The fix removes the size from `puddle_types`, or the field. It is safe: neither the MDP nor the
    picture changes.
    """
    level = context.level
    sizes = {puddle.size for puddle in level.puddles}
    for size in context.data.get("puddle_types", ()):
        if size not in sizes:
            yield Finding(
                Key(("puddle_types", size)),
                f"the level has no {size} puddle",
                f"remove `{size}`, or add such a puddle",
                fix=removal(context.document, f"remove `{size}`", ("puddle_types", size)),
            )
    for field, whose in (("hit", "movers"), ("team", "robots")):
        if context.data.get(field) and not getattr(level, whose):
            yield Finding(
                Key((field,)),
                f"the level has no `{whose}`",
                f"remove `{field}`, or add {whose}",
                fix=removal(context.document, f"remove `{field}`", (field,)),
            )


@rule("BR527", needs=Needs.ARRAYS)
def blocked_without_effect(context: LintContext) -> Iterator[Finding]:
    """Entry of `blocked` whose cells are all blocked by other entries.

    ## What it does

    Checks for redundant entries of `blocked`. Of two equal entries, the later one is reported.

    ## Why is this bad?

    The entry looks as if it had an effect. Usually it was meant for other cells.

    ## Example

    ```yaml
    version: 1
    size: [5, 5]
    blocked:
      - {at: [1, 1], size: [2, 2]}
      - {at: [2, 2]}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [5, 5]
    blocked:
      - {at: [1, 1], size: [2, 2]}
    ```

    ## Fix safety

    The fix removes the entry. It is safe: the blocked cells stay the same.
    """
    blocked = context.level.blocked
    if len(blocked) < 2 or "blocked" not in context.data:
        return
    import numpy as np

    width, height = context.level.size
    times = np.zeros((height, width), np.int32)
    places = []
    for (x, y), (columns, rows) in ((each.at, each.size) for each in blocked):
        places.append((slice(y, y + rows), slice(x, x + columns)))
        times[places[-1]] += 1
    for number, place in reversed([*enumerate(places)]):
        if (times[place] > 1).all():
            times[place] -= 1
            x, y = blocked[number].at
            yield Finding(
                ("blocked", number),
                f"the entry at [{x}, {y}] only blocks cells that are already blocked",
                "remove the entry",
                fix=removal(context.document, "remove the entry", ("blocked", number)),
            )


@rule("BR523", needs=Needs.LEVEL)
def unused_legend(context: LintContext) -> Iterator[Finding]:
    """Character of the legend that the drawing does not contain.

    ## What it does

    Checks for keys of `legend` that do not occur in `map`.

    ## Why is this bad?

    The entry has no effect. Usually the drawing contains another character where this one was
    meant.

    ## Example

    ```yaml
    version: 1
    map: |
      +---+---+---+
      | S       E |
      +---+---+---+
    legend:
      x: {reward: -5}
    ```

    Use instead:

    ```yaml
    version: 1
    map: |
      +---+---+---+
      | S   x   E |
      +---+---+---+
    legend:
      x: {reward: -5}
    ```

    ## Fix safety

    The fix removes the character from the legend. It is safe: neither the MDP nor the picture
    changes.
    """
    level = context.level
    if not level.legend or level.map is None:
        return
    # Corners, walls and spaces cannot be keys of a legend.
    shown = {*level.map}
    for character in level.legend:
        if character not in shown:
            yield Finding(
                Key(("legend", character)),
                f"the drawing does not contain `{character}`",
                "draw it, or remove it from the legend",
                fix=removal(context.document, f"remove `{character}`", ("legend", character)),
            )
