"""What a sheet shows of a level: its picture, grids for values, the optimal return, its rules."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import Any

from babyrobot_levels.analysis.guides import best_average
from babyrobot_levels.analysis.learning.algorithms import value_iteration
from babyrobot_levels.analysis.pictures import dressed, still
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import Solution, UndefinedReturnError
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.states import initial_configuration
from babyrobot_levels.render.helvetica import width_of
from babyrobot_levels.render.page_data import bare
from babyrobot_levels.render.scene.build import floor_shapes
from babyrobot_levels.render.scene.layout import CELL, layout_of
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.panels import SampledRule
from babyrobot_levels.render.scene.shapes import Rect, Scene, Shape, Text, toned
from babyrobot_levels.render.scene.situation import situation_of
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.texts import form_of
from babyrobot_levels.render.scene.things import pieces
from babyrobot_levels.render.words.phrases import with_limit
from babyrobot_levels.render.words.rules import rules_of
from babyrobot_levels.text.diagnostics import one_line

INK = "#000000"

RETURN = "Optimal return:"

_OVER, _NUMBER = "#c4c4c4", 19.0
"""The colour of cells where episodes end, and the largest font size of values, in grids."""

_SWEEP = (
    "sweep of value iteration: each value becomes that of the best action, by the values of the "
    "sweep before; before the first one, all are 0"
)

_LONGEST = 160
"""The most characters of a title."""

_DIGITS = 12
"""The digits of a digest by which a level is found again."""


@dataclass(frozen=True, slots=True)
class SheetContents:
    """What is shown of each level.

    Attributes:
        theme: the theme of its picture.
        values: whether to show optimal values.
        policy: whether to show optimal actions.
        rules: whether to tell the rules.
        grids: the number of grids for the values of sweeps.
        key: whether it is all filled in.
    """

    theme: Any = "print"
    values: bool = False
    policy: bool = False
    rules: bool = True
    grids: int = 0
    key: bool = False


@dataclass(frozen=True, slots=True)
class Entry:
    """A level on a sheet.

    Attributes:
        title: its title.
        mark: its name and the first digits of its digest.
        pictures: its picture, and the grids; each with its caption, which may be empty.
        answer: what is written below; empty for nothing.
        blank: whether there is room to write behind the answer.
        rules: its rules.
    """

    title: str
    mark: str
    pictures: Sequence[tuple[Scene, str]]
    answer: str = ""
    blank: bool = False
    rules: Sequence[SampledRule] = field(default=())


def entry_of(level: Level, shown: SheetContents) -> Entry:
    """Return what a sheet shows of a level.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
    """
    # Rules stand in one box for all levels of a page, and panels have nothing else to say.
    level = bare(dressed(level, theme=shown.theme))
    solution, answer, tells = None, RETURN, shown.values or shown.policy
    if shown.key or tells:
        try:
            solution = solve(level)
            answer = _in_words(level, solution)
        except UndefinedReturnError:
            answer = "No policy has an expected return."
    picture = still(
        level,
        values=solution if shown.values or shown.key else None,
        policy=solution if shown.policy or shown.key else None,
    )
    name = "" if level.name is None else f"{one_line(level.name)}  "
    return Entry(
        title=one_line(level.title or level.name or "Level")[:_LONGEST],
        mark=f"{name}{level.digest[: len('sha256:') + _DIGITS]}",
        pictures=[(picture, ""), *_grids(level, shown)],
        answer="" if solution is not None and not shown.key else answer,
        blank=not (shown.key or tells),
        rules=[*_rules(level, shown)] if shown.rules else (),
    )


def _in_words(level: Level, solution: Solution) -> str:
    """Return the optimal return: first within the time limit, if that makes a difference."""
    is_finite, limit = math.isfinite(solution.expected_return), level.max_steps
    figure = f"{solution.expected_return:.4g}" if is_finite else "infinite"
    within = f"{best_average(level, solution):.4g}" if limit is not None else figure
    text = f"{RETURN} {figure}"
    if within == "nan":
        text = f"{RETURN} {with_limit(figure, None, limit)}"
    elif within != figure:
        text = f"{RETURN} {with_limit(within, limit, limit)}; {with_limit(figure, None, limit)}"
    if not is_finite:
        where = "rewards" if solution.expected_return > 0 else "costs"
        return f"{text}, because {where} add up without bound"
    if math.isfinite(solution.expected_steps):
        text += f", in {solution.expected_steps:.4g} steps on average"
    else:
        text += "; episodes go on for ever"
    if solution.exit_probability < 0.9995 and level.exits:
        text += f"; the exit is reached {100 * solution.exit_probability:.3g} % of the time"
    return text


def _rules(level: Level, shown: SheetContents) -> Iterator[SampledRule]:
    if shown.grids:
        yield SampledRule(level, "", _SWEEP)
    for rule in rules_of(level):
        yield SampledRule(level, rule.sample, rule.text)


# -- grids -----------------------------------------------------------------------------------


def _grids(level: Level, shown: SheetContents) -> Iterator[tuple[Scene, str]]:
    """Yield the grids for the values of sweeps of value iteration, in a key with these values."""
    sweeps: list[Any] = []
    if shown.key and shown.grids:
        sweeps = list(islice(value_iteration(level, max_sweeps=shown.grids), 1, None))
    for number in range(1, shown.grids + 1):
        # Where nothing changes any more, there is no further sweep.
        values = sweeps[min(number, len(sweeps)) - 1].values if sweeps else None
        yield _grid(level, values), f"Sweep {number}"


def _grid(level: Level, values: Any) -> Scene:
    """Return the cells and walls of a level, with room for a value in each cell where it goes on.

    Whatever the theme of pictures is, it is on white.

    Args:
        level: the level.
        values: values as in results; None for room to write.
    """
    level = dressed(level, theme="print")
    colors, layout, mdp = level.resolved_theme.colors, layout_of(level), level.compile()
    layout = replace(layout, strip=0.0)
    over: Any = mdp.is_terminal.reshape(mdp.shape)
    ends = over.reshape(-1, *level.size[::-1]).all(axis=0)
    if level.has_things:
        # Some cells are never entered with nothing held, but episodes do not end there.
        number = initial_configuration(level)
        values, over = None if values is None else values[number], over[number]
    shapes: list[Shape] = [Rect(0, 0, layout.width, layout.height, colors.base)]
    found: dict[tuple[int, int], float] = {}
    for x, y in layout.cells():
        is_blocked = level.grid().blocked_cells[y * layout.columns + x]
        if is_blocked or ends[y, x]:
            fill = colors.blocked if is_blocked else _OVER
            shapes.append(Rect(*layout.corner(x, y), CELL, CELL, fill))
        elif values is not None and not (over[y, x] or math.isnan(values[y, x])):
            found[x, y] = float(values[y, x])
    for word, cells in (("START", level.starts), ("EXIT", level.exits)):
        for cell in cells:
            left, top = layout.corner(*cell)
            shapes.append(Text(left + 5, top + 13, word, 10, INK, "start", bold=True))
    form = form_of(found.values(), 2, CELL)
    longest = max((width_of(form.text(value), 1) for value in found.values()), default=1.0)
    size = min(_NUMBER, (CELL - 8) / longest)
    for cell, value in found.items():
        across, down = layout.corner(cell[0] + 0.5, cell[1] + 0.5)
        shapes.append(Text(across, down + 0.5 * size, form.text(value), size, INK))
    shapes += floor_shapes(level, layout, Slots(level, layout, Overlay()))
    for piece in pieces(level, layout, situation_of(level, None)):
        shapes += piece.shapes if piece.name[0] == "door" else ()
    return Scene(layout.width, layout.height, toned(shapes, colors))
