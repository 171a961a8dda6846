"""The page painter: one HTML file that shows a level and plays it, on its own and offline.

The page plays the compiled tables. Its random numbers come from the generator that the
environments use: a seed and the same actions give the same episode there and here. Opened with a
link's play part after a `#`, it shows and plays that level instead.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import islice
from typing import TYPE_CHECKING, Any, Literal, TypedDict, TypeVar, Unpack

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.language.looks import Colors, Theme
from babyrobot_levels.language.play import program
from babyrobot_levels.language.share_code import VERSION, encode
from babyrobot_levels.mdp.actions import HEADINGS, NUM_ACTIONS, NUM_MOVES, Action
from babyrobot_levels.mdp.gridworld import GridWorld, check_four_moves
from babyrobot_levels.mdp.numeric import is_numeric
from babyrobot_levels.render.colors import gray, is_gray
from babyrobot_levels.render.page_agent import PageAgent, agent_data
from babyrobot_levels.render.page_format import (
    CHEER,
    EVENTS,
    HEADING_POSES,
    POSES,
    Palette,
    TooLargeError,
    hexadecimal,
    pack,
    rounded,
    runs_of,
    short,
)
from babyrobot_levels.render.page_link import DICTIONARY, MAX_UNPACKED, PLAY_VERSIONS, play_fragment
from babyrobot_levels.render.page_sight import PageSight
from babyrobot_levels.render.page_things import Marks, team_data, things_data
from babyrobot_levels.render.scene.build import build_scene, floor_shapes, ground_layer, sign_shapes
from babyrobot_levels.render.scene.heat import BAR_STEPS, STEPS, Heat, frame_shapes
from babyrobot_levels.render.scene.layout import CELL, Overlay, layout_of
from babyrobot_levels.render.scene.panels import sample_shapes
from babyrobot_levels.render.scene.robot import GLOW, LAMP, OUTLINE, VISOR, robot_shapes
from babyrobot_levels.render.scene.shapes import Scene, Shape, toned
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.team import robot_color
from babyrobot_levels.render.scene.texts import coordinate_texts
from babyrobot_levels.render.scene.things import CORNERS, SMALL
from babyrobot_levels.render.situation import Pose, effects_of
from babyrobot_levels.render.svg import element, number, to_svg
from babyrobot_levels.render.templates import as_html, embedded_json, html, put_together, static
from babyrobot_levels.render.words.describe import describe, goal_of
from babyrobot_levels.render.words.phrases import with_limit
from babyrobot_levels.render.words.rules import rules_of
from babyrobot_levels.text.budget import OverBudgetError
from babyrobot_levels.text.errors import LevelError

if TYPE_CHECKING:
    from markupsafe import Markup


MAX_LINK = 30_000
"""The most characters of a link after its `#` that browsers and chats handle reliably."""


def to_html(level: GridWorld, **shown: Unpack[PageOptions]) -> str:
    """Return a page on which the level can be played with keys, buttons and touch.

    Args:
        level: the level; a maze needs a seed.
        shown: see `PageOptions`.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        TooLargeError: the level is too large for a page.
    """
    whole, level = level, without_panels(level)
    data = page_data(level, **shown)
    # Without a code, which only a level of a file's size has, a page has no plays to download.
    with suppress(LevelError):
        data["code"] = encode(whole.to_dict(whole=True))
    common = {
        **common_data(),
        "code_versions": [VERSION],
        "play_versions": PLAY_VERSIONS,
        "max_unpacked": MAX_UNPACKED,
        "dictionary": DICTIONARY,
    }
    icon = icon_svg(level.resolved_theme)
    parts = {
        "team": level.robots,
        "fog": "sight" in data,
        "views": shown.get("agent"),
        "progress": shown.get("previous_page") or shown.get("next_page"),
    }
    return html(
        "render/static/page.html",
        title=title_of(level),
        description=data["description"],
        icon="data:image/svg+xml;base64," + base64.b64encode(icon.encode()).decode(),
        picture=as_html(_picture(level, shown, data["shown"])),
        **{name: shown.get(name) for name in ("agent", "previous_page", "next_page")},
        facts=facts(level),
        common=embedded_json(common),
        data=embedded_json(data),
        **_own(frozenset(part for part, is_there in parts.items() if is_there)),
    )


def common_module(data: dict[str, Any]) -> dict[str, str]:
    """Return the module of what is the same for all levels with its data in it, by its path."""
    return {"render/static/common.js": f"export const COMMON = {embedded_json(data)};"}


def without_parts(parts: Iterable[str]) -> dict[str, str]:
    """Return the scripts in place of those of parts that pages do without, by their paths.

    Parts are `team`, several robots; `fog`, a sight; `views`, an agent; `progress`, other levels.
    """
    return {
        f"render/static/{part}.js": static(f"render/static/{_INSTEAD[part]}.js") for part in parts
    }


def icon_svg(theme: Theme) -> str:
    """Return the icon of pages: the robot, in the colours of a theme."""
    return to_svg(Scene(CELL, CELL, toned(robot_shapes(theme, 0, 0), theme.colors)))


def _picture(level: GridWorld, options: PageOptions, shown: list[str]) -> str:
    """Return the picture that is shown without JavaScript."""
    answers = _answer_overlay(options).at() if shown else Overlay()
    overlay = replace(
        answers,
        values=answers.values if "values" in shown else None,
        actions=answers.actions if "policy" in shown else None,
    )
    scene = build_scene(level, robot=False, overlay=overlay)
    width, height = number(scene.width), number(scene.height)
    return element(scene, f'viewBox="0 0 {width} {height}" width="{width}" height="{height}"')


def _answer_overlay(options: PageOptions) -> Overlay:
    """Return what is shown over the cells at first: of an agent if there is one."""
    shown = options.get("agent") or options.get("guide")
    return Overlay() if shown is None else shown.overlay


_INSTEAD = {"team": "one", "fog": "clear", "views": "optimum", "progress": "single"}
"""The scripts in place of those of parts that a page does without."""


@cache
def _own(parts: frozenset[str]) -> dict[str, Markup]:
    """Return style, script, and a content security policy that allows these, and no loading."""
    given = without_parts({*_INSTEAD} - parts)
    style = put_together("render/static/page.css")
    script = f'"use strict";\n{put_together("render/static/page.js", given)}'
    style_hash, script_hash = (
        base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        for text in (style, script)
    )
    policy = (
        f"default-src 'none'; img-src data:; style-src 'sha256-{style_hash}'; "
        f"script-src 'sha256-{script_hash}'; base-uri 'none'; form-action 'none'"
    )
    return {"style": as_html(style), "script": as_html(script), "policy": as_html(policy)}


def link_fragment(level: GridWorld, played: GridWorld, guide: Guide | None = None) -> str:
    """Return the part of a link after its `#`: a share code, and the data that a page plays.

    Args:
        level: the level of the share code.
        played: the same level with a maze seed, if the level's maze is random.
        guide: the solution of the level, if it is known.

    Raises:
        LevelError: the level exceeds the size limit of level files.
        TooLargeError: the level is too large for a link.
    """
    code = encode(level.to_dict(whole=True))
    _check_link(code)
    content = page_data(played, guide=guide)
    if played is not level:
        content["code"] = encode(played.to_dict(whole=True))
    fragment = play_fragment(code, content)
    if len(fragment) > MAX_LINK:
        # A page that does without the values of all states cannot tell what decisions cost.
        for known in (content, content.get("turns", {})):
            known.get("returns", {}).pop("values", None)
        fragment = play_fragment(code, content)
    _check_link(fragment)
    return fragment


def _check_link(fragment: str) -> None:
    """Check the length of a link, or of its beginning.

    Raises:
        TooLargeError: it is too long.
    """
    if len(fragment) > MAX_LINK:
        raise TooLargeError(
            f"the level is too large for a link: it would have {len(fragment):,} characters or "
            f"more, and the limit is {MAX_LINK:,}"
        )


# -- what a page knows about a level ---------------------------------------------------------------

World = TypeVar("World", bound="GridWorld")

MAX_CELLS = 16_384
"""The most cells of a level on a page: 128 by 128."""

MAX_STATES = 200_000
"""The most states of a level with things on a page; with several robots, fewer by their actions."""

WatchedPolicy = Literal["best", "random", "agent"]

_ROBOT_COLORS = ("robot", "puddle")
"""The colours of a theme in the robot's pictures: of its body, and of splashes."""

