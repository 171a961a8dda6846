"""The panels: lines of text, the compass, and the rules of a level with their samples."""

from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any, NamedTuple

from babyrobot_levels.language.cells import Puddle, Rectangle, Wall, Wind
from babyrobot_levels.language.kinds import KIND
from babyrobot_levels.language.looks import Colors, Display, Panel
from babyrobot_levels.mdp.actions import DELTAS, MOVES
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.colors import ink_on, mixed, plate_for
from babyrobot_levels.render.scene.ground import ground_shapes, puddle_shapes
from babyrobot_levels.render.scene.icons import (
    Spot,
    crate_shapes,
    default_color,
    item_shapes,
    thing_color,
)
from babyrobot_levels.render.scene.layout import (
    CELL,
    COMPASS,
    LINE,
    LINE_SIZE,
    PANEL_EDGE,
    RULE_LINE,
    RULE_SIZE,
    SAMPLE,
    TEXT_LEFT,
    Layout,
    Overlay,
    bottom_room,
    panel_width,
    rows_in,
    rules_room,
    scale_for,
    side_foot,
    wrapped,
)
from babyrobot_levels.render.scene.marks import effect_shapes
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
    toned,
)
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.things import mover_shapes, pieces
from babyrobot_levels.render.scene.walls import casing_shapes, wall_shapes
from babyrobot_levels.render.situation import Effects, effects_of, situation_of

_NEEDLE = "#e5484d"


def panel_shapes(level: GridWorld, overlay: Overlay, layout: Layout) -> Iterator[Shape]:
    """Yield the backgrounds of the panels: one beside the grid, one below."""
    display, ground = level.display, level.resolved_theme.colors.text_bg
    if panel_width(display.side_panel) or overlay.side_panel:
        fill = _panel_ground(display.side_panel, ground)
        yield Rect(layout.left_width, 0, layout.side, layout.top_height, fill)
    if layout.bottom:
        fill = _panel_ground(display.bottom_panel, ground)
        yield Rect(0, layout.top_height, layout.width, layout.bottom, fill)


def strip_shapes(level: GridWorld, layout: Layout) -> Iterator[Shape]:
    """Yield the background of the strip that shows what is held."""
    if layout.strip:
        ground = level.resolved_theme.colors.text_bg
        yield Rect(0, layout.top_height, layout.width, layout.strip, ground)


def _panel_ground(panel: str | float | Panel, ground: str) -> str:
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
    for action in MOVES:
        letter, (dx, dy) = action.name[0], DELTAS[action]
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
    if (scale := scale_for([rule.text for rule in rows], room.width, room.height)) is not None:
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
    for row in rows_in([rule.text for rule in rules], width, height):
        left, top, rule = row.left, row.top, rules[row.rule]
        sample = sample_shapes(rule.level, rule.sample, SAMPLE)
        yield from toned(shifted(sample, left, top), rule.level.resolved_theme.colors)
        if sample:
            # A sample may have the colour of the panel.
            yield Path(rounded(left, top, SAMPLE, SAMPLE, 0), stroke=ink, width=1, opacity=0.5)
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
    ground = mixed(_panel_ground(panel, colors.text_bg), "#ffffff")
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


# -- samples of what is in a level: the pictures of a legend ---------------------------------------

_HERE = (0, 0)
_SPOT = Spot(CELL / 2, CELL / 2)
_PARTS: dict[str, dict[str, Any]] = {
    "exit": {"exit": _HERE},
    "blocked": {"blocked": (Rectangle(at=_HERE),)},
    "puddle-small": {"puddles": (Puddle(at=_HERE, size="small"),)},
    "puddle-large": {"puddles": (Puddle(at=_HERE, size="large"),)},
}
"""What the cell of a sample has."""


def sample_shapes(level: GridWorld, sample: str, size: float = CELL) -> tuple[Shape, ...]:
    """Return what a rule is about as the picture of a cell, in the colours of the level.

    Args:
        level: the level.
        sample: the `sample` of one of the level's rules.
        size: the side of the picture in pixels; its upper left corner is (0, 0).
    """
    return tuple(scaled(_shapes(level, sample), size / CELL)) if sample else ()


