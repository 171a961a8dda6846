"""How results show themselves in notebooks: a picture of the level, and numbers in a table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import singledispatch
from html import escape
from typing import Any

import numpy as np

from babyrobot_levels.analysis.changes import Change
from babyrobot_levels.analysis.diff import Difference, cell_changes, wall_changes
from babyrobot_levels.analysis.learning.results import Sweep, Trials
from babyrobot_levels.analysis.metrics import UNLIMITED, Metrics
from babyrobot_levels.analysis.pictures import overlay_of
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import (
    EpisodeTooLongError,
    Evaluation,
    Solution,
    StateResult,
    UndefinedReturnError,
)
from babyrobot_levels.library.catalogue import LevelInfo, LevelList
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.reading import load_file
from babyrobot_levels.mdp.states import initial_configuration
from babyrobot_levels.render.curves import FAINT, Curve, curves_svg
from babyrobot_levels.render.notebook.bundle import HTML, TEXT, Bundle
from babyrobot_levels.render.notebook.html import (
    Picture,
    beside,
    facts,
    picture_of,
    strip,
    table,
    thumbnail_of,
)
from babyrobot_levels.render.page_data import bare
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.changes import Side, marked
from babyrobot_levels.render.scene.layout import layout_of
from babyrobot_levels.render.words.phrases import with_limit
from babyrobot_levels.text.errors import LevelError

MAX_CELLS = 40_000
"""The largest level of which a result shows a picture."""

MAX_SOLVED = 5_000
"""The most states of a level that is solved only to be shown."""

MAX_THUMBNAILS = 50
"""How many levels of a list are shown as a picture."""

MAX_ROWS = 500
"""How many levels of a list are shown at all."""

MAX_LISTED = 12
"""How many fields that differ are named."""

_WIDTH, _THUMBNAIL, _SMALL = 480.0, 200.0, 72.0
"""The most width of a picture beside a table, of a level's thumbnail, and of those in a list."""


def bundle_of(result: Any) -> Bundle:
    """Return what a notebook shows of a result; its `repr` is shown where HTML cannot be."""
    return {HTML: html_of(result), TEXT: repr(result)}


@singledispatch
def html_of(result: Any) -> str:
    """Return a result as HTML."""
    raise TypeError(f"{type(result).__name__} has no HTML")


# -- values and policies -------------------------------------------------------------------


def state_picture(result: StateResult, extent: tuple[float, float] | None = None) -> Picture | None:
    """Return the picture of a result with arrays over states, None if there can be none.

    Args:
        result: the result.
        extent: the lowest and highest value of all pictures that are to have the same colours.
    """
    level: Level | None = getattr(result, "level", None)
    if level is None or _cells(level) > MAX_CELLS:
        return None
    info = {"values": result, "policy": result if hasattr(result, "policy") else None}
    try:
        overlay = overlay_of(level, info)
    except ValueError:
        # The part of one configuration, but of all headings, fits no picture.
        return None
    assert overlay is not None
    configuration = initial_configuration(level) if level.has_things else None
    if extent is not None:
        overlay = replace(overlay.at(configuration), extent=extent)
    scene = build_scene(bare(level), configuration=configuration, robot=False, overlay=overlay)
    return picture_of(scene)


def extent_of(results: Sequence[StateResult]) -> tuple[float, float] | None:
    """Return the lowest and highest value of some results, without ends; None without any."""
    tables = []
    for values, policy in ((vars(each)["values"], vars(each).get("policy")) for each in results):
        tables.append(values[np.isfinite(values) & (True if policy is None else policy >= 0)])
    found = np.concatenate(tables) if tables else np.zeros(0)
    return (float(found.min()), float(found.max())) if found.size else None


