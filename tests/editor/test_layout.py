"""The editor's layout: all is in reach in windows of all sizes, without scrolling the page."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect
from support.editors import OpenEditor

pytestmark = pytest.mark.slow

WINDOWS = [(1280, 800), (900, 672), (390, 844)]
"""A laptop, the cell of a notebook, and a phone."""


@pytest.mark.parametrize(("width", "height"), WINDOWS)
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
        tool.click()
        expect(tool).to_have_attribute("aria-pressed", "true")
    for name in ("Level", "Findings", "Text"):
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
