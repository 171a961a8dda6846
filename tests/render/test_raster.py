"""Pixels: the theme's colours where they belong, blended as they should, in bounded memory."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from PIL import Image
from support.work import counted_calls
from support.worlds import level

from babyrobot_levels.render import raster
from babyrobot_levels.render.colors import over, rgba
from babyrobot_levels.render.raster import to_png, to_rgb
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.shapes import Path, Rect, Scene, Shape, Text, curve, polyline


def painted(*shapes: Shape, side: int = 40) -> np.ndarray[Any, np.dtype[np.uint8]]:
    return to_rgb(Scene(side, side, shapes))


def solid(color: str) -> tuple[int, int, int]:
    return rgba(color)[:3]


# -- colours -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("color", "expected"),
    [
        ("red", (255, 0, 0, 1)),
        ("rebeccapurple", (102, 51, 153, 1)),
        ("#0f8", (0, 255, 136, 1)),
        ("#0f80", (0, 255, 136, 0)),
        ("#10203033", (16, 32, 48, 0.2)),
        ("rgba( 1 , 2 , 3 , .25 )", (1, 2, 3, 0.25)),
        ("hsl(240, 100%, 25%)", (0, 0, 128, 1)),
    ],
)
def test_colours_are_read(color: str, expected: tuple[float, ...]) -> None:
    assert rgba(color) == pytest.approx(expected)


def test_a_word_that_is_no_colour_is_refused() -> None:
    with pytest.raises(ValueError, match="invalid CSS colour"):
        rgba("reddish")


# -- shapes --------------------------------------------------------------------------------


def test_alpha_and_opacity_are_blended() -> None:
    picture = painted(
        Rect(0, 0, 40, 40, "orange"),
        Rect(0, 0, 20, 20, "rgba(0,0,255,0.5)"),
        Rect(20, 0, 20, 20, "#0000ff", opacity=0.5),
        Rect(0, 20, 20, 20, "rgba(0,0,255,0.5)", opacity=0.5),
    )
    for (x, y), opacity in {(5, 5): 0.5, (30, 5): 0.5, (5, 30): 0.25, (30, 30): 0.0}.items():
        expected = over(f"rgba(0,0,255,{opacity})", solid("orange"))
        assert picture[y, x].astype(int) == pytest.approx(expected, abs=2)


def test_what_overlaps_itself_is_blended_once() -> None:
    cross = polyline([(20, 0), (20, 40)]) + polyline([(0, 20), (40, 20)])
    picture = painted(Path(cross, stroke="black", width=10, opacity=0.5))
    assert set(np.unique(picture[18:22])) == {picture[5, 20, 0]}


def test_dashes_leave_gaps_in_straight_lines_and_in_curves() -> None:
    for line in (
        polyline([(0, 10), (40, 10)]),
        polyline([(0, 9.5), (40, 10.5)]),
        curve((0, 10), (20, 10.5), (40, 10)),
    ):
        picture = painted(Path(line, stroke="black", width=6, dash=(8, 8)))
        shown = [bool(picture[10, x, 0] < 128) for x in (4, 12, 20, 28, 36)]
        assert shown == [True, False, True, False, True]


def test_dashes_too_fine_to_be_seen_are_a_fainter_line() -> None:
    line = polyline([(0, 200), (400, 200)])
    scene = Scene(400, 400, (Path(line, stroke="black", width=40, dash=(4, 4)),))
    row = to_rgb(scene, (40, 40))[20, :, 0]
    assert len(np.unique(row)) == 1
    assert int(row[0]) == pytest.approx(128, abs=2)


def test_lines_thinner_than_a_pixel_are_faint() -> None:
    def darkness(width: float) -> float:
        scene = Scene(40, 40, (Path(polyline([(0, 20), (40, 20)]), stroke="black", width=width),))
        return 255.0 - float(to_rgb(scene, (40, 40))[:, 20, 0].astype(float).min())

    assert 0 < darkness(0.1) < darkness(0.5) < darkness(2) == 255


def test_texts_are_written_and_texts_too_small_to_read_are_not() -> None:
    text = Text(20, 24, "EXIT", 12, "black", bold=True)
    thin = Text(20, 24, "EXIT", 12, "black")
    ink = {shape: int((255 - painted(shape).astype(int)).sum()) for shape in (text, thin)}
    assert ink[text] > ink[thin] > 0
    assert (to_rgb(Scene(40, 40, (text,)), (10, 10)) == 255).all()


def test_anchors_hold_a_text_at_its_start_middle_and_end() -> None:
    def columns(anchor: Any) -> tuple[int, int]:
        xs = np.nonzero((painted(Text(20, 20, "mm", 10, "black", anchor)) < 128).any(axis=(0, 2)))
        return int(xs[0].min()), int(xs[0].max())

    assert columns("start")[0] >= 20 > columns("end")[1]
    left, right = columns("middle")
    assert (left + right) / 2 == pytest.approx(20, abs=1)


# -- levels --------------------------------------------------------------------------------


def test_a_picture_has_the_scene_s_size_or_the_one_asked_for() -> None:
    scene = build_scene(level(size=[4, 2]))
    assert to_rgb(scene).shape == (2 * 64 + 6, 4 * 64 + 6, 3)
    assert to_rgb(scene, (50, 70)).shape == (70, 50, 3)
    assert to_rgb(scene).dtype == np.uint8


@pytest.mark.parametrize("size", [(0, 10), (10, -1), (100_000, 100_000)])
def test_sizes_that_cannot_be_are_refused(size: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="pixels"):
        to_rgb(build_scene(level()), size)


def test_a_png_is_the_same_picture() -> None:
    scene = build_scene(level(size=[3, 2]))
    with Image.open(io.BytesIO(to_png(scene, (90, 60)))) as image:
        assert image.format == "PNG"
        assert np.array_equal(np.asarray(image), to_rgb(scene, (90, 60)))


def test_memory_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is painted at once never exceeds the bound, nor a picture without a size its own."""
    monkeypatch.setattr(raster, "MAX_PIXELS", 40_000)
    monkeypatch.setattr(raster, "MAX_SIDE", 100)
    sizes = []
    new = Image.new

    def record(mode: str, size: tuple[int, int], *more: Any) -> Image.Image:
        sizes.append(size[0] * size[1])
        return new(mode, size, *more)

    monkeypatch.setattr(Image, "new", record)
    scene = build_scene(level(size=[6, 6]))
    assert to_rgb(scene).shape == (100, 100, 3)
    assert to_rgb(scene, (199, 199)).shape == (199, 199, 3)
    assert max(sizes) <= 40_000


