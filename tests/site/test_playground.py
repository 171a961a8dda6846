"""Examples of the documentation are changed in their places, and opened in the editor."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect
from support.sites import StaticServer, hosted
from support.web import SITE

if TYPE_CHECKING:
    from playwright.sync_api import Page

START = 60_000
"""How long Python may take to start on a busy machine, in milliseconds."""


@pytest.fixture
def server() -> Iterator[StaticServer]:
    with hosted(SITE) as started:
        yield started


def test_an_example_is_changed_in_its_place(page: Page, server: StaticServer) -> None:
    errors: list[str] = []
    asked: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(f"{server.address}docs/level-format.html")
    first, second = (page.locator(".level").nth(number) for number in (0, 1))
    assert not [url for url in asked if "/editor/" in url]
    second.get_by_role("button", name="Change").click()
    text, svg = second.locator("textarea.text"), second.locator(".stage > svg")
    expect(svg).to_be_visible(timeout=START)
    expect(second.locator(".level-picture")).to_be_hidden()
    text.fill("version: 1\nsize: [3, 2]\npuddles:\n  - {at: [1, 1]}\n  - {at: [3, 1]}\n")
    expect(second.locator(".finding-text")).to_contain_text("off the grid")
    expect(svg).to_have_css("opacity", "0.4")
    text.fill(
        "version: 1\nsize: [3, 2]\nwalls:\n  - {at: [0, 0], side: E}\n  - {at: [0, 1], side: E}\n"
    )
    second.locator(".fix").click()
    expect(text).to_have_value(re.compile(r"side: E, length: 2"))
    # Another one beside it has a session of its own.
    first.get_by_role("button", name="Change").click()
    expect(first.locator("textarea.text")).to_have_value("version: 1\n")
    second.locator("textarea.text").press("ControlOrMeta+z")
    expect(text).to_have_value(re.compile(r"\[0, 1\], side: E"))
    address = second.get_by_role("link", name="Open in the editor").get_attribute("href")
    first.get_by_role("button", name="Back to the example").click()
    expect(first.locator(".level-picture")).to_be_visible()
    page.goto(address or "")
    expect(page.locator("textarea.text")).to_have_value(
        re.compile(r"\[0, 1\], side: E"), timeout=START
    )
    assert errors == []


def test_an_example_with_an_error_is_opened_in_the_editor(page: Page, server: StaticServer) -> None:
    page.goto(f"{server.address}docs/rules/out-of-bounds.html")
    page.get_by_role("link", name="Open in the editor").first.click()
    expect(page.locator(".problem")).to_contain_text("off the grid", timeout=START)
    expect(page.locator("textarea.text")).to_have_value("version: 1\nsize: [3, 2]\nexit: [3, 1]\n")


def test_a_level_of_the_gallery_is_opened_in_the_editor(page: Page, server: StaticServer) -> None:
    page.goto(f"{server.address}gallery/final-maze/index.html")
    page.get_by_role("tab", name="YAML").click()
    page.get_by_role("link", name="Edit").click()
    expect(page).to_have_title("The final maze – editor", timeout=START)
