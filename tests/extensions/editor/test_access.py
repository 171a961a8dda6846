"""The editor for everybody: roles and names, the focus, contrast, windows of all sizes."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, expect
from support.editors import OpenEditor

pytestmark = pytest.mark.slow

LEVEL = """\
version: 1
title: Two puddles
size: [6, 4]
puddles:
  - {at: [1, 1], size: small}
  - {at: [2, 1], size: large}
walls:
  - {at: [5, 0], side: S}
  - {at: [4, 0], side: E}
"""

TABS = ("Selection", "Level", "Findings", "Learn")

UNNAMED = """({ shadowRoot: root }) =>
  [...root.querySelectorAll("button, input, select, textarea, summary")]
    .filter((each) => each.checkVisibility() && !each.ariaLabel && !each.textContent.trim() &&
      !each.labels?.length)
    .map((each) => each.outerHTML)"""

FOCUSED = """({ shadowRoot: { activeElement: at } }) => {
  if (at === null) return null;
  const name = at.ariaLabel ?? at.getRootNode().getElementById(at.getAttribute("aria-labelledby"))
    ?.textContent ?? at.textContent;
  const isSeen = [at, at.closest(".pane") ?? at].map(getComputedStyle)
    .some((style) => style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 1);
  return [name, isSeen];
}"""

FAINT = """({ shadowRoot: root }) => {
  const pixel = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
  const over = (below, color) => {
    pixel.fillStyle = `rgb(${below.join(" ")})`;
    pixel.fillRect(0, 0, 1, 1);
    pixel.fillStyle = color;
    pixel.fillRect(0, 0, 1, 1);
    return [...pixel.getImageData(0, 0, 1, 1).data].slice(0, 3);
  };
  const ground = (element) => {
    const behind = element.parentElement === null ? [255, 255, 255] : ground(element.parentElement);
    return over(behind, getComputedStyle(element).backgroundColor);
  };
  const light = (color) => color
    .map((part) => part / 255)
    .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4))
    .reduce((sum, part, at) => sum + part * [0.2126, 0.7152, 0.0722][at], 0);
  const ratio = (element) => {
    const below = ground(element);
    const [dark, bright] = [below, over(below, getComputedStyle(element).color)]
      .map(light)
      .sort((one, other) => one - other);
    return (bright + 0.05) / (dark + 0.05);
  };
  const isText = (element) =>
    [...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim() !== "");
  return [...root.querySelectorAll(".editor *:not(svg *, option, textarea)")]
    .filter((each) => each.checkVisibility() && isText(each) && !each.closest(":disabled"))
    .filter((each) => ratio(each) < 4.5)
    .map((each) => `${each.outerHTML.slice(0, 120)}: ${ratio(each).toFixed(2)}`);
}"""


@pytest.fixture
def editor(editor_page: OpenEditor) -> Locator:
    return editor_page(LEVEL).page.locator("#editor")


def show(editor: Locator, tab: str) -> None:
    editor.get_by_role("tab", name=tab).click()
    expect(editor.get_by_role("tabpanel", name=tab)).to_be_visible()


def test_everything_has_a_role_and_a_name(editor: Locator) -> None:
    stage = editor.get_by_role("application", name="Two puddles")
    expect(stage).to_have_attribute("aria-roledescription", "level editor")
    expect(stage).to_have_accessible_description(re.compile("6 columns and 4 rows.*question mark"))
    for region in ("Level and file", "Picture", "Details"):
        expect(editor.get_by_role("region", name=region)).to_have_count(1)
    for name in ("Mode", "History", "File", "Zoom"):
        expect(editor.get_by_role("group", name=name)).to_have_count(1)
    for tab in TABS:
        show(editor, tab)
        assert editor.evaluate(UNNAMED) == []


def test_the_focus_is_seen_wherever_it_is(editor: Locator) -> None:
    reached = []
    while (found := editor.evaluate(FOCUSED)) is not None:
        name, is_seen = found
        assert is_seen, name
        reached.append(name)
        editor.page.keyboard.press("Escape")  # Tab leaves the text only after it.
        editor.page.keyboard.press("Tab")
    for part in ("Two puddles", "Zoom in", "Values V", "Selection", "Level file"):
        assert part in reached


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_all_words_have_enough_contrast(editor_page: OpenEditor, scheme: str) -> None:
    editor = editor_page(LEVEL, color_scheme=scheme).page.locator("#editor")
    for tab in TABS:
        show(editor, tab)
        assert editor.evaluate(FAINT) == []
    editor.get_by_role("button", name="Keys and gestures").click()
    assert editor.evaluate(FAINT) == []


def test_nothing_moves_for_those_who_do_not_want_it(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL, reduced_motion="reduce").page.locator("#editor")
    moving = editor.evaluate(
        """({ shadowRoot: root }) => [...root.querySelectorAll("*")].filter((each) => {
          const { transitionDuration, animationDuration, animationName } = getComputedStyle(each);
          return parseFloat(transitionDuration) > 0 ||
            (animationName !== "none" && parseFloat(animationDuration) > 0);
        }).map((each) => each.outerHTML.slice(0, 80))"""
    )
    assert moving == []


WINDOWS = [(1280, 800), (900, 672), (390, 844)]
"""A laptop, the cell of a notebook, and a phone."""


@pytest.mark.parametrize(
    ("width", "height"),
    [*(pytest.param(*size, marks=pytest.mark.sweep) for size in WINDOWS[:2]), WINDOWS[2]],
)
def test_everything_is_in_reach(editor_page: OpenEditor, width: int, height: int) -> None:
    page = editor_page(
        "version: 1\nsize: [8, 5]\n", viewport={"width": width, "height": height}
    ).page
    overflow = page.evaluate(
        """() => {
          const { scrollWidth, scrollHeight } = document.documentElement;
          return [scrollWidth - innerWidth, scrollHeight - innerHeight];
        }"""
    )
    assert max(overflow) <= 0
    picture = page.locator(".stage > svg").bounding_box()
    assert picture is not None
    assert picture["width"] >= 0.35 * width or picture["height"] >= 0.35 * height
    for tool in page.locator("[data-tool]").all():
        if page.locator(".tool-sheet").is_visible():
            page.locator(".tool-sheet").click()
        tool.click()
        expect(tool).to_have_attribute("aria-pressed", "true")
    for name in (*TABS[1:], "Text"):
        tab = page.get_by_role("tab", name=name)
        if tab.is_visible():
            tab.click()
    expect(page.locator(".text")).to_be_in_viewport()
    for mode in ("Play", "Policy", "Edit"):
        page.get_by_role("button", name=mode, exact=True).click()
        expect(page.locator(".stage > svg")).to_be_in_viewport(ratio=1)


def test_one_panel_is_shown_at_a_time_beside_the_text(editor_page: OpenEditor) -> None:
    page = editor_page("version: 1\n").page
    page.get_by_role("tab", name="Level").click()
    expect(page.locator(".world")).to_be_visible()
    expect(page.locator(".inspector")).to_be_hidden()
    expect(page.locator(".text")).to_be_visible()
    page.get_by_role("tab", name="Level").press("ArrowRight")
    expect(page.get_by_role("tab", name="Findings")).to_have_attribute("aria-selected", "true")
    expect(page.locator(".world")).to_be_hidden()
