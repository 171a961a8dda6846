"""The editor's server, as a browser uses it."""

from __future__ import annotations

import pytest
from support.editors import OpenEditor
from support.jupyter import until

TEXT = "version: 1\nsize: [3, 2]  # small\nstart: [0, 0]\nexit: [2, 1]\n"


@pytest.mark.slow
def test_a_click_on_the_picture_changes_the_text(editor_page: OpenEditor) -> None:
    editor = editor_page(TEXT)
    editor.page.locator("svg").first.click(position={"x": 80, "y": 60})
    until(lambda: editor.session.text != TEXT, "the text changes")
    assert "# small" in editor.session.text