_OWN_COLORS = (OUTLINE, VISOR, GLOW, LAMP)
"""The colours that it has in any theme but those of greys."""

PHASES = 4
"""The number of pictures of the robot for a move from cell to cell."""


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
        values: the optimal value of each state, `[states]`, of a level without a time limit; with
            one, they depend on the steps that are left, and the page computes them.
    """

    policy: Sequence[int]
    overlay: Overlay
    expected_return: float
    turning: Guide | None = None
    random_return: float | None = None
    values: Sequence[float] = ()


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
    try:
        mdp = level.compile() if level.has_things and is_numeric() else None
    except OverBudgetError as error:
        raise TooLargeError(str(error)) from None
    limit = MAX_STATES * NUM_ACTIONS // (mdp.num_actions if mdp is not None else NUM_ACTIONS)
    if mdp is not None and mdp.num_states > limit:
        raise TooLargeError(
            f"a level of {mdp.num_states:,} states is too large for a page; "
            f"the limit is {limit:,} states"
        )
    return bare(level)


def bare(level: World) -> World:
    """Return the level without the panels and the compass."""
    display = {"side_panel": "none", "bottom_panel": "none", "compass": False}
    return level.model_copy(update={"display": level.display.model_copy(update=display)})


class PageOptions(TypedDict, total=False):
    """What a page shows, and what it shows at first.

    Attributes:
        guide: the solution of the level, if it is known.
        policy: the policy that can be watched; without a guide there is no best one, which is the
            default.
        agent: the agent that is shown beside the optimum, or without it, and watched with the
            policy `"agent"`.
        seed: the random seed of the first episode.
        values: whether the values of cells are shown at first.
        arrows: whether the optimal actions are shown at first.
        previous_page: the address of the page of the level before, to which the page leads.
        next_page: that of the level after it, to which also the card of a result leads.
        turns: whether the robot turns at first. The page can change between turning and moving
            if it does, or if the level sets a `heading`.
        learn: whether algorithms can learn the level; by default, with a guide.
        sight: the sight through which it is played, without a guide; its best agent can be watched.
    """

    guide: Guide | None
    agent: PageAgent | None
    policy: WatchedPolicy
    seed: int
    values: bool
    arrows: bool
    previous_page: str | None
    next_page: str | None
    turns: bool
    learn: bool | None
    sight: PageSight | None


def page_data(level: GridWorld, **shown: Unpack[PageOptions]) -> dict[str, Any]:
    """Return everything that a page needs to show and play a level; see `to_html`."""
    guide, policy = shown.get("guide"), shown.get("policy", "best")
    learn = shown.get("learn")
    at_first = {"policy": shown.get("arrows"), "values": shown.get("values")}
    level = without_panels(level)
    colors = level.resolved_theme.colors
    body = robot_color(level, 0) if level.robots else colors.robot
    return {
        "title": title_of(level),
        "description": (level.description or "").strip(),
        "facts": list(facts(level)),
        **_played(level),
        # Those that differ between themes, in the order of `common_data`.
        "robot": [
            *(hexadecimal(color) for color in (body, colors.puddle)),
            *(hexadecimal(gray(color)) for color in _OWN_COLORS if is_gray(colors)),
        ],
        **_picture_data(level, shown),
        "goal": goal_of(level),
        "alt": describe(level, robot=False),
        "seed": str(shown.get("seed", 0)),
        "walker": policy if guide is not None or policy != "best" else None,
        "shown": [name for name, is_shown in at_first.items() if is_shown],
        **_answers(level, guide),
        **({} if learn is None else {"learn": learn}),
        **_seen(shown.get("sight")),
        **(team_data(level) if level.robots else {}),
    }


@cache
def common_data() -> dict[str, Any]:
    """Return what is the same for all levels: the robot's pictures, and the meaning of codes.

    Each shape of the robot is there once; its picture in a pose and a phase, of a cell at (0, 0),
    is a list of the shapes' numbers (`sprites`, `[poses][phases]`), each less the number at its
    place two pictures before.
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
                    robot_shapes(theme, 0, 0, Pose(pose.facing, pose.mood, phase / PHASES)), palette
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
        "needed": {kind.name: kind.need.met for kind in NEEDED},
        "spots": [[1, 0, 0], *([SMALL, CELL * dx, CELL * dy] for dx, dy in CORNERS)],
        "robot": names,
        "palette": palette.colors,
        "shapes": list(map(json.loads, shapes)),
        "sprites": _differences(sprites),
        "made_by": program(),
    }


