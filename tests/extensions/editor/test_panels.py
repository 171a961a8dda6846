"""The panels beside the picture: the selection, the level, and the findings."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, Page, expect
from support.editors import EditorPage, OpenEditor
from support.hands import Mouse
from support.jupyter import until

pytestmark = pytest.mark.slow

LEVEL = """\
version: 1
title: Doors and walls
# The grid.
size: [5, 3]
walls:
  - {at: [1, 0], side: E}  # first
items:
  - {name: key, at: [0, 2]}
switches:
  - {name: lever, at: [2, 2]}
doors:
  - {at: [3, 1], side: E, needs: key}
puddles:
  - {at: [2, 1]}
"""


def select(editor: EditorPage, found: str) -> Locator:
    """Select the entry of the line that contains a text; return the inspector."""
    page = editor.page
    number = editor.session.text[: editor.session.text.index(found)].count("\n")
    page.get_by_label("Level file").focus()
    page.keyboard.press("Control+Home")
    for _ in range(number):
        page.keyboard.press("ArrowDown")
    inspector = page.locator(".inspector")
    expect(inspector.get_by_role("button", name="Remove")).to_be_visible()
    return inspector


def level_section(page: Page, title: str) -> Locator:
    """Open a section of the level; return it."""
    page.get_by_role("tab", name="Level").click()
    section = page.locator("details.group").filter(has=page.locator("summary", has_text=title))
    if section.get_attribute("open") is None:
        section.locator("> summary").click()
    return section


def field(place: Locator, name: str) -> Locator:
    return place.locator(f'.field[data-name="{name}"]')


def becomes(editor: EditorPage, wanted: str) -> None:
    """Wait until the text contains something, and the page shows it."""
    until(lambda: wanted in editor.session.text, f"{wanted!r} is in the text")
    expect(editor.page.get_by_label("Level file")).to_have_value(editor.session.text)


# -- the selection -------------------------------------------------------------------------------


def test_each_field_of_an_entry_is_one_change(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    inspector = select(editor, "side: E}  # first")
    number = field(inspector, "pass").get_by_role("textbox")
    number.fill("0.25")
    number.press("Enter")
    becomes(editor, "{at: [1, 0], side: E, pass: 0.25}  # first")
    field(inspector, "side").get_by_role("combobox").select_option("S")
    becomes(editor, "side: S")
    field(inspector, "fit").get_by_role("checkbox").check()
    becomes(editor, "fit: true")
    field(inspector, "color").get_by_role("textbox").last.fill("crimson")
    field(inspector, "color").get_by_role("textbox").last.press("Enter")
    becomes(editor, "color: crimson")
    expect(field(inspector, "color").locator("[type=color]")).to_have_value("#dc143c")
    field(inspector, "color").get_by_role("button", name="Reset").click()
    until(lambda: "crimson" not in editor.session.text, "the colour is the theme's")
    for _ in range(5):
        editor.page.get_by_role("button", name="Undo").click()
    expect(editor.page.get_by_label("Level file")).to_have_value(LEVEL)


def test_a_wrong_value_is_told_at_its_field_and_can_be_corrected(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    width = field(select(editor, "# first"), "width")
    for wrong in ("wide", "300"):
        width.get_by_role("textbox").fill(wrong)
        width.get_by_role("textbox").press("Enter")
        expect(width.get_by_role("alert")).to_contain_text("width")
        expect(editor.page.locator(".said")).not_to_contain_text("`")
        expect(width.get_by_role("textbox")).to_have_value(wrong)
        assert editor.session.text == LEVEL
    width.get_by_role("textbox").fill("9")
    width.get_by_role("textbox").press("Enter")
    becomes(editor, "width: 9")
    expect(width.get_by_role("alert")).to_have_count(0)


def test_a_stepper_that_is_held_is_one_change(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    reward = field(select(editor, "name: key"), "reward")
    more = reward.get_by_role("button", name="more").bounding_box()
    assert more is not None
    editor.page.mouse.move(more["x"] + 5, more["y"] + 5)
    editor.page.mouse.down()
    editor.page.wait_for_timeout(1500)
    assert editor.session.text == LEVEL
    editor.page.mouse.up()
    becomes(editor, "reward: ")
    assert float(reward.get_by_role("textbox").input_value()) > 5
    editor.page.get_by_role("button", name="Undo").click()
    expect(editor.page.get_by_label("Level file")).to_have_value(LEVEL)


def test_a_stepper_works_by_touch_and_by_keyboard(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL, viewport={"width": 390, "height": 844}, has_touch=True)
    editor.page.get_by_role("tab", name="Level").tap()
    editor.page.locator("summary", has_text="Rewards").tap()
    step = editor.page.locator('.field[data-name="rewards.step"]')
    step.get_by_role("button", name="less").tap()
    becomes(editor, "step: -2")
    step.get_by_role("textbox").press("ArrowDown")
    becomes(editor, "step: -3")


def test_an_empty_level_greets_with_three_steps_until_something_stands_in_it(
    editor_page: OpenEditor,
) -> None:
    editor = editor_page("version: 1\nsize: [4, 3]\n")
    steps = editor.page.locator(".steps")
    expect(steps.locator("li")).to_have_count(3)
    expect(steps.locator("li").last).to_be_in_viewport(ratio=1)
    steps.get_by_role("textbox").first.fill("6")
    steps.get_by_role("textbox").first.press("Enter")
    becomes(editor, "size: [6, 3]")
    steps.get_by_role("button", name="Grow a maze").click()
    becomes(editor, "maze: {seed: ")
    expect(steps).to_be_hidden()
    # What is pressed beside the picture leaves the keys to it.
    editor.page.keyboard.press("p")
    expect(editor.page.locator(".playing")).to_be_visible()
    expect(editor.page.locator(".stage")).to_be_focused()


def test_a_maze_is_grown_without_scrolling(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    editor.page.get_by_role("tab", name="Level").click()
    expect(editor.page.get_by_role("button", name="Grow a maze")).to_be_in_viewport(ratio=1)


def test_panels_are_made_wider_by_keys_and_by_hand_and_stay_so(editor_page: OpenEditor) -> None:
    page = editor_page(LEVEL).page
    divider = page.get_by_role("separator", name="Width of the panels")

    def wide() -> float:
        box = page.locator(".panels").bounding_box()
        assert box is not None
        return box["width"]

    usual = wide()
    divider.press("ArrowLeft")
    assert wide() == pytest.approx(usual + 32, abs=1)
    page.reload()
    expect(divider).to_have_attribute("aria-valuenow", str(round(usual + 32)))
    box = divider.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 6, 400)
    page.mouse.down()
    page.mouse.move(box["x"] - 94, 400)
    page.mouse.up()
    assert wide() == pytest.approx(usual + 132, abs=8)
    divider.dblclick()
    assert wide() == pytest.approx(usual, abs=1)


def test_tools_have_names_where_there_is_room_and_one_taps_without_a_mouse(
    editor_page: OpenEditor,
) -> None:
    page = editor_page(LEVEL).page
    name = page.locator("[data-tool=small] .tool-name")
    expect(name).to_be_visible()
    expect(page.locator(".options .hint")).to_contain_text("Click a side")
    page.set_viewport_size({"width": 900, "height": 700})
    expect(name).to_be_hidden()
    size = {"width": 390, "height": 844}
    page = editor_page(LEVEL, viewport=size, has_touch=True, is_mobile=True).page
    expect(page.locator(".options .hint")).to_contain_text("Tap a side")


def test_a_door_needs_what_is_checked(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    needs = field(select(editor, "needs: key"), "needs")
    expect(needs.get_by_label("key")).to_be_checked()
    needs.get_by_label("lever").check()
    becomes(editor, "needs: [key, lever]")
    needs.get_by_label("key").uncheck()
    until(
        lambda: "needs: [lever]" in editor.session.text or "needs: lever" in editor.session.text, ""
    )


def test_what_else_is_in_the_cell_is_offered(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL.replace("at: [0, 2]", "at: [2, 1]"))
    inspector = select(editor, "- {at: [2, 1]}")
    inspector.get_by_role("button", name="key").click()
    expect(inspector.get_by_role("heading")).to_have_text("Key at [2, 1]")


# -- the level -----------------------------------------------------------------------------------


def test_fields_of_the_level_are_set_and_reset(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    about = level_section(editor.page, "About the level")
    field(about, "title").get_by_role("textbox").fill("Another: title")
    field(about, "title").get_by_role("textbox").press("Enter")
    becomes(editor, 'title: "Another: title"\n# The grid.')
    field(about, "tags").get_by_role("textbox").fill("doors, walls")
    field(about, "tags").get_by_role("textbox").press("Enter")
    becomes(editor, "tags: [doors, walls]")
    size = level_section(editor.page, "Size")
    size.get_by_role("textbox", name="size: width").fill("7")
    editor.page.keyboard.press("Enter")
    becomes(editor, "size: [7, 3]")
    display = level_section(editor.page, "Display")
    expect(field(display, "display.compass")).to_be_in_viewport(ratio=1)
    field(about, "title").get_by_role("button", name="Reset").click()
    until(lambda: "title" not in editor.session.text, "there is no title")


def test_a_maze_is_grown_changed_and_written_out(editor_page: OpenEditor) -> None:
    editor = editor_page("version: 1\nsize: [6, 4]\n")
    section = level_section(editor.page, "Maze")
    section.get_by_role("button", name="Grow a maze").click()
    until(lambda: "maze:" in editor.session.text, "there is a maze")
    first = editor.session.text
    section.get_by_role("button", name="Another seed").click()
    until(lambda: editor.session.text not in (first, "version: 1\nsize: [6, 4]\n"), "another maze")
    field(section, "maze.algorithm").get_by_role("combobox").select_option("wilson")
    becomes(editor, "algorithm: wilson")
    grid = editor.session.level.grid().open if editor.session.level else None
    section.get_by_role("button", name="Write out as walls").click()
    until(lambda: "maze" not in editor.session.text, "the maze is written out")
    assert "walls:" in editor.session.text
    assert grid is not None
    assert editor.session.level is not None
    assert (editor.session.level.grid().open == grid).all()
    expect(section.get_by_role("button", name="Grow a maze")).to_be_visible()


def test_a_maze_whose_walls_are_opened_says_so_and_can_be_written_out(
    editor_page: OpenEditor,
) -> None:
    editor = editor_page("version: 1\nsize: [3, 3]\nmaze: {seed: 1}\n")
    page = editor.page
    section, offer = (
        level_section(page, "Maze"),
        page.get_by_role("button", name="Write the maze out"),
    )
    expect(section.get_by_text("removes walls of the maze")).to_be_hidden()
    expect(offer).to_be_hidden()
    page.get_by_label("Level file").fill(
        editor.session.text + "openings:\n  - {at: [0, 0], side: E}\n"
    )
    expect(section.get_by_text("removes walls of the maze")).to_be_visible()
    offer.click()
    until(lambda: "maze" not in editor.session.text, "the maze is written out")
    expect(offer).to_be_hidden()


def test_a_maze_that_has_grown_anew_says_so_and_its_walls_can_be_kept(
    editor_page: OpenEditor,
) -> None:
    editor = editor_page("version: 1\nsize: [5, 4]\nmaze: {seed: 1}\n")
    page = editor.page
    kept = page.get_by_role("button", name="Keep the walls of the maze")
    expect(kept).to_be_hidden()
    mouse = Mouse(editor)
    mouse.drag(mouse.at(0.5, 0.5), mouse.at(2.5, 2.5))
    expect(page.locator(".said")).to_contain_text("The maze has grown anew.")
    kept.click()
    expect(kept).to_be_hidden()
    assert "maze" not in editor.session.text
    assert "start: [2, 2]" in editor.session.text


def test_wind_is_added_changed_and_removed(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    section = level_section(editor.page, "Wind")
    section.get_by_role("combobox").select_option("S")
    section.get_by_role("textbox", name="column or row").fill("2")
    section.get_by_role("button", name="Add").click()
    becomes(editor, "south: [0, 0, 1, 0, 0]")
    section.get_by_role("button", name="more column 2").click()
    becomes(editor, "south: [0, 0, 2, 0, 0]")
    section.get_by_role("button", name="Remove the wind").click()
    until(lambda: "south" not in editor.session.text, "there is no wind")


def test_a_theme_is_chosen_and_its_contrasts_are_told(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    section = level_section(editor.page, "Theme")
    section.get_by_role("button", name="green", exact=True).click()
    becomes(editor, "theme: green")
    expect(section.get_by_text("everything stands out")).to_be_visible()
    section.locator("summary", has_text="Colours and widths").click()
    walls = field(section, "theme.colors.walls").get_by_role("textbox").last
    walls.fill("#588158")
    walls.press("Enter")
    becomes(editor, 'walls: "#588158"')
    expect(section.get_by_text("walls too low")).to_be_visible()
    level = editor.session.level
    assert level is not None
    # The other colours stay those of the theme that was chosen.
    assert level.resolved_theme.colors.exit == "#00352a"
    section.get_by_role("button", name="default").click()
    until(lambda: "theme" not in editor.session.text, "the theme is the default one")


# -- findings ------------------------------------------------------------------------------------

FOUND = """\
version: 1
size: [4, 2]
walls:
  - {at: [1, 0], side: E}
  - {at: [1, 0], side: E}
