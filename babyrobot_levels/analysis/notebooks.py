"""How results show themselves in notebooks: a picture of the level, and numbers in a table."""

from __future__ import annotations

import base64
import math
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from babyrobot_levels.analysis.picture_formats import FORMATS
from babyrobot_levels.analysis.shown import WIDTH, image, level_picture, state_picture
from babyrobot_levels.analysis.solver.results import Solution
from babyrobot_levels.language.metric_names import MAX_SOLVED, UNLIMITED
from babyrobot_levels.render.notebook.html import beside, facts
from babyrobot_levels.render.words.phrases import number, reaching, with_limit

if TYPE_CHECKING:
    from babyrobot_levels.analysis.metrics import Metrics
    from babyrobot_levels.analysis.previews import Facts, Preview
    from babyrobot_levels.analysis.solver.occupancy import Occupancy
    from babyrobot_levels.analysis.solver.results import Evaluation, ExactSolution

_HEIGHT = 720
"""The height of a page in a notebook, in pixels."""


def evaluation_html(found: Evaluation) -> str:
    """Return the values of a policy, or of an optimal one, and what is known of its episodes."""
    limit = None if found.level is None else found.level.max_steps
    rows = [
        ("Expected return", with_limit(number(found.expected_return), found.within, limit)),
        ("Expected steps", number(found.expected_steps)),
        (reaching(found.level).capitalize(), _share(found.exit_probability)),
        ("Discount", number(found.discount)),
        ("Actions", found.actions),
    ]
    if found.level is not None and not found.level.has_goal:
        del rows[2]
    if isinstance(found, Solution):
        rows.append(("Method", f"{found.method}, residual {found.residual:.1g}"))
    text = f"<p>{escape(found.explanation)}</p>" if found.explanation else ""
    return beside(image(state_picture(found)), facts(rows) + text)


def exact_html(found: ExactSolution) -> str:
    """Return the numbers of an optimal policy, as fractions."""
    return facts(
        [
            ("Expected return", str(found.expected_return)),
            ("Expected steps", str(found.expected_steps)),
            (reaching(found.level).capitalize(), str(found.exit_probability)),
            ("Discount", str(found.discount)),
            ("Actions", found.actions),
            ("Method", "policy iteration over the rationals: no action is better"),
        ]
    )


def occupancy_html(found: Occupancy) -> str:
    """Return how often a policy visits cells."""
    rows = [("Expected steps", number(found.steps)), ("Discount", number(found.discount))]
    if np.isinf(found.visits).any():
        return facts(rows)
    return beside(image(state_picture(found)), facts(rows))


def metrics_html(found: Metrics) -> str:
    """Return the metrics of a level, by name."""
    texts = {
        name: (", ".join(value) or "nothing") if isinstance(value, tuple) else number(value)
        for name, value in found.to_dict(solve=found.states <= MAX_SOLVED).items()
    }
    for name in texts.keys() & UNLIMITED:
        texts[name] = with_limit(texts[name], None, found.level.max_steps)
    told = [(name.replace("_", " "), text) for name, text in texts.items()]
    return beside(image(level_picture(found.level, WIDTH)), facts(told))


def facts_html(found: Facts) -> str:
    """Return the facts about a level, by name."""
    rows = [(name, text) for name, text in found.lines().items() if text]
    return beside(image(level_picture(found.level, WIDTH)), facts(rows))


def preview_html(made: Preview) -> str:
    """Return a picture, a film or a page itself."""
    if isinstance(made.data, str) and made.format == "html":
        style = f'style="width: 100%; height: {_HEIGHT}px; border: 0"'
        return f'<iframe srcdoc="{escape(made.data)}" {style}></iframe>'
    media_type = FORMATS[made.format].media_type
    if not media_type.startswith("image/"):
        return f"<pre>{escape(repr(made))}</pre>"
    data = made.data.encode() if isinstance(made.data, str) else made.data
    address = f"data:{media_type};base64,{base64.b64encode(data).decode()}"
    return f'<img src="{address}" style="max-width: 100%; height: auto">'


def _share(probability: float) -> str:
    """Return a probability in percent."""
    return "–" if math.isnan(probability) else f"{100 * probability:.4g} %"
