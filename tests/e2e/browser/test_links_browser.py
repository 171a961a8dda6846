"""Links in a real browser: a page plays the level of its address, and nothing worse than that."""

from __future__ import annotations

import copy
import io
import re
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from PIL import Image, ImageChops
from playwright.sync_api import Browser, Page, expect
from support.codes import CODE, play_sealed, played
from support.combinations import swept
from support.playground import Playground
from support.worlds import World, decorated_worlds, level_of

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.page import link_fragment, page_data, to_html
from babyrobot_levels.render.page_link import MAX_UNPACKED

SOME = ["final-maze", "four-corners", "glasshouse", "random-maze", "side-panel", "teleport-pads"]
"""Between them, they have all that a level can have; worlds that are drawn have the rest."""
OWN = Level.from_fields({"version": 1, "size": [4, 3], "title": "The page's own", "theme": "print"})
NO_LEVEL = "This link is damaged: its content is not a level."


@pytest.fixture(scope="module")
def opened(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Playground]:
    context = browser.new_context(viewport={"width": 1280, "height": 1024}, device_scale_factor=1)
    context.set_default_timeout(20_000)
    playground = Playground(context.new_page(), tmp_path_factory.mktemp("page"))
    playground.open(OWN)
    yield playground
    context.close()


@pytest.fixture
def ground(opened: Playground) -> Iterator[Playground]:
    """A page with a level of its own, which is opened by links to it."""
    opened.faults.clear()
    yield opened
    assert opened.faults == []


def game_of(name: str) -> Level:
    level = load(name)
    return level.with_maze_seed(0) if level.has_random_maze else level


def fragment_of(name: str) -> str:
    game = game_of(name)
    return link_fragment(load(name), game, guide_of(game))


def seen(page: Page) -> tuple[str, str]:
    """Return the title, and all that the page shows."""
    main = page.evaluate("() => document.querySelector('main').outerHTML")
    return page.title(), main.replace(' class=""', "")


def notice(ground: Playground) -> str:
    expect(ground.page.locator("#notice")).to_be_visible()
    return ground.page.locator("#notice").inner_text()


# -- the level of the link -------------------------------------------------------------------


@pytest.mark.parametrize("name", swept(SOME[::2], SOME))
def test_a_link_shows_what_the_levels_own_page_shows(
    name: str, ground: Playground, tmp_path: Path
) -> None:
    ground.follow("")
    own = seen(ground.page)
    ground.follow(fragment_of(name))
    linked = seen(ground.page)
    game = game_of(name)
    (tmp_path / "its-own.html").write_text(to_html(game, guide=guide_of(game)), "utf-8")
    ground.page.goto((tmp_path / "its-own.html").as_uri())
    ground.page.wait_for_selector("body.ready")
    assert seen(ground.page) == linked != own


@pytest.mark.parametrize("name", swept(["glasshouse", "teleport-pads"], SOME))
def test_what_scripts_paint_is_the_picture(name: str, page: Page) -> None:
    """A page has its picture twice: as it is, and as data. Both look alike."""
    game = game_of(name)
    html = to_html(game, guide=guide_of(game), values=True, arrows=True)
    (plain,) = re.findall(
        r'<svg viewBox="[^"]*" width="\d+" height="\d+" role="img".*?</svg>', html, re.S
    )
    page.goto("about:blank")
    page.set_content(html)
    page.wait_for_selector("body.ready")
    drawn = page.evaluate(
        "() => { const svg = document.querySelector('#stage svg'); svg.removeAttribute('style');"
        " for (const part of svg.querySelectorAll('g'))"
        "   if (part.id === 'robot' || getComputedStyle(part).display === 'none') part.remove();"
        " return svg.outerHTML }"
    )

    def picture(svg: str) -> Image.Image:
        page.set_content(f"<body style='margin:0'>{svg}")
        return Image.open(io.BytesIO(page.locator("svg").screenshot())).convert("RGB")

    first, second = picture(plain), picture(drawn)
    assert first.size == second.size
    difference = np.asarray(ImageChops.difference(first, second))
    # Data has lengths in tenths of a pixel: edges between them differ a little.
    assert np.mean(difference) < 0.25
    assert np.mean(difference.max(axis=2) > 64) < 0.0003


def test_a_link_without_best_moves_has_no_controls_for_them(ground: Playground) -> None:
    maze = load("maze")
    ground.follow(link_fragment(maze, maze))
    for name in ("#watch", "#show-values", "#show-policy", "#best"):
        expect(ground.page.locator(name)).to_be_hidden()
    ground.press("p", "v", "b", "d")
    assert ground.number("steps") == 1


