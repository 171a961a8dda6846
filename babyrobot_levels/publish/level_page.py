"""The page of a level in a gallery: its parts as tabs, its facts, and its files."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from typing import Any

from babyrobot_levels.language.play import program
from babyrobot_levels.library.catalogue import files_in
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.reading import load_file
from babyrobot_levels.library.search_path import gallery_place
from babyrobot_levels.publish.citation import bibtex, citation
from babyrobot_levels.publish.facts import Facts
from babyrobot_levels.publish.highlight import python_html, yaml_html
from babyrobot_levels.publish.level_values import shown_values, solved_values
from babyrobot_levels.render.page_data import Guide, TooLargeError, page_data, rounded
from babyrobot_levels.render.svg import number
from babyrobot_levels.render.templates import as_html, embedded_json, html
from babyrobot_levels.render.words.describe import describe
from babyrobot_levels.text.errors import BabyRobotError, LevelError

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
        sizes: the numbers of bytes of its files.
    """
    data, reason = _played(level, guide, key=key)
    tabs = {"play": "Play", "yaml": "YAML", "python": "Python", "cite": "Cite"}
    solved = None
    if guide is not None and facts.files.values is not None:
        solved = solved_values(level, facts, guide)
        tabs = {"values": "Values", **tabs} if key else {"play": "Play", "values": "Values", **tabs}
    return html(
        "publish/static/level.html",
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
        tabs=tabs,
        told=_facts(facts, guide),
        files=_downloads(facts, sizes),
        made_by=program(),
    )


def with_neighbours(page: str, previous: Facts | None, following: Facts | None) -> str:
    """Return a page with links to the levels before and after it, None where there is none."""
    nav = ""
    if previous is not None or following is not None:
        nav = html("publish/static/neighbours.html", previous=previous, following=following)
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
    in_package = named == facts.name
    made = f'"babyrobot/{named}-v0"' if in_package else f'"babyrobot/Level-v0", level="{named}"'
    lines = [
        "import gymnasium",
        "import babyrobot_levels as brl",
        "",
        f'level = brl.load("{named}")',
        "print(level.draw())",
        "",
        f"env = gymnasium.make({made})",
        "observation, info = env.reset(seed=0)",
        "observation, reward, terminated, truncated, info = env.step(env.action_space.sample())",
        "print(observation, reward)",
    ]
    if answers:
        lines += ["", "solution = brl.solve(level)", "print(solution.values)"]
    train = [
        "import babyrobot_levels as brl",
        "",
        f'for trials in brl.q_learning("{named}", episodes=500, seed=0, every=100):',
        "    print(trials.number, trials.returns[-100:].mean())",
    ]
    return "\n".join(lines), "\n".join(train)


def load_name(facts: Facts) -> str:
    """Return what `brl.load` takes: a name of the package's gallery, else that of the file."""
    path = _package_levels().get(facts.name)
    if path is not None:
        with suppress(BabyRobotError):
            if load_file(path).digest == facts.digest:
                return facts.name
    return f"{facts.id}.yaml"


@cache
def _package_levels() -> dict[str, Path]:
    return {file.name: file.path for file in files_in(gallery_place())}


def _facts(facts: Facts, guide: Guide | None) -> Iterator[tuple[str, str]]:
    """Yield the facts of a level that are known, each with its name."""
    width, height = facts.size
    yield "Size", f"{width} × {height}"
    yield "States", f"{facts.states:,}"
    yield "Time limit", "none" if facts.max_steps is None else f"{facts.max_steps:,} steps"
    yield "Discount", f"{facts.discount:g}"
    yield "Deterministic", "yes" if facts.deterministic else "no"
    yield from shown_values(facts, guide)
    if facts.difficulty is not None:
        yield "Difficulty", rounded(facts.difficulty)
    if contents := (*facts.things, *facts.features):
        yield "Contains", ", ".join(contents)
    if facts.tags:
        yield "Tags", ", ".join(facts.tags)
    if facts.split:
        yield "Split", facts.split
    if facts.name:
        yield "Name", facts.name
    yield "Digest", facts.digest


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
