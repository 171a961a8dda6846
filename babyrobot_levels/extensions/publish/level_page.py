"""The page of a level in a gallery: its parts as tabs, its facts, and its files."""

from __future__ import annotations

import math
import posixpath
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from babyrobot_levels.extensions.publish.facts import Facts
from babyrobot_levels.extensions.publish.published import Comparison, comparisons
from babyrobot_levels.language.kinds import THINGS
from babyrobot_levels.language.play import program
from babyrobot_levels.library.catalogue import files_in
from babyrobot_levels.library.citation import bibtex, citation
from babyrobot_levels.library.level import Level, load_file
from babyrobot_levels.library.search_path import Place, gallery_place
from babyrobot_levels.mdp.states import (
    configuration_words,
    initial_configuration,
    shown_configurations,
)
from babyrobot_levels.render.page import Guide, bare, page_data
from babyrobot_levels.render.page_format import TooLargeError, rounded
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.svg import escaped, number, to_svg
from babyrobot_levels.render.templates import as_html, embedded_json, html
from babyrobot_levels.render.words.describe import describe
from babyrobot_levels.render.words.phrases import with_limit
from babyrobot_levels.text.errors import BabyRobotError, LevelError

if TYPE_CHECKING:
    from markupsafe import Markup

MAX_SHOWN = 100_000
"""The most characters of a level's text on its page."""

_NEIGHBOURS = "<!--neighbours-->"
"""Stands in a page until its neighbours are known."""


def level_html(
    level: Level,
    facts: Facts,
    *,
    text: str,
    guide: Guide | None,
    answers: bool,
    key: bool,
    title: str,
    sizes: Mapping[str, int],
    editor: str | None = None,
) -> str:
    """Return the page of a level, without links to its neighbours: see `with_neighbours`.

    Args:
        level: the level; a maze has its seed.
        facts: its facts.
        text: the text of its file.
        guide: what the page shows of its solution; None without one, or without answers.
        answers: whether the gallery knows the answers.
        key: whether it is the teacher's copy, which shows the answers from the start.
        title: the title of the gallery.
        editor: the address of a site of the editor, from the gallery's folder; None for none.
        sizes: the numbers of bytes of its files.
    """
    data, reason = _played(level, guide, key=key)
    tabs = {"play": "Play", "yaml": "YAML", "python": "Python", "cite": "Cite"}
    solved = None
    if guide is not None and facts.files.values is not None:
        solved = solved_values(level, facts, guide)
        tabs = {"values": "Values", **tabs} if key else {"play": "Play", "values": "Values", **tabs}
    return html(
        "extensions/publish/static/level.html",
        facts=facts,
        gallery=title,
        key=key,
        neighbours=as_html(_NEIGHBOURS),
        relative=partial(_relative, facts),
        alt=describe(level),
        data=None if data is None else embedded_json(data),
        reason=reason,
        solved=solved,
        yaml_text=yaml_html(text[:MAX_SHOWN]),
        length=len(text),
        most=MAX_SHOWN,
        is_in_package=load_name(facts) == facts.name,
        programs=list(map(python_html, programs(facts, answers=answers))),
        citation=citation(level, facts.name),
        bibtex=bibtex(level, facts.name),
        share_code=_share_code(level),
        editor=None if editor is None else _from_page(facts, editor),
        tabs=tabs,
        told=_facts(facts, guide),
        files=_downloads(facts, sizes),
        made_by=program(),
    )


def with_neighbours(page: str, previous: Facts | None, following: Facts | None) -> str:
    """Return a page with links to the levels before and after it, None where there is none."""
    nav = ""
    if previous is not None or following is not None:
        nav = html(
            "extensions/publish/static/neighbours.html", previous=previous, following=following
        )
    return page.replace(_NEIGHBOURS, nav, 1)


def _played(level: Level, guide: Guide | None, *, key: bool) -> tuple[dict[str, Any] | None, str]:
    """Return what the game plays, or why there is none."""
    try:
        data = page_data(level, guide=guide, values=key, arrows=key)
    except TooLargeError as error:
        return None, str(error)
    if code := _share_code(level):
        data["code"] = code
    return data, ""


