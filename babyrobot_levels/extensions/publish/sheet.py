"""Hand-outs: levels on pages for print, as PDF, HTML or PNG, and the teacher's copy of them."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

from babyrobot_levels.analysis.endings import ending_of
from babyrobot_levels.analysis.guides import best_average
from babyrobot_levels.analysis.pictures import dressed, still
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import Solution, UndefinedReturnError, check_count
from babyrobot_levels.extensions.learning.algorithms import value_iteration
from babyrobot_levels.extensions.publish.sheet_pages import INK, Entry, PageStyle, pages_of
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.states import initial_configuration, shown_configurations
from babyrobot_levels.registry.later import Shown as ShownInNotebook
from babyrobot_levels.render.notebook.html import picture_of, strip
from babyrobot_levels.render.page import bare
from babyrobot_levels.render.pdf import to_pdf, width_of
from babyrobot_levels.render.raster import to_png
from babyrobot_levels.render.scene.build import floor_shapes
from babyrobot_levels.render.scene.layout import CELL, Overlay, layout_of
from babyrobot_levels.render.scene.panels import SampledRule
from babyrobot_levels.render.scene.shapes import Rect, Scene, Shape, Text, toned
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.texts import form_of
from babyrobot_levels.render.scene.things import pieces
from babyrobot_levels.render.situation import situation_of
from babyrobot_levels.render.svg import number, to_svg
from babyrobot_levels.render.templates import as_html, html
from babyrobot_levels.render.words.phrases import with_limit
from babyrobot_levels.render.words.rules import rules_of
from babyrobot_levels.suites.suite import Levels, named_levels
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.files import write_bytes
from babyrobot_levels.text.words import check_choice

TITLE = "Exercise sheet"

PAPERS = {"a4": (210.0, 297.0), "letter": (215.9, 279.4)}
"""The papers, with width and height in millimetres."""

KINDS = ("pdf", "html", "png")
"""The formats of files in which a sheet is saved."""

MAX_LEVELS = 500
MAX_PER_PAGE = 24
MAX_GRIDS = 11
MAX_LINES = 24
MAX_SETS, MAX_WITH_SETS = 4, 9
"""The most sets of held things of which a key has a picture of a level, and of levels then."""

MAX_CELLS = 10_000
"""The largest level of which a sheet has a picture."""

_PER_PAGE, _WITH_GRIDS = 4, 3
"""The number of levels on a page, if it is not given."""

_INCH = 25.4
_PIXELS = 96 / _INCH
"""Pixels of scenes per millimetre."""

_DPI = 150
"""Pixels per inch of PNG files."""


def sheet(
    levels: Levels,
    *,
    title: str | None = None,
    per_page: int | None = None,
    paper: str = "a4",
    landscape: bool = False,
    theme: Any = "print",
    values: bool = False,
    policy: bool = False,
    rules: bool = True,
    grids: int = 0,
    lines: int = 0,
    key: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Sheet:
    """Return levels on pages for print, which show themselves in notebooks.

    Args:
        levels: a level, a folder, a pack or a suite: a name, a path, a mapping, a `Level` or a
            `Suite`; or several levels. Mazes need a seed.
        title: the title of the sheet; "Exercise sheet" by default.
        per_page: the number of levels on a page; by default 4, with `grids` 3.
        paper: `"a4"` or `"letter"`.
        landscape: whether pages are wider than high.
        theme: the theme of the pictures; `"print"` has greys only, None is each level's own.
        values: whether to show the optimal values of cells.
        policy: whether to show optimal actions.
        rules: whether to tell on each page what its levels do, pay and cost.
        grids: the number of empty grids beside each level into which values of the sweeps of value
            iteration are written.
        lines: the number of lines to write on below each level, as far as there is room; a key has
            none.
        key: whether it is the teacher's copy: with values, actions, the optimal return, and grids
            that are filled in.
        progress: told of the levels that are drawn: how many of how many.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid, its maze has no seed yet, or there is no such theme.
        ValueError: there are no levels, or more than 500; one has more than 10,000 cells; or
            another argument has an invalid value.
    """
    check_choice("paper", paper, PAPERS)
    size = PAPERS[paper][::-1] if landscape else PAPERS[paper]
    check_count("per_page", 1 if per_page is None else per_page, 1, MAX_PER_PAGE)
    check_count("grids", grids, 0, MAX_GRIDS)
    check_count("lines", lines, 0, MAX_LINES)
    found = list(islice(named_levels(levels), MAX_LEVELS + 1))
    if not found:
        raise ValueError("a sheet needs at least one level")
    if len(found) > MAX_LEVELS:
        raise ValueError(f"a sheet has at most {MAX_LEVELS} levels")
    # On a page of many levels, there is room for one picture each.
    sets = MAX_SETS if key and (per_page or 1) <= MAX_WITH_SETS else 1
    shown = SheetContents(theme, values, policy, rules, grids, key, sets, lines)
    entries: list[Entry] = []
    for each in found:
        entries.append(entry_of(load(each), shown))
        if progress is not None:
            progress(len(entries), len(found))
    style = PageStyle(
        " ".join(one_line(title or TITLE).split())[:200],
        size[0] * _PIXELS,
        size[1] * _PIXELS,
        per_page or (_WITH_GRIDS if grids else _PER_PAGE),
        key,
    )
    return Sheet(tuple(pages_of(entries, style)), style.title)


@dataclass(frozen=True, eq=False, repr=False)
class Sheet(ShownInNotebook, public=True):
    """Levels on pages for print.

    Attributes:
        pages: the pages as scenes, whose pixels are 1/96 inch.
        title: the title.
    """

    pages: tuple[Scene, ...]
    title: str

    def _html(self) -> str:
        return strip([(picture_of(page, 480), "") for page in self.pages], None)

    def __repr__(self) -> str:
        return f"<Sheet {self.title!r} of {len(self.pages)} page{'s' * (len(self.pages) > 1)}>"

    def to_pdf(self) -> bytes:
        """Return the sheet as a PDF file: the same bytes for the same levels."""
        return to_pdf(self.pages, title=self.title)

    def to_html(self) -> str:
        """Return the sheet as an HTML document, which prints page by page."""
        width, height = (side / _PIXELS for side in (self.pages[0].width, self.pages[0].height))
        return html(
            "extensions/publish/static/sheet.html",
            title=self.title,
            width=number(width),
            height=number(height),
            pages=(as_html(to_svg(page)) for page in self.pages),
        )

    def to_png(self, page: int = 0) -> bytes:
        """Return a page as a PNG file of 150 pixels per inch.

        Args:
            page: its number, counted from 0.

        Raises:
            IndexError: there is no such page.
        """
        scene = self.pages[page]
        return to_png(scene, (round(scene.width * _DPI / 96), round(scene.height * _DPI / 96)))

    def files(self, path: str | os.PathLike[str], kind: str) -> dict[Path, Callable[[], bytes]]:
        """Return the files in which the sheet is saved, each with a function that makes it.

        Args:
            path: where. Several pages are several PNG files, as in `save`.
            kind: `"pdf"`, `"html"` or `"png"`.
        """
        path = Path(path)
        if kind == "pdf":
            return {path: self.to_pdf}
        if kind == "html":
            return {path: lambda: self.to_html().encode("utf-8")}
        numbers = range(len(self.pages))
        names = [path.with_stem(f"{path.stem}-{each + 1}") for each in numbers]
        return {
            name: partial(self.to_png, each)
            for each, name in zip(numbers, names if len(names) > 1 else [path], strict=True)
        }

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the sheet to a file, atomically; an existing one is replaced.

        Args:
            path: a `.pdf`, `.html` or `.png` file. Several pages are several PNG files:
                `sheet-1.png`, `sheet-2.png` and so on.

        Raises:
            ValueError: it has another suffix.
        """
        kind = Path(path).suffix.lower().removeprefix(".")
        check_choice("the suffix", kind, KINDS)
        for file, made in self.files(path, kind).items():
            write_bytes(file, made())


