"""What a page knows about a level: texts, tables, picture, and optimal behaviour.

One mapping that JSON can hold. A page contains that of its own level, a link that of another
one: the page's script plays and paints either, and knows nothing else about levels.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.looks import Colors, Theme
from babyrobot_levels.mdp.actions import HEADINGS
from babyrobot_levels.render.colors import gray, is_gray
from babyrobot_levels.render.effects import effects_of
from babyrobot_levels.render.page_shapes import Palette, hexadecimal, pack
from babyrobot_levels.render.page_tables import CHEER, EVENTS, HEADING_POSES, POSES, rows_of
from babyrobot_levels.render.page_things import Marks, things_data
from babyrobot_levels.render.scene.build import floor_shapes, ground_layer, sign_shapes
from babyrobot_levels.render.scene.heat import BAR_STEPS, STEPS, Heat, frame_shapes
from babyrobot_levels.render.scene.layout import CELL, layout_of
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.panels import sample_shapes
from babyrobot_levels.render.scene.robot import GLOW, LAMP, OUTLINE, VISOR, robot_shapes
from babyrobot_levels.render.scene.shapes import Shape
from babyrobot_levels.render.scene.situation import Pose
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.texts import coordinate_texts
from babyrobot_levels.render.scene.things import CORNERS, SMALL
from babyrobot_levels.render.svg import number
from babyrobot_levels.render.words.describe import describe, goal_of
from babyrobot_levels.render.words.phrases import with_limit
from babyrobot_levels.render.words.rules import rules_of

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

World = TypeVar("World", bound="GridWorld")

MAX_CELLS = 16_384
"""The most cells of a level on a page: 128 by 128."""

MAX_STATES = 200_000
"""The most states of a level with things on a page."""

MAX_NUMBERS = 2_000_000
"""The most numbers of the distinct rows of a page's tables."""

WatchedPolicy = Literal["best", "random"]

_ROBOT_COLORS = ("robot", "puddle")
"""The colours of a theme in the robot's pictures: of its body, and of splashes."""

MAX_QUANTILES = 101
"""The most quantiles of returns on a page."""

_OWN_COLORS = (OUTLINE, VISOR, GLOW, LAMP)
"""The colours that it has in any theme but those of greys."""

PHASES = 4
"""The number of pictures of the robot for a move from cell to cell."""


class TooLargeError(ValueError):
    """A level that is too large for a page or a link."""


@dataclass(frozen=True, slots=True)
class Guide:
    """The solution of a level, as far as the page shows it.

    Attributes:
        policy: the optimal action of each state, as `Action`s, `[states]`; -1 where there is none.
        overlay: the values and optimal actions of the cells, which the page can show.
        expected_return: the optimal expected return from the starts, within the level's time
            limit; without one, it may be infinite.
        turning: the same for a robot that turns, with the actions of `Turn`, if it is known.
        random_return: that of random actions, if it is known.
        quantiles: quantiles of the policy's return at evenly spaced probabilities, ascending, at
            most `MAX_QUANTILES`; empty if they are unknown.
    """

    policy: Sequence[int]
    overlay: Overlay
    expected_return: float
    turning: Guide | None = None
    random_return: float | None = None
    quantiles: Sequence[float] = ()


def without_panels(level: GridWorld) -> GridWorld:
    """Return the level without the panels and the compass, which a page does not need.

    Raises:
        TooLargeError: the level is too large for a page.
    """
    width, height = level.size
    if width * height > MAX_CELLS:
        raise TooLargeError(
            f"a level of {width} x {height} cells is too large for a page; "
            f"the limit is {MAX_CELLS:,} cells"
        )
    states = level.compile().num_states if level.has_things else 0
    if states > MAX_STATES:
        raise TooLargeError(
            f"a level of {states:,} states is too large for a page; "
            f"the limit is {MAX_STATES:,} states"
        )
    return bare(level)


def bare(level: World) -> World:
    """Return the level without the panels and the compass."""
    display = {"side_panel": "none", "bottom_panel": "none", "compass": False}
    return level.model_copy(update={"display": level.display.model_copy(update=display)})


def page_data(
    level: GridWorld,
    *,
    guide: Guide | None = None,
    policy: WatchedPolicy = "best",
    seed: int = 0,
    values: bool = False,
    arrows: bool = False,
    turns: bool = False,
) -> dict[str, Any]:
    """Return everything that a page needs to show and play a level.

    Args and errors are those of `to_html`.
    """
    level = without_panels(level)
    colors = level.resolved_theme.colors
    return {
        "title": title_of(level),
        "description": (level.description or "").strip(),
        "facts": list(facts(level)),
        **playable(level),
        "robot": [hexadecimal(color) for color in _robot_colors(colors)],
        **_picture(level, guide, turns=turns),
        "goal": goal_of(level),
        "alt": describe(level, robot=False),
        "seed": str(seed),
        "walker": policy if guide is not None or policy == "random" else None,
        "shown": [name for name, shown in (("policy", arrows), ("values", values)) if shown],
        **_answers(level, guide),
    }


