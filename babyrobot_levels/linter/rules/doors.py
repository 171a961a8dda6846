"""Rules about doors and about what doors and exits need."""

from collections.abc import Iterable, Iterator

from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding
from babyrobot_levels.linter.fixes import door_removal, removal
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.text.diagnostics import Key, Route
from babyrobot_levels.text.words import listed


@rule("BR530")
def door_never_opens(context: LintContext) -> Iterator[Finding]:
    """Door that is always closed.

    ## What it does

    Checks for doors that are closed in all states that an episode can reach: what they need can
    never be held or switched on, or not at the same time, or something that closes them is held or
    on from the beginning. The check uses the exact transition tables.

    ## Why is this bad?

    The door is a wall, and nothing behind it can be reached that way. Usually the item that it
    needs lies behind it, or `unless` was meant where `needs` is written.

    In NAVIX's `KeyCorridor` no door could be passed
    ([NAVIX #98](https://github.com/epignatelli/navix/issues/98)); later, some walls were doors that
    could never open ([NAVIX #224](https://github.com/epignatelli/navix/pull/224)).

    ## Example

    ```yaml
    version: 1
    size: [4, 2]
    walls:
      - {at: [1, 0], side: E}
    doors:
      - {at: [1, 1], side: E, needs: lever, unless: key}
    switches:
      - {name: lever, at: [1, 0], once: true}
    items:
      - {name: key, at: [0, 0]}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 2]
    walls:
      - {at: [1, 0], side: E}
    doors:
      - {at: [1, 1], side: E, needs: [lever, key]}
    switches:
      - {name: lever, at: [1, 0], once: true}
    items:
      - {name: key, at: [0, 1]}
    ```
    """
    for number, door in enumerate(context.level.doors):
        if not context.things.is_closed(number).all():
            continue
        why = _why_unmet(context, door.keys) or "something closes it whenever its needs are met"
        for name in door.locks:
            if context.things.met[name].all():
                why = f"{_state(context, name)} from the beginning"
            elif name in door.keys:
                why = f"`{name}` both opens and closes it"
        yield Finding(
            context.place_of_entry("doors", number),
            f"{_door_text(context, number)} never opens: {why}",
            "change `needs` or `unless`, or write a wall instead of the door",
        )


def _why_unmet(context: LintContext, names: Iterable[str]) -> str | None:
    """Return why some names are never all held or on, None if they can be."""
    if never := [name for name in names if not context.things.met[name].any()]:
        return f"`{never[0]}` is never {'held' if context.things.is_item(never[0]) else 'on'}"
    if not context.things.are_met(names).any():
        return "what it needs is never all held or on at the same time"
    return None


def _state(context: LintContext, name: str) -> str:
    return f"`{name}` is {'held' if context.things.is_item(name) else 'on'}"


def _door_text(context: LintContext, number: int) -> str:
    door = context.level.doors[number]
    return f"the door on side {door.side} of [{door.at[0]}, {door.at[1]}]"


@rule("BR531")
def door_always_open(context: LintContext) -> Iterator[Finding]:
    """Door that is never closed.

    ## What it does

    Checks for doors that are open in all states that an episode can reach: they need nothing, or
    what they need is held or on from the beginning and stays so, or what closes them is never held
    or on. The check uses the exact transition tables.

    ## Why is this bad?

    The door bars nothing, and the goal behind it stands open. In NAVIX's `KeyCorridor` the door of
    the goal's room was open at reset, so that agents could reach the goal without the key
    ([NAVIX #141](https://github.com/epignatelli/navix/issues/141)).

    ## Example

    ```yaml
    version: 1
    size: [4, 2]
    doors:
      - {at: [1, 0], side: E, length: 2, needs: key}
    items:
      - {name: key, at: [0, 0]}
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

    ## Fix safety

    The fix removes the door, also from the drawing. It is safe if the digest stays the same, as it
    does unless the door is the level's only thing.
    """
    level = context.level
    for number, door in enumerate(level.doors):
        if context.things.is_closed(number).any():
            continue
        from babyrobot_levels.linter.optimal_policy import without

        why = "it needs nothing"
        if door.keys:
            why = f"{_state(context, door.keys[0])} from the beginning"
        elif door.locks:
            kind = "held" if context.things.is_item(door.locks[0]) else "on"
            why = f"`{door.locks[0]}` is never {kind}"
        yield Finding(
            context.place_of_entry("doors", number),
            f"{_door_text(context, number)} is never closed: {why}",
            "change `needs` or `unless`, or remove the door",
            fix=door_removal(
                context.document,
                level,
                number,
                safe=context.has_same_digest(doors=without(level.doors, number)),
            ),
        )


