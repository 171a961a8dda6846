"""The wall of a gallery, with a tile for each level, and the files that all its pages share."""

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from urllib.parse import quote

from babyrobot_levels.analysis.endings import SURE
from babyrobot_levels.extensions.publish.facts import Facts
from babyrobot_levels.language.kinds import THINGS
from babyrobot_levels.language.looks import Theme
from babyrobot_levels.language.play import program
from babyrobot_levels.render.page import common_data, common_module, icon_svg, without_parts
from babyrobot_levels.render.templates import embedded_json, html, put_together, static

DIFFICULTIES = (("easy", 5), ("medium", 7), ("hard", math.inf))
"""The words for difficulties, each with the difficulty below which it applies."""

MANY_DECISIONS = 10
"""More of them are many."""

SIZES = (("small", 25), ("medium", 100), ("large", math.inf))
"""The words for sizes, each with the largest number of cells to which it applies."""

COMMON_TAGS = 8
"""The number of tags that are seen at once; the others are behind "More"."""

MOST_TAGS = 60
"""The number of tags that can be chosen: the most common ones."""

MAX_TEXT = 500
"""The most characters of each text that a search looks through."""

CONTENTS = (
    "keys",
    *(kind.field for kind in THINGS),
    *("areas", "ends", "glass", "maze", "puddles", "warps", "wind"),
)
"""Things and features, in the order in which they are shown."""

ORDERS = {
    "title": "Title, A to Z",
    "size": "Smallest first",
    "-size": "Largest first",
    "difficulty": "Easiest first",
    "-difficulty": "Hardest first",
    "steps": "Fewest steps without a limit",
    "-steps": "Most steps without a limit",
    "-return": "Highest optimum without a limit",
    "return": "Lowest optimum without a limit",
}
"""The orders that can be chosen instead of the gallery's own, and their names."""

ANSWERS = {"difficulty", "steps", "return"}
"""The orders that tell something about the answers."""


@dataclass(frozen=True)
class Facet:
    """A property of levels by which the wall can be filtered.

    Attributes:
        name: its name in links to the filtered wall.
        legend: its heading.
        values_of: its values of a level.
        values: all its values, in order; None if the most common one comes first.
        hints: what some of the values mean.
        has_icons: whether each of its values has an icon.
        tells: whether it tells something about the answers.
    """

    name: str
    legend: str
    values_of: Callable[[Facts], Iterable[str]]
    values: Sequence[str] | None = None
    hints: Mapping[str, str] = field(default_factory=dict)
    has_icons: bool = False
    tells: bool = False


FACETS = (
    Facet(
        "difficulty",
        "Difficulty",
        lambda facts: filter(None, [_difficulty(facts)]),
        tuple(word for word, _ in DIFFICULTIES),
        {"easy": "below 5", "medium": "5 to 7", "hard": "7 and more"},
        has_icons=True,
        tells=True,
    ),
    Facet(
        "hard",
        "Hard by",
        lambda facts: _hardships(facts),
        ("mistakes", "decisions", "order", "distractors", "luck"),
        {
            "mistakes": "some are for ever",
            "decisions": f"more than {MANY_DECISIONS}",
            "order": "one thing for another",
            "distractors": "things of no use",
            "luck": "the best may fail",
        },
        tells=True,
    ),
    Facet(
        "size",
        "Size",
        lambda facts: [next(word for word, most in SIZES if math.prod(facts.size) <= most)],
        tuple(word for word, _ in SIZES),
        {"small": "up to 25 cells", "medium": "26 to 100", "large": "more than 100"},
    ),
    Facet(
        "outcomes",
        "Transitions",
        lambda facts: [_outcomes(facts)],
        ("deterministic", "stochastic"),
        has_icons=True,
    ),
    Facet("has", "Contains", lambda facts: _contents(facts), CONTENTS, has_icons=True),
    Facet("split", "Split", lambda facts: filter(None, [facts.split])),
    Facet("tag", "Tags", lambda facts: facts.tags),
)


def wall_html(
    facts: Sequence[Facts],
    *,
    title: str,
    answers: bool,
    key: bool,
    home: str | None,
    points: Mapping[str, float] | None = None,
) -> str:
    """Return the page of a gallery.

    Args:
        facts: the facts of its levels, in order.
        title: the title of the gallery.
        answers: whether the gallery knows the answers.
        key: whether it is the teacher's copy, which shows the answers from the start.
        home: the address that the page links back to; None for no link.
        points: what the levels of a course are worth, by their names; None if it is no course.
    """
    facets = [each for each in FACETS if answers or not each.tells]
    options = {each.name: _options(each, facts) for each in facets}
    # A box is known by its place: a tile's row of data names the boxes that fit it.
    places = {
        (name, value): place
        for place, (name, value) in enumerate(
            (name, value) for name, values in options.items() for value in values
        )
    }
    rows = [
        [
            [
                places[each.name, value]
                for each in facets
                for value in each.values_of(level)
                if (each.name, value) in places
            ],
            _searched(level),
            level.digest,
            *_numbers(level, answers=answers),
        ]
        for level in facts
    ]
    return html(
        "extensions/publish/static/wall.html",
        title=title,
        key=key,
        answers=answers,
        lead=_lead(len(facts), answers=answers, key=key),
        first=facts[0] if facts else None,
        home=home,
        facets=facets,
        options=options,
        common=COMMON_TAGS,
        orders={
            value: name
            for value, name in ORDERS.items()
            if answers or value.lstrip("-") not in ANSWERS
        },
        levels=facts,
        points=points or {},
        difficulty=_difficulty,
        icons=_icons,
        infinity=math.inf,
        made_by=program(),
        data=embedded_json(rows),
    )


