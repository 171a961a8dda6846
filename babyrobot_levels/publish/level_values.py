"""What the page of a level shows of its solution: a picture, returns, and figures in print."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from babyrobot_levels.language.kinds import THINGS
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.states import initial_configuration
from babyrobot_levels.publish.facts import Facts
from babyrobot_levels.publish.published import Comparison, comparisons
from babyrobot_levels.render.page_data import Guide, bare, rounded
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.svg import escaped, to_svg
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


def values_panel(level: Level, facts: Facts, guide: Guide, picture: str) -> str:
    """Return the tab of values as HTML.

    Args:
        level: the level; a maze has its seed.
        facts: its facts.
        guide: its solution.
        picture: the address of the picture with values and actions, for an attribute.
    """
    changing = [kind.state for kind in THINGS if kind.field in facts.things]
    where = (
        f" These are the values at the start of an episode. They change with {', '.join(changing)}."
        if changing
        else ""
    )
    rows = "".join(
        f"<div><dt>{name}</dt><dd>{text}</dd></div>" for name, text in shown_values(facts, guide)
    )
    return "\n".join(
        [
            '<div class="values">',
            f'<figure><img src="{picture}" width="{LARGE_CELL * level.size[0]}" '
            'alt="The level with the optimal value and the optimal actions of each cell">',
            "<figcaption>The number and the colour of a cell are its optimal value: the expected "
            f"return of an optimal policy {with_limit('from there', None, facts.max_steps)}. "
            f"Arrows are optimal actions, of several those that end the episode soonest.{where}"
            "</figcaption></figure>",
            f'<div><h3>Expected returns</h3><dl class="returns">{rows}</dl>',
            *map(_figure, comparisons(level)),
            "</div></div>",
            *_all_values(level, guide),
        ]
    )


def _all_values(level: Level, guide: Guide) -> Iterator[str]:
    """Yield the values as a table, if it is not too large."""
    values = guide.overlay.at(_start(level)).values
    if values is None or math.prod(level.size) > MOST_CELLS:
        return
    texts = [
        ["" if value is None or math.isnan(value) else rounded(value) for value in row]
        for row in values
    ]
    yield "<details><summary>Values as a table</summary>"
    yield f'<div class="scroll" tabindex="0" role="region" aria-label="Values">{_grid(texts)}</div>'
    yield "</details>"


def _grid(rows: Sequence[Sequence[str]], caption: str = "") -> str:
    """Return a table of cells of a level, each as HTML, with their coordinates."""
    heads = "".join(f'<th scope="col">{x}</th>' for x in range(len(rows[0])))
    body = "".join(
        f'<tr><th scope="row">{y}</th>{"".join(f"<td>{cell}</td>" for cell in row)}</tr>'
        for y, row in enumerate(rows)
    )
    head = f'<thead><tr><th scope="col"><span class="unseen">y, x</span></th>{heads}</tr></thead>'
    return f'<table class="cells">{caption}{head}<tbody>{body}</tbody></table>'


def _figure(comparison: Comparison) -> str:
    """Return a figure in print beside what is computed."""
    figure = comparison.figure
    told = f"<h3>{escaped(figure.what)}</h3>\n<p>{escaped(figure.source)}</p>\n"
    decimals = figure.decimals
    difference = _fixed(comparison.difference, decimals + 2)
    agrees = "equal when rounded as in print" if comparison.agrees else "not equal"
    pairs = [
        [
            None if value is None or other is None
            else (_fixed(value, decimals), _fixed(other, decimals + 2))
            for value, other in zip(row, computed, strict=True)
        ]
        for row, computed in zip(figure.printed, comparison.computed, strict=True)
    ]  # fmt: skip
    if len(pairs) == len(pairs[0]) == 1 and pairs[0][0] is not None:
        printed, computed = pairs[0][0]
        rows = (("In print", printed), ("Computed", computed), ("Difference", difference))
        listed = "".join(f"<div><dt>{name}</dt><dd>{text}</dd></div>" for name, text in rows)
        return f'<section class="print">{told}<dl class="returns">{listed}</dl></section>'
    cells = [
        ["" if pair is None else f"{pair[0]}<small>{pair[1]}</small>" for pair in row]
        for row in pairs
    ]
    caption = (
        "<caption>In each cell the number in print, and below it the computed one. The largest "
        f"difference is {difference}: {agrees}.</caption>"
    )
    return f'<section class="print">{told}{_grid(cells, caption)}</section>'


def _fixed(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    return ("0" if float(text) == 0 else text).replace("-", "\N{MINUS SIGN}")