"""


def test_findings_lead_to_their_places_and_are_fixed(editor_page: OpenEditor) -> None:
    editor = editor_page(FOUND)
    page = editor.page
    page.get_by_role("tab", name="Findings").click()
    panel = page.locator(".findings")
    expect(panel.get_by_role("heading")).to_have_text("Findings (1)")
    panel.locator(".finding").click()
    area = page.get_by_label("Level file")
    expect(area).to_be_focused()
    place = area.evaluate("area => area.value.slice(0, area.selectionStart).split('\\n').length")
    assert place == 5
    page.get_by_role("tab", name="Findings").click()
    panel.get_by_role("button", name="Fix").click()
    until(lambda: editor.session.text.count("side: E") == 1, "one wall is left")
    expect(panel.get_by_role("heading")).to_have_text("No findings")


def test_fixes_that_change_the_level_say_so(editor_page: OpenEditor) -> None:
    useless = "version: 1\nsize: [4, 2]\nexit: [3, 1]\nitems:\n  - {name: gem, at: [1, 1]}\n"
    page = editor_page(useless).page
    page.get_by_role("tab", name="Findings").click()
    fix = page.locator(".findings .fix", has_text="changes the level")
    expect(fix).to_have_accessible_name("Fix: remove `gem` (changes the level)")


def test_in_a_narrow_window_a_finding_leads_to_the_text(editor_page: OpenEditor) -> None:
    page = editor_page(FOUND, viewport={"width": 390, "height": 844}).page
    page.get_by_role("tab", name="Findings").click()
    page.locator(".finding").click()
    expect(page.get_by_label("Level file")).to_be_focused()
    expect(page.locator(".line.warning")).to_be_in_viewport()