def _differences(sprites: list[list[list[int]]]) -> list[list[list[int]]]:
    """Return lists of numbers, each number less the one at its place two lists before."""
    every = [[], [], *(numbers for phases in sprites for numbers in phases)]
    rest = iter(zip(every[2:], every, strict=False))

    def less(numbers: list[int], before: list[int]) -> list[int]:
        known = [*before, *[0] * len(numbers)]
        return [number - known[place] for place, number in enumerate(numbers)]

    return [[less(*pair) for pair in islice(rest, len(phases))] for phases in sprites]


def _played(level: GridWorld) -> dict[str, Any]:
    """Return what the page's script plays; lengths are those of the scene.

    Without NumPy there are no tables: the level can be shown as it begins, and not be played.
    """
    width, height = level.size
    data = {
        "width": width,
        "height": height,
        "margin": short(layout_of(level).margin),
        "speed": short(level.display.robot.speed),
        "starts": [y * width + x for x, y in level.starts],
        "exits": [y * width + x for x, y in level.exits],
        "max_steps": level.max_steps,
        "discount": short(level.discount),
        "good_ends": sorted(y * width + x for x, y in effects_of(level).good_ends),
    }
    if is_numeric():
        from babyrobot_levels.render.page_tables import tables_of

        return data | tables_of(level)
    possible = [1 << Action.STAY | bits << Action.NORTH for bits in level.grid().open_bits]
    return data | {"possible": possible}


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
        "Digest": level.digest if is_numeric() else None,
    }
    yield from ((name, text) for name, text in values.items() if text)


