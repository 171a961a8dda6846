"""The editor under fingers: one draws, two move and zoom, a long press selects."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, expect
from support.editors import OpenEditor
from support.hands import Finger, Point

pytestmark = pytest.mark.slow

LEVEL = """\
version: 1
size: [6, 4]
puddles:
  - {at: [1, 1], size: small}
"""

LEAST_TARGET = 44
"""Pixels."""


class Hand(Finger):
    """Fingers on one editor."""

    @property
    def text(self) -> str:
        return self.editor.session.text

    @property
    def stage(self) -> Locator:
        return self.page.locator(".stage")

    @property
    def picture_width(self) -> float:
        box = self.page.locator(".stage > svg").bounding_box()
        assert box is not None
        return box["width"]

    def spread(self, *moments: tuple[Point, Point]) -> None:
        """Put two fingers down, one after the other, move them, and lift them."""
        first, _ = moments[0]
        self.touch("touchStart", first)
        for fingers in moments:
            self.touch("touchMove" if fingers is not moments[0] else "touchStart", *fingers)
        self.touch("touchEnd")


@pytest.fixture
def hand(editor_page: OpenEditor) -> Hand:
    return Hand(editor_page(LEVEL, **Hand.context))


def test_a_tap_right_after_a_drag_is_taken(hand: Hand) -> None:
    """Chromium drops taps while it throws what was dragged; the picture is not thrown."""
    for x in range(3):
        hand.choose("large")
        expect(hand.page.locator("[data-tool=large]")).to_have_attribute("aria-pressed", "true")
        hand.paint((x, 3))
        hand.choose("walls")
        expect(hand.page.locator("[data-tool=walls]")).to_have_attribute("aria-pressed", "true")
        hand.draw_wall((2, x), "S", 3)


def test_a_long_press_selects_what_is_there(hand: Hand) -> None:
    hand.choose("large")
    hand.touch("touchStart", hand.at(1.5, 1.5))
    expect(hand.page.locator(".spoken")).to_have_text("Selected: small puddle.")
    hand.touch("touchMove", hand.at(3.5, 1.5))
    hand.touch("touchEnd")
    expect(hand.page.get_by_role("tabpanel", name="Selection")).to_contain_text("puddle")
    hand.paint((4, 2))
    assert hand.text == LEVEL + "  - {at: [4, 2], size: large}\n"


def test_a_finger_that_moves_draws_however_long_it_takes(hand: Hand) -> None:
    hand.choose("small")
    with hand.changing():
        hand.touch("touchStart", hand.at(3.5, 1.5))
        hand.touch("touchMove", hand.at(4.5, 1.5))
        hand.page.wait_for_timeout(700)
        hand.touch("touchEnd")
    assert "- {at: [3, 1], size: small}\n  - {at: [4, 1], size: small}" in hand.text


def test_two_fingers_zoom_and_scroll_and_draw_nothing(hand: Hand) -> None:
    hand.choose("blocked")
    x, y = hand.at(3, 2)
    before = hand.picture_width
    hand.spread(((x - 30, y), (x + 30, y)), ((x - 60, y), (x + 60, y)), ((x - 90, y), (x + 90, y)))
    assert hand.picture_width == pytest.approx(3 * before, rel=0.1)
    # What was between the fingers is still there.
    assert hand.at(3, 2) == pytest.approx((x, y), abs=6)
    hand.spread(((x - 30, y), (x + 30, y)), ((x - 60, y - 40), (x, y - 40)))
    assert hand.at(3, 2) == pytest.approx((x - 30, y - 40), abs=6)
    assert hand.text == LEVEL
    # A finger alone draws again, in the part that is seen.
    hand.paint((3, 2))
    assert "blocked:\n  - {at: [3, 2]}" in hand.text


@pytest.mark.parametrize("size", [(390, 844), (844, 390)])
def test_everything_is_large_enough_for_fingers(
    editor_page: OpenEditor, size: tuple[int, int]
) -> None:
    width, height = size
    options = Hand.context | {"viewport": {"width": width, "height": height}}
    page = editor_page(LEVEL, **options).page
    small = page.locator("#editor").evaluate(
        """({ shadowRoot: root }, least) => [...root.querySelectorAll(
            ":is(.bar, .tools, .zoom, .tabs, .answers, .options) button, [data-handle] .target")]
          .filter((each) => each.checkVisibility())
          .map((each) => [each.outerHTML.slice(0, 80), each.getBoundingClientRect()])
          .filter(([, { width, height }]) => Math.min(width, height) < least - 0.01)
          .map(([name]) => name)""",
        LEAST_TARGET,
    )
    assert small == []
    outside = page.locator("#editor").evaluate(
        """({ shadowRoot: root }) =>
          [...root.querySelectorAll(":is(.bar, .answers, .tabs) button")]
          .filter((each) => each.checkVisibility())
          .filter((each) => each.getBoundingClientRect().right > innerWidth)
          .map((each) => each.textContent)"""
    )
    assert outside == []


def test_the_help_lists_what_fingers_and_keys_do(hand: Hand) -> None:
    hand.press(hand.page.get_by_role("button", name="Keys and gestures"))
    help_list = hand.page.get_by_role("dialog", name="Keys and gestures")
    expect(help_list).to_contain_text("Long press")
    expect(help_list.get_by_text("Drag along sides")).to_be_visible()
    expect(help_list.get_by_text("Right button")).to_be_hidden()
    expect(help_list.get_by_text("Page up")).to_be_visible()


def test_a_handle_that_is_held_can_still_be_dragged(hand: Hand) -> None:
    box = hand.page.locator("[data-handle=size][data-way='0 1']").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    row = hand.at(0, 1)[1] - hand.at(0, 0)[1]
    with hand.changing():
        hand.touch("touchStart", (x, y))
        hand.page.wait_for_timeout(700)
        hand.touch("touchMove", (x, y + row))
        hand.touch("touchEnd")
    assert hand.size == (6, 5)
