"""Learn on a page: frames and updates a second while algorithms run, in Chromium and Firefox.

    python benchmarks/learning.py

Policy evaluation with a sweep in each frame, and the same and Q-learning as fast as they can, in
mazes of 8 by 8 and 40 by 40 cells. Frames are those that the browser offers, at most 60 a second.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import mkdtemp
from typing import Any

import report
from timing import Comparison, Measure, MissingPeer, in_turns, installed

sys.path.append(str(Path(__file__).parents[1] / "tests"))

from support.firefox import FirefoxError, firefox

import babyrobot_levels as brl

SIZES = 8, 40
RUNS = {
    "policy evaluation, a sweep a frame": ("policy_evaluation", 3),
    "policy evaluation, fastest": ("policy_evaluation", 4),
    "Q-learning, fastest": ("q_learning", 4),
}
"""The algorithms, and the speeds at which they run, as the slider has them."""

FRAMES = """(speed) => new Promise((done) => {
  document.querySelector("#learn-speed").value = speed;
  const { learner } = learning;
  const { step } = learner;
  let [frames, updates, begin] = [0, 0, 0];
  learner.step = () => (updates++, step.call(learner));
  const look = (now) => {
    begin ||= now;
    if (now - begin < 2000) requestAnimationFrame(look, frames++);
    else done([frames, updates].map((count) => (1000 * count) / (now - begin)), learning.begin());
  };
  learning.run(true);
  requestAnimationFrame(look);
})"""
"""Returns the frames and updates of two seconds."""

Run = Callable[[str, str, int], list[float]]
"""Opens the page of an address in a browser, and returns what a function there returns."""


def in_chromium(stack: ExitStack) -> Run:
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError:
        raise MissingPeer("playwright is not installed") from None
    chromium = stack.enter_context(sync_playwright()).chromium
    path = shutil.which("chromium") or shutil.which("google-chrome")
    try:
        browser = chromium.launch(executable_path=path, args=["--no-sandbox"])
    except Error:
        raise MissingPeer("there is no Chromium") from None
    page = browser.new_page(viewport={"width": 1280, "height": 900})

    def run(address: str, function: str, speed: int) -> list[float]:
        page.goto("about:blank")
        page.goto(address)
        page.wait_for_selector("body.ready")
        rates: list[float] = page.evaluate(function, speed)
        return rates

    return run


def in_firefox(stack: ExitStack) -> Run:
    try:
        page = stack.enter_context(firefox(Path(mkdtemp()))).page()
    except FirefoxError as error:
        raise MissingPeer(str(error)) from None

    def run(address: str, function: str, speed: int) -> list[float]:
        page.open("about:blank")
        page.open(address)
        page.until("() => document.body.classList.contains('ready')")
        rates: list[float] = page.run(function, speed)
        return rates

    return run


def compare(count: int) -> Iterator[Comparison]:
    """Measure each browser by itself; there is no peer."""
    folder = Path(mkdtemp())
    for size in SIZES:
        fields: dict[str, Any] = {"version": 1, "size": [size, size]}
        maze = {"seed": 1, "algorithm": "wilson", "loops": 0.2}
        brl.Level.from_fields({**fields, "maze": maze}).to_html(folder / f"{size}.html", learn=True)
    for browser, opened in (("Chromium", in_chromium), ("Firefox", in_firefox)):
        updates: dict[str, list[float]] = {}
        with ExitStack() as stack:
            try:
                measures = dict(_measures(opened(stack), folder, updates))
            except MissingPeer as error:
                yield Comparison("frames per second", {browser: []}, missing={browser: str(error)})
                continue
            rates, missing = in_turns(measures, count)
        note = "updates a second: " + "; ".join(
            f"{name}: {median(found):,.0f}" for name, found in updates.items()
        )
        versions = installed("babyrobot-levels", "playwright")
        unit = f"frames per second, {browser}"
        yield Comparison(unit, rates, missing=missing, versions=versions, note=note)


def _measures(
    run: Run, folder: Path, updates: dict[str, list[float]]
) -> Iterator[tuple[str, Measure]]:
    for size in SIZES:
        for name, (algorithm, speed) in RUNS.items():
            address = f"{(folder / f'{size}.html').as_uri()}#learn={algorithm}"
            found = updates.setdefault(f"{size}x{size}, {name}", [])
            yield f"{size}x{size}, {name}", partial(_measured, run, address, speed, found)


def _measured(run: Run, address: str, speed: int, updates: list[float]) -> float:
    frames, learned = run(address, FRAMES, speed)
    updates.append(learned)
    return frames


if __name__ == "__main__":
    report.main(__doc__, compare)