@pytest.mark.slow
def test_a_large_maze_is_painted_soon() -> None:
    world = level(size=[100, 100], maze={"seed": 1})
    world.grid()
    with counted_calls() as work:
        to_png(build_scene(world), (2048, 2048))
    assert work.calls < 10_000_000, work


def test_names_are_colours_also_when_pillow_used_them_before() -> None:
    Image.new("RGB", (1, 1), "rebeccapurple")
    assert rgba("rebeccapurple") == (102, 51, 153, 1.0)


@pytest.mark.parametrize("width", [0.0, 3.0])
def test_translucent_lines_that_are_apart_are_painted_as_if_they_were_together(
    width: float,
) -> None:
    """A line across the whole picture keeps its pieces together in one mask."""
    lines = [polyline([(x, y), (x + 5, y + 5)]) for x in (8, 40, 72) for y in (8, 40, 72)]
    commands = tuple(command for line in lines for command in line)
    far = (*polyline([(-9, -9), (-9, 200)]), *polyline([(-9, -9), (200, -9)]))
    look = {"stroke": "#fff", "width": width, "opacity": 0.5}
    apart, together = (
        to_rgb(Scene(100, 100, (Path(each, **look),)), (400, 400), "black")  # type: ignore[arg-type]
        for each in (commands, (*commands, *far))
    )
    assert (apart == together).all()
    assert apart.any() == (width > 0)


def test_many_translucent_lines_have_one_mask(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = [polyline([(x, y), (x + 5, y + 5)]) for x in (8, 40, 72) for y in (8, 40, 72)]
    path = Path(tuple(command for line in lines for command in line), stroke="red", opacity=0.5)
    apart = painted(path, side=400)
    monkeypatch.setattr(raster, "_MANY", 4)
    monkeypatch.setattr(raster, "_apart", None)
    assert (painted(path, side=400) == apart).all()


@pytest.mark.parametrize("anchor", ["start", "middle", "end"])
def test_a_minus_sign_is_a_bar_that_the_font_lacks(anchor: Any) -> None:
    def ink(text: str) -> np.ndarray[Any, Any]:
        shapes = Rect(0, 0, 40, 40, "white"), Text(20, 28, text, 16, "black", anchor)
        dark: np.ndarray[Any, Any] = painted(*shapes).min(axis=2) < 128
        return dark

    signed = ink("\N{MINUS SIGN}1")
    columns = np.flatnonzero(signed.any(axis=0))
    # First the bar, one run of pixels in each of its columns, then the figure, which is higher.
    heights = signed.sum(axis=0)[columns]
    assert heights[:4].max() <= 3 < heights[4:].max()
    assert (signed.any(axis=1) & signed[:, columns[0] + 1]).sum() <= 3
    assert ink("1").any(axis=0).sum() < columns.size
