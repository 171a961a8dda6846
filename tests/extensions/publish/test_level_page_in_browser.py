"""The page of a level in a real browser, opened as a file: tabs, the game, copies, progress."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect
from support.combinations import swept

import babyrobot_levels as brl

pytestmark = pytest.mark.slow

STORE = "babyrobot:progress"
FAST = {"robot": {"speed": 100}}
ROW = {"version": 1, "name": "row", "title": "A row", "size": [4, 2], "display": FAST}
HUGE = {"version": 1, "name": "huge", "size": [129, 128]}


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("gallery") / "site"
    brl.gallery([ROW, "first-key", HUGE, "gridworld-3-5"], folder)
    return folder


@pytest.fixture
def own(page: Page) -> Iterator[Page]:
    """A page on which nothing is refused, wrong, or loaded from elsewhere."""
    faults: list[str] = []

    def note(address: str) -> None:
        if not address.startswith(("file:", "data:")):
            faults.append(f"asks for {address}")

    page.on("console", lambda message: faults.append(message.text))
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("request", lambda request: note(request.url))
    yield page
    assert faults == []


def show(page: Page, site: Path, name: str = "row", fragment: str = "") -> None:
    page.goto("about:blank")
    page.goto(f"{(site / name / 'index.html').as_uri()}{fragment}")
    page.wait_for_selector("main.tabbed")


def press(page: Page, *keys: str) -> None:
    for key in keys:
        page.keyboard.press(key)


def chosen(page: Page) -> str:
    """Return the tab that is open; no other part of the page is seen."""
    name = page.locator("[role=tab][aria-selected=true]").inner_text()
    expect(page.get_by_role("tabpanel")).to_have_count(1)
    expect(page.get_by_role("tabpanel", name=name)).to_be_visible()
    return name


def progress(page: Page) -> Any:
    return json.loads(page.evaluate(f"localStorage.getItem('{STORE}')") or "null")


def solve(page: Page) -> None:
    press(page, "d", "d", "d", "s")
    expect(page.locator("#message")).to_contain_text("Exit reached")


# -- tabs --------------------------------------------------------------------------------------


def test_the_arrow_keys_walk_through_the_tabs_and_the_address_follows(
    own: Page, site: Path
) -> None:
    show(own, site)
    assert chosen(own) == "Play"
    own.get_by_role("tab", name="Play").focus()
    names = []
    for _ in range(5):
        press(own, "ArrowRight")
        names.append(chosen(own))
        assert own.evaluate("location.hash") == f"#{names[-1].lower()}"
    assert names == ["Values", "YAML", "Python", "Cite", "Play"]
    press(own, "ArrowLeft")
    assert chosen(own) == "Cite"
    press(own, "Home")
    assert chosen(own) == "Play"
    # These keys are those of the tabs, not of the game.
    expect(own.locator("#steps")).to_have_text("0")


def test_an_address_opens_a_tab_and_the_game_begins_when_it_is_seen(own: Page, site: Path) -> None:
    show(own, site, fragment="#values")
    assert chosen(own) == "Values"
    own.evaluate("() => { location.hash = '#play' }")
    expect(own.get_by_role("tab", name="Play")).to_have_attribute("aria-selected", "true")
    assert own.locator("#stage svg").bounding_box()["width"] > 300  # type: ignore[index]
    solve(own)


def test_an_address_opens_what_is_learned(own: Page, site: Path) -> None:
    show(own, site, "gridworld-3-5", "#learn=sarsa&seed=7")
    assert chosen(own) == "Play"
    for given in ("learn=sarsa&seed=7", "learn=value_iteration"):
        own.evaluate("hash => { location.hash = hash }", given)
        sweeps = own.get_by_role("button", name="Sweep")
        expect(sweeps).to_have_count(int("iteration" in given))
        assert own.evaluate("location.hash") == f"#{given}"


def test_an_unknown_part_of_an_address_opens_the_first_tab(own: Page, site: Path) -> None:
    show(own, site, fragment="#nothing")
    assert chosen(own) == "Play"


def test_the_keys_of_the_game_act_only_while_it_is_seen(own: Page, site: Path) -> None:
    show(own, site)
    press(own, "d")
    own.get_by_role("tab", name="YAML").click()
    press(own, "d", "d")
    own.get_by_role("tab", name="Play").click()
    expect(own.locator("#steps")).to_have_text("1")
    # Whoever has pointed at the tab of the game plays with the arrow keys at once.
    press(own, "ArrowRight")
    expect(own.locator("#steps")).to_have_text("2")


# -- what the visitor has reached --------------------------------------------------------------


def test_the_result_is_kept_and_the_best_one_stays(own: Page, site: Path) -> None:
    digest = brl.load(ROW).digest
    show(own, site)
    press(own, "s")
    assert progress(own) is None
    press(own, "d", "d", "d")
    assert progress(own)[digest]["best"] == -3
    press(own, "r", "a")
    solve(own)
    assert progress(own) == {digest: {"solved": True, "best": -3, "stars": 3}}
    show(own, site)
    expect(own.locator("#progress")).to_have_text("Your best return: \N{MINUS SIGN}3 ★★★")


def test_whoever_wins_is_led_to_the_next_level_if_there_is_one(own: Page, site: Path) -> None:
    show(own, site)
    onwards = own.locator("#result").get_by_role("link", name="Next level")
    expect(onwards).to_be_hidden()
    solve(own)
    onwards.click()
    expect(own).to_have_url((site / "first-key" / "index.html").as_uri())
    own.go_back()
    press(own, "Enter")
    expect(own.locator("#steps")).to_have_text("0")
    solve(own)
    press(own, "Enter")
    expect(own).to_have_url((site / "first-key" / "index.html").as_uri())
    show(own, site, "gridworld-3-5")
    last = own.locator("#result a")
    expect(last).to_have_text("All levels Enter")
    assert last.evaluate("link => link.href") == (site / "index.html").as_uri()


def test_an_episode_that_was_watched_is_not_the_visitor_s(own: Page, site: Path) -> None:
    show(own, site)
    press(own, "p")
    expect(own.locator("#result-title")).to_have_text("Exit reached!")
    assert progress(own) is None


@pytest.mark.parametrize("kept", swept(["{", '{"sha256:0": 1}'], ["", "null", "[]"]))
def test_what_is_no_progress_is_replaced(own: Page, site: Path, kept: str) -> None:
    show(own, site)
    own.evaluate("text => localStorage.setItem('babyrobot:progress', text)", kept)
    show(own, site)
    solve(own)
    assert progress(own)[brl.load(ROW).digest]["solved"] is True


def test_without_storage_the_game_is_played_all_the_same(own: Page, site: Path) -> None:
    own.add_init_script("Object.defineProperty(window, 'localStorage', { get() { throw 1 } })")
    show(own, site)
    solve(own)
    expect(own.locator("#progress")).to_contain_text("\N{MINUS SIGN}3")


# -- texts to copy, levels without a game, no scripts -------------------------------------------


@pytest.mark.parametrize("has_clipboard", [True, False])
def test_texts_are_copied_as_they_are(own: Page, site: Path, has_clipboard: bool) -> None:
    if has_clipboard:
        own.context.grant_permissions(["clipboard-read", "clipboard-write"])
    else:
        own.add_init_script("delete Navigator.prototype.clipboard")
    show(own, site, fragment="#yaml")
    button = own.get_by_role("tabpanel").get_by_role("button")
    button.click()
    expect(button).to_contain_text("Copied")
    expect(own.locator("#copied")).to_have_text("Copied.")
    own.evaluate(
        "() => { document.body.insertAdjacentHTML('beforeend', '<textarea id=t></textarea>');"
        " document.getElementById('t').focus(); }"
    )
    press(own, "Control+v")
    assert own.locator("#t").input_value() == (site / "row" / "level.yaml").read_text("utf-8")


def test_a_level_that_is_too_large_has_its_other_tabs(own: Page, site: Path) -> None:
    show(own, site, "huge")
    expect(own.get_by_role("tabpanel")).to_contain_text("too large for a page")
    own.get_by_role("tab", name="Cite").click()
    assert chosen(own) == "Cite"


def test_neighbours_lead_from_level_to_level(own: Page, site: Path) -> None:
    show(own, site)
    own.get_by_role("link", name="Next level").click()
    expect(own).to_have_title("The first key – Levels")
    for _ in range(2):
        own.get_by_role("link", name="Next level").click()
    expect(own.get_by_role("link", name="Next level")).to_have_count(0)
    own.get_by_title("All levels").click()
    expect(own).to_have_title("Levels")


def test_without_scripts_all_parts_stand_below_one_another(page: Page, site: Path) -> None:
    browser = page.context.browser
    assert browser is not None
    with browser.new_context(java_script_enabled=False) as context:
        plain = context.new_page()
        plain.goto((site / "row" / "index.html").as_uri())
        for name in ("Play", "Values", "YAML", "Python", "Cite"):
            expect(plain.get_by_role("heading", name=name, exact=True)).to_be_visible()
        expect(plain.get_by_role("tab")).to_have_count(0)
        expect(plain.get_by_role("button", name="Copy")).to_have_count(0)


@pytest.mark.parametrize("width", [320, 1280])
@pytest.mark.parametrize("tab", ["play", "values", "yaml", "python", "cite"])
def test_nothing_is_wider_than_the_window(own: Page, site: Path, width: int, tab: str) -> None:
    own.set_viewport_size({"width": width, "height": 800})
    show(own, site, "gridworld-3-5", f"#{tab}")
    assert own.evaluate("document.documentElement.scrollWidth") <= width


def test_no_window_is_too_narrow_for_the_buttons(own: Page, site: Path) -> None:
    show(own, site, "gridworld-3-5", "#play")
    wider = []
    for width in range(320, 560, 10):
        own.set_viewport_size({"width": width, "height": 800})
        if own.evaluate("document.documentElement.scrollWidth") > width:
            wider.append(width)
    assert wider == []


def test_values_are_shown_for_what_is_chosen_to_be_held(own: Page, site: Path) -> None:
    show(own, site, "first-key", "#values")
    images = own.locator("#panel-values img:visible")
    expect(images).to_have_count(1)
    expect(images).to_have_attribute("src", "values.svg")
    own.get_by_role("radio", name="Nothing").focus()
    press(own, "ArrowRight")
    expect(own.get_by_role("radio", name="key")).to_be_checked()
    expect(images).to_have_count(1)
    expect(images).to_have_attribute("src", "values-2.svg")
    assert images.evaluate("(image) => image.decode().then(() => image.naturalWidth)") > 0