def test_another_fragment_is_another_level(ground: Playground) -> None:
    page = ground.page
    ground.follow("")
    own = seen(page)

    def change(fragment: str, title: str) -> None:
        page.evaluate("(fragment) => { location.hash = fragment }", fragment)
        expect(page.locator("h1")).to_have_text(title)

    change(fragment_of("maze"), "The maze")
    page.keyboard.press("s")
    change(fragment_of("walls"), load("walls").title or "")
    assert ground.number("steps") == 0
    page.evaluate("() => { location.hash = 'brl1.3.abc' }")
    assert "The page shows its own level instead." in notice(ground)
    assert page.locator("h1").inner_text() == OWN.title
    change(fragment_of("maze"), "The maze")
    expect(page.locator("#notice")).to_be_hidden()
    change("", OWN.title or "")
    assert seen(page) == own
    # The last of many wins, in whatever order they are unpacked.
    page.evaluate(
        "(all) => { for (const each of all) location.hash = each }",
        [fragment_of("four-rooms"), fragment_of("maze"), fragment_of("default")],
    )
    expect(page.locator("h1")).to_have_text(load("default").title or "")


@pytest.mark.parametrize("is_sound", [True, False])
def test_a_link_that_takes_long_does_not_come_back(
    is_sound: bool, page: Page, tmp_path: Path
) -> None:
    """The first link is unpacked when the next one is shown already."""
    page.add_init_script(
        """
        const Real = DecompressionStream;
        const held = new Promise((release) => { window.release = release; });
        let count = 0;
        window.DecompressionStream = function (format) {
          const isFirst = ++count === 1;
          window.unpacking = count;
          const transform = async (piece, control) => {
            if (isFirst) await held;
            control.enqueue(piece);
          };
          const { readable, writable } = new TransformStream({ transform });
          return { writable, readable: readable.pipeThrough(new Real(format)) };
        };
        """
    )
    ground = Playground(page, tmp_path)
    ground.open(OWN)
    slow = fragment_of("maze") if is_sound else play_sealed(b"\xff\xff")
    page.evaluate("(fragment) => { location.hash = fragment }", slow)
    page.wait_for_function("() => window.unpacking === 1")
    page.evaluate("(fragment) => { location.hash = fragment }", fragment_of("walls"))
    expect(page.locator("h1")).to_have_text(load("walls").title or "")
    before = seen(page)
    page.evaluate("() => { window.release(); return new Promise((go) => setTimeout(go, 300)) }")
    assert seen(page) == before
    expect(page.locator("#notice")).to_be_hidden()
    assert ground.faults == []


@pytest.mark.sweep
def test_whatever_level_a_link_has_the_page_shows_it(ground: Playground) -> None:
    checks = [HealthCheck.too_slow]

    @settings(deadline=None, max_examples=20, suppress_health_check=checks)
    @given(decorated_worlds())
    def is_shown(world: World) -> None:
        level = level_of({**world, "title": "Some world"})
        ground.follow(link_fragment(level, level))
        expect(ground.page.locator("#notice")).to_be_hidden()
        assert ground.page.title() == "Some world"

    is_shown()


# -- links that do not play --------------------------------------------------------------------

LINK = fragment_of("walls")


@pytest.mark.parametrize(
    ("fragment", "message"),
    [
        (LINK[:-5], "This link is cut off: its last 5 characters are missing."),
        (LINK.partition("~")[0] + "~", "This link is cut off or damaged."),
        (LINK + "abc", "This link is damaged."),
        (LINK[:-9] + "!" + LINK[-8:], "This link is damaged."),
        (f"{CODE}~1.0.", "This link is damaged."),
        (LINK.replace("~1.", "~31."), "has version 31, but this page supports versions 1 and 2."),
        (play_sealed(b""), "This link is damaged: it cannot be decompressed."),
        (play_sealed(zlib.compress(b"{}")[2:-4] + b"more"), "damaged: it cannot be decompressed."),
    ],
)
def test_what_is_wrong_is_said_and_the_own_level_stays(
    fragment: str, message: str, ground: Playground
) -> None:
    assert fragment != LINK
    ground.follow(fragment)
    told = notice(ground)
    assert message in told
    assert told.endswith("The page shows its own level instead.")
    assert ground.page.title() == OWN.title
    ground.press("d")
    assert (ground.state, ground.number("steps")) == (1, 1)


def test_a_bare_code_says_which_command_makes_a_link(ground: Playground) -> None:
    ground.follow(CODE)
    notice(ground)
    assert ground.page.locator("#notice code").all_inner_texts() == [
        "babyrobot share LEVEL --link ADDRESS"
    ]


