"""`render_mode="human"` and `"canvas"` in a Jupyter kernel, run as nbconvert would run it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from support.subprocesses import python

import babyrobot_levels as brl
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.info import overlay_from
from babyrobot_levels.render.situation import Pose
from babyrobot_levels.render.svg import to_svg

RUNNER = """
import json, sys
import nbformat
from nbclient import NotebookClient

cells = [nbformat.v4.new_code_cell(source) for source in json.loads(sys.argv[1])]
notebook = nbformat.v4.new_notebook(cells=cells)
NotebookClient(notebook, kernel_name="python3", timeout=60).execute()
print(json.dumps([cell["outputs"] for cell in notebook["cells"]]))
"""

MAKE = """
import babyrobot_levels as brl
env = brl.load("default").make(render_mode={mode!r})
info = {{"text": [((1, 1), "here")]}};
"""
INFO = {"text": [((1, 1), "here")]}
SVG = "image/svg+xml"

pytestmark = pytest.mark.slow


@pytest.fixture
def run_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return a function that runs cells in a kernel and returns what each put out."""
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    script = tmp_path / "runner.py"
    script.write_text(RUNNER, encoding="utf-8")

    def run(*cells: str) -> list[list[dict[str, Any]]]:
        # Jupyter's own warnings are no errors of ours.
        done = python("-W", "default", script, json.dumps(cells), cwd=tmp_path, timeout=120)
        assert done.returncode == 0, done.stderr[-3000:]
        outputs: list[list[dict[str, Any]]] = json.loads(done.stdout)
        return outputs

    return run


def pictures(outputs: list[dict[str, Any]]) -> list[str]:
    return [output["data"][SVG] for output in outputs if SVG in output.get("data", {})]


def svg(state: int, pose: Pose, *, with_info: bool = False) -> str:
    level = brl.load("default")
    overlay = overlay_from(INFO, level) if with_info else None
    return to_svg(build_scene(level, state=state, pose=pose, overlay=overlay))


def test_a_person_sees_one_picture_that_follows_the_episode(run_cells: Any) -> None:
    made, shown, later, done = run_cells(
        MAKE.format(mode="human"),
        "env.unwrapped.show_info(info); env.reset(); env.step(brl.Action.EAST); env.render()",
        "env.step(brl.Action.SOUTH);",
        "env.close(); env.close(); print('done')",
    )
    assert made == []
    # The picture stays where it was shown first, and is renewed there.
    assert pictures(shown) == [svg(4, Pose(brl.Action.SOUTH), with_info=True)]
    assert pictures(later) == []
    assert [output.get("text") for output in done] == ["done\n"]


def test_an_environment_as_the_last_line(run_cells: Any) -> None:
    _, wrapped, bare, watched = run_cells(
        MAKE.format(mode=None),
        "env.reset(); env.step(brl.Action.EAST); env.unwrapped.show_info(info); env",
        "env.unwrapped.clear_info(); env.unwrapped",
        "brl.load('default').make(render_mode='human')",
    )
    # The robot looked at nobody yet when he took his step.
    assert pictures(wrapped) == [svg(1, Pose(), with_info=True)]
    assert pictures(bare) == [svg(1, Pose())]
    assert pictures(watched) == [svg(0, Pose())]


def test_a_canvas_is_a_widget_that_follows_the_episode(run_cells: Any) -> None:
    code = """
from ipycanvas import MultiCanvas
canvas = env.render()
env.reset(); env.step(brl.Action.EAST)
assert isinstance(canvas, MultiCanvas)
assert env.render() is canvas
canvas
"""
    _, shown = run_cells(MAKE.format(mode="canvas"), code)
    assert "application/vnd.jupyter.widget-view+json" in shown[0]["data"]