@cache
def common_data() -> dict[str, Any]:
    """Return what is the same for all levels: the robot's pictures, and the meaning of codes.

    Each shape of the robot is there once; its picture in a pose and a phase, of a cell at (0, 0),
    is a list of the shapes' numbers (`sprites`, `[poses][phases]`).
    """
    names = (*_ROBOT_COLORS, *_OWN_COLORS)
    palette = Palette(names)
    theme = Theme.model_construct(colors=Colors.model_construct(robot="robot", puddle="puddle"))
    shapes: dict[str, int] = {}
    sprites = [
        [
            [
                shapes.setdefault(json.dumps(shape, separators=(",", ":")), len(shapes))
                for _, _, packed in pack(
                    robot_shapes(theme, 0, 0, Pose(pose.facing, pose.mood, phase / PHASES)),
                    palette,
                )
                for shape in packed
            ]
            for phase in range(PHASES)
        ]
        for pose in POSES
    ]
    return {
        "cell": round(CELL),
        "events": EVENTS,
        "cheer": CHEER,
        "phases": PHASES,
        "max_cells": MAX_CELLS,
        "max_states": MAX_STATES,
        "steps": STEPS,
        "bar": BAR_STEPS,
        "headings": HEADING_POSES,
        "spots": [[1, 0, 0], *([SMALL, CELL * dx, CELL * dy] for dx, dy in CORNERS)],
        "robot": names,
        "palette": palette.colors,
        "shapes": list(map(json.loads, shapes)),
        "sprites": sprites,
    }


def _robot_colors(colors: Colors) -> Iterator[str]:
    """Yield the colours of the robot that differ between themes, in the order of `common_data`."""
    yield from (getattr(colors, name) for name in _ROBOT_COLORS)
    if is_gray(colors):
        yield from map(gray, _OWN_COLORS)


def title_of(level: GridWorld) -> str:
    """Return the heading of a level's page."""
    return level.title or level.name or "Level"


def facts(level: GridWorld) -> Iterator[tuple[str, str]]:
    """Yield the facts about a level, each with its name."""
    width, height = level.size
    values = {
        "Level": level.name,
        "Size": f"{width} × {height}",
        "Author": level.author,
        "Source": level.source,
        "License": level.license,
        "Time limit": f"{level.max_steps} steps" if level.max_steps is not None else None,
        "Digest": level.digest,
    }
    yield from ((name, text) for name, text in values.items() if text)


def _picture(level: GridWorld, guide: Guide | None, *, turns: bool) -> dict[str, Any]:
    """Return the picture, what it shows of things and of a robot that turns, and the rules.

    A rule is its sample, shapes of a cell in the picture's palette, its text, and the runs of cells
    that it is about, each as its first cell and its length.

    Values and optimal actions are marks. What the level tells of its cells is there twice: as it is
    seen alone, and beside answers. If a cell shows the same in all states, there is also what sets
    the level off from the colours of the values, and its coordinates are in inks for these; those
    beside actions alone have a layer of their own.
    """
    may_turn = turns or "heading" in level.model_fields_set
    is_still = not (level.has_things or may_turn)
    overlay = guide.overlay.at() if guide is not None else Overlay()
    layout = layout_of(level, overlay=overlay)
    palette = Palette(is_gray=is_gray(level.resolved_theme.colors))
    alone, beside = (Slots(level, layout, shown) for shown in (Overlay(), overlay))
    own = level.display.coordinates
    # Without the strip for what is held, which the page has outside of the picture.
    seen = replace(layout, strip=0.0)
    shapes: dict[str, Iterable[Shape]] = {
        "base": ground_layer(level, seen),
        "grid": floor_shapes(level, layout, beside),
        "signs": sign_shapes(level, layout, alone, own),
    }
    if guide is not None:
        shapes["beside"] = sign_shapes(level, layout, beside, False)
    picture: dict[str, Any] = {
        "width": round(seen.width),
        "height": round(seen.height),
        "layers": {name: pack(each, palette, layout.margin) for name, each in shapes.items()},
    }
    data: dict[str, Any] = {"picture": picture}
    if level.has_things:
        data["things"], picture["looks"] = things_data(level, layout, palette)
    turning = guide.turning if guide is not None and may_turn else None
    moves, turned = (
        [*_overlays(level, guide)] if guide is not None else [],
        [*_overlays(level, turning, turns=True)] if turning is not None else [],
    )
    marks = Marks(level, layout, palette, beside, [*moves, *turned])
    if moves:
        picture["legend"], picture["scale"] = round(layout.legend), marks.scale.stops
        palette.use(marks.scale.colors)
        data["marks"] = {"values": marks.values(moves), "policy": marks.actions(moves)}
        heat = Heat(level, layout, overlay, beside)
        edges = heat.edges if is_still else frame_shapes(level, beside.acting, layout)
        over = {"heat": tuple(edges)}
        if own and is_still and overlay.has_colors:
            over["values"] = (*coordinate_texts(level, layout, beside, heat.colors_of),)
            over["places"] = (*coordinate_texts(level, layout, beside),)
        elif own:
            over["beside"] = (*coordinate_texts(level, layout, beside, on_plates=True),)
        for name, each in over.items():
            picture["layers"].setdefault(name, []).extend(pack(each, palette, layout.margin))
        picture["layers"]["heat"] += marks.legend
    if may_turn:
        data["turns"] = _turns(level, turning, on=turns)
        if turned:
            data["turns"]["marks"] = {"values": marks.values(turned)}
    if marks.packed:
        picture["marks"], picture["tiles"] = marks.packed, marks.tiles
    data["rules"] = [
        [pack(sample_shapes(level, rule.sample), palette), rule.text, _runs(rule.cells)]
        for rule in rules_of(level)
    ]
    picture["palette"] = palette.colors
    return data