def test_a_bomb_is_left_before_it_goes_off(page: Page, tmp_path: Path) -> None:
    page.add_init_script(
        """
        const Real = DecompressionStream;
        window.counted = 0;
        window.DecompressionStream = function (format) {
          const { readable, writable } = new Real(format);
          const transform = (piece, control) => {
            window.counted += piece.length;
            control.enqueue(piece);
          };
          return { writable, readable: readable.pipeThrough(new TransformStream({ transform })) };
        };
        """
    )
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = b" " * (1 << 20)
    bomb = b"".join(packer.compress(block) for _ in range(200)) + packer.flush()
    ground = Playground(page, tmp_path)
    ground.open(OWN)
    ground.follow(play_sealed(bomb))
    assert "its content is larger than any level" in notice(ground)
    assert MAX_UNPACKED < page.evaluate("() => window.counted") < 2 * MAX_UNPACKED
    assert ground.faults == []


def test_a_browser_that_cannot_unpack_says_so(page: Page, tmp_path: Path) -> None:
    page.add_init_script("delete window.DecompressionStream")
    ground = Playground(page, tmp_path)
    ground.open(OWN)
    ground.follow(LINK)
    assert "This browser is too old to open links." in notice(ground)
    assert ground.faults == []


# -- hostile links -----------------------------------------------------------------------------

DATA: Any = page_data(load("puddles"), guide=guide_of(load("puddles")))
EVIL = (
    "</title></script></style></svg><script>window.hacked = 1</script>"
    "<img src=x onerror='window.hacked = 2'><foreignObject><body onload='window.hacked = 3'>"
)


def test_hostile_texts_are_texts(ground: Playground) -> None:
    data = copy.deepcopy(DATA)
    data |= {
        "title": EVIL,
        "description": EVIL,
        "goal": EVIL,
        "best": EVIL,
        "facts": [[EVIL, EVIL]],
    }
    data["picture"]["layers"]["base"] = [[0, 0, [[3, 0, 9, 9, EVIL, 90]]]]
    ground.follow(played(data))
    expect(ground.page.locator("#notice")).to_be_hidden()
    assert ground.page.title() == EVIL
    for place in (
        "h1",
        "#description",
        "#message",
        "#best",
        "#facts dt",
        "#facts dd",
        "#ground text >> nth=0",
    ):
        assert ground.page.locator(place).text_content() == EVIL
    ground.press("d", "v", "b", "p")
    assert ground.page.evaluate("() => window.hacked") is None
    assert ground.page.locator("img, foreignObject").count() == 0


def test_what_nobody_asked_for_is_ignored(ground: Playground) -> None:
    ground.follow(played({**DATA, "__proto__": {"hidden": True}, "onload": "window.hacked = 1"}))
    expect(ground.page.locator("#notice")).to_be_hidden()
    assert ground.page.evaluate("() => [window.hacked, ({}).hidden]") == [None, None]


def shape(*values: Any) -> Callable[[Any], None]:
    def put(data: Any) -> None:
        data["picture"]["layers"]["base"] = [[0, 0, [list(values)]]]

    return put


def path(commands: str) -> Callable[[Any], None]:
    return shape(2, 0, commands)


def field(value: Any, *route: Any) -> Callable[[Any], None]:
    def put(data: Any) -> None:
        inner = data
        for key in route[:-1]:
            inner = inner[key]
        inner[route[-1]] = value

    return put


def last_way(row: list[float]) -> Callable[[Any], None]:
    """Return what lets the way east from the cell before the exit, which is the last, be a row."""

    def put(data: Any) -> None:
        data["table"][5 * 7 + 2] = len(data["rows"])
        data["rows"].append(row)

    return put


BILLION = 10**9

