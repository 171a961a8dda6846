"""The wall of a gallery in a browser: filters, search, order, links, films and progress."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from playwright.sync_api import expect
from support.walls import facts_of_wall

from babyrobot_levels.extensions.publish.wall import ASSETS, wall_html

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    from babyrobot_levels.extensions.publish.facts import Facts

pytestmark = pytest.mark.slow

FACTS = [
    facts_of_wall(
        "garden",
        title="The garden",
        description="Flowers cost more.",
        tags=("areas",),
        size=(6, 5),
        difficulty=5.5,
        film=True,
    ),
    facts_of_wall("cliff", title="Cliff", tags=("textbook",), size=(12, 4), difficulty=9.0),
    facts_of_wall(
        "key", title="Été", tags=("textbook", "areas"), things=("items", "doors"), film=True
    ),
    facts_of_wall("endless", title="Endless", difficulty=None, best_steps=None, best_return=None),
]

PIXEL = bytes.fromhex("47494638396101000100800000ff0000ffffff2c00000000010001000002024401003b")


@dataclass
class Wall:
    """A wall that is open in a browser."""

    page: Page
    address: str
    requests: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    @property
    def titles(self) -> list[str]:
        return self.page.locator("#wall h2").all_text_contents()

    @property
    def count(self) -> str:
        return self.page.inner_text("#count")

    def box(self, value: str) -> Any:
        return self.page.locator(f'#filters input[value="{value}"]')

    def number_at(self, value: str) -> str | None:
        label = self.page.locator("label", has=self.page.locator(f'input[value="{value}"]'))
        return label.locator(".n").text_content()

    def films(self) -> list[str]:
        return [each for each in self.requests if each.endswith("film.gif")]


@pytest.fixture(scope="module")
def gallery(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The address of a wall of four levels, made without the rest of their gallery."""
    return written(tmp_path_factory.mktemp("gallery"), FACTS)


def written(folder: Path, facts: list[Facts]) -> str:
    (folder / "assets").mkdir()
    for name, text in ASSETS.items():
        (folder / "assets" / name).write_text(text(), "utf-8")
    html = wall_html(facts, title="Levels", answers=True, key=False, home=None)
    (folder / "index.html").write_text(html, "utf-8")
    for level in facts:
        (folder / level.id).mkdir()
        for name in ("tile.png", "film.gif"):
            (folder / level.id / name).write_bytes(PIXEL)
        (folder / level.files.page).write_text("<title>A level</title>", "utf-8")
    return (folder / "index.html").as_uri()


def opened(page: Page, address: str) -> Wall:
    wall = Wall(page, address)
    page.on("request", lambda request: wall.requests.append(request.url))
    page.on("pageerror", lambda error: wall.errors.append(str(error)))
    page.on("console", lambda message: wall.errors.append(message.text))
    page.goto(address)
    return wall


@pytest.fixture
def wall(page: Page, gallery: str) -> Any:
    wall = opened(page, gallery)
    yield wall
    assert wall.errors == []


def test_filters_of_one_facet_add_and_those_of_two_narrow(wall: Wall) -> None:
    wall.box("items").check()
    assert wall.titles == ["Été"]
    wall.box("items").uncheck()
    wall.box("medium").first.check()
    wall.box("hard").check()
    assert wall.titles == ["The garden", "Cliff"]
    wall.box("textbook").check()
    assert wall.titles == ["Cliff"]
    assert wall.count == "1 of 4 levels"


def test_a_range_of_difficulty_is_chosen_linked_and_cleared(wall: Wall) -> None:
    wall.page.fill("#least", "3")
    assert wall.titles == ["The garden", "Cliff"]
    wall.page.fill("#most", "5.5")
    assert wall.titles == ["The garden"]
    assert wall.number_at("hard") == "0", "a box promises what the range leaves out"
    wall.page.keyboard.press("Enter")
    assert wall.page.url.endswith("#least=3&most=5.5")
    wall.page.reload()
    assert wall.titles == ["The garden"]
    wall.page.get_by_role("button", name="Clear all").click()
    assert wall.count == "4 levels"
    assert wall.page.input_value("#least") == ""


def test_a_visitor_is_told_where_to_start(wall: Wall) -> None:
    start = wall.page.locator("#next")
    assert start.inner_text() == "Start here: The garden"
    start.click()
    assert wall.page.url.endswith(FACTS[0].files.page)


