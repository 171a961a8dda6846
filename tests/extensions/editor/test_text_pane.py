"""The text beside the picture: typing, findings at their place, and what the caret is about."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, Page, expect
from support.editors import OpenEditor
from support.jupyter import until

pytestmark = pytest.mark.slow

LEVEL = """\
version: 1
# The grid.
size: [5, 3]
exit: [4, 2]
puddles:
  - {at: [2, 1], size: large}  # wet
  - {at: [3, 1]}
"""

DRAWN = """\
version: 1
map: |
  +---+---+
  | S   o |
  +   +   +
  |     E |
  +---+---+
"""

SLOWLY = """() => {
  const quick = window.fetch;
  window.fetch = async (...request) => {
    await new Promise((done) => setTimeout(done, 250));
    return quick(...request);
  };
}"""
"""Makes every answer take a quarter of a second longer."""

PAUSE = 1200
"""Milliseconds after which what is typed is another step."""


def area(page: Page) -> Locator:
    return page.get_by_label("Level file")


def line(page: Page, number: int) -> Locator:
    return page.locator(".line").nth(number - 1)


def put_caret(page: Page, number: int, column: int = 1) -> None:
    area(page).focus()
    page.keyboard.press("Control+Home")
    for key, times in (("ArrowDown", number - 1), ("ArrowRight", column - 1)):
        for _ in range(times):
            page.keyboard.press(key)


def caret(page: Page) -> int:
    place: int = area(page).evaluate("area => area.selectionStart")
    return place


def top_of(shown: Locator) -> float:
    box = shown.bounding_box()
    assert box is not None
    return box["y"]


def test_what_is_typed_changes_the_level_and_pauses_part_the_steps(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    page, session = editor.page, editor.session
    put_caret(page, 8)
    page.keyboard.type("max_steps: 9", delay=20)
    until(lambda: session.text == LEVEL + "max_steps: 9", "the level is changed")
    page.wait_for_timeout(PAUSE)
    page.keyboard.type("5", delay=20)
    until(lambda: session.text.endswith("95"), "the level is changed again")
    page.keyboard.press("Control+z")
    expect(area(page)).to_have_value(LEVEL + "max_steps: 9")
    page.keyboard.press("Control+z")
    expect(area(page)).to_have_value(LEVEL)
    assert not session.can_undo
    page.keyboard.press("Control+Shift+z")
    page.keyboard.press("Control+y")
    expect(area(page)).to_have_value(LEVEL + "max_steps: 95")


def test_nothing_is_lost_that_is_typed_while_an_answer_is_awaited(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    page = editor.page
    page.evaluate(SLOWLY)
    put_caret(page, 8)
    words = "# one two three four five six seven"
    for word in words.split(" "):
        page.keyboard.type(f"{word} ", delay=15)
        page.wait_for_timeout(170)
    until(lambda: editor.session.text == f"{LEVEL}{words} ", "all is there")
    expect(area(page)).to_have_value(f"{LEVEL}{words} ")


def test_a_mistake_is_shown_at_its_place_and_told_at_the_caret(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL.replace("large", "huge"))
    page = editor.page
    expect(page.locator(".line.error")).to_have_count(1)
    expect(line(page, 6).locator(".mark.error")).to_have_text("huge")
    put_caret(page, 6)
    expect(page.locator(".at-caret")).to_contain_text("Line 6: ")
    line(page, 6).locator(".mark").hover(force=True)
    expect(area(page)).to_have_attribute("title", editor.session.report.diagnostics[0].message)
    expect(area(page)).to_have_attribute("aria-invalid", "true")
    area(page).fill(LEVEL)
    expect(page.locator(".line.error")).to_have_count(0)
    expect(area(page)).to_have_attribute("aria-invalid", "false")


def test_the_line_of_the_caret_is_seen_beside_the_message_about_it(editor_page: OpenEditor) -> None:
    page = editor_page(LEVEL + "# more\n" * 20).page
    put_caret(page, 28)
    page.keyboard.type("wind: [")
    expect(page.locator(".at-caret")).to_contain_text("Line 2")
    last, pane = line(page, 28).bounding_box(), page.locator(".pane").bounding_box()
    assert last is not None
    assert pane is not None
    assert last["y"] + last["height"] <= pane["y"] + pane["height"]


def test_a_refusal_is_told_until_the_text_is_corrected(editor_page: OpenEditor) -> None:
    page = editor_page(LEVEL.replace("large", "huge")).page
    page.get_by_role("tab", name="Level").click()
    page.locator("summary", has_text="Theme").click()
    page.locator("[data-theme=black_orange]").click()
    expect(page.locator(".said")).to_contain_text("correct them")
    area(page).fill(LEVEL)
    expect(page.locator(".said")).to_have_text("")


def test_findings_are_found_in_lines_with_signs_of_two_halves(editor_page: OpenEditor) -> None:
    page = editor_page("version: 1\nmaze: {seed: 1, 🤖🤖: 2}\n").page
    expect(line(page, 2).locator(".mark").first).to_have_text("🤖🤖")


def test_the_caret_selects_the_entry_of_its_line(editor_page: OpenEditor) -> None:
    page = editor_page(LEVEL).page
    heading = page.locator(".inspector h2")
    put_caret(page, 6)
    expect(heading).to_have_text("Large puddle at [2, 1]")
    put_caret(page, 7)
    expect(heading).to_have_text("Small puddle at [3, 1]")
    expect(page.locator(".line.chosen")).to_have_text("  - {at: [3, 1]}\n")
    put_caret(page, 2)
    expect(heading).to_have_text("Nothing is selected")


def test_the_caret_selects_what_is_drawn_at_its_column(editor_page: OpenEditor) -> None:
    page = editor_page(DRAWN).page
    put_caret(page, 4, 9)
    expect(page.locator(".inspector h2")).to_have_text("Small puddle at [1, 0]")
    expect(line(page, 4).locator(".part")).to_contain_text("o")


def test_what_is_selected_in_the_picture_is_marked_in_the_text(editor_page: OpenEditor) -> None:
    many = "".join(f"# line {number}\n" for number in range(100))
    page = editor_page(LEVEL.replace("# The grid.\n", many)).page
    page.get_by_role("button", name="Select").click()
    stage = page.locator(".stage > svg").first.bounding_box()
    assert stage is not None
    page.mouse.click(stage["x"] + stage["width"] / 2, stage["y"] + stage["height"] / 2)
    chosen = page.locator(".line.chosen")
    expect(chosen).to_have_text("  - {at: [2, 1], size: large}  # wet\n")
    expect(chosen).to_be_in_viewport()


def test_a_change_by_the_panels_keeps_caret_and_scroll(editor_page: OpenEditor) -> None:
    many = "".join(f"# line {number}\n" for number in range(100))
    editor = editor_page(LEVEL + many)
    page = editor.page
    put_caret(page, 100, 4)
    before, shown = caret(page), page.locator(".line", has_text="# line 90")
    top = top_of(shown)
    page.get_by_role("tab", name="Level").click()
    page.locator("summary", has_text="Wind").click()
    page.get_by_role("button", name="Add", exact=True).click()
    until(lambda: "wind:" in editor.session.text, "there is wind")
    expect(area(page)).to_have_value(editor.session.text)
    moved = len(editor.session.text) - len(LEVEL + many)
    assert caret(page) in (before, before + moved)
    assert abs(top_of(shown) - top) < 1


def test_tab_indents_and_leaves_after_escape(editor_page: OpenEditor) -> None:
    editor = editor_page("version: 1\nrewards:\n")
    page = editor.page
    put_caret(page, 3)
    page.keyboard.press("Tab")
    page.keyboard.type("step: -2")
    page.keyboard.press("Enter")
    page.keyboard.type("exit: 5")
    until(
        lambda: editor.session.text == "version: 1\nrewards:\n  step: -2\n  exit: 5", "it is typed"
    )
    page.keyboard.press("Escape")
    page.keyboard.press("Tab")
    expect(area(page)).not_to_be_focused()
    assert "\t" not in editor.session.text
    put_caret(page, 3)
    page.keyboard.press("Shift+ArrowDown")
    page.keyboard.press("Tab")
    until(lambda: "\n    step: -2\n" in editor.session.text, "the line is indented further")
