"""Jupyter Notebook 7 has the canvas, the editor, and the pictures that stay, as JupyterLab has."""

from __future__ import annotations

from pathlib import Path

import gymnasium
import pytest
from playwright.sync_api import Page
from support.jupyter import jupyter, until
from support.pictures import changed_cells, photograph

import babyrobot_levels as brl
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_scene

LEVEL = brl.load("final-maze")
EMPTY = to_rgb(build_scene(LEVEL, robot=False))
WAY = [2, 2, 3, 4]

DRAW = """\
import babyrobot_levels as brl
env = brl.load("final-maze").make(render_mode="human")
env.reset(seed=9)
env.render()"""
WALK = f"for action in {WAY}: env.step(action)"
EDIT = """\
editor = brl.edit(brl.Level(version=1, size=(3, 2)))
editor"""
TOLD = "print(editor.yaml)"


def end() -> tuple[int, int]:
    """The cell to which the way leads."""
    env = gymnasium.make("babyrobot/final-maze-v0")
    env.reset(seed=9)
    for action in WAY:
        (x, y), *_ = env.step(action)
    return int(x), int(y)


@pytest.mark.sweep
def test_a_level_is_walked_in_edited_and_kept(page: Page, tmp_path: Path) -> None:
    root, home = tmp_path / "served", tmp_path / "home"
    root.mkdir()
    with jupyter(root, home, "notebook") as served:
        served.write("walk.ipynb", DRAW, WALK, EDIT, TOLD)
        notebook = served.open(page, "walk.ipynb")
        notebook.run(0, 1, 2)
        canvas = notebook.output(0).locator("canvas:visible")
        until(
            lambda: changed_cells(LEVEL, photograph(canvas), EMPTY) == {end()},
            "the robot stands where the way ends",
        )
        editor = notebook.output(2)
        editor.get_by_role("button", name="Small puddle").click()
        editor.locator(".stage svg[viewBox]").click()
        until(
            lambda: "puddles:" in editor.get_by_role("textbox", name="Level file").input_value(),
            "the text has the puddle",
        )
        notebook.run(3)
        assert "- {at: [1, " in notebook.output(3).inner_text()
        notebook.save()
        # What others passed on has no kernel, and its scripts are not trusted.
        text = (root / "walk.ipynb").read_text("utf-8")
        (root / "passed-on.ipynb").write_text(text.replace("import ", "import  "), "utf-8")
        notebook = served.open(page, "passed-on.ipynb")
        still = notebook.still(0)
        still.wait_for()
        assert changed_cells(LEVEL, photograph(still), EMPTY) == {end()}
