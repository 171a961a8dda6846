"""What a kernel puts out, and so what a notebook stores: pictures that need no kernel."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

from support.kernels import Message, run_cells

import babyrobot_levels as brl
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.situation import Pose
from babyrobot_levels.render.svg import to_svg

WIDGET = "application/vnd.jupyter.widget-view+json"
SVG = "image/svg+xml"
PICTURE = {SVG, "image/png", "text/plain"}

LEVEL = brl.Level(version=1, size=(4, 3))
VIEW = """\
import babyrobot_levels as brl
from babyrobot_levels.render.notebook.view import LevelView

view = LevelView(brl.Level(version=1, size=(4, 3)), speed=50)
"""
LAST_LINE = """\
class Shown:
    def __init__(self, view): self.view = view
    def _repr_mimebundle_(self, **_): return self.view.mimebundle()

"""
WALK = "for state in (1, 2, 3, 7): view.move(state)"

COLAB = """\
import sys, types

for name in ("google.colab", "google.colab.output", "google.colab.output._widgets"):
    sys.modules[name] = types.ModuleType(name)
"""


def shown(cell: list[Message]) -> list[dict[str, Any]]:
    """Return what a cell puts out for the first time."""
    return [told["data"] for kind, told in cell if kind in ("display_data", "execute_result")]


def renewed(cell: list[Message]) -> list[dict[str, Any]]:
    """Return what a cell puts in the place of what is there already."""
    return [told["data"] for kind, told in cell if kind == "update_display_data"]


def kinds(cell: list[Message]) -> list[str]:
    return [kind for kind, _ in cell]


def ends_of(cell: list[Message]) -> list[str]:
    return [told["ename"] for kind, told in cell if kind == "error"]


def is_picture(bundle: dict[str, Any], state: int, pose: Pose = Pose()) -> bool:  # noqa: B008
    """Return whether something is the picture of the level with the robot in a state."""
    svg = ET.fromstring(bundle[SVG])
    svg.attrib.pop("class", None)
    expected = ET.fromstring(to_svg(build_scene(LEVEL, state=state, pose=pose)))
    return set(bundle) == PICTURE and ET.tostring(svg) == ET.tostring(expected)


def test_a_person_sees_a_widget_and_the_notebook_keeps_a_picture_beside_it(tmp_path: Path) -> None:
    show, walk, nothing, close, again, later = run_cells(
        VIEW + "view.show()\nview.show()",
        WALK,
        "1",
        "view.move(6); view.close(); view.close()",
        LAST_LINE + "other = LevelView(brl.Level(version=1, size=(4, 3)))\nShown(other)",
        "Shown(other)",
        person=True,
        home=tmp_path,
    )
    style, picture, widget = shown(show)
    name = ET.fromstring(picture[SVG]).get("class") or ""
    assert f":is(canvas, div).{name}" in style["text/html"]
    assert is_picture(picture, 0)
    assert set(widget) == {WIDGET, "text/plain"}
    # Where it is not shown, nothing stands for it below the picture.
    assert widget["text/plain"] == ""
    assert name.endswith(widget[WIDGET]["model_id"])
    opened = [told for kind, told in show if kind == "comm_open"]
    layers = {"_dom_classes": [name]}
    changed = [told["data"].get("state") for kind, told in show if kind == "comm_msg"]
    assert len(opened) > 6
    assert layers in changed

    # Whatever happens in a cell, the stored picture is renewed once.
    assert shown(walk) == []
    assert kinds(walk).count("comm_msg") == 4
    assert [is_picture(bundle, 7) for bundle in renewed(walk)] == [True]
    assert renewed(nothing) == []

    assert [is_picture(bundle, 6) for bundle in renewed(close)] == [True]
    assert "comm_close" in kinds(close)

    # As the last line of a cell it is shown likewise, and the next time as it is by then.
    other_style, other_picture, other_widget = shown(again)
    assert is_picture(other_picture, 0)
    assert other_style != style
    assert set(other_widget) == {WIDGET, "text/plain"}
    assert "execute_result" in kinds(again)
    assert [is_picture(bundle, 0) for bundle in shown(later)] == [True]
    cells = show, walk, nothing, close, again, later
    assert [ends_of(cell) for cell in cells] == 6 * [[]]


def test_a_program_gets_one_picture_a_cell_and_no_widgets(tmp_path: Path) -> None:
    show, walk, last, close = run_cells(
        VIEW + "view.show()",
        WALK,
        LAST_LINE + "Shown(view)",
        "view.move(6); view.close()",
        person=False,
        home=tmp_path,
    )
    assert [is_picture(bundle, 0) for bundle in shown(show)] == [True]
    assert [is_picture(bundle, 7) for bundle in renewed(walk)] == [True]
    assert [is_picture(bundle, 7) for bundle in shown(last)] == [True]
    assert [is_picture(bundle, 6) for bundle in renewed(close)] == [True]
    for cell in (show, walk, last, close):
        assert ends_of(cell) == []
        assert not [kind for kind in kinds(cell) if kind.startswith("comm_")]


def test_where_there_is_no_canvas_every_step_is_a_picture_and_a_line_says_so(
    tmp_path: Path,
) -> None:
    show, walk = run_cells(COLAB + VIEW + "view.show()", WALK, person=True, home=tmp_path)
    picture, note = shown(show)
    assert is_picture(picture, 0)
    assert "enable_custom_widget_manager" in note["text/plain"]
    assert [
        is_picture(bundle, state) for bundle, state in zip(renewed(walk), (1, 2, 3, 7), strict=True)
    ] == 4 * [True]
    assert [ends_of(cell) for cell in (show, walk)] == [[], []]
