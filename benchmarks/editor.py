"""The editor: from the end of a gesture to the frame that shows what came of it.

    python benchmarks/editor.py

A maze of 20 by 20 cells is edited in Chromium, with values shown and findings in the list. Each
gesture is a click of the mouse on the side of a cell. It is measured in the page, from `pointerup`
to the frame after the picture was drawn anew: the way to Python and back, the splice of the text,
findings, tables, the optimum, and the new picture are all in it.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from statistics import median
from threading import Thread
from typing import Any

import report
from timing import Comparison, Measure, MissingPeer, in_turns, installed

from babyrobot_levels.editor.hosts.server import EditorServer
from babyrobot_levels.editor.session import Session

SIZE = 20
GESTURES = 20
"""The number of gestures of a round."""

LEVEL = f"""\
version: 1
title: A maze  # with a comment
size: [{SIZE}, {SIZE}]
maze: {{seed: 1, algorithm: wilson, loops: 0.2}}
max_steps: 1000
puddles:
  - {{at: [3, 3], size: large}}
  - {{at: [12, 8], size: small}}
walls:
  - {{at: [5, 5], side: E, pass: 0.5}}
  - {{at: [{SIZE - 1}, 0], side: E}}  # without effect, which is a finding
"""

WATCH = """
() => {
  const stage = document.querySelector("#editor").shadowRoot.querySelector(".stage");
  stage.addEventListener("pointerup", () => (window.begin = performance.now()), true);
  new MutationObserver(() => requestAnimationFrame(() => requestAnimationFrame(() => {
    window.took = performance.now() - window.begin;
  }))).observe(stage, { childList: true });
}
"""
"""Measures each gesture. The second frame begins when the first has been painted."""


@contextmanager
def opened(address: str) -> Iterator[Any]:
    """Open the editor in Chromium: that of the system, or the one that Playwright installed.

    Raises:
        MissingPeer: there is neither.
    """
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError:
        raise MissingPeer("playwright is not installed") from None
    with sync_playwright() as playwright:
        path = shutil.which("chromium") or shutil.which("google-chrome")
        try:
            browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        except Error:
            raise MissingPeer("there is no Chromium") from None
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(address)
        page.locator("[data-shown=values]").click()
        page.evaluate(WATCH)
        yield page
        browser.close()


TOOK = """
() => new Promise((done) => {
  const look = () => (window.took === null ? setTimeout(look, 5) : done(window.took));
  look();
})
"""
"""Waits for the picture, and returns the milliseconds that it took."""


def drawing(page: Any, latencies: list[float]) -> Measure:
    """Return a measure of gestures per second, which adds the milliseconds of each to a list."""

    def measure() -> float:
        picture = page.locator(".stage > svg").bounding_box()
        side = picture["width"] / SIZE
        del latencies[:]
        for number in range(GESTURES):
            page.evaluate("window.took = null")
            # The middle of the eastern side of a cell: a wall comes, turns to glass, and goes.
            x, y = 3 + number % 4, 4.5 + number % 3
            page.mouse.click(picture["x"] + side * x, picture["y"] + side * y)
            latencies.append(page.evaluate(TOOK))
        return 1000 / median(latencies)

    return measure


def compare(count: int) -> Iterator[Comparison]:
    """Measure the gestures of an editor, which has no peer."""
    unit, name = "gestures per second, editor", f"maze {SIZE}x{SIZE}, values shown"
    latencies: list[float] = []
    server = EditorServer(Session(LEVEL))
    thread = Thread(target=server.run)
    thread.start()
    try:
        with opened(server.address) as page:
            rates, missing = in_turns({name: drawing(page, latencies)}, count)
    except MissingPeer as error:
        yield Comparison(unit, {name: []}, missing={name: str(error)})
        return
    finally:
        server.stop()
        thread.join()
    note = f"from a gesture to its picture: median {1000 / median(rates[name]):.0f} ms"
    versions = installed("babyrobot-levels", "playwright", "starlette", "uvicorn")
    yield Comparison(
        unit, rates, missing=missing, aims={(name, None): 10}, versions=versions, note=note
    )


if __name__ == "__main__":
    report.main(__doc__, compare)
