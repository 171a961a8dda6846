"""A level as the last line of a cell."""

from __future__ import annotations

import base64
import io
import sys
import xml.etree.ElementTree as ET
from types import SimpleNamespace
from typing import Any

import IPython
import pytest
from IPython.core.formatters import DisplayFormatter
from PIL import Image

import babyrobot_levels as brl
from babyrobot_levels.render.notebook.html import Frontend, frontend, in_notebook
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.svg import to_svg

PICTURES = {"image/svg+xml", "image/png", "text/plain"}


def shown(level: brl.Level) -> dict[str, str]:
    """Return what IPython makes of a level."""
    bundle, _ = DisplayFormatter().format(level)  # type: ignore[no-untyped-call]
    return dict(bundle)


def test_a_level_shows_its_picture_and_its_drawing() -> None:
    level = brl.load("final-maze")
    bundle = shown(level)
    assert set(bundle) == PICTURES
    assert bundle["image/svg+xml"] == to_svg(build_scene(level))
    assert bundle["text/plain"] == level.draw()
    picture = Image.open(io.BytesIO(base64.b64decode(bundle["image/png"])))
    svg = ET.fromstring(bundle["image/svg+xml"])
    assert (str(picture.width), str(picture.height)) == (svg.get("width"), svg.get("height"))


def test_a_level_whose_maze_is_random_shows_one_of_its_mazes() -> None:
    level = brl.load("random-maze")
    assert shown(level) == shown(level.with_maze_seed(0))


@pytest.mark.slow
def test_a_picture_that_is_wider_than_cells_is_as_wide_as_its_cell() -> None:
    # Without a size of its own. A narrow one would be enlarged.
    sizes = {}
    for columns in (3, 12, 13, 60):
        svg = ET.fromstring(shown(brl.Level(version=1, size=(columns, 3)))["image/svg+xml"])
        assert svg.get("viewBox")
        sizes[columns] = [svg.get("width"), svg.get("height")]
    assert sizes == {3: ["198", "198"], 12: ["774", "198"], 13: [None, None], 60: [None, None]}


@pytest.mark.slow
def test_the_picture_of_a_large_level_fits_on_a_screen() -> None:
    bundle = shown(brl.Level(version=1, size=(10, 100)))
    svg = ET.fromstring(bundle["image/svg+xml"])
    assert max(float(svg.get(side) or 0) for side in ("width", "height")) == pytest.approx(2048)
    bundle = shown(brl.Level(version=1, size=(60, 100)))
    picture = Image.open(io.BytesIO(base64.b64decode(bundle["image/png"])))
    assert 900_000 < picture.width * picture.height <= 1_000_000
    assert picture.width / picture.height == pytest.approx(0.6, rel=0.01)
    assert sum(map(len, bundle.values())) < 500_000


def test_of_a_level_that_is_far_too_large_only_words_are_shown() -> None:
    bundle = shown(brl.Level(version=1, size=(1024, 1024), title="All of it"))
    assert set(bundle) == {"text/plain"}
    assert bundle["text/plain"] == "All of it: 1024 × 1024 cells, too many for a notebook"


# -- the front end ---------------------------------------------------------------------------------


def kernel(*, allow_stdin: bool | None) -> SimpleNamespace:
    """Return a kernel that runs a cell, or with None handles another message."""
    content = {} if allow_stdin is None else {"allow_stdin": allow_stdin}
    return SimpleNamespace(get_parent=lambda: {"content": content})


@pytest.fixture
def run_by(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Have IPython say that it is another's shell."""
    monkeypatch.delenv("SERVER_SOFTWARE", raising=False)
    return lambda **shell: monkeypatch.setattr(
        IPython, "get_ipython", lambda: SimpleNamespace(**shell)
    )


def test_plain_python_is_no_notebook() -> None:
    assert IPython.get_ipython() is None
    assert not in_notebook()
    assert frontend() is Frontend.NONE


def test_python_without_ipython_is_no_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "IPython")
    assert not in_notebook()


def test_ipython_in_a_terminal_is_no_notebook(run_by: Any) -> None:
    run_by(ask_exit=lambda: None)
    assert not in_notebook()
    assert frontend() is Frontend.NONE


@pytest.mark.parametrize(
    ("allow_stdin", "expected"),
    [(True, Frontend.CANVAS), (None, Frontend.CANVAS), (False, Frontend.PROGRAM)],
)
def test_who_can_answer_is_a_person(
    allow_stdin: bool | None, expected: Frontend, run_by: Any
) -> None:
    run_by(kernel=kernel(allow_stdin=allow_stdin))
    assert in_notebook()
    assert frontend() is expected


def test_a_kernel_that_does_not_tell_has_a_person_before_it(run_by: Any) -> None:
    run_by(kernel=SimpleNamespace())
    assert frontend() is Frontend.CANVAS


def test_voila_runs_cells_as_programs_do_but_for_people(
    run_by: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_by(kernel=kernel(allow_stdin=False))
    monkeypatch.setenv("SERVER_SOFTWARE", "voila/0.5.8")
    assert frontend() is Frontend.CANVAS


@pytest.mark.parametrize(
    ("address", "expected"),
    [(None, Frontend.PICTURES), ("https://example.org/manager.js", Frontend.CANVAS)],
)
def test_colab_shows_a_canvas_once_it_has_been_allowed(
    address: str | None, expected: Frontend, run_by: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_by(kernel=kernel(allow_stdin=True))
    for name in ("google.colab", "google.colab.output"):
        monkeypatch.setitem(sys.modules, name, SimpleNamespace())
    widgets = SimpleNamespace(_installed_url=address)
    monkeypatch.setitem(sys.modules, "google.colab.output._widgets", widgets)
    assert in_notebook()
    assert frontend() is expected
