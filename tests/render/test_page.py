"""Pages: one HTML file that holds everything that it needs, and nothing that could do harm."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import re
import zlib
from dataclasses import replace
from importlib.resources import files
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.codes import play_data, play_stream
from support.markup import Reader
from support.worlds import World, decorated_worlds, level, level_of

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.language.share_code import PLAY_DICTIONARY_1
from babyrobot_levels.library.catalogue import levels, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import MOVES, Action
from babyrobot_levels.render.page import MAX_LINK, Guide, facts, link_fragment, page_data, to_html
from babyrobot_levels.render.page_format import CHEER, EVENTS, POSES, TooLargeError
from babyrobot_levels.render.scene.layout import Overlay
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.situation import Mood, Pose, pose_of
from babyrobot_levels.render.templates import embedded_json
from babyrobot_levels.text.errors import LevelError, LevelNotFoundError

EVIL = "</title></script><!--<script>alert(1)</script><img src=x onerror=alert(2)>&amp;\"'$title"


ROW = level(size=[3, 1], title="A row")
GUIDE = Guide([2, 2, -1], Overlay(values=[[-1.0, 0.0, None]], actions=[[(2,), (2,), ()]]), -1.0)


def test_the_facts_of_a_level_are_told_with_their_names() -> None:
    told = {"name": "lair", "author": "Ada", "source": "A book", "license": "CC0"}
    lair = level(size=[3, 2], max_steps=7, **told)
    assert list(facts(lair)) == [
        ("Level", "lair"),
        ("Size", "3 × 2"),
        ("Author", "Ada"),
        ("Source", "A book"),
        ("License", "CC0"),
        ("Time limit", "7 steps"),
        ("Digest", lair.digest),
    ]
    assert [name for name, _ in facts(ROW)] == ["Size", "Digest"]


def common_of(page: str) -> Any:
    return json.loads(Reader(page).texts["script"][0])


def data_of(page: str) -> Any:
    return json.loads(Reader(page).texts["script"][1])


# -- one file ----------------------------------------------------------------------------------


@pytest.mark.parametrize("guide", [None, GUIDE])
def test_every_element_is_closed_and_every_id_is_there_once(guide: Guide | None) -> None:
    page = Reader(to_html(ROW, guide=guide))
    assert page.open == []
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(ids) == len(set(ids))
    assert {"stage", "message", "notice", "steps", "return", "seed", "common", "data"} <= set(ids)


def test_it_loads_nothing() -> None:
    page = to_html(ROW, guide=GUIDE)
    addresses = [
        value or ""
        for _, attributes in Reader(page).elements
        for name, value in attributes.items()
        if name in ("src", "href", "action", "srcset", "xlink:href", "data")
    ]
    assert addresses
    assert [a for a in addresses if not a.startswith(("#", "data:image/svg+xml;base64,"))] == []
    assert re.findall(r"@import|url\((?!#)|fetch\(|XMLHttpRequest|import\(|WebSocket", page) == []


def test_its_policy_allows_its_own_style_and_script_and_nothing_else() -> None:
    page = Reader(to_html(ROW))
    (policy,) = page.find("meta", **{"http-equiv": "Content-Security-Policy"})
    rules = dict(rule.split(" ", 1) for rule in str(policy["content"]).split("; "))
    assert rules["default-src"] == "'none'"

    def hashed(text: str) -> str:
        digest = hashlib.sha256(text.encode()).digest()
        return f"'sha256-{base64.b64encode(digest).decode()}'"

    assert rules["style-src"] == hashed(page.texts["style"][0])
    assert rules["script-src"] == hashed(page.texts["script"][2])
    # Nothing else is a script or a style: neither elements nor attributes.
    assert len(page.find("script")) == 3
    assert page.find("script", type="application/json") == [
        {"type": "application/json", "id": name} for name in ("common", "data")
    ]
    for _, attributes in page.elements:
        assert not [name for name in attributes if name == "style" or name.startswith("on")]


def test_a_page_is_small() -> None:
    world = load("final-maze")
    assert len(world.to_html().encode()) < 197_000


def test_too_large_a_level_is_refused() -> None:
    with pytest.raises(ValueError, match="too large for a page"):
        to_html(level(size=[129, 128]))


# -- hostile levels ----------------------------------------------------------------------------


def test_no_text_of_a_level_becomes_a_part_of_the_page() -> None:
    world = level(
        size=[3, 1],
        title=EVIL,
        description=EVIL,
        author=EVIL,
        source=EVIL,
        license=EVIL,
        areas=[{"at": [1, 0], "label": EVIL}],
    )
    plain, hostile = Reader(to_html(ROW)), Reader(to_html(world))
    assert hostile.open == []
    assert hostile.comments == []
    assert len(hostile.find("script")) == len(plain.find("script"))
    assert hostile.find("img") == []
    assert hostile.texts["title"][0] == EVIL
    assert hostile.texts["h1"] == [""]
    assert hostile.texts["bdi"][0] == EVIL
    assert hostile.texts["bdi"].count(EVIL) == 5


@pytest.mark.parametrize("text", ["</script>", "<!--<script>", "]]>", "&lt;", "\u2028", "\ud800"])
def test_nothing_in_the_data_ends_the_data(text: str) -> None:
    told = embedded_json({text: [text]})
    assert not set("<>&") & set(told)
    assert told.isascii()
    assert json.loads(told) == {text: [text]}


@pytest.mark.parametrize("text", ["\ud800", "\x00\x1b[31m", "\u202e", "\ufffe"])
def test_texts_that_no_document_can_hold(text: str) -> None:
    page = to_html(ROW.model_copy(update={"title": f"a{text}b"}))
    assert b"\x1b" not in page.encode()
    assert b"\x00" not in page.encode()


# -- what it holds -----------------------------------------------------------------------------


def outcomes(data: Any, state: int, action: int) -> list[tuple[Any, ...]]:
    """Return the outcomes of an action, six numbers each."""
    row = data["rows"][data["table"][5 * state + action]]
    return [tuple(row[at : at + 6]) for at in range(0, len(row), 6)]


def test_the_data_says_who_walks_and_how() -> None:
    world = level(size=[3, 1], max_steps=7, display={"robot": {"speed": 2}})
    data = data_of(to_html(world, guide=GUIDE, policy="random", seed=2**70))
    assert (data["walker"], data["policy"], data["seed"]) == ("random", [2, 2, -1], str(2**70))
    assert (data["max_steps"], data["speed"], data["exits"]) == (7, 2, [2])


def events(world: Any, state: int, action: Action) -> dict[int, str]:
    """Return what can come of an action: what happened, by the state that it led to."""
    return {
        state + shift: EVENTS[event]
        for _, shift, _, _, event, _ in outcomes(page_data(world), state, action)
    }


def test_it_says_what_happened() -> None:
    world = level(
        size=[4, 2],
        exit=[3, 1],
        puddles=[{"at": [1, 0]}],
        walls=[{"at": [2, 0], "side": "E", "pass": 0.5}],
        warps=[{"at": [2, 1], "to": [0, 0]}],
    )
    assert events(world, 0, Action.NORTH) == {0: "bump"}
    assert events(world, 0, Action.STAY) == {0: "stay"}
    assert events(world, 0, Action.EAST) == {1: "move"}
    assert events(world, 1, Action.EAST) == {2: "move", 0: "skid", 5: "skid"}
    assert events(world, 2, Action.EAST) == {3: "move", 1: "bounce"}
    assert events(world, 5, Action.EAST) == {0: "carried"}


def test_who_is_sent_to_a_start_by_chance_is_carried_there() -> None:
    world = level(
        size=[3, 1], start=[[0, 0], [1, 0]], areas=[], warps=[{"at": [2, 0], "to": "start"}],
        exit="none",
    )  # fmt: skip
    assert events(world, 1, Action.EAST) == {0: "carried", 1: "stay"}


def test_every_outcome_has_the_pose_of_the_pictures() -> None:
    world = level(size=[3, 3], start=[1, 1], exit=[2, 2], puddles=[{"at": [1, 1]}])
    data = page_data(world)
    seen = set()
    for action in (Action.STAY, *MOVES):
        for _, shift, _, _, event, number in outcomes(data, 4, action):
            skidded = EVENTS[event] == "skid"
            assert POSES[number] == pose_of(4, 4 + shift, action, 3, skidded=skidded)
            seen.add(POSES[number].mood)
    assert seen == {Mood.CALM, Mood.SLIP}
    assert (POSES[0], POSES[CHEER]) == (Pose(), Pose(mood=Mood.CHEER))


def test_every_pose_has_its_pictures() -> None:
    common = common_of(to_html(ROW))
    assert [len(phases) for phases in common["sprites"]] == [common["phases"]] * len(POSES)
    assert len(common["sprites"][0][0]) == len(robot_shapes(ROW.resolved_theme, 0, 0))
    looks: list[list[int]] = [[], []]
    for steps in (steps for phases in common["sprites"] for steps in phases):
        before = [*looks[-2], *[0] * len(steps)]
        looks.append([step + before[place] for place, step in enumerate(steps)])
    used = {number for look in looks for number in look}
    assert used == set(range(len(common["shapes"])))
    assert common["palette"].count("robot") == common["palette"].count("puddle") == 1


# -- what it shows -----------------------------------------------------------------------------


def test_values_and_best_moves_are_there_and_shown_when_asked() -> None:
    def shown(page: str) -> tuple[list[str], bool]:
        return data_of(page)["shown"], "\N{MINUS SIGN}1" in Reader(page).texts["text"]

    assert shown(to_html(ROW, guide=GUIDE)) == ([], False)
    assert shown(to_html(ROW, guide=GUIDE, values=True)) == (["values"], True)
    assert shown(to_html(ROW, guide=GUIDE, arrows=True)) == (["policy"], False)
    data = data_of(to_html(ROW, guide=GUIDE))
    assert len(data["picture"]["marks"]) == 1 + max(max(marks) for marks in data["marks"].values())


def test_a_level_without_an_answer_has_nothing_of_it() -> None:
    data = data_of(to_html(ROW))
    assert (data["policy"], data["walker"], data["best"]) == (None, None, "")
    assert "marks" not in {*data, *data["picture"]}
    assert data_of(to_html(ROW, policy="random"))["walker"] == "random"


def test_an_infinite_return_is_not_told_as_a_number() -> None:
    assert data_of(to_html(ROW, guide=GUIDE))["best"] == "\N{MINUS SIGN}1"
    assert data_of(to_html(ROW, guide=Guide([2, 2, -1], Overlay(), float("inf"))))["best"] == ""


def test_returns_are_compared_with_what_is_known() -> None:
    def returns(guide: Guide) -> Any:
        return data_of(to_html(ROW, guide=guide)).get("returns")

    known = replace(GUIDE, random_return=-9.87654321, values=[-2.0, -1 / 3, -math.inf])
    values = [-2, -0.333333333333, None]
    assert returns(known) == {"best": -1, "random": -9.87654, "values": values}
    assert returns(GUIDE) == {"best": -1, "random": None}
    assert returns(replace(known, random_return=-float("inf")))["random"] is None
    assert returns(replace(known, expected_return=float("inf"))) is None


@pytest.mark.parametrize(
    ("value", "told"), [(0.254186, "0.25"), (-0.0345, "-0.035"), (1e-7, "0"), (0.00001, "0.00001")]
)
def test_the_best_average_has_digits_where_it_is_small(value: float, told: str) -> None:
    best = data_of(to_html(ROW, guide=replace(GUIDE, expected_return=value)))["best"]
    assert best == told.replace("-", "\N{MINUS SIGN}")


def test_the_page_knows_the_discount_and_the_goal() -> None:
    data = data_of(to_html(level(size=[3, 1], discount=0.9)))
    assert (data["discount"], data["goal"]) == (0.9, "Move the robot to the exit.")


def test_the_page_knows_the_cells_that_are_good_ends() -> None:
    pit, chest = {"at": [1, 0], "ends": True, "reward": -9}, {"at": [2, 1], "ends": True}
    world = level(size=[4, 2], areas=[pit, {**chest, "reward": 3}])
    assert data_of(to_html(world))["good_ends"] == [6]


def test_panels_are_left_to_the_page() -> None:
    wide = level(size=[3, 1], display={"side_panel": 200, "bottom_panel": 90, "compass": True})
    narrow = level(size=[3, 1])
    boxes = [Reader(to_html(world)).find("svg", role="img")[0] for world in (wide, narrow)]
    assert boxes[0] == boxes[1]


# -- style -----------------------------------------------------------------------------------------


def test_old_browsers_have_the_light_colours() -> None:
    style = files("babyrobot_levels.render").joinpath("static", "picture.css").read_text("utf-8")
    light = dict(re.findall(r"(--[\w-]+): light-dark\((#\w+), #\w+\);", style))
    assert light
    assert dict(re.findall(r"(--[\w-]+): (#\w+);", style)) == light


# -- links -----------------------------------------------------------------------------------------

LONG = ("large-corridor", "standard-maze-2", "random-maze")
"""Levels with the longest links, with things and without, and one whose maze is random."""

OTHERS = [info.name for info in levels() if info.name not in LONG]
SMALL = 25
"""The most cells of a level that is called small."""


def link_of(level: Level) -> str:
    """Return a link as `babyrobot share --link` makes it."""
    game = level.with_maze_seed(0) if level.has_random_maze else level
    return "https://example.org/#" + link_fragment(level, game, guide_of(game))


@given(decorated_worlds())
@settings(max_examples=settings().max_examples // 5)
def test_a_link_is_read_as_its_level(world: World) -> None:
    level = level_of(world)
    link = f"play.html#{link_fragment(level, level)}"
    other = load(link)
    assert other.digest == level.digest
    assert other.to_dict(whole=True) == level.to_dict(whole=True)
    assert play_data(link) == json.loads(json.dumps(page_data(level)))


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(LONG[0], marks=pytest.mark.slow),
        *LONG[1:],
        "two-doors",
        *(pytest.param(name, marks=pytest.mark.sweep) for name in OTHERS),
    ],
)
def test_links_are_short(name: str) -> None:
    level = load(name)
    link = link_of(level)
    width, height = level.size
    # Values and actions differ between the configurations of things.
    longest = 16_000 if level.has_things else 5400
    assert len(link) < (3400 if width * height <= SMALL and not level.has_things else longest)
    assert re.fullmatch(r"[A-Za-z0-9._~-]+", link.partition("#")[2])
    world = level.to_dict(whole=True)
    world.pop("expect", None)
    assert load(link).to_dict(whole=True) == world


@given(st.integers(0, 3000))
def test_however_much_of_the_play_part_is_missing_the_level_is_read(length: int) -> None:
    code, mark, part = LINK.partition("~")
    assert load(code + mark + part[:length]).digest == DIGEST
    assert load(f"{code}%7E{part[:length]}").digest == DIGEST


@given(st.data())
def test_no_changed_character_of_the_code_goes_unnoticed(data: st.DataObject) -> None:
    begin, end = LINK.index("brl1."), LINK.index("~")
    place = data.draw(st.integers(begin + 5, end - 1))
    character = data.draw(st.sampled_from("AZaz09-_.~"))
    if LINK[place] != character:
        with pytest.raises((LevelError, LevelNotFoundError)):
            load(LINK[:place] + character + LINK[place + 1 :])


LINK = link_of(load("two-doors"))
DIGEST = load("two-doors").digest


def test_a_link_says_what_a_page_says() -> None:
    level = load("final-maze")
    guide = guide_of(level)
    assert play_data(link_of(level)) == json.loads(json.dumps(page_data(level, guide=guide)))


def test_a_reader_without_dictionaries_can_use_a_stored_block() -> None:
    size = len(PLAY_DICTIONARY_1)
    head = b"\0" + size.to_bytes(2, "little") + (size ^ 0xFFFF).to_bytes(2, "little")
    data = zlib.decompress(head + PLAY_DICTIONARY_1 + play_stream(LINK), -15)[size:]
    assert json.loads(data) == play_data(LINK)


def test_the_dictionary_of_version_1_stays_as_it_is() -> None:
    told = hashlib.sha256(PLAY_DICTIONARY_1).hexdigest()
    assert told == "71b860eaddc5c0dfdfd43b4e108bf7dba4bcfc188d6394f03fe27593f06517ec"


def test_a_level_that_is_too_large_for_a_link_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    limit = len(link_fragment(ROW, ROW)) - 1
    monkeypatch.setattr("babyrobot_levels.render.page.MAX_LINK", limit)
    with pytest.raises(TooLargeError, match=f"too large for a link: .* limit is {limit:,}"):
        link_fragment(ROW, ROW)


def test_a_long_link_leaves_out_what_decisions_are_graded_by(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bare, whole = replace(GUIDE, values=()), replace(GUIDE, values=[-2.0, -1 / 3, 0.0])
    short_link, long_link = (link_fragment(ROW, ROW, guide) for guide in (bare, whole))
    assert len(short_link) < len(long_link)
    monkeypatch.setattr("babyrobot_levels.render.page.MAX_LINK", len(long_link) - 1)
    assert link_fragment(ROW, ROW, whole) == short_link


def test_a_link_does_not_hold_more_than_a_page_unpacks(monkeypatch: pytest.MonkeyPatch) -> None:
    level = Level.from_fields({"version": 1, "description": "x" * 10_000})
    data = json.dumps(page_data(level), ensure_ascii=False, separators=(",", ":"))
    size = len(data.encode())
    monkeypatch.setattr("babyrobot_levels.render.page_link.MAX_UNPACKED", size)
    assert len(link_fragment(level, level)) < MAX_LINK
    monkeypatch.setattr("babyrobot_levels.render.page_link.MAX_UNPACKED", size - 1)
    with pytest.raises(TooLargeError, match=f"its data has .* the limit is {size - 1:,}"):
        link_fragment(level, level)
