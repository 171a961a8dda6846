"""What the mouse draws on the picture of a level, tool by tool."""

from __future__ import annotations

import re
from typing import Literal

import pytest
from playwright.sync_api import Locator, expect
from support.editors import OpenEditor
from support.hands import Mouse, Point

pytestmark = pytest.mark.slow

Button = Literal["left", "middle", "right"]

LEVEL = "version: 1\nsize: [6, 4]\n"


class Hand(Mouse):
    """A mouse with its buttons, and with keys that are held."""

    @property
    def text(self) -> str:
        return self.editor.session.text

    @property
    def picture(self) -> Locator:
        return self.page.locator(".stage > svg")

    def drag(self, *points: Point, button: Button = "left") -> None:
        self.begin(*points, button=button)
        self.page.mouse.up(button=button)

    def begin(self, *points: Point, button: Button = "left") -> None:
        """Press at the first point, and move through the others."""
        mouse = self.page.mouse
        mouse.move(*points[0])
        mouse.down(button=button)
        for point in points[1:]:
            mouse.move(*point, steps=5)

    def draw(self, *points: Point, button: Button = "left", held: str | None = None) -> None:
        """Drag through points of the grid, in cells, and wait until the level has changed."""
        with self.changing():
            if held is not None:
                self.page.keyboard.down(held)
            self.drag(*(self.at(*point) for point in points), button=button)
            if held is not None:
                self.page.keyboard.up(held)


@pytest.fixture
def hand(editor_page: OpenEditor) -> Hand:
    """A mouse at an empty level of six columns and four rows."""
    return Hand(editor_page(LEVEL))


@pytest.mark.parametrize(
    ("tool", "points", "line"),
    [
        ("walls", [(1.3, 1), (3.7, 1.1)], "- {at: [1, 0], side: S, length: 3}"),
        ("walls", [(1.1, 1.1), (1, 2.5)], "- {at: [0, 1], side: E, length: 2}"),
        ("large", [(1.5, 1.5)], "- {at: [1, 1], size: large}"),
        ("blocked", [(1.5, 1.5), (3.5, 1.5)], "- {at: [1, 1], size: [3, 1]}"),
        ("area", [(2.5, 2.5), (1.5, 1.5)], '- {at: [1, 1], size: [2, 2], color: "#8fb996"}'),
        ("item", [(4.5, 0.5)], "- {name: key, at: [4, 0]}"),
        ("exit", [(4.5, 2.5)], "exit: [4, 2]"),
        ("warp", [(1.5, 1.5), (4.5, 2.5)], "- {at: [1, 1], to: [4, 2]}"),
    ],
)
def test_a_tool_adds_its_line(hand: Hand, tool: str, points: list[Point], line: str) -> None:
    hand.choose(tool)
    hand.draw(*points)
    assert line in hand.text


def test_a_mover_walks_through_the_cells_that_were_dragged_over(hand: Hand) -> None:
    hand.choose("path")
    hand.draw((1.5, 1.5), (3.5, 1.5), (3.5, 2.5))
    assert "path: [[1, 1], [2, 1], [3, 1], [3, 2]]" in hand.text


def test_a_drag_along_walls_removes_them(hand: Hand) -> None:
    hand.draw((1.5, 1), (4.5, 1))
    hand.draw((2.5, 1), (3.5, 1))
    assert "- {at: [1, 0], side: S}" in hand.text
    assert "- {at: [4, 0], side: S}" in hand.text


def test_a_click_builds_a_wall_and_the_next_one_removes_it(hand: Hand) -> None:
    empty = hand.text
    hand.draw((2, 1.5))
    assert "- {at: [1, 1], side: E}" in hand.text
    hand.draw((2, 1.5))
    assert hand.text == empty


def test_a_click_removes_glass_as_it_removes_a_wall(hand: Hand) -> None:
    empty = hand.text
    hand.choose("glass")
    hand.draw((2, 1.5))
    hand.choose("walls")
    hand.draw((2, 1.5))
    assert hand.text == empty