def _runs(cells: Sequence[int]) -> list[int]:
    """Return ascending numbers as runs: the first number and the length of each."""
    runs: list[int] = []
    for cell in cells:
        if runs and cell == runs[-2] + runs[-1]:
            runs[-1] += 1
        else:
            runs += [cell, 1]
    return runs


def _overlays(level: GridWorld, guide: Guide, *, turns: bool = False) -> Iterator[Overlay]:
    """Yield what a guide shows in each configuration, and in each heading of one that turns."""
    for configuration in range(level.compile().num_configurations):
        for heading in range(HEADINGS) if turns else (None,):
            yield guide.overlay.at(configuration, heading)


def _turns(level: GridWorld, guide: Guide | None, *, on: bool) -> dict[str, Any]:
    """Return what a page knows about the robot that turns, and whether it does so at first."""
    return {
        "on": on,
        "heading": SIDES.index(level.heading),
        **_answers(level, guide),
    }


def _answers(level: GridWorld, guide: Guide | None) -> dict[str, Any]:
    """Return the optimal policy, and what is known about its return."""
    if guide is None:
        return {"policy": None, "best": ""}
    data: dict[str, Any] = {"policy": list(guide.policy), "best": ""}
    if math.isfinite(guide.expected_return):
        limit = level.max_steps
        data["best"] = with_limit(rounded(guide.expected_return), limit, limit)
        random = guide.random_return
        data["returns"] = {
            "best": _brief(guide.expected_return),
            "random": _brief(random) if random is not None and math.isfinite(random) else None,
            "quantiles": list(map(_brief, guide.quantiles)),
        }
    return data


def rounded(value: float) -> str:
    """Return a return as text, with two decimals, or two digits where it is small."""
    if math.isinf(value):
        text = "-∞" if value < 0 else "∞"
    elif abs(value) >= 0.1 or abs(value) < 1e-6:
        text = number(value)
    else:
        text = np.format_float_positional(value, 2, unique=False, fractional=False, trim="-")
    return text.replace("-", "\N{MINUS SIGN}")


def _brief(value: float) -> float | int:
    """Return a number with six digits."""
    return _short(float(f"{value:.6g}"))


def playable(level: GridWorld) -> dict[str, Any]:
    """Return what the page's script plays: the tables, and the event and pose of each outcome.

    `rows` and `table` are those of `rows_of`. `possible` has a bit for each action. Lengths are
    those of the scene.

    Args:
        level: the level; a maze needs a seed.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    mdp = level.compile()
    rows, table = rows_of(level)
    numbers = sum(map(len, rows))
    if numbers > MAX_NUMBERS:
        raise TooLargeError(
            f"the tables of the level are too large for a page: their rows have {numbers:,} "
            f"numbers, and the limit is {MAX_NUMBERS:,}"
        )
    return {
        "width": mdp.width,
        "height": mdp.height,
        "margin": _short(layout_of(level).margin),
        "speed": _short(level.display.robot.speed),
        "starts": mdp.start.nonzero()[0].tolist(),
        "exits": [y * mdp.width + x for x, y in level.exits],
        "max_steps": level.max_steps,
        "discount": _short(level.discount),
        "good_ends": sorted(y * mdp.width + x for x, y in effects_of(level).good_ends),
        "rows": rows,
        "table": table,
        "possible": (mdp.action_mask @ (1 << np.arange(mdp.num_actions))).tolist(),
    }


def _short(value: float) -> float | int:
    return int(value) if float(value).is_integer() else value
