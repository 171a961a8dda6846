"""Rules about what moves the robot besides its actions: warps and wind."""

from collections.abc import Iterator

from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.fields import as_cells
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding
from babyrobot_levels.linter.fixes import removal
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.text.diagnostics import Key


@rule("BR505")
def warp_onto_itself(context: LintContext) -> Iterator[Finding]:
    """Warp that always leads back to its own cell.

    ## What it does

    Checks for warps that act on leaving (`when: leave`) and after which every move ends on the
    warp's own cell. The check uses the exact transition tables, so that warps that lead to other
    warps or to the start are followed.

    ## Why is this bad?

    The robot stays there forever. If that is intended, the episode should end there; otherwise it
    continues until it is truncated.

    ## Example

    ```yaml
    version: 1
    size: [4, 4]
    warps:
      - {at: [1, 2], to: [1, 2], when: leave}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 4]
    areas:
      - {at: [1, 2], ends: true, reward: -20}
    ```
    """
    mdp = context.mdp
    for number, warp in enumerate(context.level.warps):
        cell = context.state(warp.at)
        on_cell = slice(cell, None, mdp.cells)
        goes_on = ~mdp.is_terminal[on_cell]
        if warp.when != "leave" or not goes_on.any():
            continue
        happens = mdp.probability[on_cell][goes_on, 1:] > 0
        targets = mdp.next_state[on_cell][goes_on, 1:][happens] % mdp.cells
        if (targets == cell).all():
            x, y = warp.at
            yield Finding(
                ("warps", number),
                f"the warp on [{x}, {y}] always leads back to [{x}, {y}]",
                "change its target, or end the episode there with an area that has `ends: true`",
            )


@rule("BR518")
def warp_without_effect(context: LintContext) -> Iterator[Finding]:
    """Warp that never acts.

    ## What it does

    Checks for warps that act on leaving on a cell where the episode ends, and for warps that act
    on entering on a cell where no move ends.

    ## Why is this bad?

    The picture shows an arrow that the robot never follows. Usually the warp is on the wrong cell,
    or `when` has the wrong value.

    ## Example

    ```yaml
    version: 1
    areas:
      - {at: [1, 1], reward: -5, ends: true}
    warps:
      - {at: [1, 1], to: start, when: leave}
    ```

    Use instead:

    ```yaml
    version: 1
    warps:
      - {at: [1, 1], to: start, when: enter, reward: -5}
    ```

    ## Fix safety

    The fix removes the warp, also from the picture. It is safe if the transition tables stay the
    same, and unsafe if they contain transitions of states that are never reached and that the warp
    changes.
    """
    level = context.level
    if not level.warps:
        return
    suspects = _possibly_idle(context)
    if not suspects:
        return
    import numpy as np

    from babyrobot_levels.linter.variants import (
        has_equal_outcomes,
        is_equivalent,
        max_variants,
        variant,
    )

    stood = np.flatnonzero(np.frombuffer(context.reach.on, np.uint8))
    rest = level.warps
    for number in suspects[-max_variants(level) :][::-1]:
        without = (*rest[:number], *rest[number + 1 :])
        mdp, enters = variant(level, warps=without), level.warps[number].when == "enter"
        if mdp is None:
            continue
        safe = is_equivalent(level, mdp)
        if safe or (enters and has_equal_outcomes(context.mdp, mdp, stood)):
            rest = without if safe else rest
            x, y = level.warps[number].at
            reason = "the episode ends there"
            if enters:
                reason = "no move ends there"
            elif level.has_things and not context.reached_cells[context.state((x, y))]:
                reason = "no episode comes there"
            yield Finding(
                ("warps", number),
                f"the warp on [{x}, {y}] never acts",
                reason,
                fix=removal(context.document, "remove the warp", ("warps", number), safe=safe),
            )


def _possibly_idle(context: LintContext) -> list[int]:
    """Return the warps that may have no effect, without compiling variants."""
    level = context.level
    if level.wind is not None or level.has_things:
        return [*range(len(level.warps))]
    enters = any(warp.when == "enter" for warp in level.warps)
    left = {context.state(warp.at) for warp in level.warps if warp.when == "leave"}
    starts = {*level.starts}
    found = []
    for number, warp in enumerate(level.warps):
        state = context.state(warp.at)
        if warp.when == "leave":
            # Without the warp, moves lead to several cells or stay on this one.
            home = warp.at in (starts if isinstance(warp.to, str) else as_cells(warp.to))
            home = home or warp.probability < 1
            acts = not (enters or home or context.mdp.is_terminal[state])
        else:
            acts = any(
                context.reach.on[other] and other not in left for other in context.neighbours(state)
            )
        if not acts:
            found.append(number)
    return found


@rule("BR519")
def wind_without_effect(context: LintContext) -> Iterator[Finding]:
    """Wind that never moves the robot.

    ## What it does

    Checks for wind whose strengths are all 0 or cancel each other, or which only blows against
    walls; and for single directions of the wind whose strengths are all 0.

    ## Why is this bad?

    The field has no effect. Usually the strengths are given for the wrong columns or rows.

    ## Example

    ```yaml
    version: 1
    wind: {north: [0, 0, 0]}
    ```

    Use instead:

    ```yaml
    version: 1
    wind: {north: [0, 1, 0]}
    ```

    ## Fix safety

    The fix removes the field, or the direction whose strengths are all 0. It is safe: the
    transition tables stay the same.
    """
    level, wind = context.level, context.level.wind
    if wind is None:
        return
    from babyrobot_levels.linter.variants import is_equivalent, variant

    if is_equivalent(level, variant(level, wind=None)):
        yield Finding(
            Key(("wind",)),
            "the wind has no effect",
            "remove it, or let it blow where the robot can move",
            fix=removal(context.document, "remove the wind", ("wind",)),
        )
        return
    for side in sorted(wind.model_fields_set & {*SIDE_NAMES}):
        if not any(getattr(wind, side) or ()):
            yield Finding(
                Key(("wind", side)),
                f"all strengths of `{side}` are 0",
                "remove the direction",
                fix=removal(context.document, f"remove `{side}`", ("wind", side)),
            )