def test_the_options_of_glass_are_a_number(hand: Hand) -> None:
    hand.choose("glass")
    hand.page.get_by_label("Lets through").fill("0.25")
    hand.draw((1.5, 1), (2.5, 1))
    assert "- {at: [1, 0], side: S, length: 2, pass: 0.25}" in hand.text


def test_the_wheel_changes_the_number_of_selected_glass(hand: Hand) -> None:
    hand.choose("glass")
    hand.draw((2, 1.5))
    hand.choose("select")
    hand.drag(hand.at(2, 1.5))
    with hand.changing():
        hand.page.mouse.wheel(0, -100)
    assert "pass: 0.55" in hand.text


def test_the_right_button_erases(hand: Hand) -> None:
    hand.choose("small")
    hand.draw((1.5, 1.5), (2.5, 1.5))
    hand.choose("walls")
    hand.draw((3.5, 1), (4.5, 1))
    hand.draw((1.5, 1.5), button="right")
    assert "at: [1, 1]" not in hand.text
    hand.draw((3.5, 1), (4.5, 1), button="right")
    assert "walls" not in hand.text


def test_shift_fills_a_rectangle(hand: Hand) -> None:
    hand.choose("blocked")
    hand.draw((1.5, 1.5), (2.5, 2.5), held="Shift")
    assert "- {at: [1, 1], size: [2, 2]}" in hand.text


def test_a_fill_paints_what_was_shown_before(hand: Hand) -> None:
    hand.draw((5, 0.5), (5, 3.5))
    hand.choose("large")
    hand.page.locator("[data-modifier=fill]").click()
    hand.page.mouse.move(*hand.at(5.5, 1.5))
    # The wall is between five columns and the last one.
    ghost = hand.page.locator(".preview path.ghost")
    expect(ghost).to_have_attribute("d", re.compile("^(M[^M]*){4}$"))
    hand.page.mouse.move(*hand.at(2.5, 1.5))
    expect(ghost).to_have_attribute("d", re.compile("^(M[^M]*){20}$"))
    hand.draw((5.5, 1.5))
    level = hand.editor.session.level
    assert level is not None
    assert {puddle.at for puddle in level.puddles} == {(5, y) for y in range(4)}


def test_the_start_is_dragged_with_any_brush(hand: Hand) -> None:
    hand.choose("small")
    hand.draw((0.5, 0.5), (2.5, 1.5))
    assert "start: [2, 1]" in hand.text
    assert "puddles" not in hand.text


def test_alt_click_takes_the_tool_of_what_is_there(hand: Hand) -> None:
    hand.choose("large")
    hand.draw((1.5, 1.5))
    hand.choose("walls")
    hand.page.keyboard.down("Alt")
    hand.drag(hand.at(1.5, 1.5))
    hand.page.keyboard.up("Alt")
    expect(hand.page.locator("[data-tool=large]")).to_have_attribute("aria-pressed", "true")
    hand.draw((3.5, 1.5))
    assert "- {at: [3, 1], size: large}" in hand.text


def test_escape_ends_a_drag_without_a_change(hand: Hand) -> None:
    hand.begin(hand.at(1.5, 1), hand.at(4.5, 1))
    expect(hand.page.locator(".preview path")).not_to_have_count(0)
    hand.page.keyboard.press("Escape")
    expect(hand.page.locator(".preview path")).to_have_count(0)
    hand.page.mouse.up()
    hand.draw((3, 2.5))
    assert hand.text.count("- {") == 1


def test_what_is_selected_is_outlined_moved_and_deleted(hand: Hand) -> None:
    hand.choose("small")
    hand.draw((1.5, 1.5))
    hand.choose("select")
    hand.drag(hand.at(1.5, 1.5))
    expect(hand.page.locator(".selected path")).not_to_have_count(0)
    hand.draw((1.5, 1.5), (3.5, 2.5))
    assert "- {at: [3, 2], size: small}" in hand.text
    expect(hand.page.locator(".selected path")).not_to_have_count(0)
    with hand.changing():
        hand.page.keyboard.press("Delete")
    assert "puddles" not in hand.text
    expect(hand.page.locator(".selected path")).to_have_count(0)


