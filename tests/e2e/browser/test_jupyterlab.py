"""The picture in JupyterLab: drawn, walked in, written on, and still there the next day."""

from __future__ import annotations

from collections.abc import Iterator

import gymnasium
import pytest
from playwright.sync_api import Locator, Page
from support.jupyter import OpenNotebook, Served, jupyter, until
from support.pictures import Cell, Pixels, changed_cells, photograph, unlike

import babyrobot_levels as brl
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.layout import layout_of

LEVEL = brl.load("final-maze")
WAY = [2, 2, 3, 4, 4, 3, 2, 2, 2, 2]
SEED = 9

DRAW = f"""\
import gymnasium
import babyrobot_levels as brl

env = gymnasium.make("babyrobot/final-maze-v0", render_mode="human")
env.reset(seed={SEED})
env.render()"""

WALK = f"""\
for action in {WAY}:
    env.step(action)"""

WRITE = """\
best = brl.solve("final-maze")
env.unwrapped.show_info({"values": best.values, "policy": best.policy})"""

WIPE = "env.unwrapped.clear_info()"

SHOW = """\
import babyrobot_levels as brl
brl.load("final-maze")"""


WIDE = [
    "import babyrobot_levels as brl",
    'brl.Level(version=1, size=(40, 20), maze={"seed": 1})',
    'brl.strip([*brl.value_iteration("final-maze")][1:9:2])',
    'brl.diff("maze", "walls")',
    '[*brl.sarsa("cliff-walking", 50)][-1]',
    "brl.levels()[:3]",
]
"""Cells whose pictures would be wider than the cell, or as wide."""


# -- what should be seen ---------------------------------------------------------------------


def way() -> list[Cell]:
    """The cells on which the robot stands, from the start on."""
    env = gymnasium.make("babyrobot/final-maze-v0")
    place, _ = env.reset(seed=SEED)
    places = [place]
    for action in WAY:
        place, _, terminated, _, _ = env.step(action)
        assert not terminated
        places.append(place)
    return [(int(x), int(y)) for x, y in places]


def robot_in(picture: Pixels) -> set[Cell]:
    """The cells in which a picture shows more than the empty level: the robot's, or two."""
    return changed_cells(LEVEL, picture, to_rgb(build_scene(LEVEL, robot=False)))


def at_rest_in(cell: Cell, element: Locator) -> Pixels:
    """Wait until an element shows the robot standing in a cell; return what it shows."""

    def is_at_rest() -> bool:
        picture = photograph(element)
        return robot_in(picture) == {cell} and not unlike(photograph(element), picture).any()

    until(is_at_rest, f"the robot stands in {cell}")
    return photograph(element)


# -- JupyterLab ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    root, home = (tmp_path_factory.mktemp(name) for name in ("served", "jupyter"))
    with jupyter(root, home) as served:
        yield served


def canvas(notebook: OpenNotebook, number: int = 0) -> Locator:
    """The canvas in a cell's output."""
    return notebook.output(number).locator("canvas:visible")


# -- tests -----------------------------------------------------------------------------------


@pytest.mark.sweep
def test_a_walk_is_seen_and_what_is_written_on_the_level(served: Served, page: Page) -> None:
    served.write("walk.ipynb", DRAW, WALK, WRITE, WIPE)
    notebook = served.open(page, "walk.ipynb")
    view, places = canvas(notebook), way()

    notebook.run(0)
    drawn = at_rest_in(places[0], view)
    assert unlike(drawn, to_rgb(build_scene(LEVEL))).mean() < 0.02

    notebook.start(1)
    seen: set[Cell] = set()
    while not notebook.done(1):
        seen |= robot_in(photograph(view))
    walked = at_rest_in(places[-1], view)
    assert len(set(places[1:-1]) & seen) > 2

    notebook.run(2)
    others = set(layout_of(LEVEL).cells()) - {places[-1], *LEVEL.exits}
    until(
        lambda: changed_cells(LEVEL, photograph(view), walked, 0.03) >= others,
        "there is an arrow or a value in each cell but the exit",
    )
    notebook.run(3)
    until(lambda: not unlike(photograph(view), walked).any(), "they are gone")


@pytest.mark.sweep
def test_the_pictures_of_a_saved_notebook_are_still_there(served: Served, page: Page) -> None:
    served.write("first.ipynb", DRAW, WALK, SHOW)
    notebook = served.open(page, "first.ipynb")
    notebook.run(0, 1, 2)
    start, end = LEVEL.starts[0], way()[-1]
    at_rest_in(end, canvas(notebook))
    at_rest_in(start, notebook.still(2))
    notebook.save()

    # The kernel goes on, and paints for the new page.
    notebook.reload()
    at_rest_in(end, canvas(notebook))
    assert notebook.still().count() == 0
    at_rest_in(start, notebook.still(2))

    # Another kernel knows nothing of it. What was passed on by others JupyterLab does not trust.
    text = (served.root / "first.ipynb").read_text("utf-8")
    for name, source in (
        ("again.ipynb", text),
        ("passed-on.ipynb", text.replace("import gymnasium", "import  gymnasium")),
    ):
        (served.root / name).write_text(source, "utf-8")
        notebook = served.open(page, name)
        at_rest_in(end, notebook.still())
        assert "Error" not in notebook.output(0).inner_text()
        at_rest_in(start, notebook.still(2))


@pytest.mark.sweep
def test_pictures_fit_the_width_of_their_cell(served: Served, page: Page) -> None:
    page.set_viewport_size({"width": 700, "height": 900})
    served.write("wide.ipynb", *WIDE)
    notebook = served.open(page, "wide.ipynb")
    notebook.run(*range(len(WIDE)))
    notebook.save()
    text = (served.root / "wide.ipynb").read_text("utf-8")
    (served.root / "passed-on.ipynb").write_text(text.replace("import ", "import  "), "utf-8")
    for name in ("wide.ipynb", "passed-on.ipynb"):
        # What was passed on by others JupyterLab does not trust.
        notebook = served.open(page, name)
        for number in range(1, len(WIDE)):
            images = notebook.output(number).locator("img")
            images.first.wait_for()
            area = notebook.output(number).bounding_box()
            assert area
            for image in images.all():
                box = image.bounding_box()
                assert box
                assert box["width"] > 20
                assert box["x"] + box["width"] <= area["x"] + area["width"] + 1, (name, number)