def test_counts_follow_the_other_facets_and_the_search(wall: Wall) -> None:
    assert [wall.number_at(each) for each in ("easy", "hard", "textbook", "areas")] == [
        *["1", "1", "2", "2"]
    ]
    wall.box("textbook").check()
    # What a box of the same facet would add, and one of another would leave.
    assert [wall.number_at(each) for each in ("easy", "hard", "textbook", "areas")] == [
        *["1", "1", "2", "2"]
    ]
    assert wall.box("items").is_enabled()
    wall.box("hard").check()
    assert wall.number_at("items") == "0"
    assert wall.box("items").is_disabled()
    wall.page.fill("#query", "cliff")
    assert wall.number_at("areas") == "0"


@pytest.mark.parametrize(
    ("query", "titles"),
    [
        ("GARDEN", ["The garden"]),
        ("flowers", ["The garden"]),
        ("ete", ["Été"]),
        ("textbook areas", ["Été"]),
        ("key", ["Été"]),
        ("  ", ["The garden", "Cliff", "Été", "Endless"]),
    ],
)
def test_search_looks_through_all_texts_of_a_level(
    wall: Wall, query: str, titles: list[str]
) -> None:
    wall.page.fill("#query", query)
    assert wall.titles == titles


def test_nothing_found_is_said_and_cleared(wall: Wall) -> None:
    wall.page.fill("#query", "zebra")
    assert wall.titles == []
    assert wall.page.get_by_text("No level matches").is_visible()
    wall.page.locator("#none button").click()
    assert len(wall.titles) == 4
    assert wall.page.input_value("#query") == ""


def test_each_filter_can_be_removed_where_it_is_named(wall: Wall) -> None:
    wall.box("hard").check()
    wall.box("textbook").check()
    wall.page.get_by_role("button", name="Remove the filter Hard").click()
    assert not wall.box("hard").is_checked()
    assert wall.titles == ["Cliff", "Été"]


def test_levels_without_the_number_come_last_in_both_orders(wall: Wall) -> None:
    wall.page.select_option("#order", "difficulty")
    assert wall.titles == ["Été", "The garden", "Cliff", "Endless"]
    wall.page.select_option("#order", "-difficulty")
    assert wall.titles == ["Cliff", "The garden", "Été", "Endless"]
    wall.page.select_option("#order", "title")
    assert wall.titles == ["Cliff", "Endless", "Été", "The garden"]
    wall.page.select_option("#order", "")
    assert wall.titles == ["The garden", "Cliff", "Été", "Endless"]


def test_the_address_holds_what_is_chosen_and_back_returns_to_it(wall: Wall, gallery: str) -> None:
    wall.box("textbook").check()
    wall.page.select_option("#order", "title")
    assert wall.page.url == f"{gallery}#tag=textbook&sort=title"
    wall.page.go_back()
    assert wall.titles == ["Cliff", "Été"]
    assert wall.page.input_value("#order") == ""
    wall.page.go_back()
    assert len(wall.titles) == 4
    assert not wall.box("textbook").is_checked()


def test_a_link_opens_a_filtered_wall(page: Page, gallery: str) -> None:
    wall = opened(page, f"{gallery}#q=e&tag=areas&tag=unknown&sort=-size")
    assert wall.titles == ["The garden", "Été"]
    assert page.input_value("#query") == "e"
    assert opened(page, f"{gallery}#%E0%A4&sort=nonsense").count == "4 levels"


def test_the_name_in_the_address_is_passed_on_to_the_levels(page: Page, gallery: str) -> None:
    page.goto(f"{gallery}?player=Ada+Lovelace")
    links = page.locator("#wall a")
    assert links.count() == 4
    for link in links.all():
        assert str(link.get_attribute("href")).endswith("/index.html?player=Ada+Lovelace")


def test_typing_makes_no_steps_back(wall: Wall, gallery: str) -> None:
    wall.page.locator("#query").press_sequentially("cliff", delay=20)
    wall.page.wait_for_url(f"{gallery}#q=cliff")
    assert wall.page.evaluate("history.length") <= 2


def test_a_slash_goes_to_the_search_and_can_be_typed_there(wall: Wall) -> None:
    wall.page.keyboard.press("/")
    assert wall.page.evaluate("document.activeElement.id") == "query"
    wall.page.keyboard.type("a/b")
    assert wall.page.input_value("#query") == "a/b"


def test_films_are_loaded_only_where_the_pointer_or_the_focus_is(wall: Wall) -> None:
    wall.page.wait_for_timeout(300)
    assert wall.films() == []
    tiles = wall.page.locator("#wall li")
    tiles.nth(1).hover()
    tiles.nth(0).hover()
    wall.page.locator("#wall .plays .film").wait_for()
    assert len(wall.films()) == 1
    wall.page.mouse.move(2, 2)
    assert wall.page.locator(".film").count() == 0
    wall.page.locator("#wall a").nth(1).focus()
    wall.page.keyboard.press("Tab")
    wall.page.locator("#wall li:nth-child(3) .film").wait_for()
    assert [each.split("/")[-2] for each in wall.films()] == ["garden", "key"]