@rule("BR532")
def door_without_effect(context: LintContext) -> Iterator[Finding]:
    """Door that the best policies do not pass, or that is open whenever the robot comes to it.

    ## What it does

    Checks for doors that open and close, but make no difference. Either the level without the door
    and the level with a wall in its place have the same best policies, which lead from the start
    on to the same states with the same rewards. Or all that can happen stays the same without the
    door, whatever the robot does. The levels are solved exactly, for the five actions. Levels of
    more than 5,000 states are not solved, nor are more doors checked than 20,000 states allow.

    ## Why is this bad?

    The door locks nothing. Usually there is another way around it, it bars a place where it is not
    worth going, or the robot cannot come to it without what it needs. A port of MiniGrid's `Unlock`
    had its door in the outer wall, with nothing behind it
    ([rlevo #1020](https://github.com/anthonytorlucci/rlevo/issues/1020)).

    If the door is meant to mislead, suppress the finding:
    `# babyrobot: ignore[door-without-effect]`.

    ## Example

    ```yaml
    version: 1
    size: [4, 2]
    exit: [3, 0]
    doors:
      - {at: [2, 1], side: E, needs: key}
    items:
      - {name: key, at: [0, 1]}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 2]
    exit: [3, 0]
    doors:
      - {at: [2, 0], side: E, length: 2, needs: key}
    items:
      - {name: key, at: [0, 1]}
    ```

    ## Fix safety

    The fix removes the door, also from the drawing. It is unsafe: the best policies stay the same,
    but others may go where the door was.
    """
    level = context.level
    if not level.doors:
        return
    for number, is_avoided in context.necessity.idle_doors.items():
        why = "it is open whenever the robot comes to it"
        if is_avoided:
            why = "the best policies do not pass it, nor would they without a lock"
        yield Finding(
            context.place_of_entry("doors", number),
            f"{_door_text(context, number)} makes no difference: {why}",
            "close the ways around it, make it worthwhile to pass, or remove it",
            fix=door_removal(context.document, level, number, safe=False),
        )


@rule("BR533")
def need_without_effect(context: LintContext) -> Iterator[Finding]:
    """Entry of `needs`, `unless` or `exit_needs` that makes no difference.

    ## What it does

    Checks for names in `needs` and `unless` of doors and in `exit_needs` that can be removed
    without any difference in any episode: whatever the robot does, it never comes to the door or
    the exit in a state in which the name decides. That the best policies meet a need anyway is no
    reason: others may not. The check uses the exact transition tables; no more names are checked
    than 20,000 states allow. The only need of a door is not checked, because the door would always
    be open; see [`door-without-effect`](door-without-effect.md).

    ## Why is this bad?

    The item or switch looks like a condition and is none: the robot cannot get there without it.

    ## Example

    ```yaml
    version: 1
    size: [4, 2]
    exit_needs: [key, gem]
    doors:
      - {at: [2, 0], side: E, length: 2, needs: key}
    items:
      - {name: key, at: [0, 1]}
      - {name: gem, at: [3, 0]}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 2]
    exit_needs: gem
    doors:
      - {at: [2, 0], side: E, length: 2, needs: key}
    items:
      - {name: key, at: [0, 1]}
      - {name: gem, at: [3, 0]}
    ```

    ## Fix safety

    The fix removes the name. It is safe if the tables stay the same, and unsafe if they differ in
    states that no episode comes to.
    """
    level = context.level
    if not level.doors and not level.exit_keys:
        return
    for need in context.necessity.idle_needs:
        route: Route = ("exit_needs",)
        where = "`exit_needs`"
        if need.door is not None:
            route = ("doors", need.door, need.field)
            where = f"`{need.field}` of {_door_text(context, need.door)}"
        met = "with" if need.field == "unless" else "without"
        why, otherwise = (
            f"the robot never comes there {met} it",
            f"let the robot come there {met} it",
        )
        names = context.document.node(route)[0].data
        is_list = isinstance(names, list)
        if is_list and need.name in names[: need.index]:
            why = "it is named twice, and there is one thing of this name"
            otherwise = "name another one: each of several items has a name of its own"
        safe = context.has_same_digest(**need.removed(level.doors, level.exit_keys))
        if is_list:
            route = (*route, need.index)
        yield Finding(
            route if is_list else Key(route),
            f"`{need.name}` in {where} makes no difference: {why}",
            f"remove it, or {otherwise}",
            fix=removal(context.document, f"remove `{need.name}`", route, safe=safe),
        )


@rule("BR534")
def exit_never_opens(context: LintContext) -> Iterator[Finding]:
    """Exit whose needs are never met.

    ## What it does

    Checks for levels in which no episode meets all of `exit_needs`: an item that can never be
    taken, a switch that is never on, or needs that exclude each other. The check uses the exact
    transition tables.

    ## Why is this bad?

    The exit never ends an episode: the level cannot be solved. Some generators make such levels,
    BabyAI's `BossLevel` among them according to
    [BabyAI #113](https://github.com/mila-iqia/babyai/issues/113).

    ## Example

    ```yaml
    version: 1
    size: [4, 1]
    start: [1, 0]
    exit_needs: gem
    walls:
      - {at: [0, 0], side: E}
    items:
      - {name: gem, at: [0, 0]}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 1]
    start: [1, 0]
    exit_needs: gem
    items:
      - {name: gem, at: [0, 0]}
    ```
    """
    level = context.level
    if not level.exits or not level.exit_keys or context.things.exits_open:
        return
    why = _why_unmet(context, level.exit_keys)
    exits = "the exits never open" if len(level.exits) > 1 else "the exit never opens"
    yield Finding(
        Key(("exit_needs",)),
        f"{exits}: {why}",
        f"let the robot get {listed([f'`{name}`' for name in level.exit_keys])}, or remove "
        "`exit_needs`",
    )
