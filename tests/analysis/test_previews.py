"""`preview` and `play`: pictures and pages as objects that a notebook shows."""

from __future__ import annotations

from pathlib import Path

import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.picture_formats import FORMATS

pytestmark = pytest.mark.usefixtures("here")


@pytest.mark.parametrize("suffix", [name for name, each in FORMATS.items() if each.make])
def test_a_file_has_what_the_level_makes(suffix: str) -> None:
    level = brl.load("frozen-lake")
    Path(f"lake.{suffix}").write_bytes(b"replaced")
    found = brl.preview("frozen-lake", f"lake.{suffix}")
    made = getattr(level, f"to_{suffix}")()
    assert found.data == made
    assert found.format == suffix
    assert found.path is not None
    assert found.path.read_bytes() == (made.encode() if isinstance(made, str) else made)
    assert repr(found) == level.draw()


def test_a_notebook_shows_it() -> None:
    shown = {
        "svg": '<img src="data:image/svg+xml;base64,',
        "gif": '<img src="data:image/gif;base64,',
        "pdf": "<pre>+---+",
        "html": '<iframe srcdoc="&lt;!doctype html&gt;',
    }
    for kind, begins in shown.items():
        bundle = brl.preview("frozen-lake", format=kind)._repr_mimebundle_()
        assert bundle["text/html"].startswith(begins), kind
        assert bundle["text/plain"] == brl.load("frozen-lake").draw()


def test_options_are_those_of_the_picture() -> None:
    level = brl.load("frozen-lake")
    assert level.preview(values=True).data == level.to_svg(values=True)
    assert level.play("play.html", answers=False).data == level.to_html(answers=False)
    assert brl.preview(level, "page.HTM").format == "html"
    assert Path("play.html").read_text("utf-8") == brl.play(level, answers=False).data
    with pytest.raises(ValueError, match="there is no format 'bmp'"):
        brl.preview(level, "lake.bmp")


def test_a_random_maze_is_shown_with_a_seed() -> None:
    level = brl.load("random-maze")
    assert brl.preview(level).data == level.with_maze_seed(0).to_svg()
    assert brl.preview(level, maze_seed=7).data == level.with_maze_seed(7).to_svg()
    assert brl.preview(level, maze_seed=7).level.digest == level.with_maze_seed(7).digest
