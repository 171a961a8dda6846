"""axe-core finds no serious fault on pages of each kind, and none asks anything of other hosts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import pytest
from axe_playwright_python.sync_playwright import Axe
from support.combinations import covering
from support.web import SITE

if TYPE_CHECKING:
    from playwright.sync_api import Browser

PLACES = [
    "docs/index.html",
    "docs/tutorial.html",
    "docs/level-format.html",
    "docs/rules/inescapable-state.html",
    "docs/api/learning.html",
    "gallery/index.html",
    "gallery/final-maze/index.html",
]
SCREENS = {"desktop": (1280, 900), "phone": (360, 740)}


@pytest.mark.parametrize(
    ("place", "screen", "scheme"), covering([PLACES, [*SCREENS], ["light", "dark"]], 2)
)
def test_a_page_has_no_serious_fault(
    place: str, screen: str, scheme: Literal["light", "dark"], browser: Browser
) -> None:
    width, height = SCREENS[screen]
    context = browser.new_context(
        viewport={"width": width, "height": height}, color_scheme=scheme, reduced_motion="reduce"
    )
    page = context.new_page()
    asked: list[str] = []
    faults: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("console", lambda told: faults.append(told.text) if told.type == "error" else None)
    page.goto((SITE / place).as_uri())
    page.wait_for_load_state()
    overflow = page.evaluate("document.documentElement.scrollWidth - innerWidth")
    assert faults == []
    # With `preload`, axe-core asks for styles again, as a script of the page might not.
    violations = Axe().run(page, options={"preload": False}).response["violations"]
    context.close()
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []
    assert overflow <= 0
    assert [
        f"{found['id']}: {found['help']}: {node['html'][:200]} ({node['target']})"
        for found in violations
        if found["impact"] in ("serious", "critical")
        for node in found["nodes"][:5]
    ] == []