def _share_code(level: Level) -> str | None:
    """Return the code of a level; None for one that is too large."""
    try:
        return level.share_code()
    except LevelError:
        return None


def programs(facts: Facts, *, answers: bool) -> tuple[str, str]:
    """Return a program that loads the level, and one that trains an agent in it."""
    named = load_name(facts)
    given = {"named": as_html(named), "in_package": named == facts.name, "answers": answers}
    programs = (f"extensions/publish/static/{name}.py.jinja" for name in ("play", "train"))
    load, train = (html(program, **given) for program in programs)
    return load.rstrip(), train.rstrip()


def load_name(facts: Facts) -> str:
    """Return what `brl.load` takes: a name of the package's gallery, else that of the file."""
    if (path := _levels_in(gallery_place()).get(facts.name)) is not None:
        with suppress(BabyRobotError):
            if load_file(path).digest == facts.digest:
                return facts.name
    return f"{facts.id}.yaml"


@cache
def _levels_in(place: Place) -> dict[str, Path]:
    return {file.name: file.path for file in files_in(place)}


def _facts(facts: Facts, guide: Guide | None) -> Iterator[tuple[str, str]]:
    """Yield the facts of a level that are known, each with its name."""
    width, height = facts.size
    yield "Size", f"{width} × {height}"
    yield "States", f"{facts.states:,}"
    yield "Time limit", "none" if facts.max_steps is None else f"{facts.max_steps:,} steps"
    yield "Discount", f"{facts.discount:g}"
    yield "Deterministic", "yes" if facts.deterministic else "no"
    yield from shown_values(facts, guide)
    if facts.ending:
        yield "Ending", facts.ending
    if facts.difficulty is not None:
        yield "Difficulty", rounded(facts.difficulty)
    yield from _hardness(facts)
    if contents := (*facts.things, *facts.features):
        yield "Contains", ", ".join(contents)
    if facts.tags:
        yield "Tags", ", ".join(facts.tags)
    if facts.split:
        yield "Split", facts.split
    if facts.name:
        yield "Name", facts.name
    yield "Digest", facts.digest


def _hardness(facts: Facts) -> Iterator[tuple[str, str]]:
    """Yield why a level is hard, each reason with its name."""
    for name, value in facts.hardness.items():
        if value and name != "success":
            told = ", ".join(value) if isinstance(value, tuple) else f"{value:.3g}"
            yield name.capitalize(), told


def _downloads(facts: Facts, sizes: Mapping[str, int]) -> Iterator[tuple[str, str, str, str]]:
    """Yield the files of a level: what each is, its path, the suffix of its name, and its size."""
    files = facts.files
    for label, path, suffix in (
        ("YAML", files.level, "yaml"),
        ("SVG", files.svg, "svg"),
        ("SVG with values", files.values, "values.svg"),
        ("PNG", files.png, "png"),
        ("GIF", files.film, "gif"),
    ):
        if path is not None:
            yield label, path, suffix, _size(sizes[path])


def _size(size: int) -> str:
    for unit in ("bytes", "KB", "MB"):
        if size < 1000 or unit == "MB":
            break
        size = size / 1000  # type: ignore[assignment]
    return f"{number(round(size, 1))} {unit}"


def _relative(facts: Facts, path: str) -> str:
    """Return the path of a file of the gallery as it is seen from the page of a level."""
    return posixpath.relpath(path, posixpath.dirname(facts.files.page))


def _from_page(facts: Facts, address: str) -> str:
    """Return an address that is given from the gallery's folder as the page of a level needs it."""
    if urlsplit(address).scheme or address.startswith("/"):
        return address
    return _relative(facts, address) + ("/" * address.endswith("/"))


# -- YAML and Python as HTML -----------------------------------------------------------------------

_STRINGS = r'"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\n]|\'\')*\''
_NUMBER = r"[-+]?(?:\d[\d_]*(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?(?![\w.-])"