def _picture_data(level: GridWorld, options: PageOptions) -> dict[str, Any]:
    """Return the picture, what it shows of things and of a robot that turns, and the rules.

    A rule is its sample, shapes of a cell in the picture's palette, its text, and the runs of cells
    that it is about, each as its first cell and its length.

    Values and optimal actions are marks. What the level tells of its cells is there twice: as it is
    seen alone, and beside answers. If a cell shows the same in all states, there is also what sets
    the level off from the colours of the values, and its coordinates are in inks for these; those
    beside actions alone have a layer of their own.
    """
    guide, agent, turns = options.get("guide"), options.get("agent"), options.get("turns", False)
    # One who turns sees something else.
    if turns:
        check_four_moves(level, "pages of robots that turn")
    is_headed = "heading" in level.model_fields_set and level.moves == NUM_MOVES
    may_turn = turns or (is_headed and options.get("sight") is None)
    is_still = not (level.has_things or may_turn)
    overlay = _answer_overlay(options).at()
    # What the caption tells, the page has outside of the picture, as it has what is held.
    layout = replace(layout_of(level, overlay=overlay), caption=0.0)
    palette = Palette(is_gray=is_gray(level.resolved_theme.colors))
    alone, beside = (Slots(level, layout, shown) for shown in (Overlay(), overlay))
    own = level.display.coordinates
    seen = replace(layout, strip=0.0)
    shapes: dict[str, Iterable[Shape]] = {
        "base": ground_layer(level, seen),
        "grid": floor_shapes(level, layout, beside),
        "signs": sign_shapes(level, layout, alone, own),
    }
    if overlay.fills_cells:
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
    moves, turned, by_agent = (
        _overlays(level, each.overlay, turns=each is turning) if each is not None else []
        for each in (guide, turning, agent)
    )
    marks = Marks(level, layout, palette, beside, [*moves, *turned, *by_agent])
    if moves or by_agent:
        picture["legend"], picture["scale"] = round(layout.legend), marks.scale.stops
        palette.use(marks.scale.colors)
        if moves:
            data["marks"] = {"values": marks.values(moves), "policy": marks.actions(moves)}
        if agent is not None:
            data["agent"] = agent_data(agent, marks, moves, partial(_overlays, level))
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
        if agent is None:
            picture["layers"]["heat"] += marks.legend
    if may_turn:
        data["turns"] = _turns(level, turning, on=turns)
        if turned:
            data["turns"]["marks"] = {"values": marks.values(turned)}
    if marks.packed:
        picture["marks"], picture["tiles"] = marks.packed, marks.tiles
        if marks.never >= 0:
            picture["never"] = marks.never
    data["rules"] = [
        [pack(sample_shapes(level, rule.sample), palette), rule.text, runs_of(rule.cells)]
        for rule in rules_of(level)
    ]
    picture["palette"] = palette.colors
    return data


def _overlays(level: GridWorld, overlay: Overlay, *, turns: bool = False) -> list[Overlay]:
    """Return what is shown in each configuration, and in each heading of a robot that turns."""
    return [
        overlay.at(configuration, heading)
        for configuration in range(level.compile().num_configurations)
        for heading in (range(HEADINGS) if turns else (None,))
    ]


def _turns(level: GridWorld, guide: Guide | None, *, on: bool) -> dict[str, Any]:
    """Return what a page knows about the robot that turns, and whether it does so at first."""
    return {"on": on, "heading": SIDES.index(level.heading), **_answers(level, guide)}


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
            "random": None if random is None else _brief(random),
        }
        if guide.values:
            data["returns"]["values"] = [_brief(value, 12) for value in guide.values]
    return data


def _seen(sight: PageSight | None) -> dict[str, Any]:
    """Return what a page knows of the sight through which it is played.

    A description for those who do not see the picture would tell what is hidden.
    """
    if sight is None:
        return {}
    walker = "sight" if "roots" in sight.data else None
    return {"sight": sight.data, "best": sight.best, "walker": walker, "alt": ""}


def _brief(value: float, digits: int = 6) -> float | int | None:
    """Return a number with few digits; None for one that is not finite."""
    return short(float(f"{value:.{digits}g}")) if math.isfinite(value) else None