def _lead(count: int, *, answers: bool, key: bool) -> str:
    levels = "1 level" if count == 1 else f"{count:,} levels"
    if key:
        return f"{levels}, with state values and optimal actions: the teacher's copy."
    best = ", and compare with the best way there is" if answers else ""
    return f"{levels} to play in the browser: bring the robot to the exit{best}."


def _difficulty(facts: Facts) -> str | None:
    if facts.difficulty is None:
        return None
    # As it is written: what is shown as 5.0 is not below 5.
    written = round(facts.difficulty, 1)
    return next(word for word, end in DIFFICULTIES if written < end or end == math.inf)


def _hardships(facts: Facts) -> Iterator[str]:
    """Yield why a level is hard, beside its difficulty."""
    known = {name: value for name, value in facts.hardness.items() if value is not None}
    if known.get("irreversible", 0) > 0:
        yield "mistakes"
    if known.get("decisions", 0) > MANY_DECISIONS:
        yield "decisions"
    if known.get("dependencies", 0) > 1:
        yield "order"
    if known.get("distractors", 0) > 0:
        yield "distractors"
    if known.get("success", 1) < 1 - SURE:
        yield "luck"


def _contents(facts: Facts) -> tuple[str, ...]:
    keys = ("keys",) if "key" in facts.words else ()
    return (*keys, *facts.things, *facts.features)


def _outcomes(facts: Facts) -> str:
    return "deterministic" if facts.deterministic else "stochastic"


def _options(facet: Facet, facts: Sequence[Facts]) -> list[str]:
    """Return the values between which a visitor can choose: what some levels have, but not all."""
    counts = Counter(value for level in facts for value in set(facet.values_of(level)))
    common = sorted(counts, key=lambda value: (-counts[value], value))[:MOST_TAGS]
    values = common if facet.values is None else facet.values
    return [value for value in values if 0 < counts[value] < len(facts)]


def _searched(facts: Facts) -> str:
    """Return what a search looks through, beside the title."""
    kinds = " ".join((*facts.features, *facts.words))
    texts = (facts.name, facts.description, facts.author, " ".join(facts.tags), kinds)
    return "\n".join(text[:MAX_TEXT] for text in texts if text)


def _numbers(facts: Facts, *, answers: bool) -> list[float | None]:
    """Return the numbers by which tiles are sorted."""
    if not answers:
        return [math.prod(facts.size)]
    known = (facts.difficulty, facts.best_steps, facts.best_return)
    # In JSON, an infinite number stays larger than all others.
    finite = (None if each is None else round(max(-1e300, min(each, 1e300)), 4) for each in known)
    return [math.prod(facts.size), *finite]


def _icons(facts: Facts) -> list[str]:
    contents = _contents(facts)
    return [_outcomes(facts), *(each for each in CONTENTS if each in contents)]


# -- the files that all pages share ----------------------------------------------------------------

_SYMBOL = re.compile(r'<symbol id="(\w+)" viewBox="0 0 24 24">(.*)</symbol>')
"""An icon: its name, and its shapes."""


def icons_style() -> str:
    """Return the style sheet of the icons."""
    return static("extensions/publish/static/icons.css") + "".join(
        f".i-{name} {{ --shape: url('data:image/svg+xml,{_svg(shapes)}'); }}\n"
        for name, shapes in _SYMBOL.findall(static("extensions/publish/static/icons.svg"))
    )


def _svg(shapes: str) -> str:
    svg = (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 24 24" fill="none" stroke="#000" '
        f'stroke-width="2.2" stroke-linecap="round" stroke-linejoin="round">{shapes}</svg>'
    )
    return quote(svg, safe=' =:/"<>,.')


def _script(path: str, given: Mapping[str, str] | None = None) -> str:
    """Return a script that is no module, which browsers would not load from a disk."""
    return f'"use strict";\n{put_together(path, given)}\n'


def _style(path: str) -> str:
    return put_together(path) + "\n"


ASSETS: dict[str, Callable[[], str]] = {
    "icon.svg": lambda: icon_svg(Theme()),
    "icons.css": icons_style,
    "site.css": lambda: _style("extensions/publish/static/site.css"),
    "level.css": lambda: _style("extensions/publish/static/level.css"),
    "level.js": lambda: _script("extensions/publish/static/level.js"),
    "player.css": lambda: _style("render/static/player.css"),
    # With what is the same for all levels that can be played.
    "player.js": lambda: _script(
        "extensions/publish/static/played_level.js",
        common_module(common_data()) | without_parts(["views"]),
    ),
    "wall.css": lambda: _style("extensions/publish/static/wall.css"),
    "wall.js": lambda: _script("extensions/publish/static/wall.js"),
}
"""The text of each file, by its name in the folder `assets`."""