_YAML = re.compile(
    rf"""
    (?P<comment>(?:^|(?<=[ \t]))\#.*)
    | (?P<key>(?:{_STRINGS}|[\w$][\w$.\ -]*?)(?=[ \t]*:(?:[ \t]|$)))
    | (?P<text>{_STRINGS})
    | (?P<mark>[&*!][\w!/.-]+)
    | (?P<number>(?<![\w.-]){_NUMBER})
    | (?P<word>\b(?:true|false|null)\b)
    | [\w.-]+
    """,
    re.VERBOSE,
)

_BLOCK = re.compile(r"(?:^|[:\-])[ \t]*[|>][-+1-9]*[ \t]*(?:#.*)?$")
"""The end of a line after which the text of a block follows."""

_PYTHON = re.compile(
    rf"""
    (?P<comment>\#.*)
    | (?P<text>{_STRINGS})
    | (?P<number>(?<!\w){_NUMBER})
    | (?P<word>\b(?:import|as|from|for|in|while|not|and|or|if|else|True|False|None)\b)
    | \w+
    """,
    re.VERBOSE,
)


def yaml_html(text: str) -> Markup:
    """Return a YAML text as HTML."""
    return as_html("\n".join(_yaml_lines(text)))


def python_html(text: str) -> Markup:
    """Return a Python text, whose strings end on their lines, as HTML."""
    return as_html("\n".join(_line(line, _PYTHON) for line in text.split("\n")))


def _yaml_lines(text: str) -> Iterator[str]:
    """Yield the lines of a YAML text; those of a block are a text, whatever is in them."""
    outside: int | None = None
    for line in text.split("\n"):
        depth = len(line) - len(line.lstrip(" "))
        if outside is not None and (not line.strip() or depth > outside):
            yield _span("text", line) if line.strip() else line
            continue
        outside = depth if _BLOCK.search(line) else None
        yield _line(line, _YAML)


def _line(line: str, tokens: re.Pattern[str]) -> str:
    parts, at = [], 0
    for found in tokens.finditer(line):
        parts.append(escaped(line[at : found.start()]))
        kind, at = found.lastgroup, found.end()
        parts.append(_span(kind, found[0]) if kind else escaped(found[0]))
    return "".join([*parts, escaped(line[at:])])


def _span(kind: str, text: str) -> str:
    return f'<span class="{kind[0]}">{escaped(text)}</span>'


# -- what is shown of the solution -----------------------------------------------------------------

MOST_SETS = 8
"""The most sets of held things of which the page of a level has a picture of values."""

MOST_CELLS = 256
"""The most cells of a level whose values are on the page as a table, too."""


LARGE_CELL = 96
"""The width of a cell of the picture in pixels, where there is room."""


def values_svgs(level: Level, guide: Guide, path: str) -> dict[str, str]:
    """Return the pictures of a level with its optimal values and actions, by their paths.

    The first one is that where episodes begin; then comes one for each other set of held things.
    """
    found, _ = _sets(level)
    paths = [path, *(path.replace(".svg", f"-{count + 1}.svg") for count in range(1, len(found)))]
    return {
        each: to_svg(
            build_scene(bare(level), configuration=at, robot=False, overlay=guide.overlay.at(at))
        )
        for each, at in zip(paths, found.values(), strict=True)
    }


def _sets(level: Level) -> tuple[Mapping[str, int | None], int]:
    """Return the sets of held things of which there are pictures, and how many are left out."""
    return shown_configurations(level, MOST_SETS) if level.has_things else ({"": None}, 0)


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
        yield with_limit("Steps of the optimal policy", None, limit), rounded(facts.best_steps)
    if facts.random_return is not None:
        yield with_limit("Return of random actions", None, limit), rounded(facts.random_return)


def solved_values(level: Level, facts: Facts, guide: Guide) -> dict[str, Any]:
    """Return what the tab of values tells.

    Args:
        level: the level; a maze has its seed.
        facts: its facts.
        guide: its solution.
    """
    found, left_out = _sets(level)
    files, start = (facts.files.values, *facts.files.sets), _start(level)
    return {
        "sets": dict(zip(files, found, strict=False)),
        "start": "" if start is None else configuration_words(level, start),
        "left_out": left_out,
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
