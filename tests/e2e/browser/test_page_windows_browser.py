"""Pages in windows of all sizes: what is seen at once, by touch, zoomed, and on paper."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect
from support.playground import Playground, guide, level

from babyrobot_levels.library.catalogue import load

PORTRAIT, LANDSCAPE = (390, 844), (844, 390)


WORLD = level(size=[4, 3], walls=[{"at": [1, 0], "side": "E"}])
LARGE = level(size=[60, 40], start=[59, 0], exit=[0, 0])


@contextmanager
def phone(browser: Browser, folder: Path, size: tuple[int, int]) -> Iterator[Playground]:
    """A page on a touch screen."""
    width, height = size
    context = browser.new_context(
        viewport={"width": width, "height": height}, has_touch=True, is_mobile=True
    )
    context.set_default_timeout(20_000)
    playground = Playground(context.new_page(), folder)
    yield playground
    assert playground.faults == []
    context.close()


def box(place: Locator) -> tuple[float, float, float, float]:
    """The left, upper, right and lower edge of an element in the window."""
    found = place.bounding_box()
    assert found is not None
    left, top = found["x"], found["y"]
    return left, top, left + found["width"], top + found["height"]


def touch(page: Page, *moments: list[tuple[float, float]]) -> None:
    """Put fingers on the screen, move them, and lift them."""
    session = page.context.new_cdp_session(page)
    for number, points in enumerate([*moments, []]):
        kind = "touchStart" if number == 0 else "touchMove" if points else "touchEnd"
        fingers = [{"x": x, "y": y, "id": finger} for finger, (x, y) in enumerate(points)]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})
    session.detach()


def swipe(ground: Playground, dx: float, dy: float) -> None:
    left, top, right, bottom = box(ground.page.locator("#stage"))
    x, y = (left + right) / 2, (top + bottom) / 2
    touch(ground.page, *([(x + part * dx, y + part * dy)] for part in (0, 0.3, 0.7, 1)))


# -- what is seen at once ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "size"),
    [
        pytest.param("windy-gridworld", PORTRAIT, id="windy-gridworld-size0"),
        pytest.param(
            "windy-gridworld", LANDSCAPE, id="windy-gridworld-size1", marks=pytest.mark.sweep
        ),
        pytest.param(
            "treasure-chests", PORTRAIT, id="treasure-chests-size0", marks=pytest.mark.sweep
        ),
        pytest.param("treasure-chests", LANDSCAPE, id="treasure-chests-size1"),
    ],
)
def test_a_phone_shows_all_that_is_needed(
    name: str, size: tuple[int, int], browser: Browser, tmp_path: Path
) -> None:
    world = load(name)
    with phone(browser, tmp_path, size) as ground:
        ground.open(world, guide=guide(world))
        page = ground.page
        actions = [page.locator(".pad:visible button").nth(number) for number in range(5)]
        names = ("Undo", "Hint", "Retry", "New luck")
        quick = [page.locator(".quick").get_by_role("button", name=name) for name in names]
        parts = [page.locator(place) for place in ("h1", ".score", "#stage svg", "#message")]
        for part in (*parts, *actions, *quick):
            left, top, right, bottom = box(part)
            assert 0 <= left < right <= size[0]
            assert 0 <= top < bottom <= size[1]
        for button in (*actions, *quick):
            left, top, right, bottom = box(button)
            assert min(right - left, bottom - top) >= 44
        assert page.evaluate("() => document.documentElement.scrollWidth") == size[0]


def test_an_upright_tablet_shows_the_picture_above_what_is_learned_with(
    browser: Browser, tmp_path: Path
) -> None:
    with phone(browser, tmp_path, (820, 1180)) as ground:
        ground.open(WORLD, guide=guide(WORLD))
        ground.press("e")
        _, top, _, bottom = box(ground.page.locator("#stage"))
        assert 0 < top < bottom < box(ground.page.locator("#learn"))[1]


def test_messages_move_nothing(browser: Browser, tmp_path: Path) -> None:
    with phone(browser, tmp_path, PORTRAIT) as ground:
        ground.open(WORLD, guide=guide(WORLD))
        places = [ground.page.locator(place) for place in ("#stage svg", ".pad:visible", ".score")]
        before = [box(place) for place in places]
        for key in ("d", "ArrowRight", "l", "h", "s", "s", "d"):
            ground.press(key)
            assert [box(place) for place in places] == before
        # At the end the result takes the place of the actions.
        ground.press("d")
        assert [box(place) for place in places[::2]] == before[::2]
        assert ground.kind == "exit"


def test_without_a_keyboard_no_keys_are_told(browser: Browser, tmp_path: Path) -> None:
    with phone(browser, tmp_path, (1024, 768)) as ground:
        ground.open(WORLD)
        ground.page.get_by_text("Keys", exact=True).click()
        assert not ground.page.get_by_text("stays").is_visible()
        expect(ground.page.get_by_text("swipe over the picture")).to_be_visible()


# -- fingers -----------------------------------------------------------------------------------


def test_a_swipe_is_one_move(browser: Browser, tmp_path: Path) -> None:
    with phone(browser, tmp_path, LANDSCAPE) as ground:
        ground.open(WORLD)
        for shift, state in (((90, 9), 1), ((-5, 90), 5), ((-90, 0), 4), ((9, -90), 0)):
            swipe(ground, *shift)
            # A finger that is lifted is told to the page when that has time.
            expect(ground.page.locator("#robot")).to_have_attribute("data-state", str(state))
        assert ground.number("steps") == 4
        swipe(ground, 8, 3)  # A tap.
        assert ground.number("steps") == 4
        assert ground.page.evaluate("() => window.scrollY") == 0


def test_a_robot_that_turns_is_swiped_to_turn(browser: Browser, tmp_path: Path) -> None:
    with phone(browser, tmp_path, PORTRAIT) as ground:
        ground.open(level(size=[4, 3], heading="E"), turns=True)
        swipe(ground, 0, -90)
        assert ground.state == 1
        swipe(ground, 90, 0)
        assert (ground.state, ground.message[:12]) == (1, "Turned right")
        swipe(ground, 0, -90)
        assert ground.state == 5
        swipe(ground, 0, 90)
        assert ground.number("steps") == 3


def test_a_pinch_zooms_and_moves_nothing(browser: Browser, tmp_path: Path) -> None:
    with phone(browser, tmp_path, PORTRAIT) as ground:
        ground.open(WORLD)
        picture = ground.page.locator("#stage svg")
        left, top, right, bottom = box(picture)
        x, y = (left + right) / 2, (top + bottom) / 2
        fingers = [[(x - apart, y), (x + apart, y)] for apart in (30, 45, 60, 75)]
        touch(ground.page, *fingers)
        wide = box(picture)
        assert wide[2] - wide[0] == pytest.approx(2.5 * (right - left), rel=0.05)
        assert ground.number("steps") == 0
        touch(ground.page, *reversed(fingers))
        assert box(picture) == pytest.approx((left, top, right, bottom), abs=2)


def test_a_tap_tells_what_is_there(browser: Browser, tmp_path: Path) -> None:
    with phone(browser, tmp_path, PORTRAIT) as ground:
        ground.open(WORLD)
        _, _, right, bottom = box(ground.page.locator("#stage svg"))
        ground.page.touchscreen.tap(right - 30, bottom - 30)
        expect(ground.page.locator("#cell")).to_contain_text("[3, 2] · exit: ends the episode")


# -- zoom and map ------------------------------------------------------------------------------


def test_keys_and_buttons_zoom(ground: Playground) -> None:
    ground.open(WORLD)
    picture, chart = ground.page.locator("#stage svg"), ground.page.locator("#map")
    left, _, right, _ = before = box(picture)
    expect(chart).to_be_hidden()
    ground.press("+")
    expect(chart).to_be_visible()
    assert box(picture)[2] - box(picture)[0] == pytest.approx(1.4 * (right - left), abs=0.1)
    ground.press("-", "-", "-")
    assert box(picture) == pytest.approx(before, abs=0.1)
    ground.page.get_by_role("button", name="Zoom in").click(click_count=2)
    assert box(picture)[2] - box(picture)[0] == pytest.approx(1.96 * (right - left), abs=0.1)
    ground.press("0")
    assert box(picture) == pytest.approx(before, abs=0.1)
    expect(chart).to_be_hidden()


def window_on_map(ground: Playground) -> list[float]:
    """The left and upper edge, width and height of the window on the map, as shares of it."""
    shares: list[float] = ground.page.evaluate(
        """() => {
          const map = document.querySelector("#map");
          const { width, height } = map.viewBox.baseVal;
          const [x, y, w, h] = ["x", "y", "width", "height"].map((name) =>
            Number(map.querySelector("rect").getAttribute(name)));
          return [x / width, y / height, w / width, h / height];
        }"""
    )
    return shares


def test_the_map_of_a_large_level_shows_the_window(ground: Playground) -> None:
    ground.page.set_viewport_size({"width": 390, "height": 700})
    ground.page.emulate_media(reduced_motion="reduce")
    ground.open(LARGE)
    expect(ground.page.locator("#map")).to_be_visible()
    x, y, width, height = window_on_map(ground)
    # The robot starts in the upper right corner.
    assert 0.1 < width < 0.4
    assert x + width == pytest.approx(1, abs=0.03)
    assert y == pytest.approx(0, abs=0.03)
    dot = ground.page.locator("#map circle")
    assert float(dot.get_attribute("cx") or 0) == pytest.approx(59.5 * 64, abs=9)
    ground.press(*["ArrowDown"] * 12)
    ground.wait_until_still()
    assert window_on_map(ground)[1] > 0.05
    left, top, right, bottom = box(ground.page.locator("#map"))
    ground.page.mouse.click(left + 0.5 * (right - left), top + 0.8 * (bottom - top))
    x, y, width, height = window_on_map(ground)
    assert x + width / 2 == pytest.approx(0.5, abs=0.05)
    assert y + height / 2 == pytest.approx(0.8, abs=0.1)
    # The robot's next step leads back to it.
    ground.press("ArrowDown")
    ground.wait_until_still()
    x, _, width, _ = window_on_map(ground)
    assert x + width == pytest.approx(1, abs=0.03)


def test_the_map_shows_no_answers(ground: Playground) -> None:
    world = level(size=[4, 3])
    ground.open(world, guide=guide(world), values=True)
    ground.press("+")
    image = ground.page.locator("#map image").get_attribute("href") or ""
    assert "ground" in image
    assert "heat" not in image


@pytest.mark.parametrize("size", [(1280, 720), (390, 844), (844, 390)])
def test_the_result_lies_beside_the_board_or_below_it(
    size: tuple[int, int], ground: Playground
) -> None:
    width, height = size
    ground.page.set_viewport_size({"width": width, "height": height})
    ground.open(level(size=[4, 3], exit=[3, 0]))
    before = box(ground.page.locator("#stage"))
    ground.press(*"ddd")
    ground.wait_until_still()
    card, board = (box(ground.page.locator(place)) for place in ("#result", "#stage"))
    assert board == before
    assert card[0] >= board[2] or card[1] >= board[3]
    assert card[3] <= height
    expect(ground.page.locator(".pad:visible")).to_have_count(0)
    ground.press("r")
    expect(ground.page.locator(".pad:visible")).to_have_count(1)


def test_a_mouse_drags_a_picture_that_is_zoomed(ground: Playground) -> None:
    ground.open(WORLD)
    ground.press("+", "+", "+")
    before = box(ground.page.locator("#stage svg"))
    left, top, right, bottom = box(ground.page.locator("#stage"))
    x, y = (left + right) / 2, (top + bottom) / 2
    ground.page.mouse.move(x, y)
    ground.page.mouse.down()
    ground.page.mouse.move(x - 80, y - 50, steps=4)
    ground.page.mouse.up()
    after = box(ground.page.locator("#stage svg"))
    assert (before[0] - after[0], before[1] - after[1]) == pytest.approx((80, 50), abs=2)
    assert ground.number("steps") == 0


# -- the legend --------------------------------------------------------------------------------


def test_the_cell_under_the_pointer_is_told(ground: Playground) -> None:
    world = load("final-maze")
    ground.open(world)
    left, top, right, _ = box(ground.page.locator("#stage svg"))
    cell = (right - left) / 8
    ground.page.mouse.move(left + 5.5 * cell, top + 1.5 * cell)
    expect(ground.page.locator("#cell")).to_have_text(
        "[5, 1] · large puddle: costs 4, skids 6 times in 10"
    )
    here = ground.page.locator("#rules .here")
    expect(here).to_have_text("large puddle: costs 4, skids 6 times in 10")
    ground.page.mouse.move(2, 2)
    expect(ground.page.locator("#cell")).to_be_hidden()
    expect(here).to_have_count(0)


def test_a_rule_with_the_focus_shows_its_cells(ground: Playground) -> None:
    ground.open(load("final-maze"))
    rules = ground.page.get_by_role("listitem")
    expect(rules.get_by_text("each step: costs 1")).to_be_visible()
    ground.page.get_by_role("button", name="small puddle").focus()
    outlines = ground.page.locator("#outlines").get_attribute("d") or ""
    assert re.findall(r"M(\d+) (\d+)", outlines) == [
        (str(64 * x + 3), str(64 * y + 3)) for x, y in ((2, 0), (2, 2), (7, 3))
    ]
    ground.page.locator("#stage").focus()
    assert ground.page.locator("#outlines").get_attribute("d") == ""


# -- paper -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["final-maze", "windy-gridworld"])
def test_a_page_is_printed_on_one_sheet(name: str, ground: Playground) -> None:
    world = load(name)
    ground.open(world, guide=guide(world))
    sheets = re.findall(rb"/Type\s*/Page\b", ground.page.pdf(format="A4"))
    assert len(sheets) == 1
    ground.page.emulate_media(media="print", color_scheme="dark")
    for place in ("h1", "#stage svg", "#rules"):
        expect(ground.page.locator(place)).to_be_visible()
    for place in (".pad", ".quick", ".controls", ".score", "#message", "#map"):
        assert not ground.page.locator(place).first.is_visible()
    inks = ground.page.evaluate(
        "() => ['color', 'backgroundColor'].map((name) => getComputedStyle(document.body)[name])"
    )
    assert inks == ["rgb(0, 0, 0)", "rgb(255, 255, 255)"]
