"""Phrases that several texts about levels share: rewards, chances, numbers, colours."""

import colorsys
import math
from collections.abc import Iterable, Sequence

from babyrobot_levels.language.cells import RandomReward, Skid
from babyrobot_levels.language.drawing import consecutive
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.looks import Colors
from babyrobot_levels.render.colors import gray, is_gray, rgba
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.words import listed

LONGEST_NAME = 28
"""The most characters of a name or label in a text."""

MOST_WEIGHED = 4
"""The most of which one is drawn that are told with how often each is."""

_NEAR = 1e-6
_ROUND = (10, 3, 4, 1)
"""The numbers of times of which chances are told, the first in which they are whole."""

_HUES = (
    (18, "red"),
    (44, "orange"),
    (68, "yellow"),
    (165, "green"),
    (195, "turquoise"),
    (255, "blue"),
    (290, "purple"),
    (345, "pink"),
    (360, "red"),
)
"""The names of colours, each with the hue in degrees at which it ends."""


def reaching(level: LevelFields | None) -> str:
    """Return what it means to reach the goal of a level."""
    covers = level is not None and level.ends_covered
    return "covers all targets" if covers else "reaches an exit"


def name_of(text: str | None, longest: int = LONGEST_NAME) -> str:
    """Return a name, a label or a message as one short printable line; it may be empty."""
    line = one_line(" ".join((text or "").split()))
    return line if len(line) <= longest else line[: longest - 1].rstrip() + "…"


def worded(label: str) -> str:
    """Return a label that has letters; one such as `-1` or `★` says nothing in a text."""
    return label if any(map(str.isalpha, label)) else ""


def amount(value: float) -> str:
    """Return a number without its sign."""
    return f"{abs(value):,.6g}"


def reward(value: float | RandomReward) -> str:
    """Return what a reward does: `pays 10`, `costs 4 (1 time in 2) or pays 10 (1 time in 2)`."""
    if isinstance(value, RandomReward):
        if len(value.values) > MOST_WEIGHED:
            return f"{rewards(value.values)}, by chance"
        return listed([f"{reward(each)} ({chance(share)})" for each, share in value.chances], "or")
    return f"{'costs' if value < 0 else 'pays'} {amount(value)}"


def rewards(values: Iterable[float | RandomReward]) -> str:
    """Return what rewards do of which one is given: `pays 2 to 6`."""
    first, *others = values = list(values)
    if all(each == first for each in others):
        return reward(first)
    rows = [each.values if isinstance(each, RandomReward) else (each,) for each in values]
    least, most = min(map(min, rows)), max(map(max, rows))
    if least < 0 < most:
        return f"costs up to {amount(least)} or pays up to {amount(most)}"
    first, last = sorted((abs(least), abs(most)))
    return f"{'costs' if least < 0 else 'pays'} {amount(first)} to {amount(last)}"


def chance(probability: float) -> str:
    """Return how often something happens: `6 times in 10`, `1 time in 3`, `27 %`, `always`."""
    for times in _ROUND:
        count = round(times * probability)
        if abs(times * probability - count) < _NEAR and count:
            return "always" if count == times else f"{counted(count, 'time')} in {times}"
    return f"{100 * probability:.3g} %"


def percent(probability: float) -> str:
    """Return a probability as a percentage; what is not sure is not `100 %`, nor `0 %`."""
    probability = round(probability, 9)
    text = f"{100 * probability:.3g} %"
    if text == "100 %" and probability < 1:
        return "over 99.9 %"
    return "under 0.01 %" if 0 < probability < 1e-4 else text


def number(value: float | None) -> str:
    """Return a number with at most six digits; a dash where there is none."""
    if value is None or math.isnan(value):
        return "–"
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}".replace("-", "\N{MINUS SIGN}")


def skidding(skid: Skid) -> str:
    """Return how slippery something is: `skids 6 times in 10`."""
    if not skid.probability:
        return "does not skid"
    where = {"open": "", "sides": " sideways", "others": " in another direction"}[skid.to]
    return f"skids{where} {chance(skid.probability)}"


def counted(count: int, singular: str, plural: str | None = None) -> str:
    """Return a number of something: `1 puddle`, `4 puddles`."""
    return f"{count:,} {singular if count == 1 else plural or singular + 's'}"


def limited(steps: int | None) -> str:
    """Return which of a level's two optima is meant: `within 100 steps`, or `without a limit`."""
    return "without a limit" if steps is None else f"within {counted(steps, 'step')}"


def with_limit(figure: str, within: int | None, max_steps: int | None) -> str:
    """Return a figure or its name with the limit that it is for, if there is more than one figure.

    Args:
        figure: the figure, or its name.
        within: after how many steps the episodes are truncated; None for no limit.
        max_steps: that of the level; without one, a figure without a limit is the only one.
    """
    return f"{figure} {limited(within)}" if (within or max_steps) is not None else figure


def ranges(numbers: Iterable[int]) -> str:
    """Return whole numbers in ascending order, three neighbours as a range: `0, 3 to 5 and 8`."""
    parts: list[str] = []
    for run in consecutive(sorted(numbers), lambda number: (None, number)):
        parts += [f"{run[0]} to {run[-1]}"] if len(run) > 2 else map(str, run)
    return listed(parts)


def cells(places: Iterable[Sequence[int]]) -> str:
    """Return cells as they stand in files: `[0, 0], [3, 1]`."""
    return ", ".join(show_cell((x, y)) for x, y in places)


def color_name(color: str, colors: Colors) -> str:
    """Return a CSS colour as a theme shows it, in one of a few words: `dark blue`, `grey`.

    Args:
        color: the colour.
        colors: those of the theme.
    """
    if is_gray(colors):
        color = gray(color)
    red, green, blue, _ = rgba(color)
    hue, light, saturation = colorsys.rgb_to_hls(red / 255, green / 255, blue / 255)
    if light < 0.08 or light > 0.95:
        return "black" if light < 0.5 else "white"
    shade = "dark " if light < 0.3 else "light " if light > 0.78 else ""
    if saturation < 0.14:
        return f"{shade}grey"
    name = next(name for end, name in _HUES if 360 * hue <= end)
    if name == "orange" and (light < 0.42 or saturation < 0.5):
        return "brown" if light < 0.6 else "beige"
    return shade + name
