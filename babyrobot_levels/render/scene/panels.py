"""The panels with lines of text, and the compass."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.looks import Colors, Panel
from babyrobot_levels.mdp.actions import DELTAS
from babyrobot_levels.render.colors import ink_on, mixed, plate_for
from babyrobot_levels.render.scene.layout import (
    COMPASS,
    LINE,
    LINE_SIZE,
    PANEL_EDGE,
    Layout,
    bottom_room,
    panel_width,
    rules_room,
    side_foot,
    wrapped,
)
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.rule_rows import (
    RULE_LINE,
    RULE_SIZE,
    SAMPLE,
    TEXT_LEFT,
    rows_in,
    scale_for,
)
from babyrobot_levels.render.scene.shapes import (
    Ellipse,
    Path,
    Rect,
    Shape,
    Text,
    polygon,
    rounded,
    scaled,
    shifted,
)
from babyrobot_levels.render.scene.tones import toned

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_NEEDLE = "#e5484d"


def panel_shapes(level: GridWorld, overlay: Overlay, layout: Layout) -> Iterator[Shape]:
    """Yield the backgrounds of the panels: one beside the grid, one below."""
    display, ground = level.display, level.resolved_theme.colors.text_bg
    if panel_width(display.side_panel) or overlay.side_panel:
        fill = _ground(display.side_panel, ground)
        yield Rect(layout.left_width, 0, layout.side, layout.top_height, fill)
    if layout.bottom:
        fill = _ground(display.bottom_panel, ground)
        yield Rect(0, layout.top_height, layout.width, layout.bottom, fill)


def strip_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the background of the strip that shows what is held."""
    if layout.strip:
        ground = level.resolved_theme.colors.text_bg
        yield Rect(0, layout.top_height, layout.width, layout.strip, ground)


def _ground(panel: str | float | Panel, ground: str) -> str:
    return panel.color if isinstance(panel, Panel) and panel.color is not None else ground


def compass_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the compass at the top of the side panel; north is up."""
    if not level.display.compass:
        return
    colors = level.resolved_theme.colors
    x = layout.left_width + layout.side / 2
    y = COMPASS / 2
    yield Ellipse(x, y, 31, 31, plate_for(colors.text_fg, colors.text_bg))
    for down, fill in ((-1, _NEEDLE), (1, colors.text_fg)):
        half = polygon([(x - 5, y), (x, y + 16 * down), (x + 5, y)])
        yield Path(half, fill=fill, stroke=colors.text_fg, width=1.2)
    for action, (dx, dy) in DELTAS.items():
        letter = action.name[0]
        yield Text(x + 23.5 * dx, y + 23.5 * dy + 3.8, letter, 11, colors.text_fg, bold=True)


def rules_shapes(level: GridWorld, overlay: Overlay, layout: Layout) -> Iterator[Shape]:
    """Yield the rules of a level where the picture has room for all, each with its sample."""
    room = rules_room(level, overlay, layout)
    if room is None:
        return
    # Most pictures have no room for rules, and the first frame does without the time to import.
    from babyrobot_levels.render.words.rules import rules_of

    display, colors = level.display, level.resolved_theme.colors
    if room.where == "box":
        yield Rect(*room[:4], colors.text_bg)
        ink = colors.text_fg
    else:
        panel = display.side_panel if room.where == "side" else display.bottom_panel
        ink = _text_color(panel, colors)
    rows = [SampledRule(level, rule.sample, rule.text) for rule in rules_of(level)]
    scale = scale_for([rule.text for rule in rows], room.width, room.height)
    if scale is not None:
        shapes = rule_shapes(rows, room.width / scale, room.height / scale, ink)
        yield from shifted(scaled(shapes, scale), room.left, room.top)


class SampledRule(NamedTuple):
    """A rule in a box.

    Attributes:
        level: the level whose sample is drawn beside it.
        sample: the name of the sample, as in `Rule`.
        text: the rule in words.
    """

    level: GridWorld
    sample: str
    text: str


def rule_shapes(
    rules: Sequence[SampledRule], width: float, height: float, ink: str
) -> Iterator[Shape]:
    """Yield rules in a box with room for all, whose upper left corner is (0, 0), with samples."""
    from babyrobot_levels.render.scene.samples import sample_shapes

    for row in rows_in([rule.text for rule in rules], width, height):
        left, top, rule = row.left, row.top, rules[row.rule]
        sample = sample_shapes(rule.level, rule.sample, SAMPLE)
        yield from toned(shifted(sample, left, top), rule.level.resolved_theme.colors)
        if sample:
            # A sample may have the colour of the panel.
            frame = rounded(left, top, SAMPLE, SAMPLE, 0)
            yield Path(frame, stroke=ink, width=1, opacity=0.5)
        # A single line stands beside the middle of its sample.
        top += max(0.0, (SAMPLE - RULE_LINE * len(row.lines)) / 2)
        for number, line in enumerate(row.lines):
            baseline = top + RULE_LINE * (number + 0.76)
            # Not every font has a no-break space.
            line = line.replace("\N{NO-BREAK SPACE}", " ")
            yield Text(left + TEXT_LEFT, baseline, line, RULE_SIZE, ink, "start")


def panel_texts(level: GridWorld, overlay: Overlay, layout: Layout) -> Iterator[Text]:
    """Yield the lines of the panels; long ones are wrapped, those that do not fit left out."""
    display, colors = level.display, level.resolved_theme.colors
    top = COMPASS if display.compass else 0.0
    if layout.side:
        yield from _lines(
            overlay.side_panel,
            (layout.left_width, top, layout.side, side_foot(layout) - top),
            _text_color(display.side_panel, colors),
        )
    if layout.bottom:
        yield from _lines(
            overlay.bottom_panel,
            (0.0, layout.top_height, bottom_room(layout), layout.bottom),
            _text_color(display.bottom_panel, colors),
        )


def _text_color(panel: str | float | Panel, colors: Colors) -> str:
    own = panel.text_color if isinstance(panel, Panel) else None
    ground = mixed(_ground(panel, colors.text_bg), "#ffffff")
    return ink_on([ground], colors.text_fg if own is None else own)


def _lines(
    texts: Sequence[str], box: tuple[float, float, float, float], fill: str
) -> Iterator[Text]:
    left, top, width, height = box
    lines = wrapped(texts, width)
    room = max(1, int((height - PANEL_EDGE) / LINE))
    if len(lines) > room:
        lines = [*lines[: room - 1], "…"]
    for number, line in enumerate(lines):
        if line:
            baseline = top + PANEL_EDGE + LINE * number + 0.75 * LINE
            yield Text(left + PANEL_EDGE, baseline, line, LINE_SIZE, fill, "start")
