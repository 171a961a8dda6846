"""The page of a level in a gallery: its parts as tabs, its facts, and its files."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from string import Template

from babyrobot_levels.language.play import program
from babyrobot_levels.library.catalogue import files_in
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.reading import load_file
from babyrobot_levels.library.search_path import gallery_place
from babyrobot_levels.publish.citation import bibtex, citation
from babyrobot_levels.publish.facts import Facts
from babyrobot_levels.publish.highlight import python_html, yaml_html
from babyrobot_levels.publish.level_values import shown_values, values_panel
from babyrobot_levels.render.page import embedded_json, player_html
from babyrobot_levels.render.page_data import Guide, TooLargeError, page_data, rounded
from babyrobot_levels.render.scripts import static
from babyrobot_levels.render.svg import escaped, number, quoted
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
    player, scripts = _player(level, facts, guide, key=key)
    panels = {"play": ("Play", player)}
    if guide is not None and facts.files.values is not None:
        picture = quoted(_relative(facts, facts.files.values))
        values = "values", ("Values", values_panel(level, facts, guide, picture))
        panels = dict([values, *panels.items()] if key else [*panels.items(), values])
    panels |= {
        "yaml": ("YAML", _yaml(facts, text)),
        "python": ("Python", _python(facts, answers=answers)),
        "cite": ("Cite", _cite(level, facts)),
    }
    return Template(static("publish/static/level.html")).substitute(
        page_title=escaped(f"{facts.title} – {title}{' (key)' if key else ''}"),
        gallery=escaped(title),
        key='<span class="key">Key</span>' if key else "",
        neighbours=_NEIGHBOURS,
        digest=quoted(facts.digest),
        title=escaped(facts.title),
        about="\n".join(_about(facts)),
        tabs="\n".join(_tab(name, label) for name, (label, _) in panels.items()),
        panels="\n".join(_panel(name, *content) for name, content in panels.items()),
        facts="\n".join(_fact_rows(facts, guide)),
        files="\n".join(_downloads(facts, sizes)),
        made_by=escaped(program()),
        scripts=scripts,
    )


def with_neighbours(page: str, previous: Facts | None, following: Facts | None) -> str:
    """Return a page with links to the levels before and after it, None where there is none."""
    links = [
        f'<a rel="{rel}" href="../{quoted(facts.files.page)}" title="{quoted(facts.title)}">{text}'
        "</a>"
        for rel, facts, text in (
            (
                "prev",
                previous,
                '<span aria-hidden="true">‹</span> Previous<span class="unseen"> level</span>',
            ),
            (
                "next",
                following,
                'Next<span class="unseen"> level</span> <span aria-hidden="true">›</span>',
            ),
        )
        if facts is not None
    ]
    nav = f'<nav class="end" aria-label="Levels">{"".join(links)}</nav>' if links else ""
    return page.replace(_NEIGHBOURS, nav, 1)


# -- the parts -----------------------------------------------------------------------------


def _tab(name: str, label: str) -> str:
    return (
        f'<button type="button" role="tab" id="tab-{name}" aria-controls="panel-{name}" '
        f'aria-selected="false" tabindex="-1">{label}</button>'
    )


def _panel(name: str, label: str, content: str) -> str:
    return (
        f'<section class="panel" id="panel-{name}" aria-labelledby="name-{name}">\n'
        f'<h2 id="name-{name}" class="name">{label}</h2>\n{content}\n</section>'
    )


def _player(level: Level, facts: Facts, guide: Guide | None, *, key: bool) -> tuple[str, str]:
    """Return the game, or why there is none, and the scripts of the page."""
    alt = quoted(describe(level))
    try:
        data = page_data(level, guide=guide, values=key, arrows=key)
    except TooLargeError as error:
        reason = escaped(str(error))
        picture = _image(facts, facts.files.png, alt)
        said = f"<p>It cannot be played here: {reason}.</p>\n<p>{picture}</p>"
        return said, '<script src="../assets/level.js"></script>'
    with suppress(LevelError):
        data["code"] = level.share_code()
    scripts = [
        f'<script type="application/json" id="data">{embedded_json(data)}</script>',
        '<script src="../assets/player.js"></script>',
    ]
    picture = _image(facts, facts.files.svg, alt)
    return f'<div class="player">\n{player_html(picture)}</div>', "\n".join(scripts)


def _image(facts: Facts, path: str, alt: str) -> str:
    return f'<img src="{quoted(_relative(facts, path))}" alt="{alt}">'


def _yaml(facts: Facts, text: str) -> str:
    cut = text[:MAX_SHOWN]
    more = (
        f"<p>The first {MAX_SHOWN:,} of {len(text):,} characters; the file has all of them.</p>"
        if len(text) > MAX_SHOWN
        else ""
    )
    name = escaped(file_name(facts))
    download = _download(facts, facts.files.level, "Download", "yaml")
    return f"{_code('yaml-text', name, yaml_html(cut), download)}{more}"


def _python(facts: Facts, *, answers: bool) -> str:
    named = load_name(facts)
    hint = (
        "<p>The level is in the gallery of the package.</p>"
        if named == facts.name
        else f"<p>Download {_download(facts, facts.files.level, file_name(facts), 'yaml')} "
        "into the current folder first.</p>"
    )
    load, train = programs(facts, answers=answers)
    return "\n".join(
        [
            hint,
            "<h3>Load</h3>",
            _code("load", "Load", python_html(load)),
            "<h3>Train</h3>",
            _code("train", "Train", python_html(train)),
        ]
    )


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
    return file_name(facts)


def file_name(facts: Facts, suffix: str = "yaml") -> str:
    """Return the name under which a file of the level is downloaded."""
    return f"{facts.id}.{suffix}"


@cache
def _package_levels() -> dict[str, Path]:
    return {file.name: file.path for file in files_in(gallery_place())}


def _cite(level: Level, facts: Facts) -> str:
    parts = [
        "<h3>In a text</h3>",
        _code("citation", "Citation", escaped(citation(level, facts.name))),
        "<h3>BibTeX</h3>",
        _code("bibtex", "BibTeX", escaped(bibtex(level, facts.name))),
        "<h3>Digest</h3>",
        "<p>A hash of the level's tables: levels with the same digest are the same MDP.</p>",
        _code("digest", "Digest", escaped(facts.digest)),
    ]
    with suppress(LevelError):
        parts += [
            "<h3>Share code</h3>",
            "<p>The whole level in one line. Every command takes it as LEVEL, and "
            "<code>brl.load</code> too.</p>",
            _code("share-code", "Share code", level.share_code()),
        ]
    return "\n".join(parts)


def _code(name: str, label: str, content: str, more: str = "") -> str:
    """Return a text to read and to copy; `content` is HTML."""
    return (
        f'<div class="code"><p class="tools">{more}'
        f'<button type="button" class="with-script" data-copy="{name}" hidden>Copy'
        f'<span class="unseen"> {label}</span></button></p>'
        f'<pre id="{name}" tabindex="0" role="region" aria-label="{label}">{content}</pre></div>'
    )


# -- facts and files -----------------------------------------------------------------------


def _about(facts: Facts) -> Iterator[str]:
    """Yield what a level is and where it comes from."""
    if facts.description:
        yield f"<p><bdi>{escaped(facts.description)}</bdi></p>"
    told = [
        ("By", facts.author),
        ("From", facts.source),
        ("License:", facts.license),
    ]
    parts = [f"<span>{name} <bdi>{escaped(text)}</bdi></span>" for name, text in told if text]
    if parts:
        yield f'<p class="origin soft">{" ".join(parts)}</p>'
    if facts.maze_seed is not None:
        yield f"<p>The maze is random: this is the one of seed {facts.maze_seed}.</p>"


def _fact_rows(facts: Facts, guide: Guide | None) -> Iterator[str]:
    for name, text in _facts(facts, guide):
        yield f"<div><dt>{name}</dt><dd><bdi>{escaped(text)}</bdi></dd></div>"


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


def _downloads(facts: Facts, sizes: Mapping[str, int]) -> Iterator[str]:
    """Yield links to the files of a level, each with its size."""
    files = facts.files
    paths = [
        ("YAML", files.level, "yaml"),
        ("SVG", files.svg, "svg"),
        ("SVG with values", files.values, "values.svg"),
        ("PNG", files.png, "png"),
        ("GIF", files.film, "gif"),
    ]
    for label, path, suffix in paths:
        if path is not None:
            size = f"{label} <small>{_size(sizes[path])}</small>"
            yield f"<li>{_download(facts, path, size, suffix)}</li>"


def _download(facts: Facts, path: str, label: str, suffix: str) -> str:
    return (
        f'<a class="button" href="{quoted(_relative(facts, path))}" '
        f'download="{quoted(file_name(facts, suffix))}">{label}</a>'
    )


def _size(size: int) -> str:
    for unit in ("bytes", "KB", "MB"):
        if size < 1000 or unit == "MB":
            break
        size = size / 1000  # type: ignore[assignment]
    return f"{number(round(size, 1))} {unit}"


def _relative(facts: Facts, path: str) -> str:
    """Return the path of a file of the gallery as it is seen from the page of a level."""
    return posixpath.relpath(path, posixpath.dirname(facts.files.page))
