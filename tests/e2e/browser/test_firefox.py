"""Firefox does what Chromium does: a level is played, a gallery is browsed, a level is drawn."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from support.combinations import swept
from support.editors import served
from support.firefox import Firefox, FirefoxPage, firefox
from support.learned import LEARNED, runs_of
from support.playground import guide, level

import babyrobot_levels as brl
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.extensions.editor.sources import session_of
from babyrobot_levels.render.page import page_data, to_html

WORLD = level(size=[4, 3], walls=[{"at": [1, 0], "side": "E"}])
LEVELS: list[Any] = ["final-maze", "cliff-walking", "first-key"]
DRAWN = "version: 1\nsize: [5, 3]\n"

OVERFLOW = "() => document.documentElement.scrollWidth - innerWidth"
CARET_TO_THE_START = """() => {
    const [area] = seen('textarea');
    area.focus();
    area.setSelectionRange(0, 0);
}"""
SPOT = """(x, y) => {
    const svg = seen('.stage > svg')[0];
    const box = svg.getBoundingClientRect();
    const wide = svg.viewBox.baseVal.width;
    const at = (n) => ((wide - 5 * 64) / 2 + 64 * n) * box.width / wide;
    return [box.x + at(x), box.y + at(y)];
}"""


@pytest.fixture(scope="module")
def light(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Firefox]:
    with firefox(tmp_path_factory.mktemp("light")) as browser:
        yield browser


@pytest.fixture
def browser(light: Firefox) -> Iterator[Firefox]:
    yield light
    assert light.faults() == []


@pytest.fixture(scope="module")
def gallery(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("gallery") / "site"
    brl.gallery(LEVELS, folder)
    return (folder / "index.html").as_uri()


def played(page: FirefoxPage, folder: Path, **options: Any) -> FirefoxPage:
    """Open the page of a level."""
    path = folder / "page.html"
    path.write_text(to_html(WORLD, **options), encoding="utf-8")
    page.open(path.as_uri())
    page.until("() => document.body.classList.contains('ready')")
    return page


def state(page: FirefoxPage) -> int:
    return int(page.run("() => document.querySelector('#robot').dataset.state"))


def test_what_a_page_complains_of_is_noted(light: Firefox, tmp_path: Path) -> None:
    path = tmp_path / "bad.html"
    path.write_text("<img src=https://example.org/a><script>none()</script>")
    page = light.page()
    page.open(path.as_uri())
    faults = light.faults()
    for told in ("asks for https://example.org/a", "error: ReferenceError: none is not defined"):
        assert any(told in fault for fault in faults), faults
    assert light.faults() == []


def lightness(page: FirefoxPage) -> float:
    """Return how light most of a page is, of 255."""
    with Image.open(BytesIO(page.photograph())) as picture:
        return float(np.median(np.asarray(picture.convert("L"))))


@pytest.mark.sweep
def test_who_prefers_dark_sees_dark(tmp_path: Path, gallery: str, light: Firefox) -> None:
    (tmp_path / "profile").mkdir()
    with firefox(tmp_path / "profile", "dark") as dark, served(Session(DRAWN)) as address:
        path = tmp_path / "page.html"
        path.write_text(to_html(WORLD), encoding="utf-8")
        for where in (path.as_uri(), gallery, address):
            shown = []
            for each in (light, dark):
                page = each.page()
                page.open(where)
                shown.append(lightness(page))
                page.open("about:blank")
            assert shown[0] > 200
            assert shown[1] < 60
        assert dark.faults() == []


# -- the page of a level -----------------------------------------------------------------------


def test_a_level_is_learned_as_python_learns_it(browser: Firefox, tmp_path: Path) -> None:
    page = played(browser.page(), tmp_path, guide=guide(WORLD))
    page.press("e", "ArrowDown")
    assert page.text("#learn-numbers").startswith("Episode 1 ")
    assert page.text("#message").startswith("Q([")
    for name in ("frozen-lake", "first-key"):
        lake = brl.load(name)
        runs = list(runs_of(lake, all_starts=not lake.has_things))
        found = page.run(LEARNED, [page_data(lake, turns=True), runs])
        for run, (number, values, _) in zip(runs, found, strict=True):
            assert (number, values) == (run["number"], pytest.approx(run["values"])), run["options"]


def test_a_level_is_played_with_keys_and_buttons(browser: Firefox, tmp_path: Path) -> None:
    page = played(browser.page(), tmp_path, guide=guide(WORLD))
    page.press("ArrowRight", "ArrowRight", "s")
    assert state(page) == 5
    assert page.text("#steps") == "3"
    page.click("[data-control=west]")
    assert state(page) == 4
    page.press("z")
    page.click("[data-control=undo]")
    assert (state(page), page.text("#steps")) == (1, "2")
    page.press("h")
    assert page.text("#message") == "Hint: move south."
    page.press("s", "s", "d", "d")
    assert page.text("#result-title")
    assert "Exit reached after 6 steps!" in page.text("#message")


def test_answers_are_shown_and_the_best_policy_walks(browser: Firefox, tmp_path: Path) -> None:
    page = played(browser.page(), tmp_path, guide=guide(WORLD))
    for name in ("values", "policy"):
        page.click(f"[data-control={name}]")
        pressed = "(name) => document.querySelector(`[data-control=${name}]`).ariaPressed"
        assert page.run(pressed, name) == "true"
    page.click("#watch")
    page.until("() => document.querySelector('#message').dataset.kind === 'exit'")
    assert page.text("#steps") == "5"


def test_a_phone_shows_a_level_and_its_buttons(browser: Firefox, tmp_path: Path) -> None:
    page = played(browser.page(390, 740), tmp_path, guide=guide(WORLD))
    assert page.run(OVERFLOW) <= 0
    for name in ("north", "south", "east", "west", "undo", "hint"):
        box = "(n) => document.querySelector(`[data-control=${n}]`).getBoundingClientRect().bottom"
        assert 0 < page.run(box, name) <= 740


# -- the gallery -------------------------------------------------------------------------------


def titles(page: FirefoxPage) -> list[str]:
    found: list[str] = page.run("() => seen('#wall h2').map((each) => each.innerText)")
    return found


@pytest.mark.parametrize("width", swept([1280], [390]))
def test_a_gallery_is_searched_and_a_level_opened(
    width: int, browser: Firefox, gallery: str
) -> None:
    page = browser.page(width, 800)
    page.open(gallery)
    assert len(titles(page)) == len(LEVELS)
    assert page.run(OVERFLOW) <= 0
    if width == 1280:
        page.click("#filters label", "Items")
        page.until("() => location.hash.includes('items')")
        assert titles(page) == ["The first key"]
        page.click("#filters label", "Items")
    page.click("#query")
    page.press(*"cliff")
    page.until("() => location.hash.includes('cliff')")
    assert titles(page) == ["Cliff Walking"]
    page.click("#wall h2")
    page.until("() => seen('main.tabbed').length")
    page.click("[role=tab]", "Play")
    page.press("ArrowUp")
    page.until("() => document.querySelector('#steps').innerText === '1'")


# -- the editor --------------------------------------------------------------------------------


def test_a_level_is_drawn_undone_typed_saved_and_played(browser: Firefox, tmp_path: Path) -> None:
    path = tmp_path / "drawn.yaml"
    path.write_text(DRAWN, encoding="utf-8")
    session = session_of(path)
    with served(session) as address:
        page = browser.page()
        page.open(address)
        page.until("() => document.title.endsWith(' – editor')")
        page.drag(page.run(SPOT, 1.5, 1), page.run(SPOT, 3.5, 1))
        wait_for(page, "- {at: [1, 0], side: S, length: 3}")
        page.click("[data-tool=large]")
        page.drag(page.run(SPOT, 2.5, 1.5))
        wait_for(page, "- {at: [2, 1], size: large}")
        drawn = session.text
        page.press("Control+z")
        page.until("() => !seen('textarea')[0].value.includes('large')")
        page.press("Control+y")
        wait_for(page, "large")
        assert session.text == drawn
        page.run(CARET_TO_THE_START)
        page.press(*"title: Drawn", "Enter")
        page.until("() => seen('#level-name')[0].innerText === 'Drawn'")
        page.press("Control+s")
        page.until("() => !seen('.file-state.unsaved').length")
        assert path.read_text(encoding="utf-8") == session.text == f"title: Drawn\n{drawn}"
        page.click("[data-panel=algorithm]")
        page.click("#learn-run")
        page.until("() => /Episode [1-9]/.test(seen('#learn-numbers')[0].innerText)")
        page.drag(page.run(SPOT, 1.5, 1.5))
        page.until("() => seen('#spoken')[0].textContent.startsWith('What was learned of')")
        page.until("() => seen('#learn-run')[0].innerText.startsWith('Stop')")
        page.click("[data-mode=play]")
        page.press("ArrowRight")
        page.until("() => seen('.episode-told')[0]?.innerText.includes('Moved east')")
        assert browser.faults() == []
        # A page with unsaved changes asks whether to leave it.
        page.press("Control+s")
        page.until("() => !document.querySelector('.file-state.unsaved')")
        page.open("about:blank")


def wait_for(page: FirefoxPage, text: str) -> None:
    """Wait until the text pane says something."""
    page.until("(text) => seen('textarea')[0].value.includes(text)", text)