# -- what is shown of a level ----------------------------------------------------------------------

RETURN = "Optimal return:"

_OVER, _NUMBER = "#c4c4c4", 19.0
"""The colour of cells where episodes end, and the largest font size of values, in grids."""

_SWEEP = (
    "sweep of value iteration: each value becomes that of the best action, by the values of the "
    "sweep before; before the first one, all are 0"
)

_LONGEST = 160
"""The most characters of a title."""

_MOST_TEXT = 2000
"""The most characters of a description: more than have room."""

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
        sets: the most sets of held things of which there are answers.
        lines: the number of lines to write on.
    """

    theme: Any = "print"
    values: bool = False
    policy: bool = False
    rules: bool = True
    grids: int = 0
    key: bool = False
    sets: int = 1
    lines: int = 0


def entry_of(level: Level, shown: SheetContents) -> Entry:
    """Return what a sheet shows of a level.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
        ValueError: it is too large.
    """
    if (cells := math.prod(level.size)) > MAX_CELLS:
        raise ValueError(
            f"{level.name or 'a level'} has {cells:,} cells; "
            f"a sheet shows levels of at most {MAX_CELLS:,}"
        )
    # Rules stand in one box for all levels of a page, and panels have nothing else to say.
    level = bare(dressed(level, theme=shown.theme))
    solution, answer, tells = None, RETURN, shown.values or shown.policy
    if shown.key or tells:
        try:
            solution = solve(level)
            answer = _in_words(level, solution)
        except UndefinedReturnError:
            answer = "No policy has an expected return."
    pictures, left_out = _pictures(level, shown, solution)
    if left_out and shown.sets > 1:
        answer += f"; {left_out} other sets of held things are left out"
    name = "" if level.name is None else f"{one_line(level.name)}  "
    return Entry(
        title=one_line(level.title or level.name or "Level")[:_LONGEST],
        mark=f"{name}{level.digest[: len('sha256:') + _DIGITS]}",
        pictures=[*pictures, *_grids(level, shown)],
        answer="" if solution is not None and not shown.key else answer,
        blank=not (shown.key or tells),
        rules=[*_rules(level, shown)] if shown.rules else (),
        text=one_line(" ".join((level.description or "").split()))[:_MOST_TEXT],
        lines=0 if shown.key else shown.lines,
    )


def _pictures(
    level: Level, shown: SheetContents, solution: Solution | None
) -> tuple[list[tuple[Scene, str]], int]:
    """Return the pictures with their headings: of a key, one for each set of held things."""
    values, policy = (
        solution if each or shown.key else None for each in (shown.values, shown.policy)
    )
    if solution is None or not level.has_things:
        return [(still(level, values=values, policy=policy), "")], 0
    found, left_out = shown_configurations(level, shown.sets)
    pictures: list[tuple[Scene, str]] = []
    for words, at in found.items():
        held = level.things().met(level.compile().configurations[at].tolist())
        # Without a choice, it is the configuration in which episodes begin.
        picture = still(level, values=values, policy=policy, held=held if pictures else None)
        pictures.append((picture, f"With {words}" if len(found) > 1 else ""))
    return pictures, left_out


def _in_words(level: Level, solution: Solution) -> str:
    """Return the optimal return: first within the time limit, if that makes a difference."""
    is_finite, limit = math.isfinite(solution.expected_return), level.max_steps
    figure = _figure(solution.expected_return) if is_finite else "infinite"
    within = _figure(best_average(level, solution)) if limit is not None else figure
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
    ending = ending_of(solution)
    return text if ending is None else f"{text}; it {ending.told}"


def _figure(value: float) -> str:
    return f"{value:.4g}".replace("-", "\N{MINUS SIGN}")


def _rules(level: Level, shown: SheetContents) -> Iterator[SampledRule]:
    if shown.grids:
        yield SampledRule(level, "", _SWEEP)
    if level.things().needed and (shown.key or shown.values or shown.policy):
        start = "answers are those where episodes begin; " if shown.sets == 1 else ""
        text = f"{start}hatched: the robot cannot be there with what is held then"
        yield SampledRule(level, "", text)
    for rule in rules_of(level):
        yield SampledRule(level, rule.sample, rule.text)


# -- grids -----------------------------------------------------------------------------------


def _grids(level: Level, shown: SheetContents) -> Iterator[tuple[Scene, str]]:
    """Yield the grids for the values of sweeps of value iteration, in a key with these values."""
    sweeps: list[Any] = []
    if shown.key and shown.grids:
        sweeps = list(islice(value_iteration(level, max_sweeps=shown.grids), 1, None))
    for sweep in range(1, shown.grids + 1):
        # Where nothing changes any more, there is no further sweep.
        values = sweeps[min(sweep, len(sweeps)) - 1].values if sweeps else None
        yield _grid(level, values), f"Sweep {sweep}"


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
    longest = max((width_of(form.drawn(value), 1) for value in found.values()), default=1.0)
    size = min(_NUMBER, (CELL - 8) / longest)
    for cell, value in found.items():
        across, down = layout.corner(cell[0] + 0.5, cell[1] + 0.5)
        shapes.append(Text(across, down + 0.5 * size, form.drawn(value), size, INK))
    shapes += floor_shapes(level, layout, Slots(level, layout, Overlay()))
    for piece in pieces(level, layout, situation_of(level, None)):
        shapes += piece.shapes if piece.name[0] == "door" else ()
    return Scene(layout.width, layout.height, toned(shapes, colors))