def test_what_is_moved_in_a_drawing_stays_selected(editor_page: OpenEditor) -> None:
    drawn = "version: 1\nmap: |\n  +---+---+---+\n  | S   o   E |\n  +---+---+---+\n"
    hand = Hand(editor_page(drawn.replace("E |", "E |\n  +   +   +   +\n  |           |")))
    hand.choose("select")
    hand.drag(hand.at(1.5, 0.5))
    hand.draw((1.5, 0.5), (1.5, 1.5))
    expect(hand.page.locator(".selected path")).not_to_have_count(0)
    hand.draw((1.5, 1.5), (2.5, 1.5))
    with hand.changing():
        hand.page.keyboard.press("Delete")
    assert "o" not in hand.text.partition("map")[2]


@pytest.mark.parametrize(
    ("way", "drag", "size", "start"),
    [
        ("1 0", (2, 0), "[8, 4]", (0, 0)),
        ("-1 -1", (-1, -1), "[7, 5]", (1, 1)),
        ("1 1", (0, 0), "[7, 5]", (0, 0)),
    ],
)
def test_the_size_is_dragged_at_the_rim(
    hand: Hand, way: str, drag: Point, size: str, start: tuple[int, int]
) -> None:
    """A click adds a column or row."""
    box = hand.page.locator(f"[data-handle=size][data-way='{way}']").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    cell = hand.at(1, 0)[0] - hand.at(0, 0)[0]
    hand.begin((x, y), (x + cell * drag[0], y + cell * drag[1]))
    shown = size.strip("[]").replace(", ", " × ")
    expect(hand.page.locator(".preview text")).to_have_text(shown)
    with hand.changing():
        hand.page.mouse.up()
    assert f"size: {size}" in hand.text
    level = hand.editor.session.level
    assert level is not None
    assert level.starts == (start,)


def test_arrows_at_the_rim_set_the_wind(hand: Hand) -> None:
    hand.choose("wind")
    arrow = hand.page.locator("[data-handle=wind][data-side=N][data-index='2']")
    clicks: list[tuple[Button, int]] = [("left", 1), ("left", 2), ("right", 1)]
    for button, strength in clicks:
        with hand.changing():
            arrow.click(button=button)
        assert f"north: [0, 0, {strength}, 0, 0, 0]" in hand.text
        expect(arrow.locator("text")).to_have_text(str(strength))


def test_the_part_that_is_seen_stays_as_one_draws(hand: Hand) -> None:
    page = hand.page
    page.mouse.move(*hand.at(3, 2))
    page.keyboard.down("Control")
    page.mouse.wheel(0, -300)
    page.keyboard.up("Control")
    page.mouse.wheel(60, 40)
    page.wait_for_timeout(200)
    before = hand.picture.bounding_box()
    hand.draw((3.5, 2))
    assert hand.picture.bounding_box() == pytest.approx(before, abs=0.1)
    assert "- {at: [3, 1], side: S}" in hand.text


def test_cells_keep_their_size_as_one_draws_in_a_part_of_a_high_level(
    editor_page: OpenEditor,
) -> None:
    hand = Hand(editor_page("version: 1\nsize: [40, 40]\n"))
    before = hand.at(1, 0)[0] - hand.at(0, 0)[0]
    for x in range(3):
        hand.draw((x + 1, 1.5))
    assert hand.at(1, 0)[0] - hand.at(0, 0)[0] == pytest.approx(before, abs=0.01)


def test_the_map_follows_what_is_drawn_when_one_pauses(hand: Hand) -> None:
    for _ in range(2):
        hand.page.get_by_role("button", name="Zoom in").click()
    image = hand.page.locator("svg.map image")
    expect(image).to_have_attribute("href", re.compile("^data:"))
    before = image.get_attribute("href") or ""
    hand.draw((3, 1.5))
    assert image.get_attribute("href") == before
    expect(image).not_to_have_attribute("href", before)


