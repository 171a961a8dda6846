"""The editor's server, as a browser uses it: drawing, saving, and how it ends."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect
from support.editors import OpenEditor
from support.jupyter import until

from babyrobot_levels.editor.sources import session_of

TEXT = "version: 1\nsize: [3, 2]  # small\nstart: [0, 0]\nexit: [2, 1]\n"
ENDED = "The editor has ended. You can close this window."

pytestmark = pytest.mark.slow


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "small.yaml"
    path.write_text(TEXT, "utf-8")
    return path


def test_a_click_on_the_picture_changes_the_text(editor_page: OpenEditor) -> None:
    editor = editor_page(TEXT)
    editor.page.get_by_role("button", name="Small puddle").click()
    editor.page.locator(".stage svg").first.click()
    until(lambda: "puddles:" in editor.session.text, "the text changes")
    assert "# small" in editor.session.text


def test_a_file_is_saved_by_a_key_and_the_page_ends_the_server(
    editor_page: OpenEditor, file: Path
) -> None:
    editor = editor_page(session_of(file))
    page = editor.page
    page.get_by_role("textbox", name="Level file").fill(TEXT + "max_steps: 7\n")
    expect(page).to_have_title("* small – editor")
    page.keyboard.press("Control+s")
    expect(page).to_have_title("small – editor")
    assert file.read_text("utf-8") == TEXT + "max_steps: 7\n"
    page.get_by_role("button", name="End the editor").click()
    expect(page.locator("body")).to_have_text(ENDED)
    page.close(run_before_unload=True)


def test_unsaved_changes_are_told_before_the_page_ends_the_server(
    editor_page: OpenEditor, file: Path
) -> None:
    editor = editor_page(session_of(file))
    page = editor.page
    page.get_by_role("textbox", name="Level file").fill(TEXT + "max_steps: 7\n")
    until(lambda: not editor.session.is_saved, "it is typed")
    page.get_by_role("button", name="End the editor").click()
    page.get_by_role("button", name="Go on editing").click()
    page.get_by_role("button", name="End the editor").click()
    page.get_by_role("button", name="Save and end").click()
    expect(page.locator("body")).to_have_text(ENDED)
    assert file.read_text("utf-8") == TEXT + "max_steps: 7\n"


def test_what_another_program_wrote_is_overwritten_only_when_asked_for(
    editor_page: OpenEditor, file: Path
) -> None:
    editor = editor_page(session_of(file))
    page = editor.page
    page.get_by_role("textbox", name="Level file").fill(TEXT + "max_steps: 7\n")
    until(lambda: not editor.session.is_saved, "it is typed")
    file.write_text(TEXT + "max_steps: 8\n", "utf-8")
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_role("dialog")).to_contain_text("another program")
    assert file.read_text("utf-8") == TEXT + "max_steps: 8\n"
    page.get_by_role("button", name="Overwrite the file").click()
    until(lambda: file.read_text("utf-8") == TEXT + "max_steps: 7\n", "it is overwritten")


def test_a_copy_is_downloaded(editor_page: OpenEditor) -> None:
    editor = editor_page(session_of("gallery/final-maze"))
    page = editor.page
    page.get_by_role("textbox", name="Level file").fill(TEXT)
    until(lambda: editor.session.text == TEXT, "it is typed")
    with page.expect_download() as download:
        page.get_by_role("button", name="Save").click()
    assert download.value.suggested_filename == "final-maze.yaml"
    assert Path(download.value.path()).read_text("utf-8") == TEXT
    until(lambda: editor.session.is_saved, "the editor knows that it is saved")


def test_without_its_server_the_page_says_so_and_keeps_the_text(editor_page: OpenEditor) -> None:
    editor = editor_page(TEXT)
    page = editor.page
    page.context.set_offline(True)
    area = page.get_by_role("textbox", name="Level file")
    area.fill(TEXT + "max_steps: 7\n")
    expect(page.locator(".said")).to_contain_text("cannot be reached")
    assert area.input_value() == TEXT + "max_steps: 7\n"