@html_of.register
def _(result: Evaluation) -> str:
    limit = None if result.level is None else result.level.max_steps
    rows = [
        ("Expected return", with_limit(_number(result.expected_return), result.within, limit)),
        ("Expected steps", _number(result.expected_steps)),
        ("Reaches an exit", _share(result.exit_probability)),
        ("Discount", _number(result.discount)),
        ("Actions", result.actions),
    ]
    if result.level is not None and not result.level.exits:
        del rows[2]
    if isinstance(result, Solution):
        rows.append(("Method", f"{result.method}, residual {result.residual:.1g}"))
    text = f"<p>{escape(result.explanation)}</p>" if result.explanation else ""
    return beside(_image(state_picture(result)), facts(rows) + text)


@html_of.register
def _(result: Sweep) -> str:
    run = result.run
    rows = [("Number", f"{result.number:,}"), ("Largest change", f"{result.delta:.2g}")]
    if run is not None:
        rows[0] = (run.unit.title(), rows[0][1])
        rows += [
            ("Return from the start", _number(value))
            for number, value in run.estimates
            if number == result.number
        ]
        rows.append(("Discount", _number(run.discount)))
    rows.append(("Actions", result.actions))
    svg = _curve(result)
    title = "Return of each episode" if isinstance(result, Trials) else "Return from the start"
    curve = Picture(svg.encode(), "image/svg+xml", 460, 260, title) if svg else None
    return beside(_image(state_picture(result)), _image(curve) + facts(rows))