def test_a_drag_to_the_edge_of_the_stage_scrolls_the_picture(hand: Hand) -> None:
    page = hand.page
    for _ in range(3):
        page.get_by_role("button", name="Zoom in").click()
    stage = page.locator(".stage").bounding_box()
    assert stage is not None
    hand.begin(hand.at(2.5, 2), (stage["x"] + stage["width"] - 5, hand.at(0, 2)[1]))
    page.wait_for_function("""() => {
      const { scrollLeft, scrollWidth, clientWidth } =
        document.querySelector("#editor").shadowRoot.querySelector(".stage");
      return scrollLeft + clientWidth >= scrollWidth - 2;
    }""")
    with hand.changing():
        page.mouse.up()
    assert "- {at: [2, 1], side: S, length: 4}" in hand.text


def test_buttons_zoom_to_the_middle_and_the_middle_button_moves_the_picture(hand: Hand) -> None:
    middle = hand.at(3, 2)
    for _ in range(3):
        hand.page.get_by_role("button", name="Zoom in").click()
    assert hand.at(1, 0)[0] - hand.at(0, 0)[0] > 128
    assert hand.at(3, 2) == pytest.approx(middle, abs=3)
    hand.page.mouse.move(*middle)
    expect(hand.page.locator(".pointed")).to_have_text(re.compile(r"\[[23], [12]\]"))
    x, y = hand.at(1, 0)
    hand.drag((500, 400), (440, 370), button="middle")
    assert hand.at(1, 0) == pytest.approx((x - 60, y - 30), abs=1)
    assert hand.text == LEVEL


def test_an_invalid_text_dims_the_last_picture_and_says_over_it_what_is_wrong(hand: Hand) -> None:
    page = hand.page
    problem = page.locator(".view").get_by_role("button", name=re.compile("^Error in line 2"))
    expect(problem).to_be_hidden()
    with hand.changing():
        page.locator(".text").fill("version: 1\nsize: [6, wide]\n")
    expect(page.locator(".stage")).to_have_class(re.compile("dimmed"))
    expect(hand.picture).to_be_visible()
    expect(page.locator(".grip")).to_have_count(0)
    expect(page.locator(".best-return")).to_have_text("none")
    expect(problem).to_contain_text("must be")
    page.locator(".stage").focus()
    problem.click()
    expect(page.get_by_label("Level file")).to_be_focused()
    page.keyboard.press("Shift+End")
    page.keyboard.type("4]")
    expect(problem).to_be_hidden()
    expect(page.locator(".best-return")).not_to_have_text("none")


def test_ways_of_movers_and_what_opens_doors_are_always_shown(editor_page: OpenEditor) -> None:
    things = (
        "switches:\n  - {name: lever, at: [0, 3]}\n"
        "items:\n  - {name: coin, at: [1, 3], shape: coin}\n"
        "doors:\n  - {at: [2, 1], side: E, needs: [lever, coin]}\n"
        "movers:\n  - {path: [[4, 0], [5, 0], [5, 1]], back: true}\n"
        "  - {within: {at: [3, 2], size: [2, 2]}}\n"
    )
    hand = Hand(editor_page(LEVEL + things))
    ways, needed = (
        hand.page.locator(f".links .link.over{more}") for more in (":not(.needed)", ".needed")
    )
    assert [
        len(d.split("M")) - 1
        for d in map(str, [ways.get_attribute("d"), needed.get_attribute("d")])
    ] == [2, 2]
    hand.page.get_by_role("button", name="Play", exact=True).click()
    expect(ways).to_have_count(0)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("version: 1\nsize: [6, wide]\n", "the text is not a valid level"),
        ("version: 1\nsize: [300, 300]\n", "too large"),
    ],
)
def test_a_level_without_a_picture_is_told_and_its_text_shown(
    editor_page: OpenEditor, text: str, told: str
) -> None:
    page = editor_page(text).page
    expect(page.locator(".notice")).to_contain_text(told)
    expect(page.locator(".text")).to_have_value(text)
    page.locator(".stage").focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator(".said")).to_have_text("")
