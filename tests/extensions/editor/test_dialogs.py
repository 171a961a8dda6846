"""Opening, copying, saving and ending in the browser."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect
from support.editors import EditorPage, OpenEditor
from support.jupyter import until

import babyrobot_levels as brl
from babyrobot_levels.extensions.editor.sources import session_of

pytestmark = pytest.mark.slow

LEVEL = "version: 1\ntitle: Mine\nsize: [4, 3]\n"
CHANGED = LEVEL + "max_steps: 7\n"


def dialog(page: Page, name: str) -> Locator:
    return page.get_by_role("dialog", name=name)


def asked(page: Page, button: str, name: str) -> Locator:
    """Press a button of the bar; return the dialog that it opens."""
    page.get_by_role("button", name=button).click()
    expect(dialog(page, name)).to_be_visible()
    return dialog(page, name)


def on_file(editor_page: OpenEditor, folder: Path) -> tuple[EditorPage, Path]:
    path = folder / "mine.yaml"
    path.write_text(LEVEL, encoding="utf-8")
    return editor_page(session_of(path)), path


def type_change(editor: EditorPage) -> None:
    editor.page.get_by_label("Level file").fill(CHANGED)
    until(lambda: editor.session.text == CHANGED, "the level is changed")


# -- opening -------------------------------------------------------------------------------------


def test_a_level_is_opened_by_its_name_and_undone(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    opening = asked(editor.page, "Open another level", "Open a level")
    editor.page.keyboard.press("Escape")
    expect(opening).to_be_hidden()
    expect(editor.page.get_by_role("button", name="Open another level")).to_be_focused()
    opening = asked(editor.page, "Open another level", "Open a level")
    expect(opening.get_by_label("Name of the level")).to_be_focused()
    opening.get_by_label("Name of the level").fill("final")
    opening.get_by_role("button", name="The final maze").click()
    expect(opening).to_be_hidden()
    expect(editor.page.locator(".said")).to_have_text("Opened.")
    assert editor.session.level is not None
    assert editor.session.level.digest == brl.load("final-maze").digest
    editor.page.get_by_role("button", name="Undo").click()
    expect(editor.page.get_by_label("Level file")).to_have_value(LEVEL)


def test_a_map_of_another_program_is_opened_from_a_text(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    opening = asked(editor.page, "Open another level", "Open a level")
    opening.get_by_label("Text or share code").fill("no level at all\nneither is this")
    opening.get_by_role("button", name="Open the text").click()
    expect(opening.get_by_role("alert")).to_contain_text("no level")
    assert editor.session.text == LEVEL
    opening.get_by_label("Text or share code").fill("SFF\nFHF\nFFG\n")
    opening.get_by_role("combobox", name="Format").select_option("frozen-lake")
    opening.get_by_role("button", name="Open the text").click()
    expect(opening).to_be_hidden()
    assert editor.session.level is not None
    assert editor.session.level.size == (3, 3)


def test_a_level_is_opened_from_a_file(editor_page: OpenEditor, tmp_path: Path) -> None:
    editor = editor_page(LEVEL)
    other = tmp_path / "other.yaml"
    other.write_text(CHANGED, encoding="utf-8")
    opening = asked(editor.page, "Open another level", "Open a level")
    opening.get_by_label("File", exact=True).set_input_files(other)
    expect(opening).to_be_hidden()
    assert editor.session.text == CHANGED


# -- copying -------------------------------------------------------------------------------------


def test_the_level_is_copied_in_its_forms(editor_page: OpenEditor) -> None:
    page = editor_page(LEVEL, permissions=["clipboard-read", "clipboard-write"]).page
    copying = asked(page, "Copy or download", "Copy the level")
    shown = copying.get_by_label("What is copied")
    level = brl.loads(LEVEL)
    forms = {"Level file": LEVEL, "Drawing": level.draw(), "Share code": level.share_code()}
    for form, text in forms.items():
        copying.get_by_role("button", name=form).click()
        expect(shown).to_have_value(text)
        copying.get_by_role("button", name="Copy", exact=True).click()
        expect(copying.get_by_role("status")).to_have_text("Copied.")
        assert page.evaluate("navigator.clipboard.readText()") == text
    copying.get_by_role("button", name="Python").click()
    expect(shown).to_have_value(
        f'import babyrobot_levels as brl\n\nlevel = brl.loads("""\\\n{LEVEL}""")\n'
    )
    copying.get_by_role("button", name="Link").click()
    until(lambda: shown.input_value().startswith("#brl1."), "the link is shown")


def test_without_a_clipboard_the_text_is_copied_as_well(editor_page: OpenEditor) -> None:
    page = editor_page(LEVEL, permissions=["clipboard-read"]).page
    page.evaluate("() => { navigator.clipboard.writeText = () => Promise.reject(); }")
    copying = asked(page, "Copy or download", "Copy the level")
    expect(copying.get_by_label("What is copied")).to_have_value(LEVEL)
    copying.get_by_role("button", name="Copy", exact=True).click()
    expect(copying.get_by_role("status")).to_have_text("Copied.")
    assert page.evaluate("navigator.clipboard.readText()") == LEVEL


def test_a_level_without_a_file_is_downloaded(editor_page: OpenEditor) -> None:
    editor = editor_page(session_of("gallery/final-maze"))
    # At once: Python has not answered yet.
    editor.page.get_by_label("Level file").fill(CHANGED)
    with editor.page.expect_download() as saved:
        editor.page.get_by_role("button", name="Save").click()
    assert saved.value.suggested_filename == "final-maze.yaml"
    assert Path(saved.value.path()).read_text(encoding="utf-8") == CHANGED
    until(lambda: editor.session.is_saved, "the editor knows that it is saved")


# -- the file ------------------------------------------------------------------------------------


def test_ctrl_s_saves_what_was_typed_last(editor_page: OpenEditor, tmp_path: Path) -> None:
    editor, path = on_file(editor_page, tmp_path)
    area = editor.page.get_by_label("Level file")
    area.focus()
    editor.page.keyboard.press("Control+End")
    editor.page.keyboard.type("max_steps: 7")
    expect(editor.page).to_have_title("* Mine – editor")
    editor.page.keyboard.press("Control+s")
    expect(editor.page).to_have_title("Mine – editor")
    until(lambda: path.read_text(encoding="utf-8") == LEVEL + "max_steps: 7", "it is saved")
    expect(editor.page.get_by_text("mine.yaml, not saved")).to_have_count(0)


@pytest.mark.parametrize(
    ("button", "here", "in_file"),
    [
        ("Overwrite the file", CHANGED, CHANGED),
        ("Take the file's text", "version: 1\n", "version: 1\n"),
        ("Close", CHANGED, "version: 1\n"),
    ],
)
def test_of_two_changes_one_is_chosen(
    button: str, here: str, in_file: str, editor_page: OpenEditor, tmp_path: Path
) -> None:
    editor, path = on_file(editor_page, tmp_path)
    type_change(editor)
    path.write_text("version: 1\n", encoding="utf-8")
    conflict = asked(editor.page, "Save", "The file has changed")
    conflict.get_by_role("button", name="Show both").click()
    expect(conflict.get_by_label("Here")).to_have_value(CHANGED)
    expect(conflict.get_by_label("In the file")).to_have_value("version: 1\n")
    conflict.get_by_role("button", name=button).click()
    expect(conflict).to_be_hidden()
    expect(editor.page.get_by_label("Level file")).to_have_value(here)
    until(lambda: path.read_text(encoding="utf-8") == in_file, "the file is as it was decided")


def test_a_deleted_file_can_only_be_written_again(editor_page: OpenEditor, tmp_path: Path) -> None:
    editor, path = on_file(editor_page, tmp_path)
    type_change(editor)
    path.unlink()
    conflict = asked(editor.page, "Save", "The file has changed")
    expect(conflict.get_by_text("was deleted")).to_be_visible()
    expect(conflict.get_by_role("button", name="Take the file's text")).to_be_hidden()
    conflict.get_by_role("button", name="Overwrite the file").click()
    until(lambda: path.exists() and path.read_text(encoding="utf-8") == CHANGED, "it is written")


def test_ending_asks_about_changes_that_are_not_saved(
    editor_page: OpenEditor, tmp_path: Path
) -> None:
    editor, path = on_file(editor_page, tmp_path)
    type_change(editor)
    leaving = asked(editor.page, "End the editor", "End the editor?")
    leaving.get_by_role("button", name="Go on editing").click()
    expect(leaving).to_be_hidden()
    assert path.read_text(encoding="utf-8") == LEVEL
    leaving = asked(editor.page, "End the editor", "End the editor?")
    leaving.get_by_role("button", name="Save and end").click()
    expect(editor.page.get_by_text("The editor has ended.")).to_be_visible()
    assert path.read_text(encoding="utf-8") == CHANGED