HOSTILE: dict[str, Callable[[Any], None]] = {
    "colours that are addresses": field("url(javascript:alert(1))", "picture", "palette", 0),
    "colours of two lines": field("#123456\n", "picture", "palette", 0),
    "foreign objects": shape("foreignObject", 0, 0, 0, 9, 9),
    "kinds of the language": shape("constructor", 0, 0, 0, 9, 9),
    "places that are parts": shape(0, 0, 0.5, 0, 9, 9),
    "places far away": shape(0, 0, 10**12, 0, 9, 9),
    "missing numbers": shape(0, 0, 0),
    "too many numbers": shape(0, 0, 0, 0, 9, 9, 100, 0, 0, 0),
    "colours of no palette": shape(0, 99, 0, 0, 9, 9),
    "colours of no scale": shape(0, -67, 0, 0, 9, 9),
    "scales of no colours": field(["red", "blue"], "picture", "scale"),
    "bars of no scale": shape(5, -1, 0, 0, 9, 9, 0, 80),
    "legends higher than the picture": field(10_000, "picture", "legend"),
    "texts that are none": shape(3, 0, 0, 0, {"a": 1}, 9),
    "opacities above all": shape(0, 0, 0, 0, 9, 9, 101),
    "again without a first": shape(4, 0, 1000, 0, 0),
    "paths that are none": path("alert(1)"),
    "paths that lead far": path("m0 0l99999999999 0"),
    "outlines of two points": path("s0 0 1 1"),
    "pictures of no size": field(0, "picture", "width"),
    "outlines again and again": field(
        [[0, 0, [[2, 0, "s" + "1 1 " * 5000], *[[4, 0, 999, 0, 0]] * 9000]]],
        "picture",
        "layers",
        "base",
    ),
    "more shapes than there is room for": field(
        [[0, 0, [[1, 0, 0, 0, 1, 1]] * 200_001]], "picture", "layers", "base"
    ),
    "a billion cells": lambda data: data.update(width=BILLION, height=1),
    "no cells": field(0, "width"),
    "cells of another size": field(4, "width"),
    "no starts": field([], "starts"),
    "exits outside": field([-1], "exits"),
    "too much speed": field(101, "speed"),
    "a margin of a mile": field(10**6, "margin"),
    "chances above one": field([2, 0, -1, 0, 0, 0, -1, 0, -1, 0, 0, 0], "rows", 0),
    "half an outcome": field([1, 0, -1], "rows", 0),
    "rewards without end": field([1, 0, None, 0, 0, 0], "rows", 0),
    "ways out of the level": field([1, -1, -1, 0, 0, 0], "rows", 0),
    "ways past the last cell": last_way([1, 2, -1, 1, 0, 0]),
    "ways to what is over": last_way([1, 1, -1, 0, 0, 0]),
    "events that are none": field([1, 0, -1, 0, 6, 0], "rows", 0),
    "ends that are neither": field([1, 0, -1, 2, 0, 0], "rows", 0),
    "poses that are none": field([1, 0, -1, 0, 0, 11], "rows", 0),
    "rows that are none": field(BILLION, "table", 0),
    "states with half a row": field(-1, "table", 0),
    "a table too short": lambda data: data["table"].pop(),
    "rows as long as books": lambda data: data.update(
        rows=[[1 / 512, 0, 0, 0, 0, 0] * 512],
        table=[0] * 5 * 128 * 128,
        width=128,
        height=128,
        possible=[31] * 128 * 128,
        policy=None,
        walker=None,
    ),
    "more cells than there is room for": lambda data: data.update(
        rows=[[1, 0, 0, 0, 0, 0]],
        table=[0] * 5 * 129 * 128,
        width=129,
        height=128,
        possible=[31] * 129 * 128,
        policy=None,
        walker=None,
    ),
    "nothing that can be done": field(0, "possible", 0),
    "good ends in no cell": field([BILLION], "good_ends"),
    "a goal that is none": field(["x"], "goal"),
    "averages that are texts": field("<b>", "returns", "best"),
    "fewer values than states": field([0], "returns", "values"),
    "a policy of a sixth action": field(5, "policy", 0),
    "a title that is none": field(["x"], "title"),
    "facts that are none": field([["a"]], "facts"),
    "layers of others": field(["stage"], "shown"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_no_level_is_not_shown(name: str, ground: Playground) -> None:
    data = copy.deepcopy(DATA)
    HOSTILE[name](data)
    assert data != DATA
    ground.follow(played(data))
    assert notice(ground) == f"{NO_LEVEL} The page shows its own level instead."
    assert ground.page.title() == OWN.title
    ground.press("d")
    assert (ground.state, ground.number("steps")) == (1, 1)


@pytest.mark.parametrize("text", ["", "null", "[]", "{"])
def test_what_is_no_data_is_not_shown(text: str, ground: Playground) -> None:
    ground.follow(play_sealed(zlib.compress(text.encode(), 9)[2:-4]))
    assert notice(ground) == f"{NO_LEVEL} The page shows its own level instead."


def test_the_data_of_these_tests_is_good(ground: Playground) -> None:
    # Otherwise the tests above would be content with a page that shows nothing.
    ground.follow(played(DATA))
    expect(ground.page.locator("#notice")).to_be_hidden()
    assert ground.page.title() == load("puddles").title