def test_no_film_plays_where_the_visitor_wants_less_motion(browser: Browser, gallery: str) -> None:
    context = browser.new_context(reduced_motion="reduce")
    wall = opened(context.new_page(), gallery)
    wall.page.locator("#wall li").first.hover()
    wall.page.wait_for_timeout(500)
    assert wall.films() == []
    assert wall.page.locator(".film").count() == 0
    context.close()


def solve(wall: Wall, progress: Any) -> None:
    wall.page.evaluate("text => localStorage.setItem('babyrobot:progress', text)", progress)
    wall.page.reload()


def test_progress_is_shown_filtered_and_forgotten(wall: Wall) -> None:
    assert not wall.page.locator("#progress").is_visible()
    first, second = (facts.digest for facts in FACTS[:2])
    other = {"solved": True}
    progress = {first: {"solved": True, "stars": 2}, second: {"best": 1}, "other": other}
    solve(wall, json.dumps(progress))
    assert wall.page.inner_text("#solved") == "1 of 4 solved"
    assert wall.page.locator(".done").all_inner_texts() == ["★★☆"]
    link = wall.page.get_by_role("link", name=re.compile("The garden Medium 5.5"))
    expect(link).to_have_accessible_description("Solved with 2 of 3 stars")
    following = wall.page.locator("#next")
    assert following.inner_text() == f"Next: {FACTS[1].title}"
    assert (following.get_attribute("href") or "").endswith(FACTS[1].files.page)
    wall.box("solved").check()
    assert wall.titles == ["The garden"]
    wall.page.on("dialog", lambda dialog: dialog.accept())
    wall.page.click("#forget")
    assert following.inner_text() == f"Start here: {FACTS[0].title}"
    assert len(wall.titles) == 4
    assert wall.page.locator(".done").count() == 0
    stored = wall.page.evaluate("JSON.parse(localStorage.getItem('babyrobot:progress'))")
    assert stored == {"other": other}, "progress of other galleries was lost"


def test_the_next_level_is_the_one_after_the_last_that_was_solved(wall: Wall) -> None:
    solved = {"solved": True}
    solve(wall, json.dumps({FACTS[0].digest: solved, FACTS[2].digest: solved}))
    assert wall.page.inner_text("#next") == "Next: Endless"
    solve(wall, json.dumps({FACTS[2].digest: solved, FACTS[3].digest: solved}))
    assert wall.page.inner_text("#next") == "Next: The garden"


def test_a_gallery_that_is_solved_leads_nowhere(wall: Wall) -> None:
    solve(wall, json.dumps({facts.digest: {"solved": True} for facts in FACTS}))
    assert wall.page.inner_text("#solved") == "4 of 4 solved"
    expect(wall.page.locator("#next")).to_be_hidden()


@pytest.mark.parametrize(
    "text", ["nonsense", "null", "[]", "7", '{"DIGEST": null}', '{"DIGEST": 3}']
)
def test_progress_that_is_not_understood_is_none(wall: Wall, text: str) -> None:
    solve(wall, text.replace("DIGEST", FACTS[0].digest))
    assert wall.count == "4 levels"
    assert not wall.page.locator("#progress").is_visible()


def test_the_wall_works_without_storage(page: Page, gallery: str) -> None:
    page.add_init_script(
        "Object.defineProperty(window, 'localStorage', {get() { throw new Error('denied'); }})"
    )
    assert opened(page, gallery).count == "4 levels"


def test_without_javascript_all_tiles_are_links(browser: Browser, gallery: str) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(gallery)
    assert page.get_by_role("link", name="Cliff").is_visible()
    assert not page.locator("#filters").is_visible()
    assert not page.locator("#query").is_visible()
    page.get_by_role("link", name="Cliff").click()
    assert page.url.endswith("/cliff/index.html")
    context.close()


@pytest.mark.parametrize("width", [320, 390])
def test_on_a_phone_filters_are_in_a_sheet(browser: Browser, gallery: str, width: int) -> None:
    context = browser.new_context(viewport={"width": width, "height": 700})
    wall = opened(context.new_page(), gallery)
    assert not wall.box("hard").is_visible()
    wall.page.get_by_role("button", name="Filters").click()
    wall.box("hard").check()
    wall.page.get_by_role("button", name="Show 1 level", exact=True).click()
    assert wall.titles == ["Cliff"]
    assert not wall.box("hard").is_visible()
    assert wall.page.inner_text("#how-many") == "1"
    sizes = "[document.documentElement.scrollWidth, innerWidth]"
    wide, window = wall.page.evaluate(sizes)
    assert wide <= window, "the page is wider than the window"
    context.close()
