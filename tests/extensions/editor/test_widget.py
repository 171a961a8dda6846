"""The editor in notebooks: as an object of Python, and in a real JupyterLab."""

from __future__ import annotations

import asyncio
import re
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect
from support.jupyter import OpenNotebook, Served, jupyter, until

import babyrobot_levels as brl
from babyrobot_levels.extensions.editor import answers
from babyrobot_levels.extensions.editor.changes.draft import RefusedError
from babyrobot_levels.extensions.editor.notebook import edit
from babyrobot_levels.extensions.editor.widget import Editor

TEXT = "version: 1\nsize: [3, 2]  # small\nstart: [0, 0]\nexit: [2, 1]\n"
PUDDLE = {"do": "paint", "brush": "small", "cells": [[1, 1]]}


@pytest.fixture
def sent(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """What widgets send to their views."""
    messages: list[dict[str, Any]] = []
    monkeypatch.setattr(Editor, "send", lambda self, content: messages.append(content))
    return messages


def receive(editor: Editor, revision: int, **message: Any) -> None:
    """Let a widget receive a message of a view."""
    content = {"id": "a-1", "revision": revision, **message}
    editor._handle_custom_msg(content, [])


def level_of(editor: Editor) -> brl.Level:
    """Return the level of a widget that has one."""
    assert editor.level is not None
    return editor.level


# -- in Python -------------------------------------------------------------------------------


def test_what_is_drawn_is_in_the_level_and_the_text(sent: list[dict[str, Any]]) -> None:
    editor = edit(brl.loads(TEXT))
    changes: list[tuple[str, Any]] = []
    editor.observe(lambda change: changes.append((change.name, change.new)), ["level", "yaml"])
    receive(editor, 1, **PUDDLE)
    assert sent[-1]["id"] == "a-1"
    assert sent[-1]["state"]["text"] == editor.yaml
    assert "# small" in editor.yaml
    assert level_of(editor).to_dict() == brl.loads(editor.yaml).to_dict()
    assert [puddle.at for puddle in level_of(editor).puddles] == [(1, 1)]
    assert dict(changes) == {"level": editor.level, "yaml": editor.yaml}


def test_an_invalid_text_leaves_the_last_level(sent: list[dict[str, Any]]) -> None:
    editor = edit(brl.loads(TEXT))
    level = editor.level
    receive(editor, 1, do="text", text="version: 1\nsize: [")
    assert (editor.level, editor.yaml) == (level, "version: 1\nsize: [")


def test_a_text_that_is_set_in_python_is_shown_and_can_be_undone(
    sent: list[dict[str, Any]],
) -> None:
    editor = edit(brl.loads(TEXT))
    editor.yaml = TEXT.replace("[3, 2]", "[3, 3]")
    assert level_of(editor).size == (3, 3)
    assert sent[-1]["state"]["text"] == editor.yaml
    receive(editor, 2, do="undo")
    assert level_of(editor).size == (3, 2)


def test_the_kernel_goes_on_while_a_question_takes_long(
    sent: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(answers, "BUDGET", 0.0)
    editor = edit(brl.loads(TEXT))
    begun, go_on = Event(), Event()
    usual = answers.solved

    def slow(level: brl.Level) -> answers.Optimum:
        begun.set()
        assert go_on.wait(20)
        return usual(level)

    async def kernel() -> None:
        monkeypatch.setattr(answers, "solved", slow)
        receive(editor, 1, do="answers")
        await asyncio.to_thread(begun.wait, 20)
        receive(editor, 1, **PUDDLE)
        assert sent[-1]["state"]["revision"] == 2
        go_on.set()
        await until_sent(2)
        # What was asked of another text is neither told nor kept.
        assert "state" not in sent[-1]
        assert editor._session.answers.optimum is None
        receive(editor, 2, do="answers")
        await until_sent(3)
        assert sent[-1]["state"]["answers"]["status"] == "done"
        receive(editor, 2, do="copy", form="link")
        await until_sent(4)
        assert sent[-1]["copy"].startswith("#")

    async def until_sent(count: int) -> None:
        async with asyncio.timeout(20):
            while len(sent) < count:
                await asyncio.sleep(0.01)

    # In a thread of its own: the driver of the browser has a loop in this one.
    with ThreadPoolExecutor(1) as threads:
        threads.submit(asyncio.run, kernel()).result()


def test_a_level_is_saved_to_its_file_or_to_another_one(
    tmp_path: Path, sent: list[dict[str, Any]]
) -> None:
    editor = edit("gallery/final-maze")
    with pytest.raises(RefusedError, match="no file"):
        editor.save()
    editor.save(tmp_path / "maze.yaml")
    editor.yaml = TEXT
    editor.save()
    assert (tmp_path / "maze.yaml").read_text("utf-8") == TEXT
    assert edit(tmp_path / "maze.yaml").yaml == TEXT


@pytest.mark.slow
def test_it_takes_what_load_takes(tmp_path: Path) -> None:
    level = brl.load("final-maze")
    fields = {"version": 1, "size": [3, 2]}
    for given in ("gallery/final-maze", level, level.share_code(), level.to_dict(whole=True)):
        assert level_of(edit(given)).digest == level.digest
    assert level_of(edit(fields)).to_dict() == fields
    assert level_of(edit()).size == (8, 5)
    with pytest.raises(brl.LevelNotFoundError):
        edit("final-mace")
    with pytest.raises(TypeError):
        edit(7)  # type: ignore[arg-type]


@pytest.mark.slow
def test_outside_of_notebooks_it_is_the_widget_and_a_picture() -> None:
    bundle, _ = edit("gallery/final-maze")._repr_mimebundle_()
    assert {"application/vnd.jupyter.widget-view+json", "image/svg+xml", "image/png"} <= {*bundle}


def test_without_the_extra_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, Editor.__init__.__module__)
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(ImportError, match=r"needs the package `anywidget`.*extra `editor`"):
        brl.edit()


# -- in JupyterLab ---------------------------------------------------------------------------

OPEN = f"""\
import babyrobot_levels as brl
editor = brl.edit(brl.loads({TEXT!r}))
editor"""

AGAIN = "editor"

PAINTED = brl.loads(TEXT + "puddles:\n  - {at: [1, 1], size: small}\n").digest

SHOW = "print(len(editor.level.puddles), editor.level.digest)"


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    root, home = (tmp_path_factory.mktemp(name) for name in ("served", "jupyter"))
    with jupyter(root, home) as served:
        yield served


def drawing(notebook: OpenNotebook, number: int) -> Locator:
    """The picture on which one draws."""
    return notebook.output(number).locator(".stage svg[viewBox]")


def text(notebook: OpenNotebook, number: int) -> str:
    """The level file beside the picture."""
    return notebook.output(number).get_by_role("textbox", name="Level file").input_value()


def paint(notebook: OpenNotebook, number: int, x: int, y: int) -> None:
    """Paint a small puddle into a cell with the mouse."""
    output = notebook.output(number)
    output.get_by_role("button", name="Small puddle").click()
    picture = drawing(notebook, number)
    box = picture.bounding_box()
    assert box
    picture.click(position={"x": (x + 0.5) * box["width"] / 3, "y": (y + 0.5) * box["height"] / 2})


def restart(page: Page) -> None:
    """Restart the kernel as a user does, and wait for it."""
    page.locator(".jp-Toolbar").get_by_title("Restart the kernel").first.click()
    with page.expect_response(re.compile("/api/kernels/.*/restart")):
        page.locator(".jp-Dialog .jp-mod-accept").click()


@pytest.mark.slow
def test_it_draws_and_its_picture_stays(served: Served, page: Page) -> None:
    served.write("edit.ipynb", OPEN, SHOW, AGAIN)
    notebook = served.open(page, "edit.ipynb")
    notebook.run(0)
    drawing(notebook, 0).wait_for()
    paint(notebook, 0, 1, 1)
    until(lambda: "puddles:" in text(notebook, 0), "the text has the puddle")
    notebook.run(1)
    assert notebook.output(1).inner_text().split() == ["1", PAINTED]

    # Two views show the same level, and its keys are not Jupyter's.
    notebook.run(2)
    drawing(notebook, 2).wait_for()
    paint(notebook, 2, 1, 0)
    until(lambda: "[1, 0]" in text(notebook, 0), "the other view shows the second puddle")
    drawing(notebook, 2).hover()
    page.keyboard.press("Control+z")
    until(lambda: "[1, 0]" not in text(notebook, 0), "the key undoes it")
    for key in "bbadd":
        page.keyboard.press(key)
    assert page.locator(".jp-CodeCell").count() == 3
    assert notebook.still(0).count() == notebook.still(2).count() == 0

    # It is as dark as the notebook, whatever the system prefers.
    sheet = notebook.output(0).locator(".editor")
    for is_light, color in ("false", "rgb(20, 24, 30)"), ("true", "rgb(246, 244, 239)"):
        page.evaluate("is => (document.body.dataset.jpThemeLight = is)", is_light)
        expect(sheet).to_have_css("background-color", color)

    # The picture is renewed when one pauses.
    page.wait_for_timeout(2000)
    notebook.run(1)
    notebook.save()
    notebook.reload()
    drawing(notebook, 0).wait_for()
    restart(page)
    notebook.reload()
    for number in (0, 2):
        notebook.still(number).wait_for()
        assert drawing(notebook, number).count() == 0
        assert "Error" not in notebook.output(number).inner_text()
    notebook.run(1)
    assert "NameError" in notebook.output(1).inner_text()