def _shapes(level: GridWorld, sample: str) -> Iterator[Shape]:
    kind, _, what = sample.partition(":")
    if kind == "cell":
        x, y = map(int, what.split(","))
        yield from _cell(level, (x, y))
        return
    yield from _ground(_small(level, shows_start=kind == "start", **_PARTS.get(kind, {})))
    if kind in ("wall", "glass"):
        yield from _wall(level, is_glass=kind == "glass")
    elif kind == "wind":
        small = _small(level, wind=Wind(**{what: (1,)}), skid=None)
        yield from _effects(small, effects_of(small))
    elif kind == "ground":
        small = _small(level)
        yield from _effects(small, effects_of(small))
    elif kind == "item":
        item = next(item for item in level.items if item.name == what)
        yield from item_shapes(item.picture, thing_color(item, level.resolved_theme.colors), _SPOT)
    elif kind == "box":
        yield from crate_shapes(default_color("box", level.resolved_theme.colors), _SPOT)
    elif kind in KIND and KIND[kind].need.met in ("on", "covered"):
        entry = next(entry for entry in KIND[kind].of(level) if what in ("", entry.name))
        alone = entry.model_copy(update={"at": _HERE, "label": None})
        fields: dict[str, Any] = {KIND[kind].field: (alone,)}
        small = _small(level, **fields)
        for piece in pieces(small, _layout(), situation_of(small, None), _slots(small)):
            yield from piece.shapes
    elif kind == "mover":
        yield from mover_shapes(level, int(what), _SPOT)


def _small(level: GridWorld, *, shows_start: bool = False, **fields: Any) -> GridWorld:
    """Return a level of one cell that looks and pays like another one, and has no outer wall."""
    theme = level.resolved_theme
    widths = theme.widths.model_copy(update={"border": 0.0})
    given = {
        "skid": level.skid,
        "rewards": level.rewards,
        "theme": theme.model_copy(update={"widths": widths}),
    }
    return _plain(shows_start).model_copy(update=given | fields)


@cache
def _plain(shows_start: bool) -> GridWorld:
    """Return a level of one cell, with or without its start; to be copied, which is cheaper."""

    class Startless(GridWorld):
        @property
        def starts(self) -> tuple[tuple[int, int], ...]:
            return ()

    kind = GridWorld if shows_start else Startless
    display = Display(start_text=False, exit_text=False)
    return kind.model_construct(version=1, size=(1, 1), display=display)


def _layout(columns: int = 1) -> Layout:
    return Layout(columns, 1, 0.0, 0.0, 0.0)


def _slots(small: GridWorld, columns: int = 1) -> Slots:
    return Slots(small, _layout(columns), Overlay())


def _ground(small: GridWorld) -> Iterator[Shape]:
    yield from ground_shapes(small, _layout())
    yield from puddle_shapes(small, _layout(), _slots(small))


def _cell(level: GridWorld, cell: tuple[int, int]) -> Iterator[Shape]:
    """Yield what areas, puddles and warps make of a cell."""
    x, y = cell
    areas = [
        area.model_copy(update={"at": _HERE, "size": (1, 1), "label": None})
        for area in level.areas
        if 0 <= x - area.at[0] < area.size[0] and 0 <= y - area.at[1] < area.size[1]
    ]
    puddles = [Puddle(at=_HERE, size=puddle.size) for puddle in level.puddles if puddle.at == cell]
    yield from _ground(_small(level, areas=tuple(areas), puddles=tuple(puddles)))
    effects = effects_of(level).at(cell)
    warps = [warp.model_copy(update={"at": _HERE}) for warp in level.warps if warp.at == cell]
    if warps and warps[0].to != "start":
        # The arrow to the next cell, in half the size.
        there = warps[0].model_copy(update={"to": (1, 0)})
        shapes = _effects(_small(level, size=(2, 1), warps=(there,)), effects)
        yield from shifted(scaled(shapes, 0.5), 0, CELL / 4)
    else:
        yield from _effects(_small(level, warps=tuple(warps)), effects)


def _effects(small: GridWorld, effects: Effects) -> Iterator[Shape]:
    layout = _layout(small.size[0])
    yield from effect_shapes(small, layout, _slots(small, layout.columns), effects)


def _wall(level: GridWorld, *, is_glass: bool) -> Iterator[Shape]:
    """Yield a wall through the middle, upright."""
    share = next(iter(level.grid().glass.values())) if is_glass else 0.0
    wall = Wall.model_validate({"at": _HERE, "side": "E", "pass": share})
    small, layout = _small(level, size=(2, 1), walls=(wall,)), _layout(2)
    shapes = (*casing_shapes(small, layout), *wall_shapes(small, layout, _slots(small, 2)))
    yield from shifted(shapes, -CELL / 2, 0)