def _curve(result: Sweep) -> str:
    """Return how a run has gone so far: its returns, or its estimates of the start's value."""
    goal = _goal(result)
    if isinstance(result, Trials):
        returns = result.returns
        window = max(1, returns.size // 20)
        means = np.convolve(returns, np.full(window, 1 / window), "valid")
        raw = Curve("each episode", [*enumerate(returns.tolist(), 1)], FAINT, 1.0)
        mean = Curve(f"mean of {window}", [*enumerate(means.tolist(), window)])
        curves = [raw, mean] if window > 1 else [Curve("each episode", raw.points)]
        return curves_svg(curves, goal=goal, x_title="episode", y_title="return")
    if result.run is None:
        return ""
    points = [(number, value) for number, value in result.run.estimates if number <= result.number]
    curves = [Curve("estimate", points)]
    y_title = "return from the start"
    return curves_svg(curves, goal=goal, x_title=result.run.unit, y_title=y_title)


def _goal(result: Sweep) -> tuple[str, float] | None:
    """Return the optimum that learning is compared with; None where that is not known soon."""
    if result.run is None or result.values.size > MAX_SOLVED:
        return None
    try:
        best = solve(result.run.level, result.run.discount, actions=result.actions)
    except (UndefinedReturnError, EpisodeTooLongError):
        return None
    return "optimum", best.expected_return


# -- metrics and levels --------------------------------------------------------------------


@html_of.register
def _(result: Metrics) -> str:
    level = result.level
    states = level.compile().num_states if level.has_things else _cells(level)
    numbers = result.to_dict(solve=states <= MAX_SOLVED)
    texts = {name: _number(value) for name, value in numbers.items()}
    for name in texts.keys() & UNLIMITED:
        texts[name] = with_limit(texts[name], None, level.max_steps)
    rows = [(name.replace("_", " "), text) for name, text in texts.items()]
    return beside(_image(_level_picture(level, _WIDTH)), facts(rows))


@html_of.register
def _(info: LevelInfo) -> str:
    rows = [
        ("Name", info.name),
        ("Title", info.title or ""),
        ("Size", _size(info)),
        ("Tags", ", ".join(info.tags)),
        ("Source", info.source or ""),
        ("From", info.origin),
    ]
    return beside(_thumbnail(info, _THUMBNAIL), facts(rows))


@html_of.register
def _(found: LevelList) -> str:
    rows = [
        (
            _thumbnail(info, _SMALL) if number < MAX_THUMBNAILS else "",
            f"<code>{escape(info.name)}</code>",
            escape(info.title or ""),
            escape(_size(info)),
            escape(", ".join(info.tags)),
            escape(info.origin),
        )
        for number, info in enumerate(found[:MAX_ROWS])
    ]
    more = f"<p>… and {len(found) - MAX_ROWS:,} more</p>" if len(found) > MAX_ROWS else ""
    return table(("", "Name", "Title", "Size", "Tags", "From"), rows) + more


def _thumbnail(info: LevelInfo, width: float) -> str:
    """Return a small picture; nothing of a level that is too large, or that is not there now."""
    if info.size[0] * info.size[1] > MAX_SOLVED:
        return ""
    try:
        level = load_file(info.path)
    except LevelError:
        return ""
    return _image(_level_picture(level, width, small=True))


def _level_picture(level: Level, width: float, *, small: bool = False) -> Picture | None:
    if _cells(level) > MAX_CELLS:
        return None
    if level.has_random_maze:
        level = level.with_maze_seed(0)
    scene = build_scene(bare(level))
    return thumbnail_of(scene, width) if small else picture_of(scene, width)


# -- differences ---------------------------------------------------------------------------


@html_of.register
def _(result: Difference) -> str:
    verdict = "the same MDP" if result.same_game else "another MDP"
    counts = (result.things, result.cells, result.walls, result.transitions)
    names = ("Things", "Cells", "Walls", "Transitions")
    rows = [
        ("Game", verdict),
        ("Fields", _listed(change.name or "" for change in (*result.game, *result.beside))),
        *(
            (name, f"{changes.count:,} of {changes.total:,} differ")
            for name, changes in zip(names, counts, strict=True)
            if changes.total
        ),
        ("Best return", _two(result.best_return)),
        ("Random return", _two(result.random_return)),
    ]
    return "".join(_both(result)) + facts(rows)


def _both(result: Difference) -> Iterator[str]:
    """Yield the pictures of both levels, in which changed cells and walls are marked."""
    if result.levels is None or max(map(_cells, result.levels)) > MAX_CELLS:
        return
    cells = {change.cell for change in cell_changes(*result.levels, None).first if change.cell}
    walls = wall_changes(*result.levels, None).first
    pictures = []
    for number, level in enumerate(map(bare, result.levels)):
        own = {cell for change in result.game for cell in _ends(change, number)}
        sides = [
            Side(change.cell, change.name, (change.before, change.after)[number] != "open")
            for change in walls
            if change.cell and change.name
        ]
        scene = marked(build_scene(level), layout_of(level), sorted(cells | own), sides)
        pictures.append((picture_of(scene, _WIDTH), ("before", "after")[number]))
    yield strip(pictures)
    if walls:
        yield "<p>Walls that differ are marked; where there is none, by dots.</p>"


def _ends(change: Change, number: int) -> Iterator[tuple[int, int]]:
    """Yield the starts or exits that only one of the levels has."""
    if change.name in ("start", "exit"):
        both = (change.before, change.after)
        yield from (tuple(cell) for cell in both[number] if cell not in both[1 - number])


# -- numbers and texts ---------------------------------------------------------------------


def _cells(level: Level) -> int:
    columns, rows = level.size
    return columns * rows


def _size(info: LevelInfo) -> str:
    return f"{info.size[0]} × {info.size[1]}"


def _image(picture: Picture | None) -> str:
    return "" if picture is None else picture.html()


def _listed(names: Iterable[str]) -> str:
    unique = list(dict.fromkeys(names))
    more = [f"and {len(unique) - MAX_LISTED} more"] if len(unique) > MAX_LISTED else []
    return ", ".join(unique[:MAX_LISTED] + more)


def _two(numbers: tuple[float | None, float | None]) -> str:
    return f"{_number(numbers[0])} → {_number(numbers[1])}"


def _share(probability: float) -> str:
    return "–" if math.isnan(probability) else f"{100 * probability:.4g} %"


def _number(value: float | None) -> str:
    """Return a number with at most six digits; a dash where there is none."""
    if value is None or math.isnan(value):
        return "–"
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}".replace("-", "\N{MINUS SIGN}")
