"""What the page of a level shows of its solution: a picture, returns, and figures in print."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from babyrobot_levels.language.kinds import THINGS
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.states import initial_configuration
from babyrobot_levels.publish.facts import Facts
from babyrobot_levels.publish.published import Comparison, comparisons
from babyrobot_levels.render.page_data import Guide, bare, rounded
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.svg import to_svg
from babyrobot_levels.render.words.phrases import with_limit

MOST_CELLS = 256
"""The most cells of a level whose values are on the page as a table, too."""


LARGE_CELL = 96
"""The width of a cell of the picture in pixels, where there is room."""


def values_svg(level: Level, guide: Guide) -> str:
    """Return the picture of a level with its optimal values and actions, where episodes begin."""
    start = _start(level)
    scene = build_scene(
        bare(level), configuration=start, robot=False, overlay=guide.overlay.at(start)
    )
    return to_svg(scene)


def _start(level: Level) -> int | None:
    """Return the configuration in which episodes begin; None without things."""
    return initial_configuration(level) if level.has_things else None


def shown_values(facts: Facts, guide: Guide | None) -> Iterator[tuple[str, str]]:
    """Yield what is known about the returns and steps of policies, each with its name."""
    name, limit = "Optimal return", facts.max_steps
    best = None if facts.best_return is None else rounded(facts.best_return)
    if guide and limit is not None and not math.isnan(guide.expected_return):
        within = rounded(guide.expected_return)
        if best != within:
            yield with_limit(name, limit, limit), within
            name = with_limit(name, None, limit)
    if best is not None:
        yield name, best
    if facts.best_steps is not None:
        yield "Steps of the optimal policy", rounded(facts.best_steps)
    if facts.random_return is not None:
        yield "Return of random actions", rounded(facts.random_return)


def solved_values(level: Level, facts: Facts, guide: Guide) -> dict[str, Any]:
    """Return what the tab of values tells.

    Args:
        level: the level; a maze has its seed.
        facts: its facts.
        guide: its solution.
    """
    return {
        "width": LARGE_CELL * level.size[0],
        "within": with_limit("from there", None, facts.max_steps),
        "changing": [kind.state for kind in THINGS if kind.field in facts.things],
        "returns": list(shown_values(facts, guide)),
        "figures": list(map(_figure, comparisons(level))),
        "table": _table(level, guide),
    }


def _table(level: Level, guide: Guide) -> list[list[tuple[str, str]]]:
    """Return the values as the cells of a table; none if it would be too large."""
    values = guide.overlay.at(_start(level)).values
    if values is None or math.prod(level.size) > MOST_CELLS:
        return []
    return [
        [("" if value is None or math.isnan(value) else rounded(value), "") for value in row]
        for row in values
    ]


def _figure(comparison: Comparison) -> dict[str, Any]:
    """Return a figure in print beside what is computed: a single number, or a table."""
    figure, decimals = comparison.figure, comparison.figure.decimals
    difference = _fixed(comparison.difference, decimals + 2)
    rows = [
        [
            ("", "") if value is None or other is None
            else (_fixed(value, decimals), _fixed(other, decimals + 2))
            for value, other in zip(row, computed, strict=True)
        ]
        for row, computed in zip(figure.printed, comparison.computed, strict=True)
    ]  # fmt: skip
    printed, computed = rows[0][0]
    single = (("In print", printed), ("Computed", computed), ("Difference", difference))
    return {
        "what": figure.what,
        "source": figure.source,
        "difference": difference,
        "agrees": comparison.agrees,
        "rows": rows,
        "single": single if len(rows) == len(rows[0]) == 1 else None,
    }


def _fixed(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    return ("0" if float(text) == 0 else text).replace("-", "\N{MINUS SIGN}")
