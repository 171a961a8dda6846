"""The editor by keys alone, and what is told to people who do not see it."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, expect
from support.editors import OpenEditor
from support.hands import Keys

pytestmark = pytest.mark.slow

LEVEL = """\
version: 1
size: [6, 4]
start: [0, 3]
exit: [5, 3]
walls:
  - {at: [2, 0], side: E}
puddles:
  - {at: [1, 1], size: small}
"""


class Typing(Keys):
    """Keys at one editor, and what is heard of it."""

    @property
    def text(self) -> str:
        return self.editor.session.text

    @property
    def said(self) -> str:
        """What is said below the picture."""
        return self.page.locator(".said").inner_text()

    @property
    def spoken(self) -> str:
        """What screen readers read out besides."""
        return self.page.locator(".spoken").inner_text().replace("\N{NO-BREAK SPACE}", "")

    @property
    def focus(self) -> Locator:
        return self.page.locator("#editor :focus")

    def change(self, *keys: str) -> None:
        """Press keys, the last of which changes the level."""
        self.type(*keys[:-1])
        with self.changing():
            self.type(keys[-1])


@pytest.fixture
def keys(editor_page: OpenEditor) -> Typing:
    return Typing(editor_page(LEVEL))


# -- the cursor --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pressed", "cell"),
    [
        (["ArrowRight", "ArrowDown", "ArrowRight", "ArrowUp", "ArrowLeft"], "[1, 0]: empty"),
        (["End", "Home", "ArrowRight"], "[1, 0]: empty"),
        (["PageDown", "PageUp", "ArrowRight"], "[1, 0]: empty"),
        (["Control+ArrowDown", "Control+ArrowRight"], "[5, 3]: exit; east and south: wall"),
        (["ArrowDown", "ArrowRight"], "[1, 1]: small puddle"),
    ],
)
def test_the_cursor_moves_and_its_cell_is_told(keys: Typing, pressed: list[str], cell: str) -> None:
    keys.type(*pressed)
    assert keys.spoken.startswith(cell)


def test_the_cursor_stays_inside(keys: Typing) -> None:
    keys.type("ArrowUp")
    assert keys.said == "[0, 0] is at the north edge."
    keys.change("PageDown", "Alt+Shift+ArrowUp")
    keys.type("l")
    assert keys.spoken.startswith("[0, 2]: start")


def test_what_was_told_is_told_again_on_demand(keys: Typing) -> None:
    texts = []
    for _ in range(2):
        keys.type("l")
        texts.append(keys.page.locator(".spoken").text_content())
    # What is said twice is another text, or it would not be read out again.
    assert texts[0] != texts[1]
    assert keys.spoken == "[0, 0]: empty; north and west: wall"


def test_the_cursor_is_seen_in_a_part_of_the_picture(keys: Typing) -> None:
    keys.type(*"++++", "End", "PageDown")
    stage, cursor = (
        keys.page.locator(place).bounding_box() for place in (".stage", ".layers > .cursor")
    )
    assert stage is not None
    assert cursor is not None
    assert stage["x"] <= cursor["x"]
    assert stage["y"] <= cursor["y"]
    assert cursor["x"] + cursor["width"] <= stage["x"] + stage["width"]
    assert cursor["y"] + cursor["height"] <= stage["y"] + stage["height"]
    keys.type("0")
    expect(keys.page.locator(".stage")).not_to_contain_class("wide")


# -- drawing -----------------------------------------------------------------------------------


def test_a_door_that_nothing_opens_leads_to_its_key(keys: Typing) -> None:
    keys.type("d", "Shift+ArrowRight")
    expect(keys.page.get_by_role("button", name="Draw a key first")).to_be_visible()
    keys.type("Tab", "Enter", "ArrowDown", "Space")
    expect(keys.page.locator(".said")).to_contain_text("door, needs key")
    assert len(keys.level.items) == len(keys.level.doors) == 1
    expect(keys.page.get_by_role("button", name="Draw a key first")).to_be_hidden()


@pytest.mark.parametrize(
    ("pressed", "line", "said"),
    [
        (["Shift+ArrowRight"], "- {at: [0, 0], side: E}", "East side of [0, 0]: wall."),
        (
            ["ArrowDown", "m", "ArrowRight", "Shift+ArrowDown"],
            "- {at: [0, 1], side: S, length: 2}",
            "South sides of [0, 1] to [1, 1]: wall.",
        ),
        (["3", "Enter"], "- {at: [0, 0], size: large}", "Large puddle in [0, 0]"),
        (
            ["4", "r", "m", "ArrowRight", "ArrowDown", "Space"],
            "- {at: [0, 0], size: [2, 2]}",
            "Blocked in all cells from [0, 0] to [1, 1]",
        ),
        (["e", "Space"], "exit: [0, 0]", "Exit in [0, 0]"),
        (
            ["t", "m", "ArrowRight", "Space"],
            "- {at: [0, 0], to: [1, 0]}",
            "Warp from [0, 0] to [1, 0]",
        ),
        (
            ["g", "m", "ArrowRight", "ArrowDown", "Space"],
            "path: [[0, 0], [1, 0], [1, 1]]",
            "Mover through 3 cells from [0, 0] to [1, 1]",
        ),
        (
            ["g", "m", "ArrowRight", "ArrowDown", "Shift+Space"],
            "within: {at: [0, 0], size: [2, 2]}",
            "Mover in all cells from [0, 0] to [1, 1]",
        ),
        (["w", "Shift+ArrowUp"], "north: [1, 0, 0, 0, 0, 0]", "Wind of 1 to the north in column 0"),
        (["Alt+ArrowRight"], "size: [7, 4]", "The level is 7 by 4 cells"),
        (["Alt+ArrowLeft"], "start: [1, 3]", "The level is 7 by 4 cells"),
        (["Alt+Shift+ArrowUp"], "start: [0, 2]", "The level is 6 by 3 cells"),
    ],
)
def test_keys_draw_as_the_mouse_does(
    keys: Typing, pressed: list[str], line: str, said: str
) -> None:
    assert line not in keys.text
    keys.change(*pressed)
    assert line in keys.text
    assert keys.said.startswith(said)


def test_a_side_is_built_with_the_tool_at_hand_and_removed_by_the_same_key(keys: Typing) -> None:
    def twice(tool: str) -> list[str]:
        keys.type(tool)
        said = []
        for _ in range(2):
            keys.change("Shift+ArrowDown")
            words = re.fullmatch(r"South side of \[0, 0\]: (.+?)\.( .*)?", keys.said)
            assert words is not None
            said.append(words[1])
        return said

    keys.change("6", "End", "Space")
    keys.type("Home")
    assert twice("1") == twice("2") == ["wall", "open"]
    assert twice("x") == ["glass 0.5", "open"]
    assert twice("d") == ["door, needs key", "open"]


def test_what_is_there_is_moved_erased_and_removed(keys: Typing) -> None:
    keys.go((1, 1))
    keys.change("9", "m", "ArrowRight", "Space")
    assert "{at: [2, 1], size: small}" in keys.text
    assert keys.said == "Moved from [1, 1] to [2, 1]."
    keys.type("Escape")
    keys.change("Delete")
    assert "puddles" not in keys.text
    keys.change("Control+z")
    keys.type("i")
    assert keys.spoken == "Selected: small puddle."
    keys.type("Shift+F6")
    expect(keys.focus).to_have_class("stage")
    keys.change("Delete")
    assert "puddles" not in keys.text


def test_steps_are_undone_and_done_again(keys: Typing) -> None:
    keys.change("2", "Space")
    drawn = keys.text
    keys.change("Control+z")
    assert (keys.text, keys.said) == (LEVEL, "Undone: painting.")
    keys.change("Control+Shift+z")
    assert (keys.text, keys.said) == (drawn, "Done again: painting.")
    keys.change("Control+z")
    keys.change("Control+y")
    assert keys.text == drawn


def test_escape_ends_a_drag_without_a_change(keys: Typing) -> None:
    keys.type("4", "m", "ArrowRight", "Escape")
    assert keys.said == "Cancelled: nothing has changed."
    keys.change("Space")
    assert "- {at: [1, 0]}" in keys.text


def test_mistakes_are_counted_as_they_come_and_go(keys: Typing) -> None:
    keys.go((5, 2))
    keys.change("Shift+ArrowDown")
    keys.go((4, 3))
    keys.change("Shift+ArrowRight")
    assert "Findings: " in keys.said
    keys.type("ArrowRight")
    assert "cannot be reached" in keys.spoken
    keys.change("Control+z")
    assert keys.said == "Undone: walls. No findings."


# -- the rest of the editor --------------------------------------------------------------------


def test_f6_goes_through_the_parts(keys: Typing) -> None:
    parts = []
    for key in ("F6", "F6", "F6", "F6", "Shift+F6"):
        keys.type(key)
        parts.append(keys.focus.evaluate("(each) => each.closest('[data-part]').dataset.part"))
    assert parts == ["panels", "bar", "tools", "stage", "tools"]


def test_modes_have_keys(keys: Typing) -> None:
    keys.type("p")
    assert keys.spoken == "Playing."
    keys.type("ArrowRight")
    keys.type("Escape")
    assert keys.spoken == "Editing."
    # The arrow moved the robot, not the cursor.
    keys.type("l")
    assert keys.spoken.startswith("[0, 0]")


def test_a_click_on_a_button_leaves_the_keys_to_the_picture(keys: Typing) -> None:
    keys.change("2", "Space")
    pressed = ["[data-shown=values]", "[data-panel=findings]", "[title^=Undo]", "[title='Zoom in']"]
    for button in [*pressed, "[data-mode=play]", ".quick button >> nth=1"]:
        keys.page.locator(f"button{button}" if button[0] == "[" else button).click()
        assert keys.focus.get_attribute("data-part") == "stage", button
    keys.type("ArrowRight")
    expect(keys.page.locator(".episode dd").first).to_have_text("1")


def test_text_fields_keep_their_keys(keys: Typing) -> None:
    area = keys.page.get_by_role("textbox", name="Level file")
    area.focus()
    with keys.changing():
        keys.page.keyboard.press("Control+End")
        keys.page.keyboard.type("title: Spd 2?\n")
    assert keys.text == LEVEL + "title: Spd 2?\n"
    expect(keys.page.get_by_role("button", name="Walls")).to_have_attribute("aria-pressed", "true")
    keys.type("Escape", "Tab")
    expect(area).not_to_be_focused()


def test_shortcuts_of_single_letters_can_be_turned_off(keys: Typing) -> None:
    keys.type("?")
    help_list = keys.page.get_by_role("dialog", name="Keys and gestures")
    help_list.get_by_label("Letters, digits and signs are shortcuts").uncheck()
    keys.type("Escape")
    expect(help_list).to_be_hidden()
    keys.page.locator(".stage").focus()
    keys.type("2", "?")
    expect(help_list).to_be_hidden()
    keys.change("Shift+ArrowRight")
    assert "- {at: [0, 0], side: E}" in keys.text
    keys.type("F1")
    expect(help_list).to_be_visible()


def test_without_a_picture_the_text_can_still_be_corrected(editor_page: OpenEditor) -> None:
    keys = Typing(editor_page("version: 1\nsize: [0, 0]\n"))
    keys.type("ArrowRight", "Space", "Shift+ArrowUp", "2", "l", "i", "p", "v", "+", "F6", "F6")
    expect(keys.page.get_by_text("There is no picture")).to_be_visible()
    keys.page.get_by_role("textbox", name="Level file").focus()
    with keys.changing():
        keys.page.keyboard.press("Control+a")
        keys.page.keyboard.type("version: 1\n")
    expect(keys.page.locator(".stage > svg")).to_be_visible()
